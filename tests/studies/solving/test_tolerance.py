"""The setting ``tolerance``: honoured by every algorithm and by arc length, and it is the claim that is judged."""

from __future__ import annotations

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.verify import claim, judge
from studies.ask.scene import UsageError
from studies.scenes.complete import complete
from studies.solving.result import Result
from studies.solving.solve import solve

LOOSE = 1e-2


def solved(scene: str, mesh: str, contact: str = "semismooth", **settings: str) -> Result:
    solution = solve(*complete(scene, settings, mesh, contact=contact))
    assert solution.outcome.converged
    return solution


@pytest.mark.parametrize(
    "contact",
    [pytest.param(name, marks=[pytest.mark.slow] if name == "trial-and-error" else []) for name in ALGORITHMS],
)
def test_every_algorithm_stops_where_it_is_told_and_says_no_more(contact: str) -> None:
    tight, loose = (solved("tyre", "12x12", contact, delta_mm="10", **t) for t in ({}, {"tolerance": str(LOOSE)}))
    assert loose.counters["newton_iterations"] < tight.counters["newton_iterations"]
    for actual in (tight, loose):
        assert actual.steps[-1]["failures"] == []
    assert loose.steps[-1]["kkt"]["equilibrium"] <= LOOSE
    assert tight.steps[-1]["kkt"]["equilibrium"] <= 10 * RESIDUAL_TOLERANCE
    assert loose.steps[-1]["force_N"] == pytest.approx(tight.steps[-1]["force_N"], rel=LOOSE)


def test_the_default_is_what_it_was() -> None:
    usual, stated = (solved("tyre", "12x12", delta_mm="20", **t) for t in ({}, {"tolerance": "1e-9"}))
    assert np.array_equal(usual.last.u, stated.last.u)
    assert usual.counters == stated.counters


def test_a_loose_answer_is_wrong_for_who_claims_more() -> None:
    """Must fail beside must pass."""
    scene, request = complete("cantilever", {"tolerance": "1e-1"}, "16x1")
    solution = solve(scene, request)
    *_, stage = solution.model.stages()
    verdict = judge(stage.begin(None)[0](1.0), solution.last.u, solution.last.pressure)
    n = len(solution.last.u)
    assert "equilibrium" in verdict.failures(**claim(RESIDUAL_TOLERANCE, n))
    assert "equilibrium" in verdict.failures(**claim(1e-4, n))
    assert verdict.failures(**claim(1e-1, n)) == []


@pytest.mark.slow
def test_arc_length_honours_it() -> None:
    tight, loose = (solved("roof-a", "4x4", path="arc-length", tolerance=t) for t in ("1e-9", "1e-3"))
    assert loose.counters["newton_iterations"] < tight.counters["newton_iterations"]
    assert loose.steps[-1]["failures"] == tight.steps[-1]["failures"] == []


@pytest.mark.parametrize("value", ["0", "1e-15", "0.2", "nan", "x"])
def test_a_value_out_of_range_is_one_line(value: str) -> None:
    with pytest.raises(UsageError, match=r"tolerance = '.*' must be a number in \[1e-14, 0\.1\]"):
        complete("hemisphere", {"tolerance": value})
