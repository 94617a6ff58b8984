"""Sweeps of small scenes: every member is the cold one, what was finished is read again, and what fails is recorded."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from contact.problem import ContactSolution, Outcome
from studies.ask.request import Request
from studies.cli import FAILED, NOT_CONVERGED, OK, WRONG_USE, main
from studies.commands import INTERRUPTED
from studies.footprint import UsageError
from studies.footprint import sweep as sweep_in_notebook
from studies.scenes.complete import complete
from studies.scenes.tyre.grid_lines import TyreSizes
from studies.solving.refinement.mesh_error import solve_with_error
from studies.solving.solve import solve
from studies.sweeps import sweep as sweeping
from studies.sweeps.members import Member, Range, order, places
from studies.sweeps.neighbours import Followed, Neighbours, predicted
from studies.sweeps.sweep import sweep

PANEL = ["sweep", "panel", "--mesh", "4x4"]
RING = ["sweep", "ring", "--mesh", "1x8", "--set", "delta_mm=20", "--over", "h_mm=1:4:4"]


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Request, bool]]:
    """The requests that a sweep has solved, and whether from a start."""
    values = []

    def spy(scene: Any, request: Request, **how: Any) -> Any:
        values.append((request, how.get("starts") is not None))
        return solve(scene, request, **how)

    monkeypatch.setattr(sweeping, "solve", spy)
    return values


def table(out: Path) -> pd.DataFrame:
    return pd.read_csv(out / "sweep.csv")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["panel"], "a sweep goes over one setting or two"),
        (["panel", "--over", "nu"], "--over 'nu' must be KEY=A:B:N, each setting once"),
        (["panel", "--over", "nu=0:0.3:3", "--over", "nu=0:0.3:3"], "each setting once"),
        (["panel", *(f"--over={key}=1:2:2" for key in ("nu", "aspect", "E_ratio"))], "one setting or two"),
        (["panel", "--over", "nu=0:0.3"], "nu=0:0.3 must be A:B:N, N values from A to B"),
        (["panel", "--over", "nu=0:0.3:1"], "N a whole number in [2, 1000]"),
        (["panel", "--over", "nu=0:0.3:1001"], "N a whole number in [2, 1000]"),
        (["panel", "--over", "nu=0:0.3:2.5"], "N a whole number in [2, 1000]"),
        (["panel", "--over", "nu=0:x:3"], "nu = 'x' must be a number in (-1, 0.5)"),
        (["panel", "--over", "nu=0:0.5:3"], "nu = '0.5' must be a number in (-1, 0.5)"),
        (["panel", "--over", "nu=0.3:0.3:3"], "A and B must be two finite numbers"),
        (["panel", "--over", "mu=0:inf:3"], "A and B must be two finite numbers"),
        (["panel", "--over", "shape=1:2:3"], "shape is not one number: one of cylinder, sphere, plate"),
        (["tyre", "--over", "delta_mm=1:2:3"], "numbers in [0, 100]; a solve takes several, --set delta_mm=A,B,..."),
        (["tyre", "--over", "plies=1:4:4"], "plies is not one number: a whole number in [1, 64]"),
        (["panel", "--over", "nix=0:1:3"], "panel has no setting 'nix'; it has "),
        (["nix", "--over", "nu=0:1:3"], "scene 'nix' must be one of "),
        (["panel", "--over", "nu=0:0.3:3", "--set", "nu=0.2"], "nu = 0.2 is given, and swept over"),
        (["panel", "--over", "nu=0:0.3:101", "--over", "E_ratio=1:2:100"], "10100 members: a sweep has at most 10000"),
        (["panel", "--over", "nu=0:0.3:3", "--mesh", "4"], "mesh '4' must be N1xN2"),
        (["panel", "--over", "nu=0:0.3:3", "--error", "0"], "error '0' must be"),
        (["panel", "--mesh", "4x4", "--over", "nu=0:0.3:3", "--of", "nix"], "no quantity 'nix'; it has force_N"),
        (["ring", "--mesh", "1x16", "--over", "h_mm=1:4:4", "--error", "1%"], "1x64 or more"),
        (["tyre", "--mesh", "7x7", "--over", "gamma_deg=50:52:2"], "mesh 7x7: both numbers must be even"),
    ],
)
def test_what_makes_no_sense_is_one_line_and_writes_nothing(words, says, tmp_path: Path, capsys) -> None:
    assert main(["sweep", *words, "--out", str(tmp_path)]) == WRONG_USE
    (line,) = capsys.readouterr().err.splitlines()
    assert says in line
    assert list(tmp_path.iterdir()) == []


def test_a_range_has_its_ends_and_no_digits_of_rounding() -> None:
    actual = sweeping._asked("panel", {}, {"inflation": "-0.6:0.2:5", "nu": [0.1, 0.2, 0.3]}, None, "4x4", {})
    assert [each.values for each in actual.ranges] == [(-0.6, -0.4, -0.2, 0.0, 0.2), (0.1, 0.2, 0.3)]


@pytest.mark.parametrize("counts", [(5,), (2, 3), (3, 2), (4, 7)])
def test_every_member_follows_one_beside_it(counts: tuple[int, ...]) -> None:
    ranges = [Range(f"key{k}", tuple(map(float, range(n)))) for k, n in enumerate(counts)]
    actual = list(order(ranges))
    assert sorted(actual) == list(places(ranges))
    for k, place in enumerate(actual[1:], 1):
        assert math.dist(place, actual[k - 1]) == 1


def path(place: tuple[int, ...], u: float) -> Followed:
    """A stage from 0 to 1 that begins at (0, 1) and moves by (u, 2 u), with two candidates."""
    begin = ContactSolution(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2, bool), Outcome.CONVERGED)
    end = ContactSolution(np.array([u, 1 + 2 * u]), np.array([u, -u]), np.array([True, True]), Outcome.CONVERGED)
    return Followed(place, Request("panel"), {("load", 0): {0.0: begin, 1.0: end}})


def test_a_start_goes_on_as_two_neighbours_in_line_have() -> None:
    class Load:
        name = "load"

    last = 0.0, ContactSolution(np.array([5.0, 5.0]), np.zeros(2), np.zeros(2, bool), Outcome.CONVERGED)
    grid = Neighbours(3)
    for k, u in enumerate((1.0, 3.0)):
        grid.add(path((0, k), u))
    start = predicted(grid.of((0, 2), Request("panel")), Request("panel"))(None)(Load)(0, last, 1.0)
    np.testing.assert_array_equal(start.u, [5 + 5, 5 + 10])
    np.testing.assert_array_equal(start.pressure, [5.0, 0.0])  # none pulls
    assert start.active.all()
    near = predicted(grid.of((1, 1), Request("panel")), Request("panel"))(None)(Load)
    np.testing.assert_array_equal(near(0, last, 1.0).u, [5 + 3, 5 + 6])
    assert near(0, last, 0.5) is None
    assert near(1, last, 1.0) is None


def test_neighbours_are_the_nearest_of_the_same_kind() -> None:
    grid = Neighbours(3)
    for place in ((0, 0), (0, 1), (1, 0)):
        grid.add(path(place, 1.0))
    assert [each.place for each in grid.of((1, 1), Request("panel"))] == [(1, 0)]  # the latest
    grid.add(path((2, 0), 1.0))
    assert (0, 0) not in grid.known
    assert [each.place for each in grid.of((3, 0), Request("panel"))] == [(2, 0), (1, 0)]
    assert grid.of((3, 0), Request("panel", model="half")) == []
    assert Neighbours(1).of((0,), Request("panel")) == []


@pytest.mark.parametrize(("u", "nearest"), [(2.5, (1, 2)), (1.0, (2, 1))])
def test_of_two_lines_a_start_goes_on_along_that_which_changes_less(u: float, nearest: tuple[int, int]) -> None:
    grid = Neighbours(4)
    for place, value in (((0, 2), u), ((1, 2), 3.0), ((2, 0), 2.0), ((2, 1), 3.0)):
        grid.add(path(place, value))
    assert grid.of((2, 2), Request("panel"))[0].place == nearest


@pytest.mark.slow
def test_all_members_are_those_from_rest(solved: list) -> None:
    """Two settings of the tyre; the starts save a third of the iterations at least."""
    actual = sweep("tyre", {"delta_mm": "10"}, {"gamma_deg": "50:52:3", "p0_MPa": "0.14:0.15:2"}, mesh="12x14")
    spent = 0
    for place in places(actual.ranges):
        member = actual.members[place]
        cold = solve(*complete("tyre", {"delta_mm": "10", **member.settings}, "12x14"))
        assert member.quantities == pytest.approx(cold.quantities, rel=1e-9)
        spent += cold.counters["newton_iterations"]
    assert [started for _, started in solved] == [False] + [True] * 5
    assert sum(member.newton_iterations for member in actual.members.values()) < 2 / 3 * spent
    assert [m.started_from == "rest" for m in actual.members.values()] == [True] + [False] * 5


def test_friction_begins_from_rest_where_its_neighbour_has_none(solved: list) -> None:
    actual = sweep("panel", {}, {"mu": "0:0.4:3"}, mesh="4x4")
    assert [started for _, started in solved] == [False, False, True]
    for member in actual.members.values():
        cold = solve(*complete("panel", member.settings, "4x4"))
        assert member.quantities == pytest.approx(cold.quantities, rel=1e-8)


def test_a_sweep_that_is_stopped_goes_on(tmp_path: Path, solved: list, monkeypatch: pytest.MonkeyPatch) -> None:
    words, spy = [*RING, "--out", str(tmp_path)], sweeping.solve

    def stopped(scene: Any, request: Request, **how: Any) -> Any:
        if len(solved) == 2:
            raise KeyboardInterrupt
        return spy(scene, request, **how)

    monkeypatch.setattr(sweeping, "solve", stopped)
    assert main(words) == INTERRUPTED
    assert {path.name for path in tmp_path.iterdir()} == {"members"}
    kept = [json.loads(path.read_text()) for path in (tmp_path / "members").iterdir()]
    assert sorted(each["member"]["settings"]["h_mm"] for each in kept) == [1.0, 2.0]
    assert {Request.of(each["request"]) for each in kept} == {request for request, _ in solved}
    monkeypatch.setattr(sweeping, "solve", spy)
    assert main(words) == OK
    assert [request.number("h_mm") for request, _ in solved] == [1.0, 2.0, 3.0, 4.0]
    rows = {row["h_mm"]: row for row in table(tmp_path).to_dict("records")}
    for each in kept:
        assert rows[each["member"]["settings"]["h_mm"]]["P_R2_over_EI"] == each["member"]["quantities"]["P_R2_over_EI"]
        assert rows[each["member"]["settings"]["h_mm"]]["seconds"] == each["member"]["seconds"]
    before = (tmp_path / "sweep.csv").read_bytes()
    assert main(words) == OK
    assert len(solved) == 4
    assert (tmp_path / "sweep.csv").read_bytes() == before


@pytest.mark.slow
def test_a_member_that_is_damaged_or_of_others_is_solved_anew(tmp_path: Path, solved: list, capsys) -> None:
    words = [*RING, "--out", str(tmp_path)]
    assert main(words) == OK
    kept = [*(tmp_path / "members").iterdir()]
    files = {json.loads(path.read_text())["member"]["settings"]["h_mm"]: path for path in kept}
    texts = {h: path.read_text() for h, path in files.items()}
    rows = table(tmp_path)
    files[1.0].write_text(texts[1.0][:-100])
    files[2.0].write_text(texts[2.0].replace('"P_R2_over_EI": 2', '"P_R2_over_EI": 3'))
    files[3.0].write_text(texts[4.0])
    assert texts[2.0] != files[2.0].read_text()
    assert main(words) == OK
    assert [request.number("h_mm") for request, _ in solved[4:]] == [1.0, 2.0, 3.0]
    values = ["h_mm", "P_R2_over_EI", "P_H2_over_EI"]
    pd.testing.assert_frame_equal(table(tmp_path)[values], rows[values], rtol=1e-9)
    assert main([*words, "--set", "tolerance=1e-8"]) == OK  # another request
    assert len(solved) == 4 + 3 + 4
    capsys.readouterr()


def test_a_member_that_another_sweep_has_kept_stands_under_its_own_settings(tmp_path, solved: list, capsys) -> None:
    for over in ("delta_mm=0.5:1:2", "tolerance=1e-9:1e-8:2"):  # 1 mm and 1e-9 are the defaults: one request of both
        assert main([*PANEL, "--over", over, "--out", str(tmp_path)]) == OK
    assert len(solved) == 3
    assert list(table(tmp_path)["tolerance"]) == [1e-9, 1e-8]
    assert "delta_mm" not in table(tmp_path)
    assert capsys.readouterr().out.count("the error of the mesh is not known: --error E asks for it") == 2


def test_a_member_that_fails_is_recorded_and_the_others_go_on(tmp_path: Path, capsys) -> None:
    words = [*PANEL, "--over", "h_over_R=1e-8:0.02:3", "--out", str(tmp_path)]
    assert main(words) == NOT_CONVERGED
    rows = table(tmp_path)
    end, reason = rows["verdict"][0], rows["reason"][0]
    assert end in ("not-converged", "cap-hit")  # where rounding leads to is the machine's
    assert rows["verdict"].tolist() == [end, "converged", "converged"]
    assert rows["force_N"].isna().tolist() == [True, False, False]
    assert "rounding" in reason or "iteration limit" in reason
    assert rows["started_from"].tolist() == ["rest", "rest", "h_over_R=0.01"]
    said = capsys.readouterr().out
    assert "2 solved, 0 of them unstable, 1 without an answer" in said
    assert f"{end} at h_over_R 1e-08: {reason}" in said
    assert (tmp_path / "figures" / "sweep.svg").read_text().startswith("<?xml")


def test_what_an_answer_does_not_show_by_itself_is_said_of_its_members(tmp_path: Path, capsys) -> None:
    words = ["sweep", "strip-contact", "--mesh", "8x1", "--set", "load_fraction=0.1", "--over", "lam_over_a=0.3:0.4:2"]
    assert main([*words, "--out", str(tmp_path)]) == OK
    assert "\n2 of 2 members: no contact at the last load" in capsys.readouterr().out
    assert table(tmp_path)["reason"].str.startswith("no contact").all()


def test_a_member_that_cannot_be_is_recorded_and_the_others_go_on(tmp_path: Path) -> None:
    words = ["sweep", "tyre", "--mesh", "8x8", "--set", "delta_mm=5", "--set", "plies=40", "--over", "R1_mm=40:60:3"]
    assert main([*words, "--out", str(tmp_path)]) == NOT_CONVERGED
    rows = table(tmp_path)
    assert rows["verdict"].tolist() == ["unsupported", "converged", "converged"]
    assert "must be below R1_mm = 40 mm" in rows["reason"][0]
    assert len(list((tmp_path / "members").iterdir())) == 2


def test_a_member_that_the_judge_refuses_fails_the_sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(scene: Any, request: Request, **how: Any) -> Any:
        result = solve(scene, request, **how)
        if request.number("h_mm") == 2.0:
            result.outcome, result.reason = Outcome.WRONG, "no equilibrium"
        return result

    monkeypatch.setattr(sweeping, "solve", refused)
    assert main([*RING, "--out", str(tmp_path)]) == FAILED
    rows = table(tmp_path)
    assert rows["verdict"].tolist() == ["converged", "wrong", "converged", "converged"]
    assert rows["started_from"].tolist() == ["rest", "rest", "h_mm=1", "h_mm=3"]


def test_the_error_of_every_member_is_that_of_its_own_three_grids(tmp_path: Path, capsys) -> None:
    words = ["sweep", "ring", "--set", "delta_mm=20", "--over", "h_mm=1:2:2", "--error"]
    assert main([*words, "1%", "--out", str(tmp_path)]) == OK
    rows = table(tmp_path)
    assert rows["started_from"].tolist() == ["a coarser grid", "h_mm=1"]
    for row in rows.to_dict("records"):
        own = solve_with_error(*complete("ring", {"delta_mm": "20", "h_mm": row["h_mm"]})).errors["P_R2_over_EI"]
        assert (row["low"], row["high"]) == pytest.approx((own["low"], own["high"]), rel=1e-5)
        assert row["low"] < row["P_R2_over_EI"] < row["high"]
        off = max(own["high"] - row["P_R2_over_EI"], row["P_R2_over_EI"] - own["low"])
        assert row["error"] == pytest.approx(off / row["P_R2_over_EI"], rel=0.02)
    assert "within 1 %: 2 of 2" in capsys.readouterr().out
    assert json.loads((tmp_path / "sweep.json").read_text())["within_error"] == 2
    assert main([*words, "0.1%", "--out", str(tmp_path)]) == NOT_CONVERGED
    assert "within 0.1 %: 0 of 2" in capsys.readouterr().out


def test_an_error_is_the_most_that_a_value_may_be_off() -> None:
    member = Member({}, "converged", quantities={"a": 9.0, "b": 1.0}, errors={"a": {"low": 9.5, "high": 10.5}})
    assert member.error("a") == pytest.approx(0.15)
    assert member.error("b") is None


@pytest.mark.slow
def test_lines_that_follow_the_error_are_those_of_the_member_in_the_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    actual, estimated = [], TyreSizes.estimated

    def spy(request: Request) -> TyreSizes:
        actual.append(request.number("gamma_deg"))
        return estimated(request)

    monkeypatch.setattr(TyreSizes, "estimated", spy)
    sweep("tyre", {"delta_mm": "10", "grading": "adapted"}, {"gamma_deg": "50:54:3"}, mesh="12x14")
    assert actual == [52.0]
    clamped = sweep("tyre", {"delta_mm": "10", "grading": "adapted"}, {"clamp_deg": "118:122:3"}, mesh="12x14")
    assert [member.verdict for member in clamped.members.values()] == ["unsupported", "converged", "unsupported"]


@pytest.mark.slow
def test_in_a_notebook(tmp_path: Path) -> None:
    actual = sweep_in_notebook(
        "panel", {"nu": [0.1, 0.2, 0.3], "E_ratio": range(1, 3)}, mesh="4x4", keep=tmp_path / "m"
    )
    assert actual.members[["nu", "E_ratio"]].to_numpy().tolist() == [
        [n, e] for n in (0.1, 0.2, 0.3) for e in (1.0, 2.0)
    ]
    assert (actual.found.quantity, actual.found.failed) == ("force_N", [])
    assert actual.figure().axes[0].get_xlabel()
    actual.write(tmp_path)
    assert json.loads((tmp_path / "sweep.json").read_text())["files"] == ["sweep.csv", "figures/sweep.svg"]
    pd.testing.assert_frame_equal(table(tmp_path)["force_N"].to_frame(), actual.members[["force_N"]])
    with pytest.raises(UsageError, match="evenly spaced"):
        sweep_in_notebook("panel", {"nu": [0.1, 0.2, 0.4]}, mesh="4x4")
