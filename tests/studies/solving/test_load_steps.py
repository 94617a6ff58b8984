"""The error of load steps with friction: of first order, within its interval, of automatic cuts, too, and said so."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from contact.events import Event, EventKind
from studies.cli import main
from studies.footprint import solve as solve_in_a_notebook
from studies.scenes.complete import complete
from studies.solving.load_steps import TABLE, StepError, estimate, lines
from studies.solving.result import Result
from studies.solving.solve import solve

PLATE: Mapping[str, Any] = {"shape": "plate", "mu": 0.4, "delta_mm": 0.5, "drag_mm": (0.02, 0.1)}
CASES: dict[str, tuple[str, str, Mapping[str, object]]] = {
    "plate": ("panel", "6x6", PLATE),
    "cylinder": ("panel", "6x6", {"mu": 0.3, "drag_mm": (0.1, 0.3)}),
    "strip": ("strip-contact", "32x1", {"mu": 0.4}),
    "annulus": ("plate-contact", "32x1", {"mu": 0.4}),
}


def path(case: str, steps: int = 1) -> Result:
    scene, mesh, settings = CASES[case]
    result = solve(*complete(scene, settings, mesh, steps=steps))
    assert result.verdict == "converged"
    return result


@pytest.mark.parametrize("case", [pytest.param(case, marks=pytest.mark.slow) for case in CASES])
def test_the_limit_of_small_steps_is_in_every_interval(case: str) -> None:
    """The limit: of first order from 8 and 16 steps.  Where both paths agree there is no interval."""
    result, eight, sixteen = path(case), path(case, 8), path(case, 16)
    estimate(result)
    rows = [row for row in result.table(TABLE).rows() if row["low"] is not None]
    assert len(rows) >= 4
    limits = [
        {name: 2 * value - coarse.quantities[name] for name, value in fine.quantities.items()}
        for coarse, fine in zip(eight.loads, sixteen.loads, strict=True)
    ]
    loads = [next(iter(step.seen.values())) for step in result.loads]
    for row in rows:
        assert row["low"] <= limits[loads.index(row["load"])][row["quantity"]] <= row["high"], row


@pytest.mark.slow
def test_the_error_is_of_first_order_once_steps_are_small() -> None:
    """Half the steps, half the estimate; and with so many steps it is the error itself within a fifth."""
    values = []
    for steps in (8, 16):
        result = path("plate", steps)
        estimate(result)
        last = list(result.table(TABLE).rows())
        values.append({row["quantity"]: row for row in last if row["load"] == 0.02})
    for name in ("friction_N", "dissipation_N_mm"):
        assert values[1][name]["error"] / values[0][name]["error"] == pytest.approx(0.5, abs=0.06), name
        limit = values[1][name]["value"] + values[1][name]["error"]
        assert limit - values[0][name]["value"] == pytest.approx(values[0][name]["error"], rel=0.2), name


@pytest.mark.slow
def test_the_answer_stays_that_of_the_steps_asked_for() -> None:
    plain, stated = path("plate"), path("plate")
    estimate(stated)
    assert stated.quantities == plain.quantities
    assert [step.flat for step in stated.loads] == [step.flat for step in plain.loads]
    twice = path("plate", 2)
    halved = [row for row in stated.table(TABLE).rows() if row["quantity"] == "friction_N"]
    assert [row["halved"] for row in halved] == [step.quantities["friction_N"] for step in twice.loads]
    assert [(row["substeps"], row["halved_substeps"]) for row in halved] == [(1, 2)] * 3
    assert [row["stage"] for row in halved] == ["load", "drag", "drag"]
    low, high = (stated.errors["friction_N"][key] for key in ("low", "high"))
    error = 2 * (halved[-1]["halved"] - halved[-1]["value"])
    assert (low, high) == pytest.approx((halved[-1]["value"] - 3 * abs(error), halved[-1]["value"] + 3 * abs(error)))


@pytest.mark.slow
def test_a_step_that_was_cut_is_halved_in_its_parts_and_the_cut_is_printed() -> None:
    result = path("plate")
    stage, (end,) = result.ways[-1]
    (begin,) = result.ways[-2][1]
    result.ways[-1] = (stage, (begin + (end - begin) / 4, end))  # as if the last step had been cut
    result.history.append({"event": Event(EventKind.STEP_CUT, "step cut to 0.02")})
    estimate(result)
    last = [row for row in result.table(TABLE).rows() if row["quantity"] == "friction_N"][-1]
    assert last["halved_substeps"] == 4
    assert lines(result)[-1] == "load steps: step cut to 0.02"


@pytest.mark.parametrize(("fractions", "stated"), [((0.0,), []), ((0.0, 5.0, 7.0), [5.0, 7.0])])
def test_a_load_without_a_step_has_no_error_of_steps(fractions: tuple[float, ...], stated: list[float]) -> None:
    result = solve(*complete("strip-contact", {"mu": 0.4, "load_fraction": fractions}, "16x1"))
    estimate(result)
    rows = [row for each in result.tables.get(TABLE, []) for row in each.rows() if row["quantity"] == "half_force"]
    assert [row["load"] for row in rows] == stated
    values = {step.seen["load_fraction"]: step.seen["half_force"] for step in result.loads}
    assert [row["value"] for row in rows] == [values[load] for load in stated]
    assert all(0 < row["halved"] == pytest.approx(row["value"], rel=0.1) for row in rows)


def test_paths_that_agree_say_nothing() -> None:
    assert StepError("force_N", 10.0, 10.0 + 1e-9, 1e-8).interval == {}
    assert StepError("force_N", 10.0, 10.5, 1e-8).interval == {"low": 7.0, "high": 13.0}


def test_a_resultant_that_turns_round_is_not_taken_for_the_same() -> None:
    """In one step the strip is pulled outwards, in more of them inwards, by all but the same force."""
    result = solve(*complete("strip-contact", {"mu": 0.3, "load_fraction": (0.0, 5.0)}, "32x1"))
    estimate(result)
    (row,) = (row for row in result.table(TABLE).rows() if row["quantity"] == "friction_N" and row["load"] == 5.0)
    assert row["halved"] == pytest.approx(row["value"], rel=1e-3)
    assert abs(row["error"]) == pytest.approx(2 * (row["value"] + row["halved"]), rel=1e-9)
    assert row["low"] < -row["value"]
    assert any("turned by 180 degrees; " in line for line in lines(result))


@pytest.mark.slow
def test_friction_at_its_bound_is_not_known_where_nothing_shows_slip() -> None:
    """Two equal rings are mirror images: nothing rubs, and in many steps friction goes to 0.

    In two steps and in four all candidates slip, by the way before they touch, and friction is that of Coulomb's bound.
    """
    settings = {"mu": 0.2, "delta_mm": (40.0,), "other_elements": 100}
    result = solve(*complete("two-rings", settings, "1x24"))
    assert result.quantities["friction_N"] > 0.99 * result.quantities["bound_N"]
    estimate(result)
    assert result.errors["friction_N"]["low"] <= 0 < result.quantities["bound_N"] <= result.errors["friction_N"]["high"]
    assert any("does not show any slip, so it is only known to lie within 40.0" in line for line in lines(result))


def test_the_error_of_a_vector_is_the_length_of_a_difference() -> None:
    right = StepError("friction_N", 3.0, 4.0, 1e-8, turned_deg=90.0)
    assert right.error == pytest.approx(10.0, rel=1e-12)
    assert StepError("friction_N", 4.0, 3.0, 1e-8, turned_deg=0.0).error == -2.0


@pytest.mark.slow
def test_the_command_prints_the_error_beside_the_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = ["shape=plate", "mu=0.4", "delta_mm=0.5", "drag_mm=0.1,0.02"]
    asked = ["solve", "panel", "--mesh", "4x4", *(word for each in settings for word in ("--set", each))]
    assert main([*asked, "--out", str(tmp_path / "with")]) == 0
    said = capsys.readouterr().out
    assert "in 1 steps" in said
    assert "first-order error of this answer" in said
    assert "errors of load steps are estimates" in said
    record = json.loads((tmp_path / "with" / "result.json").read_text())
    assert (
        record["errors"]["friction_N"]["low"]
        < record["quantities"]["friction_N"]
        < record["errors"]["friction_N"]["high"]
    )
    assert (tmp_path / "with" / f"{TABLE}.csv").exists()
    assert main([*asked, "--no-step-error", "--out", str(tmp_path / "without")]) == 0
    assert "first-order" not in capsys.readouterr().out
    assert "errors" not in json.loads((tmp_path / "without" / "result.json").read_text())


@pytest.mark.slow
def test_a_notebook_has_the_intervals() -> None:
    run = solve_in_a_notebook("panel", mesh="4x4", **PLATE)
    assert run.errors["friction_N"]["low"] < run.quantities["friction_N"] < run.errors["friction_N"]["high"]
    assert solve_in_a_notebook("panel", mesh="4x4", step_error=False, **PLATE).errors == {}
    assert solve_in_a_notebook("panel", mesh="4x4", delta_mm=0.5).errors == {}


def test_without_an_estimate_there_is_nothing_to_print() -> None:
    assert lines(path("plate")) == []
