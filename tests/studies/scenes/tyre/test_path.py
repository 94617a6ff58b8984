"""The press of the tyre by arc length: through the limit point of the travel and on behind it."""

from pathlib import Path

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.continuation.candidates import EASY_ITERATIONS
from contact.continuation.load_stepping import WORTH
from contact.problem import Outcome
from reports.figures.result_figures import draw_result
from studies.ask.scene import UsageError
from studies.scenes.complete import complete as resolve
from studies.scenes.walk import walk
from studies.solving.result import Result
from studies.solving.solve import solve


def run(mesh: str, **settings: str) -> Result:
    return solve(*resolve("tyre", settings, mesh, model="half"))


@pytest.mark.slow
def test_the_arc_leads_to_the_states_of_the_travel() -> None:
    by_travel, by_arc = run("12x12", delta_mm="5,8,12"), run("12x12", delta_mm="5,8,12", path="arc")
    assert by_arc.outcome.converged
    reached = {step["delta_mm"]: step["force_N"] for step in by_arc.steps}
    for step in by_travel.steps:
        assert reached[step["delta_mm"]] == pytest.approx(step["force_N"], rel=1e-6)
    assert by_arc.quantities["limit_points"] == 0
    assert not any(step["failures"] for step in by_arc.steps)
    assert len(by_arc.table("curve")) == len(by_arc.steps) > 3


@pytest.mark.slow
def test_a_curve_that_goes_back_ends_where_it_began() -> None:
    """On eight elements a wall of them snaps at 12 mm, and what follows leads back until nothing touches any more."""
    solution = run("8x8", delta_mm="5,15", path="arc")
    assert solution.outcome is Outcome.LIMIT_POINT
    assert "the path goes back below t = 0" in solution.reason
    assert solution.quantities["limit_points"] == 1
    assert solution.steps[-1]["delta_mm"] < 0
    assert solution.steps[-1]["force_N"] == 0


def test_points_belong_to_an_arc() -> None:
    with pytest.raises(UsageError, match="arc_points needs path=arc"):
        run("8x8", arc_points="9")


def test_a_curve_that_is_too_short_says_so() -> None:
    solution = run("8x8", delta_mm="5,30", path="arc", arc_points="2")
    assert solution.outcome is Outcome.ITERATION_LIMIT
    assert "2 points of the curve did not reach t = 30" in solution.reason
    assert len(solution.steps) == 3


@pytest.mark.slow
def test_the_tyre_turns_back_and_goes_on(tmp_path: Path) -> None:
    """On a coarse grid the buckle beside the rim is a loop: back by half a millimetre, then on to 40 mm."""
    ended = run("20x18", delta_mm="30,40")
    ended.write(tmp_path / "travel")
    assert "mode.svg" in {path.name for path in draw_result(tmp_path / "travel")}
    limit = ended.quantities["press_limit_point"]
    solution = run("20x18", delta_mm="34,40", path="arc")
    assert solution.outcome.converged
    assert solution.quantities["limit_points"] == 2
    assert solution.quantities["press_limit_point"] == pytest.approx(limit, abs=1e-4)  # started from elsewhere
    assert not any(step["failures"] for step in solution.steps)  # each judged as a problem at its travel
    turns = [i for i, step in enumerate(solution.steps) if step["limit_point"]]
    travel = np.array([step["delta_mm"] for step in solution.steps])
    assert np.all(np.diff(travel[: turns[0] + 1]) > 0)
    assert np.all(np.diff(travel[turns[0] : turns[1] + 1]) < 0)
    assert np.all(np.diff(travel[turns[1] :]) > 0)
    assert solution.quantities["least_delta_behind_mm"] == pytest.approx(travel[turns[1]])
    forces = np.array([step["force_N"] for step in solution.steps])
    (by_travel,) = run("20x18", delta_mm="38.2").steps
    there = np.interp(38.2, travel[: turns[0] + 1], forces[: turns[0] + 1])
    back = np.interp(38.2, travel[turns[1] : turns[0] : -1], forces[turns[1] : turns[0] : -1])
    assert by_travel["force_N"] == pytest.approx(there, rel=1e-3)
    assert back < there - 20
    solution.write(tmp_path / "arc")
    assert "turning-back.svg" in {path.name for path in draw_result(tmp_path / "arc")}


@pytest.mark.slow
@pytest.mark.parametrize("measure", ["exact", "moderate-rotation"])
def test_a_coarse_tyre_that_cannot_be_pressed_further_is_given_up_early(measure: str) -> None:
    """Its path turns back before 20 mm: that is known within twenty good steps, each of twelve factorisations."""
    scene, request = resolve("tyre", {"delta_mm": "20"}, "8x8", measure=measure)
    *_, last = walk(scene.build(request).stages(), ALGORITHMS["semismooth"]())
    assert last.point.outcome is Outcome.LIMIT_POINT
    assert last.point.reached == last.point.end.limit < 12
    assert last.point.solution.counters["factorisations"] <= WORTH * EASY_ITERATIONS + EASY_ITERATIONS
