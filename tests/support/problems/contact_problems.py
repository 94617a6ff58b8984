"""Small contact problems, and a second way to solve them."""

from __future__ import annotations

import math

import numpy as np
from scipy import sparse

import contact.problem
from contact.catalogue import ALGORITHMS
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
