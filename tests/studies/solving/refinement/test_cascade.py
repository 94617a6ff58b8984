"""A quantity to an error by grids that grow: whether intervals hold, what they cost, and what a cascade leaves."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from studies.ask.scene import UsageError
from studies.cli import NOT_CONVERGED, OK, WRONG_USE, main
from studies.scenes.complete import complete
from studies.solving.refinement import cascade
from studies.solving.refinement.cascade import answer, parse_budget
from studies.solving.refinement.grids import first_grid, near
from studies.solving.refinement.nested import sketch
from studies.solving.solve import solve

STATED = [
    ("ring", {"delta_mm": "30"}, 0.01, "P_R2_over_EI", "1x256"),
    ("slender-beam", {}, 0.03, "tip_deflection_mm", "96x16"),
    ("cantilever", {"load_fraction": "0.5"}, 0.001, "tip_shortening_mm", "256x1"),
    ("strip-contact", {"load_fraction": "5"}, 0.01, "half_force", "256x1"),
    ("pagano", {"S": "20"}, 0.002, "w_bar", "48x48"),
    ("plate-contact", {}, 0.02, "contact_force", "512x1"),
    ("scordelis-lo", {}, 0.01, "edge_deflection_mm", "64x64"),
    ("hemisphere", {"load_fraction": "0.4"}, 0.01, "inward_mm", "64x64"),
]


@pytest.mark.parametrize(
    ("scene", "settings", "error", "quantity", "finer"),
    [STATED[0], *(pytest.param(*each, marks=pytest.mark.slow) for each in STATED[1:])],
)
def test_what_is_stated_holds_against_a_grid_that_is_finer(scene, settings, error, quantity, finer) -> None:
    result, enough = answer(*first_grid(scene, settings), error, quantity)
    assert enough
    seen = result.quantities
    assert seen["uncertainty"] <= error
    fine = solve(*complete(scene, settings, finer))
    true = fine.quantities[quantity]
    assert seen[f"extrapolated_{quantity}"] == pytest.approx(true, rel=seen["uncertainty"])
    grids = result.table("refinement").frame()
    assert grids["unknowns"].is_monotonic_increasing
    assert grids["unknowns"].iloc[-1] == result.counters["dofs"] < fine.counters["dofs"]


def test_what_the_iteration_leaves_on_all_grids_is_no_error_of_the_mesh() -> None:
    """Any mesh has the exact answer; grids whose forces are nearly in balance alone are off, all by as much."""
    settings = {"h_over_R": "0.15"}
    result, enough = answer(*first_grid("rubber-sphere", settings), 0.02)
    assert enough
    true = solve(*complete("rubber-sphere", settings, "8x8")).loads
    seen, table = result.quantities, result.table("loads").frame()
    limit = seen["extrapolated_pressure_MPa"]
    assert seen["error_estimate"] == pytest.approx(abs(seen["pressure_MPa"] - limit) / limit)
    assert len(true) == len(table) == 3
    for step, (_, stated) in zip(true, table.iterrows(), strict=True):
        assert stated["limit"] == pytest.approx(step.seen["pressure_MPa"], rel=stated["uncertainty"])


@pytest.mark.parametrize(("scene", "mesh", "axis"), [("scordelis-lo", "2x1", "a2"), ("tyre", "1x20", "a1")])
def test_one_element_is_not_kept_where_answers_vary_along_it(scene: str, mesh: str, axis: str) -> None:
    with pytest.raises(UsageError, match=f"^mesh {mesh} has one element along {axis}, which finer grids keep"):
        first_grid(scene, {}, mesh)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("settings", "true", "known"),
    [
        ({"delta_mm": "20"}, 1877.3, 0.001),
        ({"delta_mm": "20", "E_MPa": "20", "nu": "0.45", "load": "follower"}, 1326.1, 0.003),
    ],
)
def test_the_force_of_a_tyre_against_other_grids_and_programs(settings, true: float, known: float) -> None:
    result, enough = answer(*first_grid("tyre", settings), 0.02)
    assert enough
    seen = result.quantities
    assert seen["extrapolated_force_N"] == pytest.approx(true, rel=seen["uncertainty"] + known)


@pytest.mark.slow
def test_lines_that_may_follow_an_estimate_do() -> None:
    scene, request = first_grid("tyre", {"delta_mm": "20"})
    assert (request.choice("grading"), request.mesh) == ("adapted", (20, 20))
    assert scene.sizes is not None
    assert first_grid("tyre", {"grading": "patch"})[1].choice("grading") == "patch"
    assert first_grid("tyre", {"delta_mm": "0"})[1].choice("grading") == "patch"  # no contact, no estimate of it
    assert first_grid("tyre-solid", {})[1].mesh == (14, 18)


def test_a_budget_is_kept_and_its_best_answer_is_one(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = first_grid("ring", {"delta_mm": "30"})
    stated, enough = answer(*asked, 1e-7, budget=1e-3)
    assert enough is False  # one grid says nothing
    assert "fewer than three grids" in stated.reason
    clock = iter(range(100))  # a second a grid
    monkeypatch.setattr(cascade, "time", SimpleNamespace(process_time=lambda: float(next(clock))))
    monkeypatch.setattr(cascade, "DEARER", 0.0)
    actual, enough = answer(*asked, 1e-7, budget=5.5)
    assert enough
    assert len(list(actual.table("refinement").rows())) == 6
    assert actual.quantities["uncertainty"] > 1e-7


def test_a_budget_is_kept_while_grids_fail(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys) -> None:
    begun = []
    monkeypatch.setattr(cascade, "sketch", lambda scene, request, *how, **more: begun.append(request.mesh))
    monkeypatch.setattr(cascade, "solve_to_error", lambda *asked, **how: pytest.fail("a round is begun"))
    clock = iter(range(100))  # a second a grid
    monkeypatch.setattr(cascade, "time", SimpleNamespace(process_time=lambda: float(next(clock))))
    words = ["solve", "ring", "--set", "delta_mm=30", "--error", "1%", "--budget", "1.5s", "--out", str(tmp_path)]
    assert main(words) == NOT_CONVERGED
    assert len(begun) == 2
    assert "did not converge: no grid started within 1.5 s" in capsys.readouterr().err
    assert json.loads((tmp_path / "result.json").read_text())["class"] == "not-converged"


def test_a_grid_is_left_in_the_middle_where_its_time_is_over() -> None:
    scene, first = first_grid("ring", {"delta_mm": "30"})
    grids = cascade.Cascade(scene, 0.01, None)
    assert grids.grow(first, seconds=0.0)  # an answer there is, at least
    finer = near(scene, first, 2.0)
    assert not grids.grow(finer, seconds=0.0)
    assert [each.request for each in grids.grids] == [first]
    lost = []
    assert sketch(scene, finer, grids.last, lost=lost.append, seconds=0.0) is None
    assert lost == ["load at 30: after 0 s"]
    assert grids.grow(finer)


def test_elements_that_are_too_long_are_said_where_the_budget_leaves_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = first_grid("ring", {"delta_mm": "30"})
    monkeypatch.setattr(cascade, "_longer", lambda scene, result, request: request)
    clock = iter(range(100))
    monkeypatch.setattr(cascade, "time", SimpleNamespace(process_time=lambda: float(next(clock))))
    result, enough = answer(*asked, 0.5, budget=3.5)
    assert not enough
    assert "too long" in result.reason


def test_what_a_cascade_does_not_get_at_is_left_to_cuts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cascade, "MOST", 200)
    result, enough = answer(*first_grid("scordelis-lo", {}), 0.01)
    assert enough
    assert "finer_unknowns" in result.table("refinement").columns


@pytest.mark.slow
def test_a_cascade_that_nothing_takes_over_from_goes_on_to_the_largest_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cascade, "MOST", most := 6_000)
    result, enough = answer(*first_grid("tyre", {"delta_mm": "5"}), 1e-4)
    last = result.counters["dofs"]
    assert not enough
    assert "force_N is known to" in result.reason
    assert last <= most < last * cascade.FINER**2


def test_nothing_is_known_to_be_nothing() -> None:
    result, enough = answer(*first_grid("strip-contact", {"load_fraction": "1"}), 0.01, "half_force")
    assert enough
    assert (result.quantities["extrapolated_half_force"], result.quantities["uncertainty"]) == (0.0, 0.0)


def test_a_path_from_rest_with_another_value_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def elsewhere(*asked):
        result = solve(*asked[:2])
        result.quantities["P_R2_over_EI"] *= 1.5
        return result

    monkeypatch.setattr(cascade, "solve_from", elsewhere)
    result, enough = answer(*first_grid("ring", {"delta_mm": "30"}), 0.01)
    assert not enough
    assert "two branches" in result.reason


def test_a_budget_is_read_or_refused() -> None:
    assert [parse_budget(text) for text in ("5s", "0.5", None)] == [5.0, 0.5, math.inf]
    for wrong in ("", "0", "-1s", "nan", "inf", "5 min"):
        with pytest.raises(UsageError, match="seconds above 0"):
            parse_budget(wrong)


def test_the_command_takes_a_budget_with_an_error_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["solve", "ring", "--set", "delta_mm=20,30", "--budget", "30s", "--out", str(tmp_path)]
    assert main(words) == WRONG_USE
    assert "--error" in capsys.readouterr().err
    assert main([*words, "--error", "1%"]) == OK
    assert "P_R2_over_EI = " in capsys.readouterr().out
    loads = pd.read_csv(tmp_path / "loads.csv")
    assert loads["delta_mm"].tolist() == [20, 30]
    seen = json.loads((tmp_path / "result.json").read_text())["quantities"]
    assert loads["limit"].iloc[-1] == pytest.approx(seen["extrapolated_P_R2_over_EI"])
    assert main(["solve", "ring", "--error", "0.01%", "--budget", "0.001s", "--out", str(tmp_path)]) == NOT_CONVERGED


@pytest.mark.parametrize("budget", [math.inf, 1e-3])
def test_a_quantity_that_no_grid_has_is_one_line(budget: float) -> None:
    with pytest.raises(UsageError, match="ring has no quantity 'force_N'; it has P_R2_over_EI"):
        answer(*first_grid("ring", {"delta_mm": "30"}), 0.01, "force_N", budget=budget)
