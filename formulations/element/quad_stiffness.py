"""Geometric stiffness of a quadrilateral under unit resultants, which a quadratic measure leaves where it is.

Made once for all steps of a path, it turns the products of an iteration into sums over the modes: of a face over its
own displacements, and of E33, which knows of differences between the faces alone. No state may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from formulations.element.mixed import E33_MODES, MODE_ROWS
from formulations.element.quad_geometry import PLANE, TAKEN, QuadGeometry
from formulations.element.quad_sampling import N_SIDES, SIDE_CORNERS
from formulations.element.strain_operator import N_DOF, N_GAUSS
from formulations.strains.measure import QuadraticMeasure, StrainFunction
from formulations.strains.quantities import BETA, N_Q, N_V

N_FACE = N_DOF // 2  # displacements of one face, or of both ends of a side, or differences between the faces
UPPER = np.flatnonzero(np.triu(np.ones((N_FACE, N_FACE))))
N_UPPER = len(UPPER)
NOTHING = 1e-12  # of the largest entry
OF_FACE = np.array([[m for m, (_, row) in enumerate(MODE_ROWS) if row in PLANE[face::2]] for face in (0, 1)])


@dataclass(frozen=True, eq=False)
class UnitStiffness:
    """Upper triangles under unit forces: faces (E, 2, 5, 78) of their modes; across (E, 4, 78) of E33; sides
    (E, 4, 2, 78) of both faces along them.
    """

    faces: np.ndarray
    across: np.ndarray
    sides: np.ndarray

    @classmethod
    def of(
        cls,
        geometry: QuadGeometry,
        taken: StrainFunction,
        shears: StrainFunction,
        through: StrainFunction,
        onto: np.ndarray,
        nodal: np.ndarray | None,
    ) -> UnitStiffness | None:
        """None where it depends on displacements, where a strain of a face knows of the other one or of beta, as of a
        measure or where the wall steps, or where the shear along a side is not that of its ends alone, because the
        shears of the measure do not transform as a vector.

        The arguments are those of :class:`formulations.element.quad_element.QuadElement`.
        """
        tables = [each.quadratic for each in (taken, through, shears) if isinstance(each, QuadraticMeasure)]
        if len(tables) < 3 or geometry.steps:
            return None
        of_faces = [(PLANE[face::2], np.arange(face, BETA.start, 2), OF_FACE[face]) for face in (0, 1)]
        for rows, own, _ in of_faces:
            if np.any(np.delete(tables[0][rows], own, 1)) or np.any(np.delete(tables[0][rows], own, 2)):
                return None
        n = len(onto)
        unit = cls(*(np.empty((n, *shape, N_UPPER)) for shape in ((2, OF_FACE.shape[1]), (4,), (N_SIDES, 2))))
        for part in geometry.chunks():  # a part stays in the cache
            Q = geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_FACE, 2)
            points = onto[part].reshape(len(Q), N_GAUSS, len(TAKEN), -1)
            for face, (rows, own, modes) in enumerate(of_faces):
                to_modes = points[:, :, rows][..., modes].reshape(len(Q), -1, len(modes))
                table = tables[0][np.ix_(rows, own, own)]
                unit.faces[part, face] = _turned(to_modes, table, Q[..., face][:, :, own])
            unit.across[part] = _turned(points[:, :, -1, E33_MODES], tables[1], Q[:, :, BETA, :, 1])
            if nodal is not None:
                at_nodes = np.zeros((len(Q), 4, 3, 4, 3))
                at_nodes[:, range(4), :, range(4)] = geometry.at_nodes[part, ..., 1::2].swapaxes(0, 1)
                unit.across[part] += _turned(nodal[:, E33_MODES], tables[1], at_nodes.reshape(len(Q), 4, 3, N_FACE))
            side_Q = geometry.side_Q[part].reshape(len(Q), N_SIDES, N_Q, N_DOF)
            for side, face in product(range(N_SIDES), (0, 1)):
                M = np.tensordot(geometry.side[part, side, face], tables[2][face::2], 1)
                own = np.matmul(side_Q[:, side].swapaxes(1, 2), np.matmul(M, side_Q[:, side]))
                ends = _of_nodes(SIDE_CORNERS[side])
                if np.abs(np.delete(own, ends, axis=1)).max() > NOTHING * np.abs(own).max():
                    return None
                unit.sides[part, side, face] = own[:, ends][..., ends].reshape(len(Q), -1)[:, UPPER]
        return unit

    def add(self, tangent: np.ndarray, part: slice, work: np.ndarray, of_sides: np.ndarray) -> None:
        """To the tangents (e, 24, 24) of a part, under weighted resultants (e, 22) and the forces (e, 8) of the sides.

        Every entry is looked up where it comes from: to add block by block would cost more than all the products.
        """
        n = len(work)
        sources = np.zeros((n, N_SOURCES + 1, N_UPPER))
        across = np.matmul(work[:, None, E33_MODES], self.across[part])
        np.matmul(work[:, OF_FACE][:, :, None], self.faces[part], out=sources[:, :2, None])
        sources[:, :2] += across
        np.negative(across[:, 0], out=sources[:, 2])
        np.matmul(of_sides.reshape(n, -1, 1, 2), self.sides[part], out=sources[:, 3:N_SOURCES, None])
        for entries in ENTRIES:
            tangent += np.take(sources.reshape(n, -1), entries, axis=1)


def _of_nodes(nodes: np.ndarray) -> np.ndarray:
    """The displacements (12,) of two nodes among those of an element."""
    return (N_V * nodes[:, None] + np.arange(N_V)).ravel()


def _entries() -> np.ndarray:
    """(3, 24, 24) where to find an entry: by face and between the faces, then along sides of xi1, and of xi2.

    The sources are both faces, what is between them, the four sides, and zeros.
    """
    triangle = np.zeros((N_FACE, N_FACE), int)
    triangle.flat[UPPER] = np.arange(N_UPPER)
    triangle = np.maximum(triangle, triangle.T)
    own, face = np.divmod(np.arange(N_DOF), 2)
    places = np.full((3, N_DOF, N_DOF), N_SOURCES * N_UPPER)
    places[0] = N_UPPER * np.where(face[:, None] == face, face, 2) + triangle[np.ix_(own, own)]
    for side, corners in enumerate(SIDE_CORNERS):
        at = _of_nodes(corners)
        places[1 + side // 2][np.ix_(at, at)] = N_UPPER * (3 + side) + triangle
    return places


N_SOURCES = 3 + N_SIDES
ENTRIES = _entries()


def _turned(weights: np.ndarray, table: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Upper triangles (E, m, 78) of sums of Q^T M Q over points p and strains k, of M (k, i, i) and Q (E, p, i, 12).

    weights ((E,) p k, m): of each sum.
    """
    MQ = np.matmul(table, Q[:, :, None])
    products = np.matmul(Q[:, :, None].swapaxes(-1, -2), MQ).reshape(len(Q), -1, N_FACE**2)
    return np.take(np.matmul(weights.swapaxes(-1, -2), products), UPPER, axis=-1)
