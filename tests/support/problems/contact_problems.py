"""Small contact problems, and a second way to solve them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.optimize import nnls

import contact.problem
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution, Linearise


def linear_mechanics(K: np.ndarray | sparse.sparray, f: np.ndarray) -> Linearise:
    """linearise(u, memory) of r = K u - f."""
    return contact.problem.linear_mechanics(sparse.csc_matrix(K), f)


@dataclass(frozen=True, eq=False)
class Quadratic:
    """min 1/2 u.K.u - f.u under g0 + G u >= 0, with contact areas w; (n,), (m,), dense matrices."""

    K: np.ndarray
    f: np.ndarray
    G: np.ndarray
    g0: np.ndarray
    w: np.ndarray

    def problem(self, coupling: np.ndarray | None = None) -> ContactProblem:
        G = sparse.csr_matrix(self.G)
        return ContactProblem(
            linear_mechanics(self.K, self.f),
            lambda u: self.g0 + G @ u,
            lambda u: G,
            self.w,
            None if coupling is None else sparse.csr_matrix(coupling),
        )


def stieltjes(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric, diagonally dominant, no positive entry off the diagonal: active sets converge monotonically."""
    links = np.triu(rng.random((n, n)) * (rng.random((n, n)) < 0.5), 1)
    links = links + links.T
    return np.diag(links.sum(axis=1) + rng.uniform(0.1, 1, n)) - links


def definite(rng: np.random.Generator, n: int) -> np.ndarray:
    """Symmetric and positive definite, otherwise arbitrary."""
    root = rng.normal(size=(n, n))
    return root @ root.T / n + 0.2 * np.eye(n)


def random_quadratic(rng: np.random.Generator, kind: str, m: int = 6) -> Quadratic:
    """``obstacle``: M-matrix, one unknown a row; ``definite``: any SPD matrix; ``inclined``: three unknowns a row."""
    per_row = 3 if kind == "inclined" else 1
    n = per_row * m + 2
    K = stieltjes(rng, n) if kind == "obstacle" else definite(rng, n)
    unknowns = rng.permutation(n)[: per_row * m].reshape(m, per_row)
    G = np.zeros((m, n))
    slopes = rng.uniform(0.5, 2, (m, per_row))
    G[np.arange(m)[:, None], unknowns] = -slopes if kind == "obstacle" else slopes * rng.choice([-1, 1], slopes.shape)
    return Quadratic(K, rng.normal(size=n), G, rng.uniform(-0.3, 0.6, m), rng.uniform(0.5, 2, m))


OPEN, PRESSED, TOUCHING = range(3)


def manufactured(
    rng: np.random.Generator, kind: str, states: np.ndarray, epsilon: float = math.inf, size: float | np.ndarray = 1.0
) -> tuple[Quadratic, np.ndarray, np.ndarray]:
    """A problem whose only solution u, p is built in: each candidate OPEN, PRESSED, or TOUCHING without pressure.

    ``size`` (m,): how far open [mm] or how strongly pressed [MPa]; the touching have exactly zero of both.
    """
    data = random_quadratic(rng, kind, len(states))
    u = rng.normal(size=len(data.f))
    pressure = np.where(states == PRESSED, size * rng.uniform(0.5, 2, len(states)), 0.0)
    gap = np.where(states == OPEN, size * rng.uniform(0.5, 2, len(states)), 0.0) - pressure / epsilon
    f = data.K @ u - data.G.T @ (data.w * pressure)
    return Quadratic(data.K, f, data.G, gap - data.G @ u, data.w), u, pressure


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


def dual_by_nnls(data: Quadratic, epsilon: float) -> tuple[np.ndarray, np.ndarray]:
    """u and p from the dual: min 1/2 mu.S.mu + c.mu, mu >= 0, S = G K^-1 G^T + 1/(epsilon W)."""
    flexibility = np.linalg.solve(data.K, data.G.T)
    S = data.G @ flexibility + np.diag(1 / (epsilon * data.w))
    c = data.g0 + data.G @ np.linalg.solve(data.K, data.f)
    root_of_S = np.linalg.cholesky(S)
    mu, _ = nnls(root_of_S.T, -np.linalg.solve(root_of_S, c))
    return np.linalg.solve(data.K, data.f) + flexibility @ mu, mu / data.w


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
