"""An exact solution of the shell: a displacement of both faces, its strains and resultants, and the loads it needs.

Everything is Cartesian and comes from positions alone: lengths, curvatures and frames of the element's own geometry do
not enter. Derivatives are those of polynomials through Chebyshev points, to rounding. No grid and no interpolation of
elements may enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from formulations.geometry.surfaces import Surface
from formulations.section.laminate import Laminate
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import STRAINS
from studies.scenes.manufactured.statements import Statement, statement_of, work_gradient

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
        interpolated = np.einsum("pj,pj...->p...", second, along)
        return interpolated.reshape(*a.shape[:-1], *values.shape[2:])


Displacement = Callable[[np.ndarray], np.ndarray]  # points (..., 2) -> u of both faces (..., 2, 3), Cartesian

SIX = tuple(dict.fromkeys(name.rstrip("-+") for name in STRAINS))  # the strains of a face
# (strain, face) of each of the eleven; E33 is that of the director, the same on both faces
PLACES = tuple((SIX.index(name.rstrip("-+")), int(name.endswith("+"))) for name in STRAINS)


class Solution(Protocol):
    """What errors are measured against; points are (..., 2)."""

    @property
    def stiffness(self) -> np.ndarray:
        """D (11, 11)."""

    @property
    def displacement(self) -> Displacement:
        """u of both faces."""

    def strains(self, a: np.ndarray) -> np.ndarray:
        """E (..., 11)."""

    def body_force(self, a: np.ndarray) -> np.ndarray:
        """Force per area of the mid surface on each face, (..., 2, 3) [MPa]."""

    def edge_force(self, axis: int, a: np.ndarray) -> np.ndarray:
        """Force per length of the mid surface on each face of an edge, (..., 2, 3) [N/mm]."""


@dataclass(frozen=True, eq=False)
class Exact:
    """A shell over a rectangle of (a1, a2) that moves by ``displacement``; strains as a measure states them.

    displacement: u of the inner and of the outer face, smooth over the whole rectangle.  stiffness (11, 11): D.
    Work per area of the mid surface: sum over the faces of T_a . d(du)/ds_a, plus N . d(beta), so that forces b-+ per
    that area and t-+ per length of its edges, outward normal along +a, balance::

        mu b-+ = -d(mu T_a/|G_a|)/da_a -+ mu N/h,    t-+ = T_a |Gbar_a|/|G_a|,    mu = |Gbar_1| |Gbar_2|

    with G_a = dX/da_a of a face and Gbar_a of the surface midway between the faces. Where a measure leaves gradients
    out, so do these: |G_a| is that of the reference surface (thin), and slopes without what the frame turns (shallow).
    """

    surface: Surface
    laminate: Laminate
    measure: StrainMeasure
    stiffness: np.ndarray
    patch: Patch
    displacement: Displacement

    @cached_property
    def statement(self) -> Statement:
        """The strains of a face from its gradient."""
        return statement_of(self.measure)

    @cached_property
    def _frame(self) -> np.ndarray:
        """e1, e2, e3 as rows (n, n, 3, 3)."""
        return self.surface.frame(*np.moveaxis(self.patch.points, -1, 0))

    def _lengths(self, d: float) -> np.ndarray:
        """|dX/da_a| (n, n, 2) at the distance d."""
        x = self.surface.position(*np.moveaxis(self.patch.points, -1, 0)) + d * self._frame[..., 2, :]
        return np.stack([np.linalg.norm(slope, axis=-1) for slope in self.patch.slopes(x)], axis=-1)

    @cached_property
    def _mid(self) -> np.ndarray:
        """|Gbar_a| (n, n, 2)."""
        return self._lengths(0.5 * (self.laminate.d_minus + self.laminate.d_plus))

    @cached_property
    def _metric(self) -> np.ndarray:
        """|G_a| (n, n, face, 2) by which the measure takes gradients."""
        thin = self.measure.kinematics.thin
        distances = (0.0, 0.0) if thin else (self.laminate.d_minus, self.laminate.d_plus)
        return np.stack([self._lengths(d) for d in distances], axis=2)

    @cached_property
    def _turning(self) -> np.ndarray:
        """de3/ds_a (n, n, face, 3, 2) where slopes leave it out, else 0."""
        along = np.stack(self.patch.slopes(self._frame[..., 2, :]), axis=-1)[:, :, None] / self._metric[..., None, :]
        return along if self.measure.kinematics.shallow else np.zeros_like(along)

    @cached_property
    def _gradient(self) -> np.ndarray:
        """H (n, n, face, 3, 3) in the frame."""
        u = self.displacement(self.patch.points)
        beta = (u[:, :, 1] - u[:, :, 0]) / self.laminate.thickness
        along = np.stack(self.patch.slopes(u), axis=-1) / self._metric[..., None, :]
        across = np.broadcast_to(beta[:, :, None], u.shape)[..., None]
        H = np.einsum("...ix,...fxa->...fia", self._frame, np.concatenate([along, across], axis=-1))
        H[..., 2, :2] += np.einsum("...fx,...fxa->...fa", u, self._turning)
        return H

    @cached_property
    def _shear_factors(self) -> np.ndarray:
        """(n, n, face, 6): lengths of the face over those midway, for 2E13 and 2E23; 1 elsewhere."""
        factors = np.ones((*self._metric.shape[:-1], len(SIX)))
        if not self.measure.kinematics.thin:
            shears = [SIX.index("2E13"), SIX.index("2E23")]
            factors[..., shears] = self._metric / self._mid[:, :, None]
        return factors

    @cached_property
    def _strains(self) -> np.ndarray:
        six = self.statement(self._gradient) * self._shear_factors
        return np.stack([six[:, :, face, strain] for strain, face in PLACES], axis=-1)

    @cached_property
    def _stresses(self) -> tuple[np.ndarray, np.ndarray]:
        """T_a (n, n, face, 3, 2) and N (n, n, 3), Cartesian; T_a of the slopes alone comes third."""
        H = self._strains @ self.stiffness.T
        work = np.zeros((*H.shape[:2], 2, len(SIX)))
        for n, (strain, face) in enumerate(PLACES):
            work[:, :, face, strain] = H[..., n]
        P = work_gradient(self.statement, self._gradient, work * self._shear_factors)
        return P, np.einsum("...ix,...fia->...fxa", self._frame, P)

    @cached_property
    def _body(self) -> np.ndarray:
        """b (n, n, face, 3)."""
        P, T = self._stresses
        mu = np.prod(self._mid, axis=-1)[:, :, None, None]
        flow = mu[..., None] * T[..., :2] / self._metric[..., None, :]
        out = self.patch.slopes(flow[..., 0])[0] + self.patch.slopes(flow[..., 1])[1]
        across = T[..., 2].sum(axis=2)[:, :, None] / self.laminate.thickness
        held = np.einsum("...fa,...fxa->...fx", P[..., 2, :2], self._turning)
        return held - out / mu + across * np.array([-1.0, 1.0])[:, None]

    @cached_property
    def _edges(self) -> np.ndarray:
        """t (n, n, face, 3, 2) on lines of constant a1 and a2."""
        _, T = self._stresses
        return T[..., :2] * (self._mid[:, :, None] / self._metric)[..., None, :]

    def outer_area(self, a: np.ndarray) -> np.ndarray:
        """Area of the outer face at rest per area of the mid surface, (...)."""
        over = np.prod(self._lengths(self.laminate.d_plus), axis=-1) / np.prod(self._mid, axis=-1)
        return self.patch.at(over, a)

    def strains(self, a: np.ndarray) -> np.ndarray:
        """E (..., 11) at points (..., 2), in the order of :data:`formulations.strains.quantities.STRAINS`."""
        return self.patch.at(self._strains, a)

    def body_force(self, a: np.ndarray) -> np.ndarray:
        """Force per area of the mid surface on each face, (..., 2, 3) [MPa]."""
        return self.patch.at(self._body, a)

    def edge_force(self, axis: int, a: np.ndarray) -> np.ndarray:
        """Force per length of the mid surface on each face where a_{axis+1} is constant, (..., 2, 3) [N/mm].

        On the part below, that is where the outward normal points along +a_{axis+1}; its negative on the other side.
        """
        return self.patch.at(self._edges[..., axis], a)
