"""What the element needs of surface, grid and thickness: the operator Q from nodal displacements to the quantities q.

Two interpolations of the same unknowns live here. No strain measure, no section and no load may enter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from formulations.geometry.grid import CORNERS, Grid
from formulations.geometry.surfaces import Geometry, Surface
from formulations.section.laminate import Laminate
from formulations.strains.quantities import (
    BETA,
    FULL,
    N_BETA,
    N_Q,
    N_V,
    OF_SURFACE,
    QUANTITIES,
    Kinematics,
    shear_row_factors,
    surface_coefficients,
)

N_GAUSS, N_DOF = 4, 4 * N_V
GAUSS = CORNERS / np.sqrt(3.0)
CHUNK = 128  # elements per pass: large enough to hide the calls, small enough for the cache
ON_LINES = ("curvilinear", "isoparametric")  # of curvature
INTERPOLATIONS = (*ON_LINES, "quads")
AREAS = ("inner", "outer")
_LINE_MASS = np.array([[2, 1], [1, 2]]) / 6
CORNER_MASS = np.kron(_LINE_MASS, _LINE_MASS)[np.ix_((0, 1, 3, 2), (0, 1, 3, 2))]  # int N_r N_s over the area, (4, 4)


def shape_functions(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bilinear N_r (..., 4) and dN_r/dxi (..., 2, 4) at points xi (..., 2) of the reference square."""
    one = 1.0 + xi[..., None, 0] * CORNERS[:, 0]
    two = 1.0 + xi[..., None, 1] * CORNERS[:, 1]
    slope = np.stack([CORNERS[:, 0] * two, CORNERS[:, 1] * one], axis=-2)
    return 0.25 * one * two, 0.25 * slope


def mid_lines(x: np.ndarray) -> np.ndarray:
    """Difference (E, 2, 3) of a nodal field across the element, along both of its middle lines."""
    return 2.0 * np.einsum("br,erx->ebx", shape_functions(np.zeros((1, 2)))[1][0], x)


@dataclass(frozen=True, eq=False)
class ElementGeometry:
    """All the element needs of surface and grid.

    Q (E, 60, 24): q at the four Gauss points from the nodal displacements.  rows (E, 4, 11): shear row factors.
    weight (E,): parameter area times mubar at the centre (the paper's area).  face_weight (E, 2): the same with the
    true areas of the inner and the outer face, zeta1 zeta2 in place of zbar1 zbar2.  director (3, 6): beta of a node
    from its displacements.  relaxation (E, 2): share of the parasitic membrane energy that a "relaxed" element keeps.
    value (1 or E, 4, 4, 3, 3): components of a face's displacement at Gauss point g, in the frame there, from those of
    node r: u_i(g) = value[g, r, i, j] v_j^r.  kinematics: what the gradients leave out.

    interpolation "curvilinear" (the paper): displacement components in the turning local frame are bilinear, A, k, B
    are exact; a rigid motion of a curved element is met to O(l^2).  "isoparametric": Cartesian displacements and
    positions are bilinear, as in a solid-shell; offset (E, 4, 15) is the q of the interpolated geometry against the
    true one, strains count from there, E(offset + q) - E(offset), and an exact measure meets rigid motions exactly.
    """

    Q: np.ndarray
    rows: np.ndarray
    weight: np.ndarray
    face_weight: np.ndarray
    director: np.ndarray
    relaxation: np.ndarray
    value: np.ndarray
    kinematics: Kinematics
    interpolation: str
    offset: np.ndarray | None

    @classmethod
    def build(
        cls,
        surface: Surface,
        grid: Grid,
        laminate: Laminate,
        kinematics: Kinematics = FULL,
        interpolation: str = "curvilinear",
    ) -> ElementGeometry:
        """Evaluate surface and thickness on the grid; raises ValueError for an interpolation that does not exist."""
        d_minus, d_plus = laminate.d_minus, laminate.d_plus
        points = grid.points(GAUSS)
        geometry = surface.geometry(points[..., 0], points[..., 1])
        if interpolation == "curvilinear":
            turn = np.broadcast_to(np.eye(3), (1, N_GAUSS, 4, 3, 3))
            Q, offset = _operator(geometry, grid, laminate, kinematics, None, turn), None
        elif interpolation == "isoparametric" and kinematics == FULL:
            turn = _frames_turn(surface, points, grid)
            Q = _operator(geometry, grid, laminate, kinematics, turn, turn)
            offset = _offset(surface, Q, grid, laminate)
        else:
            known = " or ".join(ON_LINES)
            raise ValueError(f"interpolation {interpolation!r} must be {known}, the latter with full gradients only")
        at_centre = surface.geometry(grid.centre[:, 0], grid.centre[:, 1])
        parameter_area = 4.0 * grid.half.prod(axis=-1)
        face = np.stack([area_factor(at_centre, d) for d in (d_minus, d_plus)], axis=-1)
        return cls(
            Q=Q.reshape(-1, N_GAUSS * N_Q, N_DOF),
            interpolation=interpolation,
            offset=offset,
            rows=shear_row_factors(geometry, d_minus, d_plus, kinematics),
            weight=parameter_area * area_factor(at_centre, 0.5 * (d_minus + d_plus)),
            face_weight=parameter_area[:, None] * face,
            director=np.kron(np.eye(3), [-1.0, 1.0]) / (d_plus - d_minus),
            relaxation=_relaxation(at_centre, grid, d_plus - d_minus),
            value=shape_functions(GAUSS)[0][:, :, None, None] * turn,
            kinematics=kinematics,
        )

    def frames_on(self, surface: Surface, grid: Grid) -> np.ndarray:
        """Frames (E, 4, 3, 3) at the Gauss points, to whose directions ``value`` belongs."""
        return surface.frame(*np.moveaxis(grid.points(GAUSS), -1, 0))

    def left_handed_on(self, surface: Surface, grid: Grid) -> np.ndarray:
        """(E,) bool: whether the corners of an element go round against its normal."""
        return np.asarray(np.linalg.det(surface.frame(*grid.centre.T)) < 0)

    def point_areas(self, face: str) -> np.ndarray:
        """Area (E, 1 or 4) of the "mid" surface (mubar) or of the "inner" or "outer" face at each Gauss point."""
        return self._area(face)[:, None] / N_GAUSS

    def corner_areas(self, face: str) -> np.ndarray:
        """int N_r dA (E, 4) on the same areas."""
        return np.repeat(0.25 * self._area(face)[:, None], 4, axis=1)

    def corner_mass(self, face: str) -> np.ndarray:
        """int N_r N_s dA (E, 4, 4) on the same areas."""
        return self._area(face)[:, None, None] * CORNER_MASS

    def _area(self, face: str) -> np.ndarray:
        return self.weight if face == "mid" else self.face_weight[:, AREAS.index(face)]

    @cached_property
    def director_pairs(self) -> np.ndarray:
        """(9, 36): beta_i beta_j of a node from the products of its displacements."""
        return np.kron(self.director, self.director)

    def chunks(self) -> Iterator[slice]:
        """Slices over the elements, one pass each."""
        n = len(self.Q)
        return (slice(start, min(start + CHUNK, n)) for start in range(0, n, CHUNK))


def _relaxation(geometry: Geometry, grid: Grid, h: float) -> np.ndarray:
    """Share s_a = 1/(1 + (k_a l_a^2/h)^2), (E, 2), of the membrane energy kept on the modes 01 (a = 1) and 10 (a = 2).

    A slope w' across an element of length l and curvature k leaves there the parasitic membrane strain k w' l/2 xi.
    Its energy E h (k w' l/2)^2/3 over that of the bending w'/l, E h^3/12 (w'/l)^2, is (k l^2/h)^2: s_a is the share of
    bending in the sum. Flat elements keep all (s = 1), and so does every element in the end, 1 - s = O(l^4).
    The idea of keeping a part of the membrane energy exact: Arnold, Brezzi, Math. Comp. 66 (1997) 1-14.
    """
    length = 2.0 * grid.half * geometry.A
    return 1.0 / (1.0 + (geometry.k * length**2 / h) ** 2)


def surface_operator(
    geometry: Geometry, grid: Grid, d: float, kinematics: Kinematics, turn: np.ndarray | None
) -> np.ndarray:
    """l, w, t of a1, then of a2, at the Gauss points of the surface at the distance d, (E, 4, 6, 4, 3), by its nodes.

    turn (E, 4, 4, 3, 3): e_i at the Gauss point . e_j at the node, of Cartesian displacements; None of components.
    """
    value, slope = shape_functions(GAUSS)
    slope = slope / grid.half[:, None, :, None]
    if turn is None:
        c0, c1, c2 = (c[..., None, :] for c in surface_coefficients(geometry, d, kinematics))
        d1, d2 = slope[..., 0, :], slope[..., 1, :]
        return c0 * value[:, None, :, None] + c1 * d1[:, :, None, :, None] + c2 * d2[:, :, None, :, None]
    own = np.zeros((len(turn), N_GAUSS, len(OF_SURFACE), 4, 3))
    signs = (1, 1, -1)  # du/ds_a = l e_a + w e_g - t e3
    for a in (0, 1):
        scale = 1.0 / (geometry.A[..., a] * (1.0 + geometry.k[..., a] * d))
        for row, i in enumerate((a, 1 - a, 2)):
            along = signs[row] * scale[..., None] * slope[..., a, :]
            own[:, :, 3 * a + row] = along[..., None] * turn[:, :, :, i, :]
    return own


def _operator(
    geometry: Geometry, grid: Grid, laminate: Laminate, kinematics: Kinematics, turn: np.ndarray | None, at: np.ndarray
) -> np.ndarray:
    """Q (E, 4, 15, 4, 6) of two faces; ``at``: the frames at the Gauss points from those at the nodes."""
    value, _ = shape_functions(GAUSS)
    Q = np.zeros((len(grid.half), N_GAUSS, N_Q, 4, N_V))
    for face, d in enumerate((laminate.d_minus, laminate.d_plus)):
        Q[:, :, face : BETA.start : 2, :, face::2] = surface_operator(geometry, grid, d, kinematics, turn)
        for i in range(N_BETA):
            sign = (2 * face - 1) / laminate.thickness
            Q[:, :, BETA.start + i, :, face::2] = sign * value[:, :, None] * at[:, :, :, i, :]
    return Q


def _frames_turn(surface: Surface, points: np.ndarray, grid: Grid) -> np.ndarray:
    """e_i at the Gauss point . e_j at the node, (E, 4, 4, 3, 3)."""
    at_gauss, at_node = (surface.frame(x[..., 0], x[..., 1]) for x in (points, grid.points(CORNERS)))
    return np.einsum("egix,erjx->egrij", at_gauss, at_node)


def _offset(surface: Surface, Q: np.ndarray, grid: Grid, laminate: Laminate) -> np.ndarray:
    """(E, 4, 15) of the interpolated positions."""
    corners = grid.points(CORNERS)
    x, at_node = (at(corners[..., 0], corners[..., 1]) for at in (surface.position, surface.frame))
    faces = np.stack([x + d * at_node[:, :, 2] for d in (laminate.d_minus, laminate.d_plus)], axis=2)
    nodal = np.empty((len(Q), 4, N_V))
    for face, on_face in enumerate(np.moveaxis(_on_arcs(faces, grid, laminate.thickness), 2, 0)):
        nodal[..., face::2] = np.einsum("erix,erx->eri", at_node, on_face)
    offset = np.einsum("egqrv,erv->egq", Q, nodal)
    identity = [QUANTITIES.index(name) for name in ("l1-", "l1+", "l2-", "l2+", "beta3")]
    offset[..., identity] -= 1.0
    return offset


def _on_arcs(corners: np.ndarray, grid: Grid, h: float) -> np.ndarray:
    """Positions (E, 4, 2, 3) of the corners on both faces, those of hanging nodes on the arcs that they move on."""
    if grid.hanging is None:
        return corners
    at_nodes = np.empty((grid.n_nodes, 2, 3))
    at_nodes[grid.elements] = corners
    from formulations.geometry.arcs import Arcs  # loaded with hanging nodes alone

    ends = at_nodes[grid.hanging.ends]
    bow = Arcs.between(ends.reshape(-1, 12), h, np.broadcast_to(np.eye(12), (len(ends), 12, 12))).bow
    at_nodes[grid.hanging.nodes] = ends.mean(axis=1) + bow
    return np.where(np.isin(grid.elements, grid.hanging.nodes)[..., None, None], at_nodes[grid.elements], corners)


def area_factor(geometry: Geometry, d: float) -> np.ndarray:
    """A1 A2 zeta1 zeta2 of the surface at distance d."""
    return np.prod(geometry.A * (1.0 + geometry.k * d), axis=-1)
