"""Contact problems of a few unknowns with random matrices, some made from their answer, and a second way to solve them.

For the laws that every contact algorithm must keep; nothing here knows an algorithm of ours.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep, freeze
from contact.problem import ContactProblem, linear_mechanics


@dataclass(frozen=True, eq=False)
class Quadratic:
    """min 1/2 u.K.u - f.u under g0 + G u >= 0, with contact areas w; (n,), (m,), dense matrices."""

    K: np.ndarray
    f: np.ndarray
    G: np.ndarray
    g0: np.ndarray
    w: np.ndarray

    def problem(self, coupling: np.ndarray | None = None) -> ContactProblem:
        """As a contact problem; coupling: consistent W (m, m), default diag(w)."""
        G = sparse.csr_matrix(self.G)
        return ContactProblem(
            linear_mechanics(sparse.csc_matrix(self.K), self.f),
            lambda u: self.g0 + G @ u,
            lambda u: G,
            self.w,
            None if coupling is None else sparse.csr_matrix(coupling),
        )

    def step(self) -> FrozenStep:
        """As a step from u = 0."""
        return freeze(self.problem(), np.zeros_like(self.f), np.zeros_like(self.g0), {})


_EYE, _ONES, _FAR = np.eye(2), np.ones(2), np.array([10.0, 10.0])
HOPELESS = {  # problems without an answer, or with no numbers
    "no number": Quadratic(_EYE, np.array([np.nan, 0.5]), -_EYE, _FAR, _ONES),
    "no solution": Quadratic(np.diag([-1.0, 1.0]), np.array([1.0, 0.0]), _EYE, np.zeros(2), _ONES),
    "no stiffness": Quadratic(np.zeros((2, 2)), np.array([1.0, 0.5]), -_EYE, _FAR, _ONES),
}


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


def dual_by_nnls(data: Quadratic, epsilon: float) -> tuple[np.ndarray, np.ndarray]:
    """u (n,) and p (m,) from the dual: min 1/2 mu.S.mu + c.mu, mu >= 0, S = G K^-1 G^T + 1/(epsilon W)."""
    from scipy.optimize import nnls

    flexibility = np.linalg.solve(data.K, data.G.T)
    S = data.G @ flexibility + np.diag(1 / (epsilon * data.w))
    c = data.g0 + data.G @ np.linalg.solve(data.K, data.f)
    root_of_S = np.linalg.cholesky(S)
    mu, _ = nnls(root_of_S.T, -np.linalg.solve(root_of_S, c))
    return np.linalg.solve(data.K, data.f) + flexibility @ mu, mu / data.w
