"""The mixed (Hu-Washizu) four-node element of the 2004 paper, vectorised over the elements of a grid.

Bilinear face displacements; strains and resultants on the modes xi1^r1 xi2^r2 (paper eqs 10-13)::

    00: all 11 strains     01: E11-+, 2E13-+, E33     10: E22-+, 2E23-+, E33     11: E33

E^{r1r2} is the L2 projection of the compatible strain on its mode, H = D E mode by mode, and the work of a mode is
weighted by 1/3^{r1+r2}. Geometry (A, k, B, zeta) is taken at the 2 x 2 Gauss points, the area weight mubar at the
element centre. The element sees a measure only through strain, gradient and contract; it knows no surface, load or
boundary condition.

Resultants of the last linear step, H* = D (E + B dV), may be passed as ``predicted``: they then build the geometric
stiffness instead of D E (mixed Newton); the residual never changes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from formulations.grid import CORNERS, Grid
from formulations.laminate import Laminate
from formulations.measure import StrainMeasure
from formulations.quantities import N_E, N_Q, N_V, gradient_coefficients, shear_row_factors
from formulations.surface import Geometry, Surface

N_GAUSS, N_DOF = 4, 4 * N_V
GAUSS = CORNERS / np.sqrt(3.0)
CHUNK = 128  # elements per pass: large enough to hide the calls, small enough for the cache

# Strain rows carried by each mode (r1, r2); the order of the modes is the order of the 22 mode strains.
MODES = {
    (0, 0): tuple(range(N_E)),
    (0, 1): (0, 1, 6, 7, 10),
    (1, 0): (2, 3, 8, 9, 10),
    (1, 1): (10,),
}
MODE_WEIGHTS = np.array([3.0 ** -(r1 + r2) for (r1, r2), rows in MODES.items() for _ in rows])
N_M = len(MODE_WEIGHTS)
SHEAR_ROWS = slice(6, 10)  # the only rows whose geometric factor differs from 1


# L2 projection: mode strains (22,) = strains of all Gauss points (44,) @ _PROJECTION (44, 22).
def _projection() -> np.ndarray:
    projection, start = np.zeros((N_GAUSS, N_E, N_M)), 0
    for (r1, r2), rows in MODES.items():
        on_mode = GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2 * 3.0 ** (r1 + r2) / N_GAUSS
        for m, row in enumerate(rows, start):
            projection[:, row, m] = on_mode
        start += len(rows)
    return projection.reshape(N_GAUSS * N_E, N_M)


_PROJECTION = _projection()


def shape_functions(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bilinear N_r (..., 4) and dN_r/dxi (..., 2, 4) at points xi (..., 2) of the reference square."""
    one = 1.0 + xi[..., None, 0] * CORNERS[:, 0]
    two = 1.0 + xi[..., None, 1] * CORNERS[:, 1]
    slope = np.stack([CORNERS[:, 0] * two, CORNERS[:, 1] * one], axis=-2)
    return 0.25 * one * two, 0.25 * slope


@dataclass(frozen=True, eq=False)
class ElementGeometry:
    """All the element needs of surface and grid.

    Q (E, 60, 24): q at the four Gauss points from the nodal displacements.  rows (E, 4, 11): shear row factors.
    weight (E,): parameter area times mubar at the centre (the paper's area).  face_weight (E, 2): the same with the
    true areas of the inner and the outer face, zeta1 zeta2 in place of zbar1 zbar2.
    """

    Q: np.ndarray
    rows: np.ndarray
    weight: np.ndarray
    face_weight: np.ndarray

    @classmethod
    def build(cls, surface: Surface, grid: Grid, laminate: Laminate) -> ElementGeometry:
        """Evaluate surface and thickness on the grid."""
        d_minus, d_plus = laminate.d_minus, laminate.d_plus
        points = grid.centre[:, None, :] + grid.half[:, None, :] * GAUSS
        geometry = surface.geometry(points[..., 0], points[..., 1])
        c0, c1, c2 = gradient_coefficients(geometry, d_minus, d_plus)
        value, slope = shape_functions(GAUSS)
        slope = slope / grid.half[:, None, :, None]
        Q = np.empty((len(grid.elements), N_GAUSS, N_Q, 4, N_V))
        for r in range(4):
            Q[..., r, :] = (
                c0 * value[:, r, None, None] + c1 * slope[..., 0, r, None, None] + c2 * slope[..., 1, r, None, None]
            )
        at_centre = surface.geometry(grid.centre[:, 0], grid.centre[:, 1])
        parameter_area = 4.0 * grid.half.prod(axis=-1)
        face = np.stack([_area_factor(at_centre, d) for d in (d_minus, d_plus)], axis=-1)
        return cls(
            Q=Q.reshape(-1, N_GAUSS * N_Q, N_DOF),
            rows=shear_row_factors(geometry, d_minus, d_plus),
            weight=parameter_area * _area_factor(at_centre, 0.5 * (d_minus + d_plus)),
            face_weight=parameter_area[:, None] * face,
        )

    def chunks(self) -> Iterator[slice]:
        """Slices over the elements, one pass each."""
        n = len(self.Q)
        return (slice(start, min(start + CHUNK, n)) for start in range(0, n, CHUNK))


def _area_factor(geometry: Geometry, d: float) -> np.ndarray:
    """A1 A2 zeta1 zeta2 of the surface at distance d."""
    return np.prod(geometry.A * (1.0 + geometry.k * d), axis=-1)


@dataclass(frozen=True, eq=False)
class MixedElement:
    """Measure and section on the modes; ``initial`` are the resultants H0 (11,) of the reference state."""

    measure: StrainMeasure
    mode_stiffness: np.ndarray
    initial: np.ndarray

    @classmethod
    def build(cls, measure: StrainMeasure, D: np.ndarray, initial: np.ndarray) -> MixedElement:
        """Restrict D (11, 11) to the modes: one block per mode, as H^{r} = Q^{rT} D Q^{r} E^{r}."""
        blocks = np.zeros((N_M, N_M))
        start = 0
        for rows in MODES.values():
            stop = start + len(rows)
            blocks[start:stop, start:stop] = D[np.ix_(rows, rows)]
            start = stop
        on_modes = np.zeros(N_M)
        on_modes[:N_E] = initial  # uniform over the element: only the mode 00
        return cls(measure, blocks, on_modes)

    def mode_strains(self, geometry: ElementGeometry, v: np.ndarray, dv: np.ndarray | None = None) -> np.ndarray:
        """Mode strains E (E, 22) of nodal displacements v (E, 24); with ``dv`` their linear prediction E + B dv."""
        strains = np.empty((len(v), N_M))
        for part in geometry.chunks():
            Q, rows = geometry.Q[part], geometry.rows[part]
            q = np.matmul(Q, v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
            strain = self.measure.strain(q)
            if dv is not None:
                dq = np.matmul(Q, dv[part, :, None]).reshape(-1, N_GAUSS, N_Q, 1)
                strain += np.matmul(self.measure.gradient(q), dq)[..., 0]
            strains[part] = (strain * rows).reshape(-1, N_GAUSS * N_E) @ _PROJECTION
        return strains

    def resultants(self, strains: np.ndarray) -> np.ndarray:
        """H = D E on the modes, (E, 22)."""
        return strains @ self.mode_stiffness.T

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy 1/2 E D E of the whole grid (H0 excluded); a potential only where D is symmetric."""
        strains = self.mode_strains(geometry, v)
        return float(
            0.5 * np.einsum("...m,...m,m,...->", strains, self.resultants(strains), MODE_WEIGHTS, geometry.weight)
        )

    def linear_initial_force(self, geometry: ElementGeometry) -> np.ndarray:
        """The work of H0 on the linear strains, (E, 24): balanced in the reference state, so it is taken off."""
        gradient = self.measure.gradient(np.zeros((1, N_GAUSS, N_Q)))
        force = np.zeros((len(geometry.Q), N_DOF))
        if np.any(self.initial):
            for part in geometry.chunks():
                rows, Q = geometry.rows[part], geometry.Q[part]
                B = self._mode_gradient(np.tile(gradient, (len(Q), 1, 1, 1)), rows, Q)
                force[part] = geometry.weight[part, None] * ((MODE_WEIGHTS * self.initial) @ B)
        return force

    def integrate(
        self,
        geometry: ElementGeometry,
        v: np.ndarray,
        predicted: np.ndarray | None,
        force: np.ndarray,
        tangent: np.ndarray,
    ) -> None:
        """Internal force (E, 24) and tangent (E, 24, 24) at v (E, 24), written into the given arrays.

        ``predicted`` (E, 22): the resultants that build the geometric stiffness; None takes D E(v).
        """
        stiffness = MODE_WEIGHTS[:, None] * self.mode_stiffness
        for part in geometry.chunks():
            Q, rows, weight = geometry.Q[part], geometry.rows[part], geometry.weight[part]
            q = np.matmul(Q, v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
            strain = (self.measure.strain(q) * rows).reshape(-1, N_GAUSS * N_E) @ _PROJECTION
            H = self.resultants(strain)
            B = self._mode_gradient(self.measure.gradient(q), rows, Q)
            work = MODE_WEIGHTS * (H + self.initial) * weight[:, None]
            force[part] = np.matmul(work[:, None, :], B)[:, 0]
            H_geometric = H if predicted is None else predicted[part]
            work = MODE_WEIGHTS * (H_geometric + self.initial) * weight[:, None]
            at_gauss = (work @ _PROJECTION.T).reshape(-1, N_GAUSS, N_E) * rows
            M = self.measure.contract(q, at_gauss)
            MQ = np.matmul(M, Q.reshape(-1, N_GAUSS, N_Q, N_DOF)).reshape(Q.shape)
            B_transposed = B.transpose(0, 2, 1)
            np.matmul(B_transposed, np.matmul(stiffness, B) * weight[:, None, None], out=tangent[part])
            tangent[part] += np.matmul(Q.transpose(0, 2, 1), MQ)

    @staticmethod
    def _mode_gradient(gradient: np.ndarray, factors: np.ndarray, Q: np.ndarray) -> np.ndarray:
        """B (..., 22, 24) on the modes from dE/dq (..., 4, 11, 15) at the Gauss points, which is used up."""
        gradient[..., SHEAR_ROWS, :] *= factors[..., SHEAR_ROWS, None]
        at_gauss = np.matmul(gradient, Q.reshape(-1, N_GAUSS, N_Q, N_DOF))
        return np.matmul(_PROJECTION.T, at_gauss.reshape(-1, N_GAUSS * N_E, N_DOF))
