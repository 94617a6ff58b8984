"""The settings of OSQP: each is another one, all that run are right, and effects are against the same scale."""

from __future__ import annotations

import pandas as pd
import pytest

from studies.arena.answers import accuracy
from studies.arena.solver_summaries import effects
from studies.arena.solvers import catalogue
from studies.arena.solvers.catalogue import ABLATION, SETTINGS
from support.problems.arena_steps import known_step

VARIANTS = {solver.name: solver for solver in ABLATION}


@pytest.mark.parametrize("name", [name for name, solver in VARIANTS.items() if solver.missing() is None])
def test_variants_find_the_answer(name: str) -> None:
    step, *_ = known_step(1)
    found = VARIANTS[name].solve(step, 1e-6)
    assert found.claimed, found.reason
    assert accuracy(step, found.du, found.pressure).worst < 1e-4


def test_a_warm_start_saves_iterations() -> None:
    step, *_ = known_step(1)
    for scale in ("OSQP", "OSQP, scaled"):
        cold, warm = (VARIANTS[f"{scale}: {name}"].solve(step, 1e-5).iterations for name in ("defaults", "warm start"))
        assert warm < cold


def test_settings_arrive() -> None:
    """Another first rho that is never adapted takes another number of iterations; a name OSQP does not know is told."""
    step, *_ = known_step(1)
    spent = {
        name: VARIANTS[f"OSQP: {name}"].solve(step, 1e-8).iterations for name in ("defaults", "rho 1e-3", "rho 1e3")
    }
    assert len(set(spent.values())) == 3


def test_each_setting_is_there_on_both_scales() -> None:
    names = {name.split(": ")[1] for name in VARIANTS if name.startswith("OSQP: ")}
    assert names == {*SETTINGS, "warm start", "reduced KKT"}
    assert {name.split(": ")[1] for name in VARIANTS if "scaled" in name} == names | {"condensed"}


def test_the_reduced_system_is_listed_where_it_is_missing() -> None:
    reason = VARIANTS["OSQP: reduced KKT"].missing()
    assert (reason is None) == bool(catalogue._algebra())


def test_effects_by_hand() -> None:
    rows = [
        ("OSQP: defaults", 2.0, 8, 1),
        ("OSQP: polished", 3.0, 9, 0),
        ("OSQP, scaled: defaults", 1.0, 10, 0),
        ("OSQP, scaled: polished", 0.5, 10, 2),
    ]
    summed = pd.DataFrame(rows, columns=["solver", "mean_s", "solved", "false"])
    summed = summed.assign(tolerance=1e-6, kind="convex", size="all", problems=10)
    found = effects(summed).set_index(["scale", "setting"])
    assert found["time_ratio"].to_dict() == {
        ("OSQP", "defaults"): 1.0,
        ("OSQP", "polished"): 1.5,
        ("OSQP, scaled", "defaults"): 1.0,
        ("OSQP, scaled", "polished"): 0.5,
    }
    assert tuple(found.loc[("OSQP", "polished"), ["more_solved", "more_false"]]) == (1, -1)
    assert tuple(found.loc[("OSQP, scaled", "polished"), ["more_solved", "more_false"]]) == (0, 2)
