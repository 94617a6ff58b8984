"""Answers that differ: which cells are the same problem, and why they end apart; on records made up, and on solves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pandas as pd
import pytest

from studies.analysis.agreement import disagreements
from studies.ask.request import Request, Settings
from studies.ask.settings import configured
from studies.fuzz.comparing import AGREES, Answer, compared
from studies.scenes.complete import complete
from studies.solving.disagreement import BEYOND, BRANCHES, LOAD_STEPS, SYMMETRY, UNSTABLE, Facts, why
from studies.solving.result import Result
from studies.solving.solve import solve


def test_why_is_told_by_facts() -> None:
    for one, other, said in (
        (Facts(True, 1, True), Facts(True, 7, True), LOAD_STEPS),
        (Facts(True, 7, True), Facts(True, 7, True), BEYOND),
        (Facts(False, 1, True), Facts(False, 7, False), UNSTABLE),
        (Facts(False, 1, False), Facts(False, 1, False), UNSTABLE),
        (Facts(False, 1, True), Facts(False, 7, True), BRANCHES),
        (Facts(False, 1, True, "half", (0.0, 0.3)), Facts(False, 1, True, "full", (0.01, 0.3)), SYMMETRY),
        (Facts(False, 1, True, "half", (0.0, 0.3)), Facts(False, 1, True, "full", (0.0, 0.3)), BRANCHES),
        (Facts(False, 1, True, "full", (0.0, 0.3)), Facts(False, 1, True, "full", (0.1, 0.3)), BRANCHES),
    ):
        assert why(one, other) == why(other, one) == said


def cell(label: str, force: float, **changed: Any) -> dict[str, Any]:
    """A cell of the tyre, as collect has it."""
    settings = {"epsilon": math.inf, "tolerance": 1e-9, "delta_mm": (5.0,), **changed.get("settings", {})}
    options = {"contact": "semismooth", "model": "full", "steps": 1, **changed.get("options", {})}
    request = Request("tyre", mesh=(14, 12), settings=Settings(settings), **options)
    row = {"label": label, "scene": "tyre", "contact": options["contact"], "model": options["model"]}
    row |= {"mesh": "14x12", "outcome": "converged", "tolerance": settings["tolerance"], "command": f"solve {label}"}
    row |= {"request": request, "q.force_N": force, "q.friction_N": changed.get("friction", math.nan)}
    row |= {"q.central_asymmetry": changed.get("asymmetry", 0.0), "q.mirror_asymmetry": 0.2, "c.substeps": 1}
    return {**row, **changed.get("row", {})}


def found(*cells: dict[str, Any]) -> list[dict[Any, Any]]:
    return disagreements(pd.DataFrame(cells)).to_dict("records")


def test_the_answer_of_most_cells_stands_beside_each_further_one() -> None:
    by = [cell(name, 10.0 + 1e-8, options={"contact": name}) for name in ("qp", "lcp")]
    (row,) = found(cell("one", 11.0, options={"contact": "trial-and-error"}), *by)
    assert row["label"] in ("qp", "lcp")
    assert (row["other_label"], row["quantity"], row["why"]) == ("one", "force_N", BRANCHES)
    assert row["difference"] == pytest.approx(1 / 11)


def test_what_asks_another_problem_is_not_compared() -> None:
    one = cell("one", 10.0)
    assert not found(one, cell("mu", 11.0, settings={"mu": 0.5}))
    assert not found(one, cell("soft", 11.0, settings={"epsilon": 1e4}))
    assert not found(one, cell("loose", 11.0, settings={"tolerance": 1e-4}))  # its error is the solver's
    assert not found(one, cell("wrong", 11.0, row={"outcome": "wrong"}))
    assert not found(one, cell("alike", 10.0 * (1 + 5e-7), options={"contact": "lcp"}))
    assert found(one, cell("other", 10.0 * (1 + 5e-6), options={"contact": "lcp"}))


def test_no_friction_is_no_difference_beside_a_force() -> None:
    rubbed = {"settings": {"mu": 0.5}}
    assert not found(cell("a", 10.0, friction=1e-13, **rubbed), cell("b", 10.0, friction=9e-13, **rubbed))


def test_a_pair_has_its_class() -> None:
    cases: tuple[tuple[dict[str, Any], str], ...] = (
        ({"settings": {"mu": 0.5}, "row": {"c.substeps": 7}}, LOAD_STEPS),
        ({"settings": {"mu": 0.5}, "options": {"contact": "lcp"}}, BEYOND),
        ({"options": {"contact": "lcp"}, "row": {"outcome": "unstable"}}, UNSTABLE),
        ({"options": {"model": "half"}, "asymmetry": 0.0}, SYMMETRY),
    )
    for changed, said in cases:
        usual = {"settings": changed.get("settings", {}), "asymmetry": 0.1 if said == SYMMETRY else 0.0}
        rows = found(cell("one", 10.0, **usual), cell("other", 11.0, **changed))
        assert [row["why"] for row in rows] == [said]


def test_the_pair_that_was_solved_most_alike_decides() -> None:
    """Of two further cells in one answer the one in the same steps shows that steps are not what decides."""
    rubbed = {"settings": {"mu": 2.0}}
    others = [
        cell("cut", 11.0, **rubbed, row={"c.substeps": 5}),
        cell("alike", 11.0, **rubbed, options={"contact": "qp"}),
    ]
    majority = [cell(f"{i}", 10.0, **rubbed) for i in range(3)]
    (row,) = found(*majority, *others)
    assert (row["other_label"], row["why"]) == ("alike", BEYOND)


# --- solves -----------------------------------------------------------------------------------------------------------


def answer(result: Result) -> Answer:
    assert result.end is not None
    algorithm = configured(result.request.contact, result.request.settings)
    return Answer(result.end.problem, result.end.point.solution, algorithm, result.ways)


def test_two_step_cuts_of_a_drag_are_told_with_their_numbers() -> None:
    asked = {"shape": "plate", "mu": 0.4, "delta_mm": 0.5, "drag_mm": 0.1}
    one, other = (solve(*complete("panel", asked, "6x6", steps=steps)) for steps in (1, 2))
    again = solve(*complete("panel", asked, "6x6", contact="lcp"))
    assert compared(answer(one), answer(again)) == AGREES
    said = compared(answer(one), answer(other))
    assert said.startswith(f"{LOAD_STEPS}: 2 and 4 on the path, apart by ")
    # the same steps, and a state that is none of both ways of solving: nothing explains that
    moved = answer(other)
    false = replace(moved, ways=one.ways, state=replace(moved.state, u=1.01 * moved.state.u))
    assert compared(answer(one), false) == ""


def test_equilibria_of_a_snapping_cap_are_told_apart_by_stability() -> None:
    """Below its limit load a cap has three: before, between and beyond the limit points; that between is unstable."""
    result = solve(*complete("shallow-cap", {}, "8x2"))
    assert result.end is not None
    load = 0.9 * result.quantities["limit_load_fraction"]
    algorithm = configured(result.request.contact, result.request.settings)
    problem = result.end.problem_at(load)
    before, between, beyond = (
        Answer(problem, result.at(load, passage), algorithm, result.ways) for passage in range(3)
    )
    assert compared(before, between).startswith(f"{UNSTABLE}: 0 and 1 eigenvalues")
    assert compared(between, beyond).startswith(f"{UNSTABLE}: 1 and 0 eigenvalues")
    assert compared(before, beyond).startswith(f"{BRANCHES}, each confirmed")
