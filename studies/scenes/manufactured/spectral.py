"""Smooth functions of (a1, a2) on a rectangle, by their values at Chebyshev points: derivatives and values to rounding.

Any function that can be evaluated can be differentiated; no mechanics may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

N_POINTS = 24  # along each coordinate: analytic fields of a few radians are resolved to 1e-12


@dataclass(frozen=True, eq=False)
class Chebyshev:
    """The points x_k = m - r cos(pi k/(n - 1)) of [m - r, m + r], and the derivative (n, n) of what has values there.

    Sources: Trefethen, Spectral Methods in MATLAB (2000); Berrut, Trefethen, SIAM Review 46 (2004) 501 (recalled).
    """

    points: np.ndarray
    derivative: np.ndarray
    weights: np.ndarray

    @classmethod
    def between(cls, low: float, high: float, n: int = N_POINTS) -> Chebyshev:
        """n points from ``low`` to ``high``, both included."""
        k = np.arange(n)
        x = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * k / (n - 1))
        weights = (-1.0) ** k
        weights[[0, -1]] *= 0.5
        apart = x[:, None] - x + np.eye(n)
        derivative = weights / weights[:, None] / apart
        np.fill_diagonal(derivative, 0.0)
        np.fill_diagonal(derivative, -derivative.sum(axis=1))  # a constant has no slope, to rounding
        return cls(x, derivative, weights)

    def basis(self, x: np.ndarray) -> np.ndarray:
        """The cardinal polynomials at x (...), (..., n), by the barycentric formula."""
        apart = x[..., None] - self.points
        hit = apart == 0
        terms = self.weights / np.where(hit, 1.0, apart)
        on_point = hit.any(axis=-1, keepdims=True)
        return np.where(on_point, hit, terms / np.where(on_point, 1.0, terms.sum(axis=-1, keepdims=True)))


@dataclass(frozen=True, eq=False)
class Patch:
    """A rectangle in (a1, a2); values on it are (n, n, ...), a1 first."""

    axes: tuple[Chebyshev, Chebyshev]

    @classmethod
    def over(cls, a1: tuple[float, float], a2: tuple[float, float]) -> Patch:
        """The rectangle between the ends of both coordinates."""
        return cls((Chebyshev.between(*a1), Chebyshev.between(*a2)))

    @property
    def points(self) -> np.ndarray:
        """(n, n, 2)."""
        return np.stack(np.meshgrid(self.axes[0].points, self.axes[1].points, indexing="ij"), axis=-1)

    def slopes(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives by a1 and by a2, of the shape of the values."""
        first, second = (axis.derivative for axis in self.axes)
        return np.einsum("ij,jk...->ik...", first, values), np.einsum("kj,ij...->ik...", second, values)

    def at(self, values: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Values (p, ..., of a value) at points a (p, ..., 2)."""
        points = a.reshape(-1, 2)
        first, second = (axis.basis(points[:, i]) for i, axis in enumerate(self.axes))
        along = np.tensordot(first, values, axes=1)
        found = np.einsum("pj,pj...->p...", second, along)
        return found.reshape(*a.shape[:-1], *values.shape[2:])
