"""Small frozen steps with a known answer, and solvers that lie, dawdle, hang and die."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver
from support.problems.contact_problems import OPEN, PRESSED, TOUCHING, manufactured

STATES = np.array([OPEN, PRESSED, PRESSED, TOUCHING, OPEN, PRESSED])


def known_step(
    seed: int = 0, kind: str = "definite", states: np.ndarray = STATES
) -> tuple[FrozenStep, np.ndarray, np.ndarray]:
    """A convex step, and its only answer du, p, built in."""
    data, du, pressure = manufactured(np.random.default_rng(seed), kind, states)
    K, G = sparse.csc_matrix(data.K), sparse.csr_matrix(data.G)
    return FrozenStep(K, -data.f, G, data.g0, data.w, float(np.linalg.norm(data.f))), du, pressure


def in_units(step: FrozenStep, force: float, length: float) -> FrozenStep:
    """The same step with forces and lengths in other units; areas are left alone."""
    return replace(
        step,
        K=step.K * (force / length),
        r=step.r * force,
        gap=step.gap * length,
        scale=step.scale * force,
    )


def indefinite(step: FrozenStep) -> FrozenStep:
    """Its first unknown, made unstable."""
    K = step.K.tolil()
    K[0, 0] = -1.0
    return replace(step, K=sparse.csc_matrix(K))


def lopsided(step: FrozenStep) -> FrozenStep:
    """A follower's share in K."""
    K = step.K.tolil()
    K[0, 1] += 0.1
    return replace(step, K=sparse.csc_matrix(K))


@dataclass(frozen=True)
class Told(Solver):
    """A solver that has been told the answer: it adds an error, and says what it is told to say."""

    du: np.ndarray = field(default_factory=lambda: np.zeros(0))
    pressure: np.ndarray = field(default_factory=lambda: np.zeros(0))
    error: float = 0.0
    claims: bool = True
    spends: float = 0.0

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        begun = time.process_time()
        while time.process_time() - begun < self.spends:
            pass
        return Answer(self.du, self.pressure * (1 + self.error), self.claims, 1, reason="as told")


class Hangs(Solver):
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        time.sleep(600)
        raise AssertionError("not killed")


class Dies(Solver):
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        os._exit(3)


class Greedy(Solver):
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        return Answer(np.zeros(10**11), np.zeros(0), True)


class Broken(Solver):
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        raise ValueError("no\nsuch thing")
