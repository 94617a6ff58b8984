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

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from formulations.element.strain_operator import GAUSS, N_DOF, N_GAUSS, ElementGeometry
from formulations.geometry.grid import CORNERS
from formulations.strains.measure import StrainMeasure, strain_change
from formulations.strains.quantities import N_E, N_Q

# Strain rows carried by each mode (r1, r2); the order of the modes is the order of the 22 mode strains.
MODES = {
    (0, 0): tuple(range(N_E)),
    (0, 1): (0, 1, 6, 7, 10),
    (1, 0): (2, 3, 8, 9, 10),
    (1, 1): (10,),
}
MODE_ROWS = [(mode, row) for mode, rows in MODES.items() for row in rows]
MODE_WEIGHTS = np.array([3.0 ** -(r1 + r2) for (r1, r2), _ in MODE_ROWS])
N_M = len(MODE_WEIGHTS)
E33 = 10
N_SAMPLES = N_GAUSS * N_E
SHEAR_ROWS = slice(6, 10)  # the only rows whose geometric factor differs from 1
THICKNESS_STRAINS = {"projected": 0.0, "balanced": 0.5, "nodal": 1.0}  # share of E33 that is sampled at the nodes
MEMBRANES = ("compatible", "relaxed")
MEMBRANE_PAIRS = (N_E, N_E + len(MODES[0, 1]))  # first of E11-+ on the mode 01, and of E22-+ on the mode 10


def _projection(nodal: float) -> np.ndarray:
    """Mode strains (22,) = samples (48,) @ projection (48, 22): the 11 strains at 4 Gauss points, E33 at 4 nodes.

    Samples at the Gauss points give the L2 projection on xi1^r1 xi2^r2; those at the nodes are interpolated bilinearly
    and projected, which is exact. ``nodal``: their share of E33; where it is 0, their rows are left out.
    """
    projection = np.zeros((N_SAMPLES + N_GAUSS, N_M))
    at_gauss = projection[:N_SAMPLES].reshape(N_GAUSS, N_E, N_M)
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        share = nodal if row == E33 else 0.0
        at_gauss[:, row, m] = (1 - share) * 3.0 ** (r1 + r2) * GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2 / N_GAUSS
        projection[N_SAMPLES:, m] = share * CORNERS[:, 0] ** r1 * CORNERS[:, 1] ** r2 / N_GAUSS
    return projection if nodal else projection[:N_SAMPLES]


@dataclass(frozen=True, eq=False)
class MixedElement:
    """Measure and section on the modes; ``initial`` are the resultants H0 of the reference state on the modes.

    thickness_strain: the share s of E33 that is sampled at the nodes and not at the Gauss points, none ("projected",
    the paper), half ("balanced") or all ("nodal"). An interpolated director is shorter than its nodal values, and a
    thin shell at finite rotation pays for that. Where directors turn by phi across an element of length l, bending
    stiffness D and the angle phi0 at rest (phi > 0 bends it further), the moment is to the third order in both angles::

        curvilinear:    M l/D = phi - (1 + 2 s)/8 phi0 phi^2 + (1/6 - s/3) phi^3
        isoparametric:  M l/D = (1 - s/3 phi0^2) phi + 3/8 (1 - 2 s) phi0 phi^2 + (1/6 - s/3) phi^3

    so s = 1/2 is what cancels phi^3 in flat and in curved elements. With less a fold is too stiff; with more it is too
    soft, phi - phi^3/6, and has a limit point of its own at phi = sqrt(2).
    membrane: "compatible" (the paper), or "relaxed": the linear modes of E11 and E22 keep only the share of their
    face-mean part that curvature and thickness justify, see :func:`_relaxation`; it removes what is left of membrane
    locking on coarse meshes of thin curved shells and changes nothing on flat ones.
    """

    measure: StrainMeasure
    mode_stiffness: np.ndarray
    initial: np.ndarray
    projection: np.ndarray
    nodal: bool
    relaxed: bool

    @classmethod
    def build(
        cls,
        measure: StrainMeasure,
        D: np.ndarray,
        initial: np.ndarray,
        thickness_strain: str = "projected",
        membrane: str = "compatible",
    ) -> MixedElement:
        """Restrict D (11, 11) to the modes: one block per mode, as H^{r} = Q^{rT} D Q^{r} E^{r}.

        Raises ValueError for an option that does not exist.
        """
        if thickness_strain not in THICKNESS_STRAINS:
            raise ValueError(f"thickness strain {thickness_strain!r} is not one of {', '.join(THICKNESS_STRAINS)}")
        if membrane not in MEMBRANES:
            raise ValueError(f"membrane {membrane!r} is not one of {', '.join(MEMBRANES)}")
        blocks = block_diag(*(D[np.ix_(rows, rows)] for rows in MODES.values()))
        on_modes = np.zeros(N_M)
        on_modes[:N_E] = initial  # uniform over the element: only the mode 00
        nodal = THICKNESS_STRAINS[thickness_strain]
        return cls(measure, blocks, on_modes, _projection(nodal), nodal > 0, membrane == "relaxed")

    def mode_strains(self, geometry: ElementGeometry, v: np.ndarray, dv: np.ndarray | None = None) -> np.ndarray:
        """Mode strains E (E, 22) of nodal displacements v (E, 24); with ``dv`` their linear prediction E + B dv."""
        strains = np.empty((len(v), N_M))
        for part in geometry.chunks():
            q, at_nodes = self._gradients(geometry, part, v)
            samples = self._samples(geometry, part, q, at_nodes)
            if dv is not None:
                dq, change = self._gradients(geometry, part, dv)
                along = np.matmul(self.measure.gradient(_placed(geometry, part, q)), dq[..., None])[..., 0]
                at_gauss = along * geometry.rows[part]
                samples[:, :N_SAMPLES] += at_gauss.reshape(-1, N_SAMPLES)
                if self.nodal:
                    samples[:, N_SAMPLES:] += np.sum(self.measure.gradient(at_nodes)[..., E33, :] * change, axis=-1)
            strains[part] = self._onto_modes(samples, geometry, part)
        return strains

    def resultants(self, strains: np.ndarray) -> np.ndarray:
        """H = D E on the modes, (E, 22)."""
        return strains @ self.mode_stiffness.T

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy 1/2 E D E of the whole grid (H0 excluded); a potential only where D is symmetric."""
        strains = self.mode_strains(geometry, v)
        work = np.sum(MODE_WEIGHTS * strains * self.resultants(strains), axis=-1)
        return float(0.5 * geometry.weight @ work)

    def linear_initial_force(self, geometry: ElementGeometry) -> np.ndarray:
        """The work of H0 on the linear strains, (E, 24): balanced in the reference state, so it is taken off."""
        force = np.zeros((len(geometry.Q), N_DOF))
        if np.any(self.initial):
            for part in geometry.chunks():
                q, at_nodes = self._gradients(geometry, part, force)  # of the reference state
                B = self._mode_gradient(geometry, part, q, at_nodes)
                force[part] = geometry.weight[part, None] * ((MODE_WEIGHTS * self.initial) @ B)
        return force

    def integrate(
        self,
        geometry: ElementGeometry,
        v: np.ndarray,
        predicted: np.ndarray | None,
        force: np.ndarray,
        tangent: np.ndarray | None = None,
    ) -> None:
        """Internal force (E, 24) and tangent (E, 24, 24), unless that is None, at v (E, 24), written into the arrays.

        ``predicted`` (E, 22): the resultants that build the geometric stiffness; None takes D E(v).
        """
        stiffness = MODE_WEIGHTS[:, None] * self.mode_stiffness
        for part in geometry.chunks():
            rows, weight = geometry.rows[part], geometry.weight[part, None]
            q, at_nodes = self._gradients(geometry, part, v)
            H = self.resultants(self._onto_modes(self._samples(geometry, part, q, at_nodes), geometry, part))
            B = self._mode_gradient(geometry, part, q, at_nodes)
            force[part] = np.matmul((MODE_WEIGHTS * (H + self.initial) * weight)[:, None, :], B)[:, 0]
            if tangent is None:
                continue
            np.matmul(B.transpose(0, 2, 1), np.matmul(stiffness, B) * weight[..., None], out=tangent[part])
            H_geometric = H if predicted is None else predicted[part]
            work = MODE_WEIGHTS * (H_geometric + self.initial) * weight
            self._relax(work, geometry, part)
            at_samples = work @ self.projection.T
            at_gauss = at_samples[:, :N_SAMPLES].reshape(-1, N_GAUSS, N_E) * rows
            if self.nodal:
                through = np.zeros_like(at_gauss)
                through[..., E33] = at_samples[:, N_SAMPLES:]
                tangent[part] += _quadratic_form(self.measure.contract(at_nodes, through), geometry.node_beta)
            Q = geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_DOF)
            tangent[part] += _quadratic_form(self.measure.contract(_placed(geometry, part, q), at_gauss), Q)

    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The q of v at the Gauss points and, for a nodal E33, at the nodes (beta only): (e, 4, 15) each."""
        q = np.matmul(geometry.Q[part], v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
        if not self.nodal:
            return q, q
        return q, (v[part] @ geometry.node_beta.reshape(-1, N_DOF).T).reshape(-1, 4, N_Q)

    def _samples(self, geometry: ElementGeometry, part: slice, q: np.ndarray, at_nodes: np.ndarray) -> np.ndarray:
        """Strains at the Gauss points times the geometric row factors, then E33 at the nodes: (e, 44 or 48)."""
        if geometry.offset is None:
            strain = self.measure.strain(q)
        else:
            strain = strain_change(self.measure, geometry.offset[part], q)
        at_gauss = (strain * geometry.rows[part]).reshape(-1, N_SAMPLES)
        if not self.nodal:
            return at_gauss
        through = self.measure.strain(at_nodes)[..., E33]  # a node's director is the true one: no offset
        return np.concatenate([at_gauss, through], axis=1)

    def _mode_gradient(self, geometry: ElementGeometry, part: slice, q: np.ndarray, at_nodes: np.ndarray) -> np.ndarray:
        """B (e, 22, 24): derivative of the mode strains by the nodal displacements."""
        gradient = self.measure.gradient(_placed(geometry, part, q))
        gradient[..., SHEAR_ROWS, :] *= geometry.rows[part][..., SHEAR_ROWS, None]
        sampled = np.matmul(gradient, geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_DOF)).reshape(-1, N_SAMPLES, N_DOF)
        B = np.matmul(self.projection[:N_SAMPLES].T, sampled)
        if self.nodal:
            along = self.measure.gradient(at_nodes)[..., E33, None, :]
            B += np.matmul(self.projection[N_SAMPLES:].T, np.matmul(along, geometry.node_beta)[..., 0, :])
        self._relax(B, geometry, part)
        return B

    def _onto_modes(self, samples: np.ndarray, geometry: ElementGeometry, part: slice) -> np.ndarray:
        """Mode strains (e, 22) of the samples."""
        on_modes = samples @ self.projection
        self._relax(on_modes, geometry, part)
        return on_modes

    def _relax(self, on_modes: np.ndarray, geometry: ElementGeometry, part: slice) -> None:
        """Shrink the face mean of E11 on the mode 01 and of E22 on the mode 10, in place; a symmetric operator."""
        if not self.relaxed:
            return
        for a, first in enumerate(MEMBRANE_PAIRS):
            shrink = 1.0 - np.sqrt(geometry.relaxation[part, a])
            pair = on_modes[:, first : first + 2]
            pair -= shrink.reshape(-1, *[1] * (pair.ndim - 1)) * pair.mean(axis=1, keepdims=True)


def _placed(geometry: ElementGeometry, part: slice, q: np.ndarray) -> np.ndarray:
    """The gradients q counted from the true geometry: the offset of an interpolated one added."""
    return q if geometry.offset is None else geometry.offset[part] + q


def _quadratic_form(M: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Sum over the four points of Q^T M Q, (e, 24, 24), for M (e, 4, 15, 15) and Q (..., 4, 15, 24)."""
    MQ = np.matmul(M, Q).reshape(len(M), -1, N_DOF)
    return np.matmul(Q.reshape(*Q.shape[:-3], -1, N_DOF).swapaxes(-1, -2), MQ)
