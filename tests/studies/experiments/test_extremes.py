"""Maps of extremes: classes of outcomes, a real map against all of its points, and the scene they are made of."""

from itertools import product

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.events import PathEnd
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.ask.scene import UsageError
from studies.cli import main
from studies.experiments import extremes
from studies.experiments.extremes import (
    CHARTS,
    CLASSES,
    CONVERGED,
    CRASHED,
    END,
    FAILED,
    REFUSED,
    UNTOUCHED,
    WRONG,
    Axis,
    Chart,
    Found,
    attempt,
    axes_table,
    chart_of,
    check_table,
    extremes_table,
)
from studies.scenes.complete import Cell
from studies.scenes.complete import complete as resolve
from studies.scenes.contact.panel import lines
from studies.solving.solve import solve


def panel(contact: str = "semismooth", mesh: str = "4x4", **settings: str) -> Cell:
    return Cell("", "panel", {"mesh": mesh, "contact": contact}, settings)


# --- one point ------------------------------------------------------------------------------------------------------


def test_a_point_tells_whether_anything_touches() -> None:
    actual = attempt(panel())
    assert (actual.kind, actual.reason) == (CONVERGED, "")
    assert {attempt(panel(inflation="-0.5")).kind, attempt(panel(delta_mm="-1")).kind} == {UNTOUCHED}


def test_a_set_that_just_touches_at_the_start_settles() -> None:
    """Every gap is zero before the load, and rounding in the end: its size is known from the way between."""
    for inflation in ("3.16228e-07", "0.01", "1"):
        actual = attempt(chart_of("everywhere").point(inflation, "trial-and-error"))
        assert actual.kind == CONVERGED, inflation


def test_a_refusal_is_a_class_with_its_reason() -> None:
    for cell, says in (
        (panel(nu="0.5"), "nu = '0.5' must be a number in (-1, 0.5)"),
        (panel(mesh="1x4"), "must have at least 2 elements"),
        (panel("regularised", epsilon="inf"), "regularised does not apply: its law p = epsilon"),
        (panel(aspect="10", shape="sphere"), "aspect = 10 extends the panel beyond the poles of its sphere"),
    ):
        actual = attempt(cell)
        assert actual.kind == REFUSED
        assert says in actual.reason


class Lying(Semismooth):
    """Calls whatever it starts with solved."""

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        counters = {"newton_iterations": 1.0, "factorisations": 0.0}
        return ContactSolution(start.u, start.pressure, start.active, Outcome.CONVERGED, counters)


class Broken(Semismooth):
    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        raise ZeroDivisionError("by nothing")


def test_a_false_success_is_wrong_and_an_exception_a_crash(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(ALGORITHMS, "semismooth", Lying)
    actual = attempt(panel(inflation="0.1"))
    assert actual.kind == WRONG
    assert actual.reason.startswith("the judge finds equilibrium, penetration")
    monkeypatch.setitem(ALGORITHMS, "semismooth", Broken)
    assert attempt(panel()) == Found(CRASHED, "ZeroDivisionError: by nothing")


def test_a_path_that_ends_is_told_from_one_that_is_lost() -> None:
    message = "step cut; limit point of the path at about 0.5: an eigenvalue falls"
    for end in (PathEnd.LIMIT_POINT, PathEnd.BIFURCATION):
        assert extremes._failed(Outcome.STEP_LIMIT, message, end) == Found(END, message)
    assert extremes._failed(Outcome.STEP_LIMIT, message, PathEnd.NEITHER).kind == FAILED
    assert extremes._failed(Outcome.SINGULAR, "", None).reason == Outcome.SINGULAR.value
    assert extremes._failed(Outcome.REFUSED, "no minimum", None).kind == REFUSED


# --- maps -----------------------------------------------------------------------------------------------------------


def test_every_corner_of_a_map_is_a_valid_request() -> None:
    assert len({chart.name for chart in CHARTS}) == len(CHARTS)
    assert len({(chart.scene, axis.key) for chart in CHARTS for axis in (chart.x, chart.y) if not axis.named}) >= 10
    for chart in CHARTS:
        for i, j in product((0, chart.shape[0] - 1), (0, chart.shape[1] - 1)):
            cell = chart.cell(i, j)
            resolve(cell.scene, cell.settings, **cell.options)
    assert CHARTS[0].command(0, 1) == "footprint extremes thin-travel --at 0.0165482,1e-06"
    assert Axis.powers("k", "", -2, 2, 5).values == ("0.01", "0.1", "1", "10", "100")
    assert Axis.even("k", "", -0.1, 0.2, 4).values == ("-0.1", "0", "0.1", "0.2")


def half(cell: Cell) -> Found:
    """Made up: what lies right of 1 does not converge."""
    x = float(cell.settings["delta_mm"])
    return Found(CONVERGED) if x < 1 else Found(FAILED, f"lost at {x:g}")


def test_a_table_of_a_made_up_map() -> None:
    x, y = Axis.powers("delta_mm", "travel", -2, 2, 17), Axis.even("inflation", "pressure", 0, 1, 17)
    table = extremes_table([Chart("made-up", "Made up", "panel", x, y)], half)
    assert len(table) == 17 * 17
    assert ((table["class"] == FAILED) == (table["x"].astype(float) >= 1)).all()
    asked = table[table["asked"]]
    assert len(asked) <= 0.4 * len(table)
    assert asked["command"].str.fullmatch(r"footprint extremes made-up --at \S+,\S+").all()
    assert table[~table["asked"]]["command"].isna().all()
    assert set(table["class"]) <= set(CLASSES)


@pytest.mark.slow
def test_a_real_map_against_all_of_its_points() -> None:
    """Each algorithm with any epsilon; every class of every point, for a part of the solves."""
    (row,) = check_table(("epsilon",)).to_dict("records")
    assert row["points"] == 33 * len(ALGORITHMS)
    assert row["distance"] == row["unlike"] == 0


def test_what_the_maps_are_of() -> None:
    table = axes_table(CHARTS).set_index("map")
    assert table.loc["one-node", ["title", "y_named"]].tolist() == ["One node under a ball, by algorithm", True]
    with pytest.raises(UsageError, match="map 'none' must be one of thin-travel"):
        chart_of("none")


# --- the command ----------------------------------------------------------------------------------------------------


def test_a_point_is_solved_again_by_its_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["extremes"]) == 0
    assert "thin-travel" in capsys.readouterr().out
    assert main(["extremes", "epsilon", "--at", "100,lcp"]) == 0
    assert capsys.readouterr().out.startswith(
        "converged: footprint solve panel --mesh 4x4 --contact lcp --set epsilon=100"
    )
    assert main(["extremes", "epsilon", "--at", "100,augmented-lagrangian"]) == 2
    assert capsys.readouterr().out.startswith("refused: augmented-lagrangian does not apply")
    assert main(["extremes", "epsilon", "--at", "100"]) == 2
    assert "--at '100' must be X,Y" in capsys.readouterr().err
    assert main(["extremes", "nothing", "--at", "1,2"]) == 2


# --- the scene ------------------------------------------------------------------------------------------------------


def force(**settings: str) -> float:
    scene, request = resolve("panel", settings, "4x4")
    result = solve(scene, request)
    assert result.outcome.converged
    return result.quantities["force_N"]


def test_uneven_lines_keep_the_ends_and_the_middle() -> None:
    even, uneven = lines(4, 2.0, 0.0), lines(4, 2.0, 0.9)
    np.testing.assert_allclose(even, [-2, -1, 0, 1, 2])
    np.testing.assert_allclose(uneven, [-2, -0.1, 0, 1.9, 2])


def test_a_plate_that_lies_on_a_plane_hands_on_its_pressure() -> None:
    """But for what the clamped edges take of it, half of a row of elements at the most all around."""
    h_mm, p = 2.0, 0.5 * 100.0 * 0.02  # MPa
    carried = force(shape="plate", delta_mm="0", inflation="0.5", h_over_R=f"{h_mm / 100}")
    assert 0.2 * p * 50**2 < carried < p * 50**2


def test_units_change_nothing_and_stiff_fibres_and_thick_walls_push_harder() -> None:
    one = force()
    assert one > 1
    assert force(length_unit="1e-3", stress_unit="1e6") == pytest.approx(one, rel=1e-9)
    assert force(length_unit="1e4") == pytest.approx(one, rel=1e-9)
    assert force(E_ratio="10") > 1.1 * one
    assert force(h_over_R="0.04") > 1.5 * one
    with pytest.raises(UsageError, match="must be"):
        force(E_ratio="0.5")
