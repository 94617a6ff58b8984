"""The mixed element on any quadrilateral: its geometry from the nodes alone, and where it takes its strains.

Both faces are bilinear between the nodes, X- = X + d- n and X+ = X + d+ n with the nodal normals n, and so are
Cartesian displacements: an exact measure meets rigid motions exactly, and every measure counts from the interpolated
positions, as on an isoparametric grid. No coordinates are needed. What differs from an isoparametric grid:

- E_ab of a face is taken along the axes of the laminate at the Gauss points, turned to the base vectors at the centre
  of the element, each of unit length, and projected on its modes (E11 on 1, xi2; E22 on 1, xi1; 2E12 on 1) with the
  area at the Gauss points as weight. A constant strain is a constant there and has its own mean: any quadrilateral
  passes the patch tests of membrane and bending. Covariant components of each point would not be constant.
  Source: Pian, Sumihara, IJNME 20 (1984) 1685-1695.
- 2E_a3 of a face is taken at the middle of the two sides along xi_a, in a frame along the side, as the covariant strain
  of that side; between them it is linear. A plate bent to a constant curvature has none there. Of the catalogue
  novozhilov alone can tell that frame from others: its 2E_a3 is no vector, and what it converges to depends on the
  directions of the sides. Source: Bathe, Dvorkin, IJNME 21 (1985) 367-383.
- E33 as on a grid.

The modes turn to the axes of the laminate at every Gauss point, so that of an element::

    S = sum over Gauss points g of w_g A_g^T D A_g,    A_g (11, 22): strains in these axes from those of the modes

On rectangles S is D mode by mode, and all that is left of the difference is where the shears are taken. No strain
measure by name, no load and no support may enter here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formulations.element.mixed import (
    ALL,
    E33_MODES,
    MODE_ROWS,
    MODE_WEIGHTS,
    N_M,
    THICKNESS_STRAINS,
    MixedElement,
    Samples,
)
from formulations.element.strain_operator import AREAS, GAUSS, N_DOF, N_GAUSS, ElementGeometry, shape_functions
from formulations.geometry.grid import CORNERS
from formulations.strains.measure import QuadraticMeasure, StrainFunction, restricted, strain_and_gradient
from formulations.strains.quantities import BETA, E33, FULL, N_E, N_Q, N_V, Kinematics

PLANE = np.arange(6)  # E11-+, E22-+, 2E12-+
TAKEN = np.append(PLANE, E33)  # rows that are taken at the Gauss points
SIDES = (((0, 1), (3, 2)), ((0, 3), (1, 2)))  # corners of the two sides along xi1, and along xi2
SIDE_CORNERS = np.array([side for pair in SIDES for side in pair])
SHEARS = (np.array([6, 7]), np.array([8, 9]))  # 2E13-+, 2E23-+
N_SIDE, N_SIDE_DOF = 6, 2 * N_V
# a shear that is taken: direction, side, face; and those of one direction and face, on both sides
N_TAKEN = 8
PAIRS = {(a, face): slice(4 * a + face, 4 * a + 4, 2) for a in (0, 1) for face in (0, 1)}


def along_side(a: int, face: int) -> np.ndarray:
    """Places in q of l_a, w_a, t_a of a face, and of beta."""
    return np.append(6 * a + face + 2 * np.arange(3), np.arange(N_Q)[BETA])


ACROSS = ((0, 1), (1, 0))  # the mode on which a strain along xi1, or along xi2, is linear


def _mode_index(mode: tuple[int, int], row: int) -> int:
    return MODE_ROWS.index((mode, row))


def _sides_to_modes() -> np.ndarray:
    """(8, 22): strains of the modes from the shears of both faces along the four sides."""
    onto = np.zeros((2, 2, 2, N_M))
    for a, (rows, linear) in enumerate(zip(SHEARS, ACROSS, strict=True)):
        for face, row in enumerate(rows.tolist()):
            onto[a, :, face, _mode_index((0, 0), row)] = 0.5
            onto[a, :, face, _mode_index(linear, row)] = [-0.5, 0.5]
    return onto.reshape(N_TAKEN, N_M)


SIDES_TO_MODES = _sides_to_modes()
SHEAR_MODES = np.flatnonzero(SIDES_TO_MODES.any(axis=0))


class FoldedQuadError(ValueError):
    """An element of a mesh that is no convex quadrilateral, or is bent too far around to be seen as one."""


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


@dataclass(frozen=True, eq=False)
class QuadGeometry(ElementGeometry):
    """:class:`ElementGeometry` of quadrilaterals; rows is 1, offset is what positions put into q.

    share (E, 4): of the area of an element at its Gauss points; face_share (E, 4, 2): of its faces.
    plane (E, 4, 3, 3): strains (11, 22, 2 12) along the base vectors of the centre from those at a Gauss point.
    turn (E, 4, 11, 22): the A_g.
    frame (E, 4, 3, 3): that of the inner face at the Gauss points, to which ``value`` belongs.
    left_handed (E,): the corners go round against the normals.
    side_Q (E, 8, 6, 12), side_offset (E, 8, 6): l, w, t and beta in the middle of a side of a face from its two nodes.
    side_length (E, 8): over that of the element at its centre.
    at_nodes (E, 4, 3, 6): beta along (two tangents, normal) from the displacements of a node.
    """

    share: np.ndarray
    face_share: np.ndarray
    plane: np.ndarray
    turn: np.ndarray
    frame: np.ndarray
    left_handed: np.ndarray
    side_Q: np.ndarray
    side_offset: np.ndarray
    side_length: np.ndarray
    at_nodes: np.ndarray

    @classmethod
    def of(cls, faces: NodalFaces, d_minus: float, d_plus: float, kinematics: Kinematics = FULL) -> QuadGeometry:
        """From positions at the nodes; raises FoldedQuadError naming the first one that is none."""
        h = d_plus - d_minus
        X = faces.middle[:, :, None] + np.array([d_minus, d_plus])[:, None] * faces.normal[:, :, None]
        mid = X.mean(axis=2)  # of both faces (E, 4, 3)
        sides = _Sides.of(mid, faces)
        frame = sides.frames(mid, faces)
        jacobian = np.einsum("egax,gbr,erx->egab", frame[:, :, :2], shape_functions(GAUSS)[1], mid)
        weight = sides.turns[:, None] * np.linalg.det(jacobian)
        bad = np.flatnonzero(~_convex(mid))
        if len(bad):
            raise FoldedQuadError(f"element {bad[0]} has an angle of 180 degrees or more; {len(bad)} of {len(X)} have")
        area, centre = weight.sum(axis=1), 0.5 * _mid_lines(mid)
        lengths = np.linalg.norm(centre, axis=-1)

        Q, offset, face_area, inner = _at_gauss(faces, X, sides, h, kinematics)
        side_Q, side_offset, side_length = _on_sides(faces, X, h, kinematics)
        plane = _plane_strains(_carried(frame, centre / lengths[..., None]))
        bent = np.sum(_mid_lines(faces.normal) * _mid_lines(mid), axis=-1)  # k l^2
        return cls(
            Q=Q.reshape(len(X), N_GAUSS * N_Q, N_DOF),
            rows=np.ones((len(X), 1, N_E)),
            weight=area,
            face_weight=face_area.sum(axis=1),
            director=np.kron(np.eye(3), [-1.0, 1.0]) / h,
            relaxation=1.0 / (1.0 + (bent / h) ** 2),
            value=shape_functions(GAUSS)[0][:, :, None, None] * np.einsum("egix,erjx->egrij", inner, faces.frame),
            kinematics=kinematics,
            interpolation="quads",
            offset=offset,
            share=weight / area[:, None],
            face_share=face_area / face_area.sum(axis=1, keepdims=True),
            plane=plane,
            turn=_modes_to_axes(jacobian, lengths, plane),
            frame=inner,
            left_handed=sides.turns * sides.hand < 0,
            side_Q=side_Q,
            side_offset=side_offset,
            side_length=side_length / np.repeat(lengths, 4, axis=1),
            at_nodes=_directors(faces, h),
        )

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
    def elements(self) -> dict[object, QuadElement]:
        """Those that were made on this geometry."""
        return {}

    @cached_property
    def projection(self) -> np.ndarray:
        """(E, 28, 22): strains of the modes from those TAKEN at the Gauss points, all of E33 at these."""
        onto = np.zeros((len(self.weight), N_GAUSS, len(TAKEN), N_M))
        for kind in range(3):  # of E11, E22, 2E12
            mean, slope = self._weights_of_line(1 - kind) if kind < 2 else (self.share, None)
            for face in (0, 1):
                row, faces = 2 * kind + face, slice(face, len(PLANE), 2)
                onto[:, :, faces, _mode_index((0, 0), row)] = mean[..., None] * self.plane[:, :, kind]
                if slope is not None:
                    onto[:, :, faces, _mode_index(ACROSS[kind], row)] = slope[..., None] * self.plane[:, :, kind]
        for m in E33_MODES:
            r1, r2 = MODE_ROWS[m][0]
            onto[:, :, -1, m] = 3.0 ** (r1 + r2) * GAUSS[:, 0] ** r1 * GAUSS[:, 1] ** r2 / N_GAUSS
        return onto.reshape(-1, N_GAUSS * len(TAKEN), N_M)

    def _weights_of_line(self, coordinate: int) -> tuple[np.ndarray, np.ndarray]:
        """Of samples (E, 4) at the Gauss points, c + s xi in the mean square of the area: weights of c and of s."""
        xi = GAUSS[:, coordinate]
        middle = self.share @ xi
        from_middle = self.share * (xi - middle[:, None])
        slope = from_middle / np.einsum("eg,g->e", from_middle, xi)[:, None]
        return self.share - middle[:, None] * slope, slope


_GAUSS3 = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)]), np.array([5, 8, 5]) / 9


def _triple() -> np.ndarray:
    """int N_t N_r N_s over the reference square of area 1, (4, 4, 4)."""
    x, w = _GAUSS3
    points = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    value = shape_functions(points)[0]
    return np.einsum("p,pt,pr,ps->trs", np.outer(w, w).ravel() / 4, value, value, value)


_TRIPLE = _triple()


def _unit(x: np.ndarray) -> np.ndarray:
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


@dataclass(frozen=True, eq=False)
class _Sides:
    """Which way round, (E,) of +-1: ``hand`` of (axis 1, axis 2, normal); ``turns`` of (g_1, g_2) against the axes."""

    hand: np.ndarray
    turns: np.ndarray

    @classmethod
    def of(cls, mid: np.ndarray, faces: NodalFaces) -> _Sides:
        up = faces.normal.sum(axis=1)
        axes, lines = faces.axes.sum(axis=1), _mid_lines(mid)
        hand, round_ = (np.sign(np.sum(np.cross(x[:, 0], x[:, 1]) * up, axis=-1)) for x in (axes, lines))
        return cls(hand, hand * round_)

    def frames(self, nodal: np.ndarray, faces: NodalFaces) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points of a surface through nodes (E, 4, 3)."""
        tangents = np.einsum("gbr,erx->egbx", shape_functions(GAUSS)[1], nodal)
        e3 = _unit(np.cross(tangents[:, :, 0], tangents[:, :, 1]))
        return self.along_axes((self.hand * self.turns)[:, None, None] * e3, faces)

    def along_axes(self, e3: np.ndarray, faces: NodalFaces) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points with that e3, and e1 and e2 as near to both axes as they get."""
        value = shape_functions(GAUSS)[0]
        one, two = (_across(np.einsum("gr,erx->egx", value, faces.axes[:, :, axis]), e3) for axis in (0, 1))
        e1 = _unit(one + self.hand[:, None, None] * np.cross(two, e3))
        return np.stack([e1, self.hand[:, None, None] * np.cross(e3, e1), e3], axis=-2)


def _across(x: np.ndarray, e3: np.ndarray) -> np.ndarray:
    """Unit vectors along x, less its part along e3."""
    return _unit(x - np.sum(x * e3, axis=-1, keepdims=True) * e3)


def _carried(frame: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Base vectors of the centre (E, 2, 3) at the Gauss points, in the frames there: (E, 4, 2, 2), [component, b].

    They keep their components in a frame that lies evenly between them at the centre, however the corners are numbered,
    and is turned into the tangent plane elsewhere.
    """
    one, two = _unit(centre[:, 0]), _unit(centre[:, 1])
    normal = _unit(np.cross(one, two))
    along = _unit(one + np.cross(two, normal))
    components = np.einsum("eax,ebx->eab", np.stack([along, np.cross(normal, along)], axis=1), centre)
    e3 = frame[:, :, 2] * np.sign(np.einsum("egx,ex->eg", frame[:, :, 2], normal))[..., None]
    first = _across(along[:, None], e3)
    there = np.stack([first, np.cross(e3, first)], axis=-2)
    return np.einsum("egix,egax,eab->egib", frame[:, :, :2], there, components)


def _at_gauss(
    faces: NodalFaces, X: np.ndarray, sides: _Sides, h: float, kinematics: Kinematics
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
        area[..., face] = np.abs(np.linalg.det(np.einsum("egax,gbr,erx->egab", own[:, :, :2], slope, at)))
        if kinematics.thin:
            own, at = sides.frames(faces.middle, faces), faces.middle
        jacobian = np.einsum("egax,gbr,erx->egab", own[:, :, :2], slope, at)
        inverse = np.linalg.inv(jacobian)  # d xi_b/d s_a: [b, a]
        along = np.einsum("gbr,egba->egar", slope, inverse)
        turned = np.einsum("egix,erjx->egrij", own, faces.frame)
        for a in (0, 1):
            for row, (i, sign) in enumerate(((a, 1), (1 - a, 1), (2, -1))):
                place = 6 * a + 2 * row + face
                Q[:, :, place, :, face::2] = sign * along[:, :, a, :, None] * turned[:, :, :, i, :]
            if kinematics.shallow:  # t_a = -v3,a with v3 = u . n: the turning of n is taken off
                turning = np.einsum("gbr,erx,egb->egx", slope, faces.normal, inverse[..., a])
                Q[:, :, 6 * a + 4 + face, :, face::2] -= np.einsum("gr,egx,erjx->egrj", value, turning, faces.frame)
    director = np.einsum("gr,erx->egx", value, faces.normal)
    length = np.linalg.norm(director, axis=-1)
    turned = np.einsum("egix,erjx->egrij", sides.along_axes(director / length[..., None], faces), faces.frame)
    for face in (0, 1):
        for i in range(3):
            Q[:, :, BETA.start + i, :, face::2] = (2 * face - 1) / h * value[:, :, None] * turned[:, :, :, i, :]
    offset[..., BETA.start + 2] = length - 1.0
    return Q, offset, area, frames[0]


def _on_sides(
    faces: NodalFaces, X: np.ndarray, h: float, kinematics: Kinematics
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """side_Q (E, 8, 6, 12), side_offset (E, 8, 6) and half the lengths (E, 8) of the sides of both faces.

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
    e3 = _unit(director - np.sum(director * along, axis=-1, keepdims=True) * along)
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
    return Q.reshape(n, N_TAKEN, N_SIDE, N_SIDE_DOF), offset.reshape(n, N_TAKEN, N_SIDE), height


def _plane_strains(J: np.ndarray) -> np.ndarray:
    """Strains (11, 22, 2 12) along base vectors, the columns of J (..., 2, 2), from those in the frame, (..., 3, 3)."""
    a, b, c, d = J[..., 0, 0], J[..., 1, 0], J[..., 0, 1], J[..., 1, 1]  # g_1 = (a, b), g_2 = (c, d)
    rows = [[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _modes_to_axes(jacobian: np.ndarray, lengths: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """A_g (E, 4, 11, 22): strains in the axes of the laminate at the Gauss points from the strains of the modes."""
    in_plane = np.linalg.inv(plane)
    shear = np.linalg.inv(jacobian).swapaxes(-1, -2) * lengths[:, None, None, :]  # covariant, per unit of the modes
    A = np.zeros((len(plane), N_GAUSS, N_E, N_M))
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


def _mid_lines(x: np.ndarray) -> np.ndarray:
    """Difference (E, 2, 3) of a nodal field across the element, along both of its middle lines."""
    return 2.0 * np.einsum("br,erx->ebx", shape_functions(np.zeros((1, 2)))[1][0], x)


def _directors(faces: NodalFaces, h: float) -> np.ndarray:
    """beta (E, 4, 3, 6) of a node along two tangents and its normal, from its displacements."""
    first = _unit(faces.axes[:, :, 0])
    frame = np.stack([first, np.cross(faces.normal, first), faces.normal], axis=-2)
    turned = np.einsum("erix,erjx->erij", frame, faces.frame)
    return np.kron(turned, np.array([-1.0, 1.0])) / h


@dataclass(frozen=True, eq=False)
class QuadElement(MixedElement):
    """:class:`MixedElement` on quadrilaterals: mode_stiffness (E, 22, 22) and initial (E, 22) are those of each.

    H of a mode is what does the work MODE_WEIGHTS H dE an area.  taken: the measure at the Gauss points, without shears
    across the wall.  sides: that along the sides, of 2E13 and of 2E23.  onto (E, 28, 22): from what is taken to the
    modes.  axes_stiffness (11, 11): D in the axes of the laminate.  side_stiffness: see
    :func:`_side_stiffness`; node_stiffness (E, 4, 6, 6): the same of E33 at the nodes.
    """

    taken: StrainFunction
    sides: dict[tuple[int, int], StrainFunction]
    onto: np.ndarray
    axes_stiffness: np.ndarray
    side_stiffness: np.ndarray | None
    node_stiffness: np.ndarray | None

    @classmethod
    def on(
        cls, geometry: QuadGeometry, element: MixedElement, D: np.ndarray, initial: np.ndarray, thickness_strain: str
    ) -> QuadElement:
        """An element of grids put on quadrilaterals; D (11, 11) and H0 (11,) in the axes of the laminate.

        Made once for all steps of a path: what differs from element to element costs as much as an iteration.
        """
        key = (element.measure, D.tobytes(), initial.tobytes(), thickness_strain, element.relaxed)
        if key not in geometry.elements:
            geometry.elements[key] = cls._made(geometry, element, D, initial, thickness_strain)
        return geometry.elements[key]

    @classmethod
    def _made(
        cls, geometry: QuadGeometry, element: MixedElement, D: np.ndarray, initial: np.ndarray, thickness_strain: str
    ) -> QuadElement:
        weighted = geometry.share[..., None, None] * geometry.turn
        stiffness = np.einsum("egim,ij,egjn->emn", weighted, D, geometry.turn, optimize=True)
        onto = geometry.projection.copy()
        onto[..., E33_MODES] *= 1.0 - THICKNESS_STRAINS[thickness_strain]
        measure, through = element.measure, element.through
        sides = {(a, f): restricted(measure, SHEARS[a][f : f + 1], along_side(a, f)) for a, f in PAIRS}
        return cls(
            measure=measure,
            through=through,
            mode_stiffness=stiffness / MODE_WEIGHTS[:, None],
            initial=np.einsum("egim,i->em", weighted, initial) / MODE_WEIGHTS,
            projection=element.projection,
            nodal=element.nodal,
            relaxed=element.relaxed,
            taken=restricted(measure, TAKEN, np.arange(N_Q)),
            sides=sides,
            onto=onto,
            axes_stiffness=D,
            side_stiffness=_side_stiffness(geometry, sides),
            node_stiffness=_turned(through.quadratic[0], geometry.at_nodes)
            if isinstance(through, QuadraticMeasure)
            else None,
        )

    def resultants(self, strains: np.ndarray, part: slice = ALL) -> np.ndarray:
        """H = S E on the modes, (e, 22), of the elements of the part."""
        return np.matmul(self.mode_stiffness[part], strains[..., None])[..., 0]

    def mean_resultants(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means H (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        return self.mean_strains(geometry, strains) @ self.axes_stiffness.T

    def mean_strains(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Means E (E, 11) over the elements in the axes of the laminate, of mode strains (E, 22)."""
        assert isinstance(geometry, QuadGeometry)
        return np.asarray(np.einsum("eg,egi->ei", geometry.share, self.at_gauss(geometry, strains)))

    def at_gauss(self, geometry: ElementGeometry, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, 11) at the Gauss points in the axes of the laminate, of mode strains (E, 22)."""
        assert isinstance(geometry, QuadGeometry)
        return np.asarray(np.matmul(geometry.turn, strains[:, None, :, None])[..., 0])

    def linear_initial_force(self, geometry: ElementGeometry) -> np.ndarray:
        """The work of H0 on the linear strains, (E, 24): balanced in the reference state, so it is taken off."""
        at_rest = np.zeros((len(geometry.Q), N_DOF))
        if not np.any(self.initial):
            return at_rest
        work = MODE_WEIGHTS * self.initial * geometry.weight[:, None]
        return np.matmul(work[:, None], self.mode_gradient(geometry, at_rest))[:, 0]

    def _weighted_stiffness(self, part: slice) -> np.ndarray:
        return MODE_WEIGHTS[:, None] * self.mode_stiffness[part]

    def _initial(self, part: slice) -> np.ndarray:
        return self.initial[part]

    def _gradients(self, geometry: ElementGeometry, part: slice, v: np.ndarray) -> Samples:
        """The q of v at the Gauss points (e, 4, 15), its beta at the nodes (e, 4, 3), and q of the sides (e, 8, 6)."""
        assert isinstance(geometry, QuadGeometry)
        nodal = v[part].reshape(-1, 4, N_V)
        q = np.matmul(geometry.Q[part], v[part, :, None]).reshape(-1, N_GAUSS, N_Q)
        beta = np.einsum("erij,erj->eri", geometry.at_nodes[part], nodal)
        ends = nodal[:, np.repeat(SIDE_CORNERS, 2, axis=0)].reshape(-1, N_TAKEN, N_SIDE_DOF)
        return q, beta, np.einsum("esij,esj->esi", geometry.side_Q[part], ends)

    def _strains(self, geometry: ElementGeometry, part: slice, samples: Samples) -> tuple[np.ndarray, Samples]:
        """Mode strains (e, 22); dE/dq at the Gauss points (e, 4, 7, 15), and of sides (e, 8, 6), times their length."""
        assert isinstance(geometry, QuadGeometry)
        assert geometry.offset is not None
        q, beta, along = samples
        strain, gradient = strain_and_gradient(self.taken, q, geometry.offset[part])
        on_modes = np.matmul(strain.reshape(len(q), 1, -1), self.onto[part])[:, 0]
        shears, slopes = np.empty((len(q), N_TAKEN)), np.empty((len(q), N_TAKEN, N_SIDE))
        for key, pair in PAIRS.items():
            each, slope = strain_and_gradient(self.sides[key], along[:, pair], geometry.side_offset[part, pair])
            shears[:, pair], slopes[:, pair] = each[..., 0], slope[..., 0, :]
        length = geometry.side_length[part]
        on_modes += (length * shears) @ SIDES_TO_MODES
        if self.nodal is not None:
            on_modes += self.through.strain(beta)[..., 0] @ self.nodal
        self._relax(on_modes, geometry, part)
        return on_modes, (gradient, length[..., None] * slopes)

    def _mode_gradient(
        self, geometry: ElementGeometry, part: slice, gradients: Samples, samples: Samples, out: np.ndarray
    ) -> None:
        assert isinstance(geometry, QuadGeometry)
        (gradient, slopes), beta, n = gradients, samples[1], len(out)
        taken = np.matmul(gradient, geometry.Q[part].reshape(-1, N_GAUSS, N_Q, N_DOF))
        np.matmul(self.onto[part].swapaxes(1, 2), taken.reshape(n, -1, N_DOF), out=out)
        along = np.einsum("esi,esij->esj", slopes, geometry.side_Q[part]).reshape(n, len(SIDE_CORNERS), 2, 2, N_V)
        sides = np.zeros((n, len(SIDE_CORNERS), 2, 4, N_V))
        for side, corners in enumerate(SIDE_CORNERS):
            sides[:, side][:, :, corners] = along[:, side]
        out[:, SHEAR_MODES] = np.matmul(SIDES_TO_MODES[:, SHEAR_MODES].T, sides.reshape(n, -1, N_DOF))
        if self.nodal is not None:
            of_nodes = np.einsum("eri,erij->erj", self.through.gradient(beta)[..., 0, :], geometry.at_nodes[part])
            out.reshape(n, N_M, 4, N_V)[:, E33_MODES] += self.nodal.T[E33_MODES, :, None] * of_nodes[:, None]
        self._relax(out, geometry, part)

    def _stiffen(
        self, tangent: np.ndarray, work: np.ndarray, geometry: ElementGeometry, part: slice, samples: Samples
    ) -> None:
        assert isinstance(geometry, QuadGeometry)
        assert geometry.offset is not None
        q, beta, along = samples
        self._relax(work, geometry, part)
        n, Q = len(q), geometry.Q[part]
        H = np.matmul(self.onto[part], work[..., None]).reshape(n, N_GAUSS, -1)
        M = self.taken.contract(geometry.offset[part] + q, H)
        MQ = np.matmul(M, Q.reshape(-1, N_GAUSS, N_Q, N_DOF)).reshape(Q.shape)
        tangent += np.matmul(Q.swapaxes(1, 2), MQ)
        H = (work @ SIDES_TO_MODES.T) * geometry.side_length[part]
        own = self._of_sides(geometry, part, along, H).reshape(n, len(SIDE_CORNERS), 2, N_V, 2, N_V)
        blocks = tangent.reshape(n, 4, N_V, 4, N_V)
        for side, corners in enumerate(SIDE_CORNERS):
            for i, row in enumerate(corners):
                for j, column in enumerate(corners):
                    blocks[:, row, :, column] += own[:, side, i, :, j]
        if self.nodal is not None:
            own = self._of_nodes(geometry, part, beta, work @ self.nodal.T).reshape(n, 4, N_V, N_V)
            for corner in range(4):
                blocks[:, corner, :, corner] += own[:, corner]

    def _of_sides(self, geometry: QuadGeometry, part: slice, along: np.ndarray, H: np.ndarray) -> np.ndarray:
        """Geometric stiffness (e, 4, 144) of both faces of the sides under the forces H (e, 8)."""
        n = len(H)
        if self.side_stiffness is not None:
            unit = self.side_stiffness[part].reshape(n, -1, 2, N_SIDE_DOF**2)
            return np.einsum("esf,esfk->esk", H.reshape(n, -1, 2), unit)
        M = np.empty((*H.shape, N_SIDE, N_SIDE))
        at, side_Q = geometry.side_offset[part] + along, geometry.side_Q[part]
        for key, pair in PAIRS.items():
            M[:, pair] = self.sides[key].contract(at[:, pair], H[:, pair, None])
        return np.asarray(_turned(M, side_Q).reshape(n, -1, 2, N_SIDE_DOF**2).sum(axis=2))

    def _of_nodes(self, geometry: QuadGeometry, part: slice, beta: np.ndarray, H: np.ndarray) -> np.ndarray:
        """Geometric stiffness (e, 4, 6, 6) of E33 at the nodes under the forces H (e, 4)."""
        if self.node_stiffness is not None:
            return H[..., None, None] * self.node_stiffness[part]
        return _turned(self.through.contract(beta, H[..., None]), geometry.at_nodes[part])


def _turned(M: np.ndarray, Q: np.ndarray) -> np.ndarray:
    """Q^T M Q."""
    return np.matmul(Q.swapaxes(-1, -2), np.matmul(M, Q))


def _side_stiffness(geometry: QuadGeometry, sides: Mapping[tuple[int, int], StrainFunction]) -> np.ndarray | None:
    """Geometric stiffness (E, 8, 12, 12) of the sides under unit forces; None where it depends on the displacements."""
    unit = np.empty((*geometry.side_Q.shape[:2], N_SIDE_DOF, N_SIDE_DOF))
    for key, pair in PAIRS.items():
        side = sides[key]
        if not isinstance(side, QuadraticMeasure):
            return None
        unit[:, pair] = _turned(side.quadratic[0], geometry.side_Q[:, pair])
    return unit
