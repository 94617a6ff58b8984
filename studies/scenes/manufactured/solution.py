"""An exact solution of the shell: a displacement of both faces, its strains and resultants, and the loads it needs.

Everything is Cartesian and comes from positions alone: lengths, curvatures and frames of the element's own geometry do
not enter. No grid and no interpolation may enter here.
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
from studies.scenes.manufactured.spectral import Patch
from studies.scenes.manufactured.statements import Statement, statement_of, work_gradient

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
