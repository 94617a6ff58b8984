"""Quantities to an error: what rounds say of a limit, how a grid is refined for it, and whether the statement holds."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from contact.problem import Outcome
from studies.ask.scene import UsageError
from studies.cli import NOT_CONVERGED, OK, WRONG_USE, main
from studies.experiments.error_coverage import Case, error_coverage, shipped_cases
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.refinement.adaptive_grids import Family
from studies.solving.refinement.error_control import Round, at_loads, estimate, parse_error, solve_to_error
from studies.solving.refinement.grids import coarsest
from studies.solving.refinement.records import growth
from studies.solving.result import Result
from studies.solving.solve import solve


def rounds(*values: tuple[float, float]) -> list[Round]:
    return [Round(coarse, fine, 10 * 3**k, 40 * 3**k, 1.0, 0.6) for k, (coarse, fine) in enumerate(values)]


def test_rounds_have_the_limit_of_richardson_and_what_is_off_makes_the_statement_wide() -> None:
    first, last = rounds((104.0, 101.0), (102.0, 100.5))
    actual = estimate([first, last])
    assert actual.limit == pytest.approx(100)
    assert actual.error == pytest.approx(0.005)
    assert actual.uncertainty == pytest.approx(0.005)
    assert (actual.low, actual.high) == pytest.approx((0.0, 0.01))
    jumping, apart = estimate([first, replace(last, rim=8.0)]), estimate([first, replace(last, finer=101.7)])
    assert jumping.uncertainty * jumping.limit == pytest.approx(4.0)
    assert apart.uncertainty * apart.limit == pytest.approx(1.5 * 1.6)


@pytest.mark.parametrize("order", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_the_limit_of_any_order_lies_inside(order: float) -> None:
    """A grid cut everywhere in each round: L is wrong for another order than 2, and the statement says by how much."""
    value = [100 + 8 * 2.0 ** (-order * k) for k in range(6)]
    actual = estimate(rounds(*pairwise(value)))
    assert abs(actual.limit - 100) <= actual.uncertainty * actual.limit


def test_an_error_is_read_or_refused() -> None:
    assert [parse_error(text) for text in ("1%", "0.02", "0.5%")] == pytest.approx([0.01, 0.02, 0.005])
    for wrong in ("", "x%", "0", "nan", "-1%", "60%", "1e-9"):
        with pytest.raises(UsageError, match="must be a relative error in"):
            parse_error(wrong)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "settings", "quantity"),
    [
        ("scordelis-lo", {}, "edge_deflection_mm"),
        ("pagano", {"S": "10"}, "w_bar"),
        ("strip-contact", {}, "half_force"),
        ("cantilever", {}, "tip_shortening_mm"),
    ],
)
def test_a_statement_holds(scene: str, settings: dict[str, str], quantity: str) -> None:
    table = error_coverage([Case(scene, (quantity,), settings)], [0.01])
    (row,) = table.to_dict("records")
    assert row["reached"]
    assert row["decided"]
    assert row["inside"]
    assert row["low"] - row["known"] <= row["value_error"] <= row["high"] + row["known"]


@pytest.mark.slow
def test_elements_are_cut_where_the_quantity_is_decided() -> None:
    """The load of a pinched cylinder is at one corner: the finest elements are there, and the others stay coarse."""
    scene, request = complete("pinched-cylinder", {"shear_correction": "1000"}, (8, 8))
    result, _ = solve_to_error(scene, request, 0.003)
    leaves = np.array(result.request.leaves)
    level = leaves[:, 0]
    assert level.max() >= level.min() + 2
    finest = leaves[level == level.max()]
    assert np.all(finest[:, 1:].mean(axis=0) / 2.0 ** level.max() < (4, 4))


@pytest.mark.slow
def test_elements_that_are_too_long_for_the_stress_are_cut_both_ways() -> None:
    """One element across a cantilever has modes by itself before 0.05 % are reached; two have none."""
    result, enough = solve_to_error(*coarsest("cantilever", {"load_fraction": "1"}), 0.0005)
    assert enough
    record = result.loads[-1].certificate["stability"]
    assert (result.verdict, record["negative"], record["element_modes"]) == ("converged", 0, 0)
    assert result.request.mesh[1] > 1
    assert result.quantities["extrapolated_tip_shortening_mm"] == pytest.approx(3.29040, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("error", "stated"), [("1%", False), ("5%", True)])
def test_what_has_no_limit_under_a_point_load_is_given_none(error, stated, tmp_path: Path, capsys) -> None:
    """It grows by ln 2/(2 pi S), 0.2 %, with every halving: 1.8410, 1.8466, 1.8505e-5 at 64, 128 and 256 elements."""
    arguments = ["solve", "pinched-cylinder", "--error", error, "--mesh", "8x8", "--out", str(tmp_path)]
    assert main(arguments) == (OK if stated else NOT_CONVERGED)
    printed = capsys.readouterr().out
    assert ("has no limit in a theory with shear under a point load" in printed) != stated
    assert ("+-" in printed) == stated
    seen = json.loads((tmp_path / "result.json").read_text())["quantities"]
    assert ("uncertainty" in seen) == stated


@pytest.mark.slow
def test_the_growth_under_a_point_load_is_that_of_the_grids() -> None:
    results = [solve(*complete("pinched-cylinder", {}, (n, n))) for n in (32, 64)]
    values = [result.quantities["deflection_mm"] for result in results]
    bending = solve(*complete("pinched-cylinder", {"shear_correction": "1000"}, (32, 32)))
    finer = solve(*complete("pinched-cylinder", {"shear_correction": "1000"}, (64, 64)))
    smooth = finer.quantities["deflection_mm"] - bending.quantities["deflection_mm"]
    assert growth(results[1], "deflection_mm") == pytest.approx(values[1] - values[0] - smooth, rel=0.1)
    assert growth(solve(*complete("scordelis-lo", {}, (4, 4))), "edge_deflection_mm") == 0.0


def test_every_load_has_its_own_interval(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "cantilever", "--error", "1%", "--out", str(tmp_path)]) == OK
    head = ["load_fraction", "tip_shortening_mm", "limit", "uncertainty"]
    assert head in [line.split() for line in capsys.readouterr().out.splitlines()]
    table = pd.read_csv(tmp_path / "loads.csv")
    assert table["load_fraction"].tolist() == [0.25, 0.5, 0.75, 1.0]
    seen = json.loads((tmp_path / "result.json").read_text())["quantities"]
    last = table.iloc[-1]
    assert last["limit"] == pytest.approx(seen["extrapolated_tip_shortening_mm"])
    assert last["uncertainty"] == pytest.approx(seen["uncertainty"])
    for load in (0.25, 0.75):
        fine = solve(*complete("cantilever", {"load_fraction": str(load)}, (128, 2)))
        (row,) = table[table["load_fraction"] == load].to_dict("records")
        assert row["limit"] == pytest.approx(fine.quantities["tip_shortening_mm"], rel=row["uncertainty"])


def test_a_grid_without_the_quantity_is_too_coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a limit point that only finer ones have: the next grid is asked, and nothing is refused."""
    taken = []

    def without(scene, request, progress):
        result = solve(scene, request, progress)
        taken.append(request)
        if len(taken) == 1:
            del result.quantities["edge_deflection_mm"]
        return result

    monkeypatch.setattr("studies.solving.refinement.error_control.solve", without)
    _, enough = solve_to_error(*coarsest("scordelis-lo", {}), 0.02, "edge_deflection_mm")
    assert enough
    assert taken[0].leaves == ()
    assert taken[1].leaves != ()


def test_the_command_refines_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["solve", "scordelis-lo", "--error", "2%", "--of", "edge_deflection_mm", "--out", str(tmp_path)]
    assert main(arguments) == OK
    out = capsys.readouterr().out
    assert "edge_deflection_mm = " in out
    assert "on the last grid" in out
    seen = json.loads((tmp_path / "result.json").read_text())["quantities"]
    assert seen["uncertainty"] <= seen["error_asked"] == 0.02
    assert (tmp_path / "refinement.csv").exists()


def test_no_round_is_begun_that_the_budget_has_no_room_for() -> None:
    asked = coarsest("scordelis-lo", {})
    result, enough = solve_to_error(*asked, 1e-6, "edge_deflection_mm", budget=1e-3)
    assert enough
    assert len(result.table("refinement")) == 1
    assert "edge_deflection_mm is known to" in result.reason


@pytest.mark.parametrize("lacks", ["a path", "the quantity"])
def test_no_round_is_begun_beyond_the_budget_while_grids_fail(monkeypatch: pytest.MonkeyPatch, lacks: str) -> None:
    solved = []

    def fails(*asked: Any) -> Result:
        solved.append(solve(*asked))
        if lacks == "a path":
            solved[-1].outcome = Outcome.STEP_LIMIT
        else:
            solved[-1].quantities.pop("edge_deflection_mm")
        return solved[-1]

    monkeypatch.setattr("studies.solving.refinement.error_control.solve", fails)
    result, enough = solve_to_error(*coarsest("scordelis-lo", {}), 0.01, "edge_deflection_mm", budget=1e-3)
    assert (result, enough) == (solved[0], False)
    assert len(solved) == 1


def test_elements_that_are_too_long_are_said_where_the_budget_leaves_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Family, "shortened", lambda family, scene, result: replace(family))
    result, enough = solve_to_error(*coarsest("scordelis-lo", {}), 0.01, "edge_deflection_mm", budget=1e-3)
    assert not enough
    assert "too long" in result.reason


@pytest.mark.slow
def test_what_cannot_be_reached_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch) -> None:
    monkeypatch.setattr(
        "studies.solving.refinement.error_control.solve_to_error.__defaults__", (None, lambda text: None, 200, math.inf)
    )
    assert main(["solve", "scordelis-lo", "--error", "0.01%", "--out", str(tmp_path)]) == NOT_CONVERGED
    assert "no grid of up to 200 unknowns" in capsys.readouterr().out


def test_one_round_that_is_within_the_error_is_not_enough_and_says_so() -> None:
    result, enough = solve_to_error(*coarsest("scordelis-lo", {}), 0.5, most=600)
    assert not enough
    assert result.quantities["uncertainty"] < 0.5
    assert result.reason.startswith("no grid of up to 600 unknowns gives")
    assert result.reason.endswith("%, by two grids alone")


@pytest.mark.slow
def test_what_has_no_limit_ends_at_the_deepest_level() -> None:
    """The pressure at the rim of a strip without shear is a line force: refined there, it only grows."""
    result, enough = solve_to_error(*complete("strip-contact", {}, (16, 1)), 0.01, "edge_pressure")
    assert not enough
    assert "edge_pressure" in result.reason


def test_wrong_requests_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, error = ["--out", str(tmp_path / "out")], ["--error", "1%"]
    for wrong in (["scordelis-lo", "--of", "force_N"], ["nowhere"], ["scordelis-lo", "--mesh", "axb"]):
        assert main(["solve", *wrong, *error, *out]) == WRONG_USE
        assert capsys.readouterr().err.count("\n") == 1
    assert main(["solve", "tyre", "--of", "force_N", *out]) == WRONG_USE
    assert "--error" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_two_elements_state_the_same_force_of_the_tyre() -> None:
    low, high = [], []
    for element in ("paper", "refined"):
        result, enough = solve_to_error(*coarsest("tyre", {"delta_mm": "20", "element": element}), 0.02)
        assert enough
        limit = result.quantities["extrapolated_force_N"]
        within = result.quantities["uncertainty"] * limit
        low.append(limit - within)
        high.append(limit + within)
    assert max(low) <= min(high)


@pytest.mark.slow
def test_the_isotropic_tyre_against_solids() -> None:
    """Two independent programs with three-dimensional elements, known to 0.3 %."""
    settings = {"E_MPa": "20", "nu": "0.45", "load": "follower", "delta_mm": "20"}
    result, enough = solve_to_error(*coarsest("tyre", settings, (12, 24)), 0.002)
    assert enough
    assert result.quantities["extrapolated_force_N"] == pytest.approx(1326.1, rel=0.003)


def test_the_cases_name_what_scenes_have() -> None:
    assert sum(len(case.quantities) for case in shipped_cases()) * 2 >= 80
    assert {case.scene for case in shipped_cases()} <= set(SCENES)


def test_the_rim_has_the_same_part_in_all_loads() -> None:
    """A quarter of the last value is that of a value half as large, too."""
    coarse, fine = (
        SimpleNamespace(loads=[SimpleNamespace(seen={"q": v}) for v in values], end=SimpleNamespace(trace=None))
        for values in ((-3.0, 5.0), (-2.0, 4.0))
    )
    actual = at_loads(coarse, fine, "q", replace(rounds((5.0, 4.0))[0], rim=1.0))
    assert [(each.value, each.finer, each.rim) for each in actual] == [(-3.0, -2.0, 0.5), (5.0, 4.0, 1.0)]
