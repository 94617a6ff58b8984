"""Every reference before the judge, state by state: what a table compares is an answer of its problem."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import pytest

from contact.continuation.friction_path import PathState, Stage
from contact.verify import judge
from studies.experiments.friction.bars import LENGTH, N0, PULL, RADIUS, TAU, Bar
from studies.experiments.friction.brush import BLOCKS, WAY, Parking, uneven
from studies.experiments.friction.trusses import SQUEEZE, Wheel
from support.problems.planted_friction import with_mu


class Staged(Protocol):
    """A model with load steps."""

    def stage_at(self, load: float, anchors: np.ndarray) -> Stage: ...

    def follow(self, loads: Sequence[float]) -> list[PathState]: ...


def _strip() -> tuple[Staged, list[float], np.ndarray]:
    bar = Bar(13, LENGTH, 1.0, press=TAU)
    return bar, [PULL, 0.0, -PULL, PULL], bar.rest.anchors


def _drum() -> tuple[Staged, list[float], np.ndarray]:
    bar = Bar(13, 2 * RADIUS, 0.5, curvature=-1 / RADIUS, tension=-N0, driven=True)
    return bar, [-0.02, -10.0], bar.rest.anchors


def _block() -> tuple[Staged, list[float], np.ndarray]:
    brush = BLOCKS["normal force swells"].brush
    return brush, [WAY * k / 6 for k in range(1, 7)], brush.candidates.reference


def _spun() -> tuple[Staged, list[float], np.ndarray]:
    brush = uneven(4)
    return brush, [0.1, 0.2, 0.3], brush.candidates.reference


def _parked() -> tuple[Staged, list[float], np.ndarray]:
    disc = Parking("parabolic", 0.5)
    brush = disc.brush(7)
    return brush, [disc.phi, -disc.phi], brush.candidates.reference


def _rolled() -> tuple[Staged, list[float], np.ndarray]:
    wheel = Wheel(24, 0.1, SQUEEZE)
    return wheel, [-0.5, 0.0, 2.0, 4.0, 6.0], np.tile(wheel.truss.nodes[:-1], (2, 1))


MODELS = {"strip": _strip, "drum": _drum, "block": _block, "spun": _spun, "parked": _parked, "rolled": _rolled}


@pytest.mark.parametrize("name", MODELS)
def test_every_state_passes_the_judge(name: str) -> None:
    model, loads, anchors = MODELS[name]()
    states = model.follow(loads)
    assert len(states) == len(loads)
    for state in states:
        problem, found = model.stage_at(state.load, anchors).problem, state.solution
        assert judge(problem, found.u, found.pressure, found.rubbed.force).failures() == []
        anchors = state.anchors


def test_the_judge_would_see_less_friction() -> None:
    """The last state of the strip, its coefficient a little smaller in the problem than in the answer."""
    model, loads, anchors = _strip()
    state = model.follow(loads[:1])[0]
    problem, found = model.stage_at(state.load, anchors).problem, state.solution
    smoother = with_mu(problem, 0.999 * problem.coulomb.mu)
    assert "cone" in judge(smoother, found.u, found.pressure, found.rubbed.force).failures()
