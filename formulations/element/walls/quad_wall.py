"""What an element with surfaces inside its wall needs of a quadrilateral, beside QuadGeometry.

Every surface X + d n is bilinear between the nodes, and so are displacements. As on two faces
(:mod:`formulations.element.quad_element`) strains in the plane are taken in the axes of the laminate at the Gauss
points, with a frame of its own on every surface, and shears across the wall in the middle of the sides, as what a side
has of them. The modes are 1, phi_1, phi_2 and phi_12: xi1, xi2 and xi1 xi2 less their means over the area of the
element, of the size of those of a square. So the mode 00 is a mean, in the axes of the laminate, and the law is met
there. On 01 axis 1 is along the base vector g_1 of the centre, on 10 axis 2 is along g_2::

    00: means    01: phi_2    10: phi_1    11: phi_12

Strains in the plane are those that differ least from what is taken, in the mean square of E:E over the area. A constant
one is a constant there: any quadrilaterals pass the patch tests of membrane and bending. No strain measure, no law and
no load may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.quad_geometry import NORM, carried, strains_along, turn_of_nodes
from formulations.element.quad_sampling import (
    MIDDLES,
    N_SIDES,
    NodalFaces,
    Orientation,
    directors,
    gradients,
    gradients_on_sides,
    half_sides,
    jacobian_of,
    turn_between,
)
from formulations.element.strain_operator import GAUSS, N_GAUSS, mid_lines, shape_functions
from formulations.element.walls.geometry import N_SURFACE, WallGeometry
from formulations.element.walls.modes import E33, N_OF_SURFACE, N_ROWS, OF_E33, ROWS, mode_slices
from formulations.section.laminate import strain_rotation
from formulations.section.sampling import IN_VOIGT, Sampling
from formulations.strains.quantities import N_BETA, OF_SURFACE, Kinematics

N_POINTS = N_GAUSS + N_SIDES
OF_MODE = np.append(0, OF_E33[:-1] + 1)  # where the rows of each mode begin


@dataclass(frozen=True, eq=False)
class QuadWall(WallGeometry):
    """:class:`WallGeometry` of quadrilaterals, whose points are those of Gauss and the middles of the sides.

    taken (E, T, 15, 48): the modes of each surface by the strains at its points.  directions (2, E): angles [rad] from
    axis 1 of the laminate to axis 1 of the modes 01 and 10.  shapes (E, 4, 4): the modes at the Gauss points.
    turn (E, 4, 3, 3): components of a displacement along two tangents and the normal of a node from its own.
    """

    taken: np.ndarray
    directions: np.ndarray
    shapes: np.ndarray
    turn: np.ndarray

    @classmethod
    def of_faces(cls, faces: NodalFaces, sampling: Sampling, kinematics: Kinematics) -> QuadWall:
        """From positions at the nodes."""
        n, T = len(faces.middle), len(sampling.strained)
        X = faces.middle + sampling.strained[:, None, None, None] * faces.normal  # (T, E, 4, 3)
        sides = Orientation.of(faces.middle + 0.5 * faces.d.sum(axis=-1)[..., None] * faces.normal, faces)
        at = np.broadcast_to(faces.middle, X.shape) if kinematics.thin else X
        frames = [sides.frames(each, faces) for each in at]
        own, offset = np.empty((n, T, N_POINTS, len(OF_SURFACE), 4, 3)), np.zeros((n, T, N_POINTS, 6 + N_BETA))
        at_gauss, on_sides = slice(0, N_GAUSS), slice(N_GAUSS, N_POINTS)
        director, length, _ = directors(faces, GAUSS)
        value = [_values(sides.along_axes(director, faces), faces, GAUSS)]
        offset[:, :, at_gauss, -1] = (length - 1.0)[:, None]
        director, length, _ = directors(faces, MIDDLES)
        along = sides.along_axes(director, faces, MIDDLES)
        value.append(_values(along, faces, MIDDLES) / length[..., None, None])
        half = [length[..., None] * np.einsum("esax,esx->esa", along[:, :, :2], half_sides(x)) for x in at]
        for t in range(T):
            own[:, t, at_gauss], _ = gradients(frames[t], at[t], faces, kinematics, GAUSS)
            own[:, t, on_sides], offset[:, t, on_sides, 2:6:3] = gradients_on_sides(along, at[t], faces, kinematics)
        lines, turning = 0.5 * mid_lines(faces.middle), 0.5 * mid_lines(faces.normal)
        middle = sides.frames(faces.middle, faces)
        jacobian = jacobian_of(middle, faces.middle)
        weight = np.abs(np.linalg.det(jacobian))
        area = weight.sum(axis=1)
        modes = _Modes.of(weight / area[:, None], middle, lines)
        lengths = _lengths(lines + sampling.strained[:, None, None, None] * turning)  # (T, E, 2)
        taken = np.zeros((n, T, N_OF_SURFACE, N_POINTS, N_ROWS))
        modes.put_plane(taken)
        for t in range(T):
            modes.put_shears(taken[:, t], jacobian_of(frames[t], at[t]), half[t])
        return cls(
            sampling=sampling,
            own=own.reshape(n, T, -1, N_SURFACE),
            value=np.concatenate(value, axis=1).reshape(n, -1, N_SURFACE),
            offset=offset,
            area=area,
            growth=np.ones((n, 1)) * [1.0, 0.0, 0.0] if kinematics.thin else _growth(lines, turning),
            stretch=np.ones((n, 2, T)) if kinematics.thin else np.moveaxis(lengths / _lengths(lines), 0, 2),
            taken=taken.reshape(n, T, N_OF_SURFACE, -1),
            directions=modes.directions,
            shapes=modes.shapes,
            turn=turn_of_nodes(faces),
        )

    def projection_of(self, part: slice) -> np.ndarray:
        """(e, T, 15, 48)."""
        return np.asarray(self.taken[part])

    @property
    def angles(self) -> np.ndarray | None:
        """``directions``."""
        return self.directions

    @property
    def at_nodes(self) -> np.ndarray | None:
        """``turn``."""
        return self.turn

    def at_gauss(self, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, T, 6) in the axes of the laminate, of mode strains (E, 15 T)."""
        T = len(self.sampling.strained)
        strain = np.zeros((len(strains), N_GAUSS, T, N_ROWS))
        for mode, (block, rows) in enumerate(zip(mode_slices(T), ROWS, strict=True)):
            of_mode = np.zeros((len(strains), T, N_ROWS))
            of_mode[..., list(rows)] = strains[:, block].reshape(len(strains), T, -1)
            if mode in (1, 2):
                back = np.array([strain_rotation(-angle) for angle in self.directions[mode - 1]])
                of_mode = np.einsum("eij,etj->eti", back[:, IN_VOIGT][:, :, IN_VOIGT], of_mode)
            strain += self.shapes[:, mode, :, None, None] * of_mode[:, None]
        return strain


def _values(own: np.ndarray, faces: NodalFaces, points: np.ndarray) -> np.ndarray:
    """(E, 4, 3, 12): components of a displacement in frames (E, 4, 3, 3) at four points from those of the nodes."""
    turned = shape_functions(points)[0][:, :, None, None] * turn_between(own, faces.frame)
    return np.moveaxis(turned, 2, 3).reshape(len(own), len(points), N_BETA, N_SURFACE)


def _lengths(lines: np.ndarray) -> np.ndarray:
    """(..., E, 2) of vectors (..., E, 2, 3)."""
    return np.asarray(np.linalg.norm(lines, axis=-1))


@dataclass(frozen=True, eq=False)
class _Modes:
    """share (E, 4): of the area at the Gauss points.  shapes (E, 4, 4): 1, phi_2, phi_1, phi_12 there.

    base (E, 4, 2, 2): unit vectors along g_b at the Gauss points, in the axes of the laminate, [component, b].
    directions (2, E) [rad]: see :class:`QuadWall`.
    """

    share: np.ndarray
    shapes: np.ndarray
    base: np.ndarray
    directions: np.ndarray

    @classmethod
    def of(cls, share: np.ndarray, frame: np.ndarray, lines: np.ndarray) -> _Modes:
        """lines (E, 2, 3): base vectors of the centre; frame (E, 4, 3, 3): axes of the laminate at the Gauss points."""
        xi = GAUSS - np.einsum("eg,gb->eb", share, GAUSS)[:, None]
        slopes = 1.0 / np.sqrt(3.0 * np.einsum("eg,egb->eb", share, xi**2))
        phi = xi * slopes[:, None]
        both = GAUSS.prod(axis=1) + np.zeros_like(share)
        basis = np.stack([np.ones_like(share), phi[..., 1], phi[..., 0]], axis=-1)
        normal = np.einsum("egi,eg,egj->eij", basis, share, basis)
        taken = np.linalg.solve(normal, np.einsum("egi,eg->ei", basis, share * both)[..., None])[..., 0]
        rest = both - np.einsum("egi,ei->eg", basis, taken)
        rest /= 3.0 * np.sqrt(np.sum(share * rest**2, axis=1, keepdims=True))
        base = carried(frame, lines / _lengths(lines)[..., None])
        centre = base.sum(axis=1)
        first = np.arctan2(centre[:, 1, 0], centre[:, 0, 0])
        second = np.arctan2(-centre[:, 0, 1], centre[:, 1, 1])
        shapes = np.stack([*np.moveaxis(basis, -1, 0), rest], axis=1)
        return cls(share, shapes, base, np.stack([first, second]))

    def put_plane(self, taken: np.ndarray) -> None:
        """Strains in the plane and E33 from the Gauss points, into (E, T, 15, 8, 6), on every surface alike."""
        n = len(self.share)
        A = np.zeros((n, N_GAUSS, 3, 5))
        A[..., range(3), range(3)] = 1.0
        A[..., 3:] = strains_along(self.base)[..., :2] * np.moveaxis(self.shapes[:, 1:3], 1, 2)[:, :, None]
        fitted = _fitted(A, self.share[..., None] * NORM)  # (E, 5, 4, 3)
        rows = [0, 1, 2, OF_MODE[1], OF_MODE[2]]
        taken[:, :, rows, :N_GAUSS, :3] = fitted[:, None]
        of_normal = _fitted(np.moveaxis(self.shapes, 1, 2)[:, :, None], self.share[..., None])
        taken[..., E33][:, :, OF_E33, :N_GAUSS] = of_normal[:, None, ..., 0]

    def put_shears(self, taken: np.ndarray, jacobian: np.ndarray, half: np.ndarray) -> None:
        """Shears of one surface: along its sides, and what a mode has across its own, between two of them.

        taken (E, 15, 8, 6).  jacobian (E, 4, 2, 2): at the Gauss points.  half (E, 4, 2): of the sides, along the axes.
        """
        inverse = np.linalg.inv(jacobian)  # [g, b, i]
        to_gauss = np.stack([0.5 * (1 + sign * GAUSS[:, 1 - b]) for b in (0, 1) for sign in (-1, 1)])  # (side, g)
        along = np.repeat(np.eye(2), 2, axis=0)  # (side, b)
        field = np.einsum("sg,egbi,sb,esj->egisj", to_gauss, inverse, along, half)
        taken[:, 3:5, N_GAUSS:, 3:5] = np.einsum("eg,egisj->eisj", self.share, field)
        for b, mode in ((0, 1), (1, 2)):
            weights = 3.0 * self.share * self.shapes[:, mode]
            angle = self.directions[b] + (np.pi / 2 if b else 0.0)  # of g_b
            own, other = np.stack([np.cos(angle), np.sin(angle)], -1), np.stack([-np.sin(angle), np.cos(angle)], -1)
            row = OF_MODE[mode] + 1
            taken[:, row + b, N_GAUSS:, 3:5] = np.einsum("eg,ei,egisj->esj", weights, own, field)
            apart = np.array([-0.5, 0.5]) / (0.75 * self.shapes[:, mode] @ GAUSS[:, 1 - b])[:, None]  # d xi/d phi
            taken[:, row + 1 - b, N_GAUSS + 2 * b : N_GAUSS + 2 * b + 2, 3:5] = apart[..., None] * other[:, None]


def _fitted(A: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """(E, k, 4, r): amplitudes of k fields A (E, 4, r, k) that are nearest to what is given, by weights (E, 4, r)."""
    weighted = weight[..., None] * A
    normal = np.einsum("egrk,egrl->ekl", A, weighted)
    n, k = len(A), A.shape[-1]
    return np.linalg.solve(normal, np.moveaxis(weighted, -1, 1).reshape(n, k, -1)).reshape(n, k, *A.shape[1:3])


def _growth(lines: np.ndarray, turning: np.ndarray) -> np.ndarray:
    """(E, 3): area of the surface at d over that of the reference surface, by 1, d and d^2, at the centre."""
    (a1, a2), (b1, b2) = (np.moveaxis(each, 1, 0) for each in (lines, turning))
    vectors = (np.cross(a1, a2), np.cross(a1, b2) + np.cross(b1, a2), np.cross(b1, b2))
    square = np.sum(vectors[0] ** 2, axis=-1)
    return np.stack([np.sum(each * vectors[0], axis=-1) / square for each in vectors], axis=1)
