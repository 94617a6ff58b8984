"""The mixed element on any quadrilateral: its geometry from the nodes alone, and where it takes its strains.

Both faces are bilinear between the nodes, X- = X + d- n and X+ = X + d+ n with the nodal normals n, and so are
Cartesian displacements: an exact measure meets rigid motions exactly, and every measure counts from the interpolated
positions, as on an isoparametric grid. No coordinates are needed. What differs from an isoparametric grid:

- E_ab of a face is taken along the axes of the laminate at the Gauss points. Its modes are the tensors g_1 g_1 on 1 and
  xi2, g_2 g_2 on 1 and xi1 and g_1 g_2 on 1 of the base vectors at the centre of the element, each of unit length; what
  is taken is projected on them in the mean square of E:E over the area. A constant strain is a constant there and has
  its own mean: any quadrilateral passes the patch tests of membrane and bending. What is left out is orthogonal to what
  is kept, so that no element is stiffer for its modes; a fibre along g_1 that bends is stretched along g_1. Covariant
  components, each projected by itself, lose both: in skewed coordinates their parts cancel, and what is left out leaves
  the others. Six parallelograms of a slender beam have 0.17 of its deflection with those, 0.56 with these.
  Source: Pian, Sumihara, IJNME 20 (1984) 1685-1695, whose stresses have these modes.
- 2E_a3 of a face is taken at the middle of the two sides along xi_a, as the covariant strain of that side; between
  them it is linear. A plate bent to a constant curvature has none there. It is made of both shears along the axes of
  the laminate: those of novozhilov and elongation do not transform as a vector, and taken in a frame that turns with
  the side they would converge to another answer on every mesh. Source: Bathe, Dvorkin, IJNME 21 (1985) 367-383.
- E33 as on a grid.
- Where the thickness h differs from node to node, faces lie at X + d- n and X + d+ n of each, beta counts over the
  interpolated h, and D grows with it. Where walls of elements step at a node, the faces of an element follow those of
  the node, whose displacements are linear across the wall: any director stays the one of all elements around.

The modes turn to the axes of the laminate at every Gauss point, so that of an element::

    S = sum over Gauss points g of w_g A_g^T D A_g,    A_g (11, 22): strains in these axes from those of the modes

On rectangles S is D mode by mode, and all that is left of the difference is where the shears are taken. Force, tangent
and B of a quadratic measure take 1.1 to 1.25 times the seconds of a grid's element, 1.3 where its shears do not
transform as a vector, and 50 kB an element are kept. No load and no support may enter here, and no branch on a measure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.mixed import E33_MODES, MODE_WEIGHTS, N_M, THICKNESS_STRAINS, MixedElement, mode_index
from formulations.element.modal import ALL, Samples
from formulations.element.quad_geometry import ACROSS, TAKEN, QuadGeometry
from formulations.element.quad_sampling import N_SIDES
from formulations.element.quad_stiffness import UnitStiffness
from formulations.element.strain_operator import N_DOF, N_GAUSS, ElementGeometry
from formulations.strains.measure import StrainFunction, restricted, strain_and_gradient
from formulations.strains.quantities import N_Q, N_V

SHEARS = np.arange(6, 10)  # 2E13-+, 2E23-+


def _sides_to_modes() -> np.ndarray:
    """(4, 2, 22): strains of the modes from the shears along the four sides, of both faces."""
    onto = np.zeros((2, 2, 2, N_M))
    for a, linear in enumerate(ACROSS):
        for face, row in enumerate(SHEARS[2 * a : 2 * a + 2].tolist()):
            onto[a, :, face, mode_index((0, 0), row)] = 0.5
            onto[a, :, face, mode_index(linear, row)] = [-0.5, 0.5]
    return onto.reshape(N_SIDES, 2, N_M)


SIDES_TO_MODES = _sides_to_modes()
SHEAR_MODES = np.flatnonzero(SIDES_TO_MODES.any(axis=(0, 1)))


@dataclass(frozen=True, eq=False)
class QuadElement(MixedElement):
    """:class:`MixedElement` on quadrilaterals: mode_stiffness (E, 22, 22), S, and initial (E, 22) are those of each.

    H of a mode is what does the work MODE_WEIGHTS H dE an area.  taken: the measure at the Gauss points, without shears
    across the wall.  shears: these, in the middle of the sides.  at_rest (E, 4, 7, 15) and side_rest (E, 4, 4, 15):
    dE/dq of both in the reference state.  onto (E, 28, 22), side_onto (E, 16, 8): from what is taken to the modes, and
    to SHEAR_MODES.  axes_stiffness (11, 11) or (E, 4, 11, 11): D in the axes of the laminate.  units: None where the
    geometric stiffness is made anew of each state.
    """

    taken: StrainFunction
    shears: StrainFunction
    at_rest: np.ndarray
    side_rest: np.ndarray
    onto: np.ndarray
    side_onto: np.ndarray
    axes_stiffness: np.ndarray
    units: UnitStiffness | None

    @classmethod
    def on(
        cls, geometry: QuadGeometry, element: MixedElement, D: np.ndarray, initial: np.ndarray, thickness_strain: str
    ) -> QuadElement:
        """An element of grids put on quadrilaterals; D and H0 (11,) in the axes of the laminate.

        D: (11, 11), or at the Gauss points of each element (E, 4, 11, 11), then told from others by the array itself.
        Made once for all steps of a path: what differs from element to element costs as much as an iteration.
        """
        own = D.tobytes() if D.ndim == 2 else id(D)
        key = (element.measure, own, initial.tobytes(), thickness_strain, element.relaxed)
        if key not in geometry.elements:
            geometry.elements[key] = cls._made(geometry, element, D, initial, thickness_strain)
        return geometry.elements[key]

    @classmethod
    def _made(
        cls, geometry: QuadGeometry, element: MixedElement, D: np.ndarray, initial: np.ndarray, thickness_strain: str
    ) -> QuadElement:
        weighted = geometry.share[..., None, None] * geometry.turn
        stressed = np.matmul(D, geometry.turn).reshape(len(weighted), -1, N_M)
        stiffness = np.matmul(weighted.reshape(stressed.shape).swapaxes(1, 2), stressed)
        onto = geometry.projection.copy()
        onto[..., E33_MODES] *= 1.0 - THICKNESS_STRAINS[thickness_strain]
        measure, through = element.measure, element.through
        assert geometry.offset is not None
        taken, shears = (restricted(measure, rows, np.arange(N_Q)) for rows in (TAKEN, SHEARS))
        side_onto = np.einsum("esfa,sfm->esafm", geometry.side, SIDES_TO_MODES[..., SHEAR_MODES])
        return cls(
            measure=measure,
            through=through,
            mode_stiffness=stiffness,
            initial=np.einsum("egim,i->em", weighted, initial) / MODE_WEIGHTS,
            projection=element.projection,
            nodal=element.nodal,
            relaxed=element.relaxed,
            taken=taken,
            shears=shears,
            at_rest=taken.gradient(geometry.offset),
            side_rest=shears.gradient(geometry.side_offset),
            onto=onto,
            side_onto=side_onto.reshape(len(onto), N_SIDES * len(SHEARS), -1),
            axes_stiffness=D,
            units=UnitStiffness.of(geometry, taken, shears, through, onto, element.nodal),
        )

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H = S E on the modes, (e, 22), of the elements of the part."""
        return np.matmul(self.mode_stiffness[part], strains[..., None])[..., 0] / MODE_WEIGHTS

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        assert isinstance(geometry, QuadGeometry)
        stressed = np.matmul(self.axes_stiffness, self.at_gauss(geometry, strains)[..., None])[..., 0]
        return np.asarray(np.einsum("eg,egi->ei", geometry.share, stressed))

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        assert isinstance(geometry, QuadGeometry)
        return np.asarray(np.einsum("eg,egi->ei", geometry.share, self.at_gauss(geometry, strains)))

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points in the axes of the laminate, of mode strains (E, 22)."""
        assert isinstance(geometry, QuadGeometry)
        return np.asarray(np.matmul(geometry.turn, strains[:, None, :, None])[..., 0])

    def _weighted_stiffness(self, part: slice) -> np.ndarray:
        return self.mode_stiffness[part]

    def _initial(self, part: slice) -> np.ndarray:
        return self.initial[part]

    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> Samples:
        """The q of v at the Gauss points (e, 4, 15), its beta at the nodes (e, 4, 3), and q of the sides (e, 4, 15)."""
        assert isinstance(geometry, QuadGeometry)
        nodal = v[part].reshape(-1, 4, N_V)
        q = np.matmul(geometry.Q[part], v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
        beta = np.einsum("erij,erj->eri", geometry.at_nodes[part], nodal)
        return q, beta, np.matmul(geometry.side_Q[part], v[part, :, None]).reshape(-1, N_SIDES, N_Q)

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, Samples]:
        """Mode strains (e, 22); dE/dq at the Gauss points (e, 4, 7, 15) and of the sides (e, 4, 4, 15)."""
        assert isinstance(geometry, QuadGeometry)
        assert geometry.offset is not None
        q, beta, along = samples
        strain, gradient = strain_and_gradient(self.taken, q, geometry.offset[part], self.at_rest[part])
        on_modes = np.matmul(strain.reshape(len(q), 1, -1), self.onto[part])[:, 0]
        shear, slope = strain_and_gradient(self.shears, along, geometry.side_offset[part], self.side_rest[part])
        on_modes[:, SHEAR_MODES] = np.matmul(shear.reshape(len(q), 1, -1), self.side_onto[part])[:, 0]
        if self.nodal is not None:
            on_modes += self.through.strain(beta)[..., 0] @ self.nodal
        self._relax(on_modes, geometry, part)
        return on_modes, (gradient, slope)

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradients: Samples, samples: Samples, out: np.ndarray
    ) -> None:
        assert isinstance(geometry, QuadGeometry)
        (gradient, slope), beta, n = gradients, samples[1], len(out)
        taken = np.matmul(gradient, geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_DOF))
        np.matmul(self.onto[part].swapaxes(1, 2), taken.reshape(n, -1, N_DOF), out=out)
        taken = np.matmul(slope, geometry.side_Q[part].reshape(-1, N_SIDES, N_Q, N_DOF))
        out[:, SHEAR_MODES] = np.matmul(self.side_onto[part].swapaxes(1, 2), taken.reshape(n, -1, N_DOF))
        if self.nodal is not None:
            of_nodes = np.einsum("eri,erij->erj", self.through.gradient(beta)[..., 0, :], geometry.at_nodes[part])
            out.reshape(n, N_M, 4, N_V)[:, E33_MODES] += self.nodal.T[E33_MODES, :, None] * of_nodes[:, None]
        self._relax(out, geometry, part)

    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        assert isinstance(geometry, QuadGeometry)
        self._relax(work, geometry, part)
        if self.units is not None:
            self.units.add(tangent, part, work, np.tensordot(work, SIDES_TO_MODES, (1, 2)))
        else:
            self._stiffen_anew(tangent, work, geometry, part, samples)

    def _stiffen_anew(
        self, tangent: np.ndarray, work: np.ndarray, geometry: QuadGeometry, part: slice, samples: Samples
    ) -> None:
        """What :meth:`UnitStiffness.add` does, of any measure in its state."""
        assert geometry.offset is not None
        (q, beta, along), n = samples, len(work)
        H = np.matmul(self.onto[part], work[..., None]).reshape(n, N_GAUSS, -1)
        _add_turned(tangent, self.taken.contract(geometry.offset[part] + q, H), geometry.Q[part])
        H = np.matmul(self.side_onto[part], work[:, SHEAR_MODES, None]).reshape(n, N_SIDES, -1)
        _add_turned(tangent, self.shears.contract(geometry.side_offset[part] + along, H), geometry.side_Q[part])
        if self.nodal is not None:
            M, at_nodes = self.through.contract(beta, (work @ self.nodal.T)[..., None]), geometry.at_nodes[part]
            own = np.matmul(at_nodes.swapaxes(-1, -2), np.matmul(M, at_nodes))
            blocks = tangent.reshape(n, 4, N_V, 4, N_V)
            for corner in range(4):
                blocks[:, corner, :, corner] += own[:, corner]


def _add_turned(tangent: np.ndarray, M: np.ndarray, Q: np.ndarray) -> None:
    """Add the sum of Q^T M Q over points p to tangents (e, 24, 24), of M (e, p, i, i) and Q (e, p i, 24)."""
    MQ = np.matmul(M, Q.reshape(*M.shape[:3], N_DOF)).reshape(Q.shape)
    tangent += np.matmul(Q.swapaxes(1, 2), MQ)
