"""The walk over stages and requested points: what it visits, in which unknowns, and where it ends."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest

from contact.algorithms.qp import Qp
from contact.algorithms.semismooth import Semismooth
from contact.newton.step import NewtonRun
from contact.problem import Outcome
from studies.ask.scene import SceneModel
from studies.experiments.extremes import CONVERGED, attempt
from studies.scenes.complete import Cell, complete
from studies.scenes.walk import walk

TYRE = {"delta_mm": "2,4", "element": "paper"}


def tyre(**settings: str) -> SceneModel:
    scene, request = complete("tyre", {**TYRE, **settings}, "8x8", model="full")
    return scene.build(request)


def test_every_requested_point_of_every_stage_is_visited() -> None:
    model, stated = tyre(), []
    visited = list(walk(model.stages(), Semismooth(), 2, tell=lambda stage, at: stated.append((stage, at))))
    assert [(each.stage.name, each.point.requested) for each in visited] == [
        ("inflation", 1.0),
        ("press", 2.0),
        ("press", 4.0),
    ]
    assert [each.ends_stage for each in visited] == [True, False, True]
    assert all(each.converged for each in visited)
    assert all(each.state.u.shape == (model.n_unknowns,) for each in visited)
    np.testing.assert_array_equal(visited[2].before.u, visited[1].point.solution.u)
    steps = [("inflation", 0.5), ("inflation", 1.0), *(("press", float(at)) for at in (1, 2, 3, 4))]
    assert list(dict.fromkeys(stated)) == steps
    iterations = sum(each.point.solution.counters["newton_iterations"] for each in visited)
    assert len(stated) >= iterations + len(steps)  # before every linearisation, the first of a step among them


def test_what_is_raised_before_a_linearisation_ends_a_walk() -> None:
    seen = []

    def look(stage: str, t: float) -> None:
        seen.append((stage, t))
        if len(seen) == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(walk(tyre().stages(), Semismooth(), tell=look))
    assert seen == [("inflation", 1.0)] * 3


def test_a_stage_that_comes_back_to_its_last_value_ends_once() -> None:
    inflation, press = tyre().stages()
    visited = list(walk([inflation, replace(press, targets=(2.0, 1.0, 2.0))], Semismooth()))
    assert [each.index for each in visited] == [0, 0, 1, 2]
    assert [each.ends_stage for each in visited] == [True, False, False, True]


def test_a_walk_goes_on_from_a_state() -> None:
    whole = list(walk(tyre().stages(), Semismooth()))
    inflation, press = tyre().stages()
    *_, inflated = walk([inflation], Semismooth())
    *_, last = walk([press], Semismooth(), previous=inflated.state)
    np.testing.assert_allclose(last.state.u, whole[-1].state.u, rtol=1e-12, atol=1e-14)


def test_a_failure_is_the_last_point() -> None:
    visited = list(walk(tyre().stages(), Semismooth(max_iterations=1), smallest=0.6))
    assert len(visited) == 1
    assert not visited[0].converged
    assert visited[0].said


def test_a_refusal_is_a_point_with_a_reason() -> None:
    visited = list(walk(tyre(section="nonsymmetric").stages(), Qp()))
    assert visited[-1].point.outcome is Outcome.REFUSED
    assert "no energy to minimise" in visited[-1].said


@pytest.mark.parametrize("newton", ["mixed", "plain"])
def test_a_point_of_a_map_is_solved_to_the_tolerance_that_it_asks_for(newton: str) -> None:
    iterations = []
    for tolerance in ("1e-2", "1e-12"):
        with patch.object(NewtonRun, "advance", autospec=True, side_effect=NewtonRun.advance) as advance:
            point = attempt(Cell("point", "panel", {"mesh": "4x4", "newton": newton}, {"tolerance": tolerance}))
        assert point.kind == CONVERGED
        iterations.append(advance.call_count)
    assert 0 < iterations[0] < iterations[1]
