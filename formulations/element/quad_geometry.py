"""Quadrilaterals as the mixed element needs them: areas, base vectors, and how strains turn between modes and axes.

See :mod:`formulations.element.quad_element`. No strain measure and no section enters here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from formulations.element.mixed import E33_MODES, MODE_ROWS, N_M
from formulations.element.quad_sampling import (
    N_SIDES,
    NodalFaces,
    Orientation,
    across_normal,
    at_gauss_points,
    jacobian_of,
    on_sides,
    turn_between,
    unit,
)
from formulations.element.strain_operator import (
    AREAS,
    GAUSS,
    N_DOF,
    N_GAUSS,
    ElementGeometry,
    mid_lines,
    shape_functions,
)
from formulations.geometry.grid import CORNERS, FoldedQuadError, Grid
from formulations.geometry.surfaces import Surface
from formulations.strains.quantities import E33, FULL, N_E, N_Q, N_V, Kinematics

PLANE = np.arange(6)  # E11-+, E22-+, 2E12-+
TAKEN = np.append(PLANE, E33)  # rows that are taken at the Gauss points
NORM = np.array([1.0, 1.0, 0.5])  # E:E of (11, 22, 2 12)
ACROSS = ((0, 1), (1, 0))  # the mode on which a strain along xi1, or along xi2, is linear


@dataclass(frozen=True, eq=False)
class QuadGeometry(ElementGeometry):
    """:class:`ElementGeometry` of quadrilaterals; rows is 1, offset is what positions put into q.

    share (E, 4): of the area of an element at its Gauss points; face_share (E, 4, 2): of its faces.
    turn (E, 4, 11, 22): the A_g.
    frame (E, 4, 3, 3): that of the inner face at the Gauss points, to which ``value`` belongs.
    left_handed (E,): the corners go round against the normals.
    side_Q (E, 60, 24), side_offset (E, 4, 15): the same as Q and offset in the middle of the sides.
    side (E, 4, 2, 2): half of each side [side, face, a] along both axes, over the length of the element along it.
    at_nodes (E, 4, 3, 6): beta along (two tangents, normal) from the displacements of a node.
    steps: whether faces of an element differ from those of its nodes, so that both of a node move each of them.
    """

    share: np.ndarray
    face_share: np.ndarray
    turn: np.ndarray
    frame: np.ndarray
    left_handed: np.ndarray
    side_Q: np.ndarray
    side_offset: np.ndarray
    side: np.ndarray
    at_nodes: np.ndarray
    steps: bool

    @classmethod
    def of(cls, faces: NodalFaces, kinematics: Kinematics = FULL) -> QuadGeometry:
        """From positions at the nodes; raises FoldedQuadError naming the first that is folded."""
        X = faces.middle[:, :, None] + faces.d[..., None] * faces.normal[:, :, None]
        mid = X.mean(axis=2)  # of both faces (E, 4, 3)
        sides = Orientation.of(mid, faces)
        frame = sides.frames(mid, faces)
        jacobian = jacobian_of(frame, mid)
        weight = sides.turns[:, None] * np.linalg.det(jacobian)
        bad = np.flatnonzero(~_convex(mid))
        if len(bad):
            raise FoldedQuadError(f"element {bad[0]} has an angle of 180 degrees or more; {len(bad)} of {len(X)} have")
        area, centre = weight.sum(axis=1), 0.5 * mid_lines(mid)
        lengths = np.linalg.norm(centre, axis=-1)

        Q, offset, face_area, inner = at_gauss_points(faces, X, sides, kinematics)
        side_Q, side_offset, side = on_sides(faces, X, sides, kinematics)
        h = faces.height
        bent = np.sum(mid_lines(faces.normal) * mid_lines(mid), axis=-1)  # k l^2
        # a slope w' along xi1 leaves E11 = twist l2 w'/2 xi2, as curvature leaves k l w'/2 xi1 (strain_operator)
        warped = np.einsum("r,erx,ex->e", CORNERS.prod(axis=1), mid, unit(faces.normal.sum(axis=1)))  # twist l1 l2
        return cls(
            Q=faces.from_nodes(Q.reshape(len(X), -1, 4, N_V)).reshape(len(X), N_GAUSS * N_Q, N_DOF),
            rows=np.ones((len(X), 1, N_E)),
            weight=area,
            face_weight=face_area.sum(axis=1),
            director=np.kron(np.eye(3), [-1.0, 1.0]) / h.mean(),
            relaxation=1.0 / (1.0 + (bent**2 + warped[:, None] ** 2) / h.mean(axis=1, keepdims=True) ** 2),
            value=shape_functions(GAUSS)[0][:, :, None, None] * turn_between(inner, faces.frame),
            kinematics=kinematics,
            interpolation="quads",
            offset=offset,
            share=weight / area[:, None],
            face_share=face_area / face_area.sum(axis=1, keepdims=True),
            turn=_modes_to_axes(jacobian, lengths, carried(frame, centre / lengths[..., None])),
            frame=inner,
            left_handed=sides.turns * sides.hand < 0,
            side_Q=faces.from_nodes(side_Q.reshape(len(X), -1, 4, N_V)).reshape(len(X), N_SIDES * N_Q, N_DOF),
            side_offset=side_offset,
            side=side / np.repeat(lengths, 2, axis=1)[..., None, None],
            at_nodes=_directors(faces),
            steps=faces.steps,
        )

    def frames_on(self, surface: Surface, grid: Grid) -> np.ndarray:
        """Those of the inner face."""
        return self.frame

    def left_handed_on(self, surface: Surface, grid: Grid) -> np.ndarray:
        """As it was found."""
        return self.left_handed

    def point_areas(self, face: str) -> np.ndarray:
        """Area (E, 4) of the "mid" surface or of the "inner" or "outer" face at each Gauss point."""
        share = self.share if face == "mid" else self.face_share[..., AREAS.index(face)]
        return self._area(face)[:, None] * share

    def corner_areas(self, face: str) -> np.ndarray:
        """int N_r dA (E, 4) on the same areas."""
        return self.point_areas(face) @ shape_functions(GAUSS)[0]

    def corner_mass(self, face: str) -> np.ndarray:
        """int N_r N_s dA (E, 4, 4) on the same areas, bilinear between the Gauss points, as they are on a plate."""
        at_corners = N_GAUSS * self.point_areas(face) @ np.linalg.inv(shape_functions(GAUSS)[0]).T
        return np.einsum("et,trs->ers", at_corners, _TRIPLE)

    @cached_property
    def elements(self) -> dict[object, Any]:
        """Those that were made on this geometry."""
        return {}

    @cached_property
    def projection(self) -> np.ndarray:
        """(E, 28, 22): strains of the modes from those TAKEN at the Gauss points, all of E33 at these.

        In the plane those whose difference from what is taken is least, in the mean square of E:E over the area. So no
        element is stiffer for its modes, whatever the angle between its sides.
        """
        onto = np.zeros((len(self.weight), N_GAUSS, len(TAKEN), N_M))
        of_face = [[m for m, (_, row) in enumerate(MODE_ROWS) if row in PLANE[face::2]] for face in (0, 1)]
        A = self.turn[:, :, : len(PLANE) : 2][..., of_face[0]]  # the same on both faces
        weighted = self.share[..., None, None] * NORM[:, None] * A
        normal = np.einsum("egim,egin->emn", A, weighted)
        fitted = np.linalg.solve(normal[:, None], weighted.swapaxes(-1, -2)).swapaxes(-1, -2)
        for face, modes in enumerate(of_face):
            onto[:, :, face : len(PLANE) : 2, modes] = fitted
        for m in E33_MODES:
            r1, r2 = MODE_ROWS[m][0]
            onto[:, :, -1, m] = 3.0 ** (r1 + r2) * GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2 / N_GAUSS
        return onto.reshape(-1, N_GAUSS * len(TAKEN), N_M)


_GAUSS3 = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)]), np.array([5, 8, 5]) / 9


def _triple() -> np.ndarray:
    """int N_t N_r N_s over the reference square of area 1, (4, 4, 4)."""
    x, w = _GAUSS3
    points = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    value = shape_functions(points)[0]
    return np.einsum("p,pt,pr,ps->trs", np.outer(w, w).ravel() / 4, value, value, value)


_TRIPLE = _triple()


def carried(frame: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Base vectors of the centre (E, 2, 3) at the Gauss points, in the frames there: (E, 4, 2, 2), [component, b].

    They keep their components in a frame that lies evenly between them at the centre, however the corners are numbered,
    and is turned into the tangent plane elsewhere.
    """
    one, two = unit(centre[:, 0]), unit(centre[:, 1])
    normal = unit(np.cross(one, two))
    along = unit(one + np.cross(two, normal))
    components = np.einsum("eax,ebx->eab", np.stack([along, np.cross(normal, along)], axis=1), centre)
    e3 = frame[:, :, 2] * np.sign(np.einsum("egx,ex->eg", frame[:, :, 2], normal))[..., None]
    first = across_normal(along[:, None], e3)
    there = np.stack([first, np.cross(e3, first)], axis=-2)
    return np.einsum("egix,egax,eab->egib", frame[:, :, :2], there, components)


def strains_along(base: np.ndarray) -> np.ndarray:
    """Strains (11, 22, 2 12), columns, of g_1 g_1, g_2 g_2 and the symmetric part of g_1 g_2; base (..., 2, 2)."""
    a, b, c, d = base[..., 0, 0], base[..., 1, 0], base[..., 0, 1], base[..., 1, 1]  # g_1 = (a, b), g_2 = (c, d)
    rows = [[a * a, c * c, a * c], [b * b, d * d, b * d], [2 * a * b, 2 * c * d, a * d + b * c]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _modes_to_axes(jacobian: np.ndarray, lengths: np.ndarray, base: np.ndarray) -> np.ndarray:
    """A_g (E, 4, 11, 22): strains in the axes of the laminate at the Gauss points from the strains of the modes."""
    in_plane = strains_along(base)
    shear = np.linalg.inv(jacobian).swapaxes(-1, -2) * lengths[:, None, None, :]  # covariant, per unit of the modes
    A = np.zeros((len(base), N_GAUSS, N_E, N_M))
    for m, ((r1, r2), row) in enumerate(MODE_ROWS):
        shape = GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2
        kind, face = divmod(row, 2)
        if row < len(PLANE):
            A[:, :, face : len(PLANE) : 2, m] = shape[:, None] * in_plane[..., kind]
        elif row < E33:
            A[:, :, len(PLANE) + face : E33 : 2, m] = shape[:, None] * shear[..., kind - 3]
        else:
            A[:, :, E33, m] = shape
    return A


def _convex(mid: np.ndarray) -> np.ndarray:
    """(E,) bool: whether an element has no angle of 180 degrees or more, seen along the normal of its middle."""
    tangents = np.einsum("gbr,erx->egbx", shape_functions(CORNERS.astype(float))[1], mid)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    return np.asarray(np.all(np.einsum("egx,ex->eg", normals, normals.sum(axis=1)) > 0, axis=1))


def turn_of_nodes(faces: NodalFaces) -> np.ndarray:
    """(E, 4, 3, 3): components along two tangents and the normal of a node from those of its displacement."""
    first = unit(faces.axes[:, :, 0])
    frame = np.stack([first, np.cross(faces.normal, first), faces.normal], axis=-2)
    return np.einsum("erix,erjx->erij", frame, faces.frame)


def _directors(faces: NodalFaces) -> np.ndarray:
    """beta (E, 4, 3, 6) of a node along two tangents and its normal, from its displacements."""
    height = faces.of_node[..., 1] - faces.of_node[..., 0]
    return np.kron(turn_of_nodes(faces), np.array([-1.0, 1.0])) / height[..., None, None]
