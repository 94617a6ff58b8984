"""The mixed (Hu-Washizu) four-node element of the 2004 paper, vectorised over the elements of a grid.

Bilinear face displacements; strains and resultants on the modes xi1^r1 xi2^r2 (paper eqs 10-13)::

    00: all 11 strains     01: E11-+, 2E13-+, E33     10: E22-+, 2E23-+, E33     11: E33

E^{r1r2} is the L2 projection of the compatible strain on its mode, H = D E mode by mode, and the work of a mode is
weighted by 1/3^{r1+r2}. Geometry (A, k, B, zeta) is taken at the 2 x 2 Gauss points, the area weight mubar at the
element centre. The element sees a measure only through strain, gradient and contract; it knows no surface, load or
boundary condition.

Resultants of the last linear step, H* = D (E + B dV), may be passed as ``predicted``: they then build the geometric
stiffness instead of D E (mixed Newton); the residual never changes.

Cost of force, tangent and B (1,680 elements of the tyre, one core): 13.0 microseconds an element, and 10.2 where E33 is
not sampled at nodes and the membrane is compatible. Matrix products are 9 of them, at the rate of large ones. Measured
beside it, and not taken:

- a kernel in C that knows the zeros of measure and operator: 5.7. It shortens a whole solve (tyre, half, 42 x 40, to
  20 mm) by 9 % with SuperLU and by 18 % with fronts: not worth a wheel for each platform in place of one for all, and a
  second element beside this one, which measures that are not quadratic and plug-ins need anyway;
- the same loops in numba: 23, after 0.3 s of import and 3.2 s of compilation (0.25 s from its cache);
- one half of the symmetric products, and its mirror image: 1.07 of the time of the whole. To scatter one half takes
  seven times as long, because picking it costs more than it saves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from formulations.element.modal import ALL, ModalElement, Operations, Samples, Stiffness
from formulations.element.strain_operator import GAUSS, N_DOF, N_GAUSS, ElementGeometry
from formulations.geometry.grid import CORNERS
from formulations.operations import product
from formulations.strains.measure import StrainFunction, StrainMeasure, strain_and_gradient, through_thickness
from formulations.strains.quantities import E33, N_BETA, N_E, N_Q, N_V

# Strain rows carried by each mode xi1^r1 xi2^r2 (the 2004 paper, eqs 10-13), in the order of the 22 mode strains.
MODES = {
    (0, 0): tuple(range(N_E)),
    (0, 1): (0, 1, 6, 7, 10),
    (1, 0): (2, 3, 8, 9, 10),
    (1, 1): (10,),
}
MODE_ROWS = [(mode, row) for mode, rows in MODES.items() for row in rows]
MODE_WEIGHTS = np.array([3.0 ** -(r1 + r2) for (r1, r2), _ in MODE_ROWS])
N_M = len(MODE_WEIGHTS)
E33_MODES = [m for m, (_, row) in enumerate(MODE_ROWS) if row == E33]


def mode_index(mode: tuple[int, int], row: int) -> int:
    """Place of a strain on a mode among the 22."""
    return MODE_ROWS.index((mode, row))


def _on_gauss() -> np.ndarray:
    """(4, 22, 11): the strains at the Gauss points that belong to the modes."""
    at_gauss = np.zeros((N_GAUSS, N_M, N_E))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        at_gauss[:, m, row] = GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2
    return at_gauss


ON_GAUSS = _on_gauss()

N_SAMPLES = N_GAUSS * N_E
SHEAR_ROWS = slice(6, 10)  # the only rows whose geometric factor differs from 1
THICKNESS_STRAINS = {"projected": 0.0, "balanced": 0.5, "nodal": 1.0}  # share of E33 that is sampled at the nodes
MEMBRANES = ("compatible", "relaxed")
# operations of an element by the shapes of its products: Q v and projections; B; H B; both parts of K
SAMPLED = product(N_GAUSS, N_Q, N_DOF) + product(N_SAMPLES, N_M) + 2 * product(N_GAUSS, N_E, N_Q) + product(N_M, N_M)
DIFFERENTIATED = product(N_GAUSS, N_E, N_Q, N_DOF) + product(N_M, N_SAMPLES, N_DOF)
BALANCED = product(N_M, N_DOF)
STIFFENED = product(N_M, N_M, N_DOF) + product(N_DOF, N_M, N_DOF) + product(N_M, N_SAMPLES)
STIFFENED += product(N_GAUSS, N_Q, N_Q, N_DOF) + product(N_GAUSS, N_DOF, N_Q, N_DOF)
OF_MEASURE = product(N_GAUSS, N_E, N_Q, N_Q)  # dE/dq of a quadratic one, and its second derivative times H
MEMBRANE_PAIRS = (N_E, N_E + len(MODES[0, 1]))  # first of E11-+ on the mode 01, and of E22-+ on the mode 10


def _projections(share: float) -> tuple[np.ndarray, np.ndarray | None]:
    """Mode strains = samples (44,) @ projection (44, 22) + E33 at the nodes (4,) @ nodal (4, 22).

    Samples of the 11 strains at the 4 Gauss points give the L2 projection on xi1^r1 xi2^r2; those at the nodes are
    interpolated bilinearly and projected, which is exact. ``share`` of E33 at the nodes; where it is 0, nodal is None.
    """
    projection, nodal = np.zeros((N_GAUSS, N_E, N_M)), np.zeros((4, N_M))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        at_nodes = share if row == E33 else 0.0
        projection[:, row, m] = (1 - at_nodes) * 3.0 ** (r1 + r2) * GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2 / N_GAUSS
        nodal[:, m] = at_nodes * CORNERS[:, 0] ** r1 * CORNERS[:, 1] ** r2 / N_GAUSS
    return projection.reshape(N_SAMPLES, N_M), nodal if share else None


@dataclass(frozen=True, eq=False)
class MixedElement(ModalElement):
    """Measure and section on the modes; ``initial`` are the resultants H0 of the reference state on the modes.

    ``through``: the measure of E33 alone at the nodes, see :func:`formulations.strains.measure.through_thickness`.

    thickness_strain: the share s of E33 that is sampled at the nodes and not at the Gauss points, none ("projected",
    the paper), half ("balanced") or all ("nodal"). An interpolated director is shorter than its nodal values, and a
    thin shell at finite rotation pays for that. Where directors turn by phi across an element of length l, bending
    stiffness D and the angle phi0 at rest (phi > 0 bends it further), the moment is to the third order in both angles::

        curvilinear:    M l/D = phi - (1 + 2 s)/8 phi0 phi^2 + (1/6 - s/3) phi^3
        isoparametric:  M l/D = (1 - s/3 phi0^2) phi + 3/8 (1 - 2 s) phi0 phi^2 + (1/6 - s/3) phi^3

    so s = 1/2 is what cancels phi^3 in flat and in curved elements. With less a fold is too stiff; with more it is too
    soft, phi - phi^3/6, and has a limit point of its own at phi = sqrt(2). All this is of elements that fold alike.
    Where they do not, one node cannot suit both, unless s = 1: see :mod:`formulations.element.arc_element`.
    membrane: "compatible" (the paper), or "relaxed": the linear modes of E11 and E22 keep only the share of their
    face-mean part that curvature and thickness justify, see :func:`_relaxation`; it removes what is left of membrane
    locking on coarse meshes of thin curved shells and changes nothing on flat ones.
    """

    measure: StrainMeasure
    through: StrainFunction
    mode_stiffness: np.ndarray
    initial: np.ndarray
    projection: np.ndarray
    nodal: np.ndarray | None
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
        projections = _projections(THICKNESS_STRAINS[thickness_strain])
        return cls(measure, through_thickness(measure), blocks, on_modes, *projections, membrane == "relaxed")

    @property
    def mode_weights(self) -> np.ndarray:
        """1/3^(r1+r2)."""
        return MODE_WEIGHTS

    @property
    def powers(self) -> list[tuple[int, int]]:
        """(r1, r2) of each."""
        return [mode for mode, _ in MODE_ROWS]

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H = D E on the modes, (e, 22), of the elements of the part."""
        return strains @ self.mode_stiffness.T

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        return self.resultants(strains)[:, :N_E]

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        return strains[:, :N_E]

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points in the axes of the laminate, of mode strains (E, 22)."""
        return np.einsum("gmn,em->egn", ON_GAUSS, strains)

    def energy(self, geometry: ElementGeometry, v: np.ndarray) -> float:
        """Strain energy 1/2 E D E of the whole grid (H0 excluded); a potential only where D is symmetric."""
        strains = self.mode_strains(geometry, v)
        work = np.sum(MODE_WEIGHTS * strains * self.resultants(strains), axis=-1)
        return float(0.5 * geometry.weight @ work)

    def _areas(self, geometry: ElementGeometry) -> np.ndarray:
        return geometry.weight

    def _response(self, strains: np.ndarray, part: slice) -> tuple[np.ndarray, Stiffness]:
        return self.resultants(strains, part), Stiffness((self._weighted_stiffness(part),))

    @property
    def _operations(self) -> Operations:
        return Operations(SAMPLED, DIFFERENTIATED, BALANCED, STIFFENED, OF_MEASURE)

    def _weighted_stiffness(self, part: slice) -> np.ndarray:
        """(22, 22), or one of each element of the part."""
        return MODE_WEIGHTS[:, None] * self.mode_stiffness

    def _initial(self, part: slice) -> np.ndarray:
        """H0 on the modes (22,), or of each element of the part."""
        return self.initial

    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> Samples:
        """The q of v at the Gauss points, (e, 4, 15), and its beta at the nodes, (e, 4, 3)."""
        q = np.matmul(geometry.Q[part], v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
        return q, v[part].reshape(-1, 4, N_V) @ geometry.director.T

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, Samples]:
        """Mode strains (e, 22), and dE/dq at the Gauss points (e, 4, 11, 15); a node's director is the true one."""
        q, beta = samples
        offset = None if geometry.offset is None else geometry.offset[part]
        strain, gradient = strain_and_gradient(self.measure, q, offset)
        at_nodes = None if self.nodal is None else self.through.strain(beta)[..., 0]
        return self.on_modes(geometry, strain, at_nodes, part), (gradient,)

    def on_modes(
        self, geometry: ElementGeometry, samples: np.ndarray, at_nodes: np.ndarray | None, part: slice = ALL
    ) -> np.ndarray:
        """Mode strains (e, 22) of strains (e, 4, 11) at the Gauss points and E33 (e, 4) at the nodes, if it counts."""
        on_modes = (samples * geometry.rows[part]).reshape(-1, N_SAMPLES) @ self.projection
        if self.nodal is not None and at_nodes is not None:
            on_modes += at_nodes @ self.nodal
        self._relax(on_modes, geometry, part)
        return on_modes

    def sampled_work(
        self, geometry: ElementGeometry, work: np.ndarray, part: slice = ALL
    ) -> tuple[np.ndarray, np.ndarray | None]:
        """The transpose of :meth:`on_modes`: weighted resultants (e, 22), changed here, at the points (e, 4, 11)."""
        self._relax(work, geometry, part)
        at_gauss = (work @ self.projection.T).reshape(-1, N_GAUSS, N_E) * geometry.rows[part]
        return at_gauss, None if self.nodal is None else work @ self.nodal.T

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradients: Samples, samples: Samples, out: np.ndarray
    ) -> None:
        """B (e, 22, 24): derivative of the mode strains by the nodal displacements; takes up the gradient dE/dq."""
        (gradient,), (_, beta) = gradients, samples
        gradient[..., SHEAR_ROWS, :] *= geometry.rows[part][..., SHEAR_ROWS, None]
        sampled = np.matmul(gradient, geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_DOF))
        np.matmul(self.projection.T, sampled.reshape(-1, N_SAMPLES, N_DOF), out=out)
        if self.nodal is not None:
            along = self.through.gradient(beta)[..., 0, :] @ geometry.director
            out.reshape(-1, N_M, 4, N_V)[:, E33_MODES] += self.nodal.T[E33_MODES, :, None] * along[:, None]
        self._relax(out, geometry, part)

    def _stiffen(
        self,
        tangent: np.ndarray,
        work: np.ndarray,
        geometry: ElementGeometry,
        part: slice,
        samples: Samples,
    ) -> None:
        """Add the geometric stiffness of the weighted resultants ``work`` (e, 22) to the tangent (e, 24, 24)."""
        q, beta = samples
        Q = geometry.Q[part]
        at_gauss, at_nodes = self.sampled_work(geometry, work, part)
        M = self.measure.contract(q if geometry.offset is None else geometry.offset[part] + q, at_gauss)
        MQ = np.matmul(M, Q.reshape(-1, N_GAUSS, N_Q, N_DOF)).reshape(Q.shape)
        tangent += np.matmul(Q.swapaxes(1, 2), MQ)
        if at_nodes is not None:
            M = self.through.contract(beta, at_nodes[..., None])
            own = M.reshape(-1, 4, N_BETA**2) @ geometry.director_pairs
            np.einsum("erirj->erij", tangent.reshape(-1, 4, N_V, 4, N_V))[...] += own.reshape(-1, 4, N_V, N_V)

    def _relax(self, on_modes: np.ndarray, geometry: ElementGeometry, part: slice) -> None:
        """Shrink the face mean of E11 on the mode 01 and of E22 on the mode 10, in place; a symmetric operator."""
        if not self.relaxed:
            return
        for a, first in enumerate(MEMBRANE_PAIRS):
            shrink = 0.5 - 0.5 * np.sqrt(geometry.relaxation[part, a])
            pair = on_modes[:, first : first + 2]
            pair -= shrink.reshape(-1, *[1] * (pair.ndim - 1)) * (pair[:, :1] + pair[:, 1:])
