"""Random paths on which the foundation is dragged, reversed and turned and the load is cut: every state is judged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS, by_the_exact_law
from contact.continuation.friction_path import PathState, Stage, follow
from contact.coulomb import State
from contact.newton.friction_states import Laws, Local, friction_of
from contact.problem import ContactSolution
from contact.verify import judge
from studies.arena.frictional_steps import random_step

STOPS = 7
DISSIPATED = 1e-10  # of the largest dissipation of a step: below zero, rounding explains it


class RandomPath:
    """The body of a random step before a foundation at ``drags`` (stops, 2) [mm], under ``loads`` (stops,) of its own.

    Each stop goes on, stands still, goes back all the way, goes back a little, or turns; the load is kept or cut.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([seed, 61])
        self.step = random_step(seed)
        size = 10 ** rng.uniform(-2, 1)
        drag, way, load = np.zeros(2), rng.standard_normal(2), 1.0
        self.drags, self.loads = [drag], [load]
        for _ in range(STOPS):
            turn = rng.choice([0.0, np.pi, np.pi, np.pi / 2, rng.uniform(0, 2 * np.pi)])
            c, s = np.cos(turn), np.sin(turn)
            way = np.array([[c, -s], [s, c]]) @ way
            drag = drag + size * rng.choice([0.0, 0.1, 1.0]) * way
            load *= rng.choice([1.0, 1.0, 0.5, 2.0])
            self.drags.append(drag)
            self.loads.append(load)

    def stage(self, stop: float, anchors: np.ndarray) -> Stage:
        """The problem at a stop, slips counted from the anchors (m, 2) on the moving foundation."""
        drag, S = self.drags[int(stop)], self.step.S
        slip = np.tile(-drag, (len(anchors), 1)) - anchors
        moved = replace(self.step, r=self.loads[int(stop)] * self.step.r, slip=slip)
        return Stage(moved.problem(), lambda u: (S @ u).reshape(-1, 2) - drag)

    def states(self, name: str) -> list[tuple[Stage, PathState]]:
        """The accepted states of an algorithm with the problems that they answer."""
        n, m = len(self.step.r), len(self.step.mu)
        seen: list[Stage] = []

        def stage_at(stop: float, anchors: np.ndarray) -> Stage:
            seen.append(self.stage(stop, anchors))
            return seen[-1]

        start = PathState(-1, ContactSolution.at_rest(n, m), np.zeros((m, 2)))
        path = follow(stage_at, range(len(self.drags)), by_the_exact_law()[name], start)
        return [(seen[i], at) for i, at in enumerate(path) if at.solution.outcome.converged]


@pytest.mark.parametrize("name", ALGORITHMS)
@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 84))])
def test_no_algorithm_converges_to_what_the_judge_refuses(name: str, seed: int) -> None:
    states = RandomPath(seed).states(name)
    assert states or name == "trial-and-error"  # which cycles on most of them, and says so
    epsilon = by_the_exact_law()[name].epsilon
    largest = max((abs(at.dissipation) for _, at in states), default=0.0)
    for stage, at in states:
        found = at.solution
        verdict = judge(stage.problem, found.u, found.pressure, found.rubbed.force, epsilon=epsilon)
        assert not verdict.failures(), (at.load, verdict.kkt)
        if np.isinf(epsilon):
            assert at.dissipation >= -DISSIPATED * largest


@pytest.mark.parametrize("seed", range(12))
def test_friction_of_the_step_before_is_not_that_of_a_reversed_slip(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0, 2 * np.pi)
    old = np.array([[np.cos(angle), np.sin(angle)]])
    slips = Laws(np.array([State.SLIP]), np.zeros((1, 2)), np.zeros(1))
    for slip in (-0.3 * old, 0.3 * old):
        local = Local(np.zeros(1), slip, np.ones(1), -0.5 * old, np.zeros(1))
        friction = friction_of(local, slips, np.array([0.5]), 1e-12)
        assert float(np.sum(friction * slip)) == pytest.approx(-0.5 * 0.3)
