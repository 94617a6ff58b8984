"""What a quadrilateral samples: the quantities q at its Gauss points and on its sides, from its nodes.

Frames, gradients and offsets of interpolated positions; :mod:`formulations.element.quad_element` says what is made of
them. No mode, no section and no strain measure enters here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.strain_operator import GAUSS, N_DOF, N_GAUSS, shape_functions
from formulations.strains.quantities import BETA, N_Q, N_V, Kinematics

SIDES = (((0, 1), (3, 2)), ((0, 3), (1, 2)))  # corners of the two sides along xi1, and along xi2
SIDE_CORNERS = np.array([side for pair in SIDES for side in pair])
N_SIDE = 6
# a shear that is taken: direction, side, face; and those of one direction and face, on both sides
N_TAKEN = 8
PAIRS = {(a, face): slice(4 * a + face, 4 * a + 4, 2) for a in (0, 1) for face in (0, 1)}


def along_side(a: int, face: int) -> np.ndarray:
    """Places in q of l_a, w_a, t_a of a face, and of beta."""
    return np.append(6 * a + face + 2 * np.arange(3), np.arange(N_Q)[BETA])


@dataclass(frozen=True, eq=False)
class NodalFaces:
    """What a quadrilateral needs of its corners; every array begins with (E, 4).

    middle (.., 3): positions on the reference surface.  normal (.., 3): unit normals.  frame (.., 3, 3): rows are the
    directions of the displacement components.  axes (.., 2, 3): both axes of the laminate along the surface.
    """

    middle: np.ndarray
    normal: np.ndarray
    frame: np.ndarray
    axes: np.ndarray


def unit(x: np.ndarray) -> np.ndarray:
    """Unit vectors (..., 3) along x."""
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


def tangents_of(x: np.ndarray) -> np.ndarray:
    """Derivatives (E, 4, 2, 3) at the Gauss points of a nodal field (E, 4, 3), by xi1 and xi2."""
    slope = shape_functions(GAUSS)[1]
    return np.matmul(slope.reshape(-1, 4), x).reshape(-1, N_GAUSS, 2, 3)


def jacobian_of(frame: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The same derivatives of positions along the first two directions of frames (E, 4, 3, 3): [direction, xi]."""
    return np.matmul(frame[:, :, :2], tangents_of(x).swapaxes(-1, -2))


def turn_between(at_gauss: np.ndarray, at_nodes: np.ndarray) -> np.ndarray:
    """e_i at a Gauss point . e_j at a node, (E, 4, 4, 3, 3): [point, node, i, j]."""
    return np.matmul(at_gauss[:, :, None], at_nodes[:, None].swapaxes(-1, -2))


def mid_lines(x: np.ndarray) -> np.ndarray:
    """Difference (E, 2, 3) of a nodal field across the element, along both of its middle lines."""
    return 2.0 * np.einsum("br,erx->ebx", shape_functions(np.zeros((1, 2)))[1][0], x)


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

    def along_axes(self, e3: np.ndarray, faces: NodalFaces) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points with that e3, and e1 and e2 as near to both axes as they get."""
        value = shape_functions(GAUSS)[0]
        one, two = (across_normal(np.einsum("gr,erx->egx", value, faces.axes[:, :, axis]), e3) for axis in (0, 1))
        e1 = unit(one + self.hand[:, None, None] * np.cross(two, e3))
        return np.stack([e1, self.hand[:, None, None] * np.cross(e3, e1), e3], axis=-2)


def at_gauss_points(
    faces: NodalFaces, X: np.ndarray, sides: Orientation, h: float, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Q (E, 4, 15, 4, 6), offset (E, 4, 15), areas (E, 4, 2) of the faces, and the frame of the inner one.

    Each face has a frame of its own in its tangent plane, and beta has one along the interpolated director. So nothing
    of a position is left over but the length of that director, and no linear strain sees a small rotation. What leaves
    the stretch of the faces out has the gradients of the reference surface on both.
    """
    value, slope = shape_functions(GAUSS)
    n = len(X)
    Q, offset = np.zeros((n, N_GAUSS, N_Q, 4, N_V)), np.zeros((n, N_GAUSS, N_Q))
    area, frames = np.empty((n, N_GAUSS, 2)), [sides.frames(X[:, :, face], faces) for face in (0, 1)]
    for face in (0, 1):
        own, at = frames[face], X[:, :, face]
        area[..., face] = np.abs(np.linalg.det(jacobian_of(own, at)))
        if kinematics.thin:
            own, at = sides.frames(faces.middle, faces), faces.middle
        inverse = np.linalg.inv(jacobian_of(own, at))  # d xi_b/d s_a: [b, a]
        along = np.einsum("gbr,egba->egar", slope, inverse)
        turned = turn_between(own, faces.frame)
        for a in (0, 1):
            for row, (i, sign) in enumerate(((a, 1), (1 - a, 1), (2, -1))):
                place = 6 * a + 2 * row + face
                Q[:, :, place, :, face::2] = sign * along[:, :, a, :, None] * turned[:, :, :, i, :]
            if kinematics.shallow:  # t_a = -v3,a with v3 = u . n: the turning of n is taken off
                turning = np.einsum("gbr,erx,egb->egx", slope, faces.normal, inverse[..., a])
                Q[:, :, 6 * a + 4 + face, :, face::2] -= np.einsum("gr,egx,erjx->egrj", value, turning, faces.frame)
    director = np.einsum("gr,erx->egx", value, faces.normal)
    length = np.linalg.norm(director, axis=-1)
    turned = turn_between(sides.along_axes(director / length[..., None], faces), faces.frame)
    for face in (0, 1):
        for i in range(3):
            Q[:, :, BETA.start + i, :, face::2] = (2 * face - 1) / h * value[:, :, None] * turned[:, :, :, i, :]
    offset[..., BETA.start + 2] = length - 1.0
    return Q, offset, area, frames[0]


def on_sides(
    faces: NodalFaces, X: np.ndarray, h: float, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """side_Q (E, 48, 24), side_offset (E, 8, 6) and half the lengths (E, 8) of the sides of both faces.

    beta counts over the height of the mean director above the side, and that height in the length: a small rotation
    turns both alike, and a linear shear does not see it.
    """
    n, ends = len(X), X[:, SIDE_CORNERS]  # (E, side, end, face, 3)
    half = 0.5 * (ends[:, :, 1] - ends[:, :, 0])  # (E, side, face, 3)
    taken = np.linalg.norm(half, axis=-1)
    if kinematics.thin:  # gradients along the reference surface, shears over the length midway between the faces
        taken = np.broadcast_to(np.linalg.norm(half.mean(axis=2, keepdims=True), axis=-1), taken.shape)
        reference = faces.middle[:, SIDE_CORNERS]
        half = np.broadcast_to(0.5 * (reference[:, :, 1] - reference[:, :, 0])[:, :, None], half.shape)
    length = np.linalg.norm(half, axis=-1)
    along = half / length[..., None]
    normals, axes = faces.normal[:, SIDE_CORNERS], faces.frame[:, SIDE_CORNERS]
    director = np.broadcast_to(normals.mean(axis=2)[:, :, None], half.shape)
    e3 = unit(director - np.sum(director * along, axis=-1, keepdims=True) * along)
    frame = np.stack([along, np.cross(e3, along), e3], axis=-2)  # which way round, no measure can tell
    own = np.einsum("esfix,esnjx->esfnij", frame, axes)
    across = np.sum(director * e3, axis=-1)  # of the mean director, which is shorter than 1
    tilt = np.sum(director * along, axis=-1) / across
    Q, offset = np.zeros((n, 4, 2, N_SIDE, 2, N_V)), np.zeros((n, 4, 2, N_SIDE))
    ways = np.array([-0.5, 0.5])
    for face in (0, 1):
        slope = ways / length[:, :, face, None]  # (E, side, end)
        for row, sign in enumerate((1, 1, -1)):
            Q[:, :, face, row, :, face::2] = sign * slope[..., None] * own[:, :, face, :, row]
        if kinematics.shallow:
            turning = (normals[:, :, 1] - normals[:, :, 0]) / (2 * length[:, :, face, None])
            Q[:, :, face, 2, :, face::2] -= 0.5 * np.einsum("esx,esnjx->esnj", turning, axes)
        for sides, places in ((slice(0, 2), (3, 4, 5)), (slice(2, 4), (4, 3, 5))):  # beta1 is along xi1
            offset[:, sides, face, places[0]] = tilt[:, sides, face]
            for i, place in enumerate(places):
                for other in (0, 1):
                    share = (other - 0.5) / (h * across[:, sides, face, None, None])
                    Q[:, sides, face, place, :, other::2] = share * own[:, sides, face, :, i]
    height = (taken * across).reshape(n, N_TAKEN)
    of_all = np.zeros((n, 4, 2, N_SIDE, 4, N_V))
    for side, corners in enumerate(SIDE_CORNERS):
        of_all[:, side][..., corners, :] = Q[:, side]
    return of_all.reshape(n, N_TAKEN * N_SIDE, N_DOF), offset.reshape(n, N_TAKEN, N_SIDE), height
