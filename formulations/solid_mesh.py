"""Triquadratic hexahedra between the two faces of a shell-like body, and their shape functions and Gauss rules.

Meshes and numbering are scikit-fem's. No displacement, no load and no shell element may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from scipy import sparse

from formulations.geometry.grid import graded_lines
from formulations.geometry.surfaces import Surface
from formulations.section.laminate import Laminate


@dataclass(frozen=True, eq=False)
class Rule:
    """Products of three Gauss points with the quadratics that are one at 0, 1/2 or 1, on the unit square or cube.

    points (g, dim), weights (g,); value (g, n) of the shape functions there and slope (g, n, dim). Points and nodes
    have the last coordinate fastest.
    """

    points: np.ndarray
    weights: np.ndarray
    value: np.ndarray
    slope: np.ndarray

    @classmethod
    def tensor(cls, dim: int) -> Rule:
        """The product of ``dim`` lines."""
        points, weights = np.polynomial.legendre.leggauss(3)
        x, w = 0.5 * (points + 1), 0.5 * weights
        value = np.stack([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)], axis=-1)
        slope = np.stack([4 * x - 3, 4 - 8 * x, 4 * x - 1], axis=-1)
        along = [_product([slope if i == d else value for i in range(dim)]) for d in range(dim)]
        at = np.indices((3,) * dim).reshape(dim, -1).T
        return cls(x[at], w[at].prod(axis=-1), _product([value] * dim), np.stack(along, axis=-1))


def _product(lines: list[np.ndarray]) -> np.ndarray:
    return reduce(lambda one, other: np.kron(one, other), lines)


SQUARE, CUBE = Rule.tensor(2), Rule.tensor(3)


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """Nodes and hexahedra of a shell-like body.

    x (N, 3): Cartesian nodes; parameter (N, 3): their (a1, a2, a3).  elements (E, 27): nodes in the order of CUBE.
    frame (E, 27, 3, 3): rows e1, e2, e3 at the Gauss points; ply (E,): ply of each element.  inner, outer: face
    quadrilaterals (F, 9) in the order of SQUARE.  orientation: +1 or -1, handedness of (a1, a2, a3) on the body.
    """

    x: np.ndarray
    parameter: np.ndarray
    elements: np.ndarray
    frame: np.ndarray
    ply: np.ndarray
    inner: np.ndarray
    outer: np.ndarray
    orientation: float

    @classmethod
    def build(
        cls,
        surface: Surface,
        lines1: np.ndarray,
        lines2: np.ndarray,
        laminate: Laminate,
        *,
        per_ply: int = 1,
        periodic: bool = False,
    ) -> SolidMesh:
        """Hexahedra over the tensor grid of the lines, ``per_ply`` through each ply; nodes on the true geometry."""
        tops = laminate.d_minus + np.cumsum([ply.thickness for ply in laminate.plies])
        lines3 = graded_lines([laminate.d_minus, *tops], [per_ply] * len(tops))
        from skfem import Basis, ElementHex2, MeshHex  # slow to load, and shells have no need of it

        basis = Basis(MeshHex.init_tensor(lines1, lines2, lines3), ElementHex2(), intorder=1)
        parameter, elements = basis.doflocs.T.copy(), basis.element_dofs.T.astype(np.intp)
        low = parameter[elements].min(axis=1)
        size = np.ptp(parameter[elements], axis=1)
        halves = np.rint(2 * (parameter[elements] - low[:, None, :]) / size[:, None, :]).astype(int)
        elements = np.take_along_axis(elements, np.argsort(halves @ (9, 3, 1), axis=1), axis=1)
        at_gauss = low[:, None, :] + size[:, None, :] * CUBE.points
        inner = elements[np.isclose(low[:, 2], lines3[0])][:, 0::3]
        outer = elements[np.isclose(low[:, 2] + size[:, 2], lines3[-1])][:, 2::3]
        if periodic:
            seam = np.isclose(parameter[:, 1], lines2[-1])
            moved = parameter.copy()
            moved[seam, 1] = lines2[0]
            _, first, number = np.unique(np.round(moved, 9), axis=0, return_index=True, return_inverse=True)
            number = number.ravel()
            parameter, elements, inner, outer = moved[first], number[elements], number[inner], number[outer]
        a1, a2 = parameter[:, 0], parameter[:, 1]
        frame = surface.frame(at_gauss[..., 0], at_gauss[..., 1])
        x = surface.position(a1, a2) + parameter[:, 2:] * surface.frame(a1, a2)[:, 2]
        ply = np.searchsorted(tops, low[:, 2] + 0.5 * size[:, 2])
        return cls(x, parameter, elements, frame, ply, inner, outer, float(np.sign(np.linalg.det(frame[0, 0]))))

    def on(self, axis: int, value: float) -> np.ndarray:
        """Nodes with a_{axis+1} = value."""
        return np.flatnonzero(np.isclose(self.parameter[:, axis], value, atol=1e-9))

    def supports(self, *held: tuple[np.ndarray | slice, int | slice]) -> np.ndarray:
        """(N, 3) bool: what is held of the nodes, (nodes, component) of each, all of either by a slice."""
        fixed = np.zeros(self.x.shape, bool)
        for nodes, component in held:
            fixed[nodes, component] = True
        return fixed

    def jacobian_determinants(self) -> np.ndarray:
        """det dx/dxi (E, 27) [mm^3] at the Gauss points, of the sign of ``orientation`` in sound elements."""
        return np.linalg.det(np.einsum("gnd,enx->egdx", CUBE.slope, self.x[self.elements]))

    def area_vectors(self, x: np.ndarray, face: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Tangents (F, g, 2, 3) of a face (F, 9) at x (N, 3), and outward area vectors (F, g, 3) per unit square."""
        tangents = np.einsum("gnd,fnx->fgdx", SQUARE.slope, x[face])
        return tangents, self.orientation * np.cross(tangents[..., 0, :], tangents[..., 1, :])

    def face_areas(self, face: np.ndarray) -> np.ndarray:
        """Nodal areas (N,) of a reference face (F, 9): int N_r dA, all positive."""
        area = np.linalg.norm(self.area_vectors(self.x, face)[1], axis=-1)
        shares = np.einsum("g,fg,gn->fn", SQUARE.weights, area, SQUARE.value)
        return np.bincount(face.ravel(), weights=shares.ravel(), minlength=len(self.x))

    def face_mass(self, face: np.ndarray) -> sparse.csr_matrix:
        """Consistent matrix (N, N) of int N_r N_s dA on a reference face (F, 9); its row sums are the nodal areas."""
        area = SQUARE.weights * np.linalg.norm(self.area_vectors(self.x, face)[1], axis=-1)
        blocks = np.einsum("fg,gm,gn->fmn", area, SQUARE.value, SQUARE.value)
        rows, columns = np.repeat(face, 9, axis=1), np.tile(face, (1, 9))
        shape = (len(self.x), len(self.x))
        return sparse.coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsr()
