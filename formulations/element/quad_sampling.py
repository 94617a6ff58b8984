"""What a quadrilateral samples: the quantities q at its Gauss points and on its sides, from its nodes.

Frames, gradients and offsets of interpolated positions; :mod:`formulations.element.quad_element` says what is made of
them. No mode, no section and no strain measure enters here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.strain_operator import GAUSS, N_GAUSS, mid_lines, shape_functions
from formulations.strains.quantities import BETA, N_Q, N_V, OF_SURFACE, Kinematics

SIDE_CORNERS = np.array([[0, 1], [3, 2], [0, 3], [1, 2]])  # of the two sides along xi1, and along xi2
MIDDLES = np.array([[0.0, -1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]])  # of these sides
N_SIDES = len(MIDDLES)


@dataclass(frozen=True, eq=False)
class NodalFaces:
    """What a quadrilateral needs of its corners; every array begins with (E, 4).

    middle (.., 3): positions on the reference surface.  normal (.., 3): unit normals.  frame (.., 3, 3): rows are the
    directions of the displacement components.  axes (.., 2, 3): both axes of the laminate along the surface.
    d (.., 2): distances of the faces of the element from the reference surface.  of_node (.., 2): those of the faces
    of the node, whose displacements are the unknowns: where the wall steps they are not the same.
    """

    middle: np.ndarray
    normal: np.ndarray
    frame: np.ndarray
    axes: np.ndarray
    d: np.ndarray
    of_node: np.ndarray

    @property
    def height(self) -> np.ndarray:
        """(E, 4) between the faces."""
        return np.asarray(self.d[..., 1] - self.d[..., 0])

    @property
    def steps(self) -> bool:
        """Whether a face of an element lies elsewhere than that of its node."""
        return not np.array_equal(self.d, self.of_node)

    def from_nodes(self, Q: np.ndarray) -> np.ndarray:
        """Q (E, k, 4, 6) of displacements of the faces of an element, as one of those of its nodes.

        Displacements are linear across the wall: u(d) = u- + (d - d-)/(d+ - d-) (u+ - u-), d-+ of the node.
        """
        if not self.steps:
            return Q
        low, span = self.of_node[..., :1], self.of_node[..., 1:] - self.of_node[..., :1]
        upper = (self.d - low) / span  # (E, 4, face)
        shares = np.stack([1 - upper, upper], axis=-1)
        parts = Q.reshape(*Q.shape[:2], 4, 3, 2)
        return np.einsum("ekrif,erfn->ekrin", parts, shares).reshape(Q.shape)


def unit(x: np.ndarray) -> np.ndarray:
    """Unit vectors (..., 3) along x."""
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


def tangents_of(x: np.ndarray, points: np.ndarray = GAUSS) -> np.ndarray:
    """Derivatives (E, 4, 2, 3) at four points of a nodal field (E, 4, 3), by xi1 and xi2."""
    slope = shape_functions(points)[1]
    return np.matmul(slope.reshape(-1, 4), x).reshape(-1, len(points), 2, 3)


def jacobian_of(frame: np.ndarray, x: np.ndarray, points: np.ndarray = GAUSS) -> np.ndarray:
    """The same derivatives of positions along the first two directions of frames (E, 4, 3, 3): [direction, xi]."""
    return np.matmul(frame[:, :, :2], tangents_of(x, points).swapaxes(-1, -2))


def turn_between(at_points: np.ndarray, at_nodes: np.ndarray) -> np.ndarray:
    """e_i at a point . e_j at a node, (E, 4, 4, 3, 3): [point, node, i, j]."""
    return np.matmul(at_points[:, :, None], at_nodes[:, None].swapaxes(-1, -2))


def across_normal(x: np.ndarray, e3: np.ndarray) -> np.ndarray:
    """Unit vectors along x, less its part along e3."""
    return unit(x - np.sum(x * e3, axis=-1, keepdims=True) * e3)


@dataclass(frozen=True, eq=False)
class Orientation:
    """Which way round, (E,) of +-1: ``hand`` of (axis 1, axis 2, normal); ``turns`` of (g_1, g_2) against the axes."""

    hand: np.ndarray
    turns: np.ndarray

    @classmethod
    def of(cls, mid: np.ndarray, faces: NodalFaces) -> Orientation:
        """Of elements whose corners are at ``mid`` (E, 4, 3)."""
        up = faces.normal.sum(axis=1)
        axes, lines = faces.axes.sum(axis=1), mid_lines(mid)
        hand, round_ = (np.sign(np.sum(np.cross(x[:, 0], x[:, 1]) * up, axis=-1)) for x in (axes, lines))
        return cls(hand, hand * round_)

    def frames(self, nodal: np.ndarray, faces: NodalFaces) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points of a surface through nodes (E, 4, 3)."""
        tangents = tangents_of(nodal)
        e3 = unit(np.cross(tangents[:, :, 0], tangents[:, :, 1]))
        return self.along_axes((self.hand * self.turns)[:, None, None] * e3, faces)

    def along_axes(self, e3: np.ndarray, faces: NodalFaces, points: np.ndarray = GAUSS) -> np.ndarray:
        """Frames (E, 4, 3, 3) at four points with that e3, and e1 and e2 as near to both axes as they get."""
        value = shape_functions(points)[0]
        one, two = (across_normal(np.einsum("gr,erx->egx", value, faces.axes[:, :, axis]), e3) for axis in (0, 1))
        e1 = unit(one + self.hand[:, None, None] * np.cross(two, e3))
        return np.stack([e1, self.hand[:, None, None] * np.cross(e3, e1), e3], axis=-2)


def at_gauss_points(
    faces: NodalFaces, X: np.ndarray, sides: Orientation, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Q (E, 4, 15, 4, 6), offset (E, 4, 15), areas (E, 4, 2) of the faces, and the frame of the inner one.

    Each face has a frame of its own in its tangent plane, and beta has one along the interpolated director. So nothing
    of a position is left over but the length of that director, and no linear strain sees a small rotation. What leaves
    the stretch of the faces out has the gradients of the reference surface on both.
    """
    n = len(X)
    Q, offset = np.zeros((n, N_GAUSS, N_Q, 4, N_V)), np.zeros((n, N_GAUSS, N_Q))
    area, frames = np.empty((n, N_GAUSS, 2)), [sides.frames(X[:, :, face], faces) for face in (0, 1)]
    for face in (0, 1):
        own, at = frames[face], X[:, :, face]
        area[..., face] = np.abs(np.linalg.det(jacobian_of(own, at)))
        if kinematics.thin:
            own, at = sides.frames(faces.middle, faces), faces.middle
        Q[:, :, face : BETA.start : 2, :, face::2], _ = gradients(own, at, faces, kinematics, GAUSS)
    director, length, height = directors(faces, GAUSS)
    _put_beta(Q, sides.along_axes(director, faces), height, faces, GAUSS)
    offset[..., BETA.start + 2] = length - 1.0
    return Q, offset, area, frames[0]


def on_sides(
    faces: NodalFaces, X: np.ndarray, sides: Orientation, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Q (E, 4, 15, 4, 6) and offset (E, 4, 15) in the middle of the sides; half of each side (E, 4, 2, 2) of the faces.

    All of q has one frame there, along the director and the axes of the laminate, in whose plane lengths are counted:
    half of a side [side, face, a] is along both axes. beta counts over the height of the director, and that height in
    the side: a small rotation turns both alike, and a linear shear does not see it.
    """
    n, half = len(X), half_sides(X)  # (E, side, face, 3)
    Q, offset = np.zeros((n, N_SIDES, N_Q, 4, N_V)), np.zeros((n, N_SIDES, N_Q))
    director, length, height = directors(faces, MIDDLES)
    own = sides.along_axes(director, faces, MIDDLES)
    if kinematics.thin:  # gradients along the reference surface, shears over the length midway between the faces
        half = np.broadcast_to(half.mean(axis=2, keepdims=True), half.shape)
    for face in (0, 1):
        at = faces.middle if kinematics.thin else X[:, :, face]
        slopes, leaning = gradients_on_sides(own, at, faces, kinematics)
        Q[:, :, face : BETA.start : 2, :, face::2], offset[:, :, 4 + face : BETA.start : 6] = slopes, leaning
    _put_beta(Q, own, height * length, faces, MIDDLES)
    return Q, offset, length[..., None, None] * np.matmul(half, own[:, :, :2].swapaxes(-1, -2))


def directors(faces: NodalFaces, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of the interpolated way between the faces at four points, the direction (E, 4, 3), the length (E, 4) over the
    interpolated height, and that height (E, 4).
    """
    value = shape_functions(points)[0]
    height = faces.height @ value.T
    director = np.einsum("gr,erx->egx", value, faces.height[..., None] * faces.normal) / height[..., None]
    length = np.linalg.norm(director, axis=-1)
    return director / length[..., None], length, height


def gradients(
    own: np.ndarray, at: np.ndarray, faces: NodalFaces, kinematics: Kinematics, points: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """l, w and t of a surface, (E, 4, 6, 4, 3) by its displacements at the nodes, and d xi_b/d s_a (E, 4, 2, 2) [b, a].

    at (E, 4, 3): its positions; own (E, 4, 3, 3): the frames of the four points.
    """
    value, slope = shape_functions(points)
    inverse = np.linalg.inv(jacobian_of(own, at, points))
    along = np.einsum("gbr,egba->egar", slope, inverse)
    turned = turn_between(own, faces.frame)
    Q = np.empty((len(at), len(points), len(OF_SURFACE), 4, 3))
    for a in (0, 1):
        for row, (i, sign) in enumerate(((a, 1), (1 - a, 1), (2, -1))):
            Q[:, :, 3 * a + row] = sign * along[:, :, a, :, None] * turned[:, :, :, i, :]
        if kinematics.shallow:  # t_a = -v3,a with v3 = u . n: the turning of n is taken off
            turning = np.einsum("gbr,erx,egb->egx", slope, faces.normal, inverse[..., a])
            Q[:, :, 3 * a + 2] -= np.einsum("gr,egx,erjx->egrj", value, turning, faces.frame)
    return Q, inverse


def gradients_on_sides(
    own: np.ndarray, at: np.ndarray, faces: NodalFaces, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray]:
    """The same in the middle of the sides, and the t (E, 4, 2) of the positions, which lean on the frames there."""
    Q, inverse = gradients(own, at, faces, kinematics, MIDDLES)
    out_of_plane = np.matmul(tangents_of(at, MIDDLES), own[:, :, 2, :, None])[..., 0]
    return Q, -np.matmul(out_of_plane[:, :, None], inverse)[:, :, 0]


def half_sides(x: np.ndarray) -> np.ndarray:
    """(E, 4, ..., 3): half of each side of nodes (E, 4, ..., 3), from its first end to its second."""
    ends = x[:, SIDE_CORNERS]
    return np.asarray(0.5 * (ends[:, :, 1] - ends[:, :, 0]))


def _put_beta(Q: np.ndarray, own: np.ndarray, height: np.ndarray, faces: NodalFaces, points: np.ndarray) -> None:
    """beta over a height (E, 4), in frames ``own`` at four points."""
    share = shape_functions(points)[0] / height[..., None]
    turned = turn_between(own, faces.frame)
    for face in (0, 1):
        for i in range(3):
            Q[:, :, BETA.start + i, :, face::2] = (2 * face - 1) * share[..., None] * turned[:, :, :, i, :]
