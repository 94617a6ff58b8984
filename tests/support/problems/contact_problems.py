"""Small contact problems, and a second way to solve them.

Small frozen steps with a known answer, and solvers that lie, dawdle, hang and die.
"""

from __future__ import annotations

import math
import os
import time
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

import contact.problem
from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep
from contact.problem import ContactProblem, ContactSolution, Linearise
from studies.arena.card.problems import (
    OPEN,
    PRESSED,
    TOUCHING,
    Quadratic,
    definite,
    dual_by_nnls,
    manufactured,
    random_quadratic,
    stieltjes,
)
from studies.arena.solvers.base import Answer, Solver

__all__ = [
    "EXACT",
    "OPEN",
    "PRESSED",
    "TOUCHING",
    "Quadratic",
    "applicable",
    "definite",
    "dense_step",
    "dual_by_nnls",
    "linear_mechanics",
    "manufactured",
    "random_quadratic",
    "solve_from_rest",
    "stieltjes",
]


def linear_mechanics(K: np.ndarray | sparse.sparray, f: np.ndarray) -> Linearise:
    """linearise(u, memory) of r = K u - f."""
    return contact.problem.linear_mechanics(sparse.csc_matrix(K), f)


def applicable(*epsilons: float) -> list[tuple[str, float]]:
    """The pairs (algorithm, epsilon) that a symmetric problem with lumped coupling is supported by."""
    any_problem = random_quadratic(np.random.default_rng(0), "definite").problem()
    pairs = [(name, epsilon) for name in ALGORITHMS for epsilon in epsilons]
    return [
        (name, epsilon) for name, epsilon in pairs if ALGORITHMS[name](epsilon=epsilon).supports(any_problem) is None
    ]


EXACT = [name for name, _ in applicable(math.inf)]  # those that enforce the condition itself


def solve_from_rest(
    name: str, problem: ContactProblem, n: int, epsilon: float = math.inf, **options
) -> ContactSolution:
    """The algorithm called ``name`` from rest."""
    algorithm = ALGORITHMS[name](epsilon=epsilon, **options)
    assert algorithm.supports(problem) is None
    return algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.weights)))


def dense_step(
    data: Quadratic, W: np.ndarray, u: np.ndarray, active: np.ndarray, epsilon: float
) -> tuple[np.ndarray, np.ndarray]:
    """Du and p_A of K du - G^T W p = -r, G_A du + p_A/epsilon = -g_A by one dense solve."""
    A = np.flatnonzero(active)
    G = data.G[A]
    push = data.G.T @ W[:, A]
    system = np.block([[data.K, -push], [G, np.eye(len(A)) / epsilon]])
    right = -np.concatenate([data.K @ u - data.f, (data.g0 + data.G @ u)[A]])
    # scaled by rows and columns so that a small epsilon does not spoil the reference itself
    scale = 1 / np.sqrt(np.abs(system).max(axis=1))
    solution = scale * np.linalg.solve(scale[:, None] * system * scale, scale * right)
    pressure = np.zeros(len(active))
    pressure[A] = solution[len(u) :]
    return solution[: len(u)], pressure


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
