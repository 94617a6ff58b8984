"""Every reference before the judge, state by state: what a table compares is an answer of its problem."""

from typing import Any

import numpy as np
import pytest

from contact.verify import judge
from studies.experiments.friction.bars import LENGTH, N0, PULL, RADIUS, TAU, Bar
from studies.experiments.friction.brush import BLOCKS, WAY, Parking, uneven
from studies.experiments.friction.trusses import SQUEEZE, Wheel
from support.problems.frictional import with_mu


def _models() -> dict[str, tuple[Any, list[float], np.ndarray]]:
    """Bodies, loads, and anchors at rest."""
    strip = Bar(13, LENGTH, 1.0, press=TAU)
    drum = Bar(13, 2 * RADIUS, 0.5, curvature=-1 / RADIUS, tension=-N0, driven=True)
    block, spun, disc = BLOCKS["normal force swells"].brush, uneven(4), Parking("parabolic", 0.5)
    parked, wheel = disc.brush(7), Wheel(24, 0.1, SQUEEZE)
    return {
        "strip": (strip, [PULL, 0.0, -PULL, PULL], strip.rest.anchors),
        "drum": (drum, [-0.02, -10.0], drum.rest.anchors),
        "block": (block, [WAY * k / 6 for k in range(1, 7)], block.candidates.reference),
        "spun": (spun, [0.1, 0.2, 0.3], spun.candidates.reference),
        "parked": (parked, [disc.phi, -disc.phi], parked.candidates.reference),
        "rolled": (wheel, [-0.5, 0.0, 2.0, 4.0, 6.0], np.tile(wheel.truss.nodes[:-1], (2, 1))),
    }


MODELS = _models()


@pytest.mark.parametrize("name", MODELS)
def test_every_state_passes_the_judge(name: str) -> None:
    model, loads, anchors = MODELS[name]
    states = model.follow(loads)
    assert len(states) == len(loads)
    for state in states:
        problem, found = model.stage_at(state.load, anchors).problem, state.solution
        assert judge(problem, found.u, found.pressure, found.rubbed.force).failures() == []
        anchors = state.anchors


def test_the_judge_would_see_less_friction() -> None:
    """The last state of the strip, its coefficient a little smaller in the problem than in the answer."""
    model, loads, anchors = MODELS["strip"]
    state = model.follow(loads[:1])[0]
    problem, found = model.stage_at(state.load, anchors).problem, state.solution
    smoother = with_mu(problem, 0.999 * problem.coulomb.mu)
    assert "cone" in judge(smoother, found.u, found.pressure, found.rubbed.force).failures()
