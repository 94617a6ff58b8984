"""What an element with surfaces inside its wall needs of reference surface, grid and wall, beside ElementGeometry.

No strain measure, no law and no load may enter here.

E33 of the director of the faces, (v+ - v-)/h, a share of which is taken at the nodes and not at the Gauss points.

It is that director which is too short between nodes that turn, see :class:`formulations.element.mixed.MixedElement`,
whatever the surfaces between the faces do: were the E33 of every surface taken at the nodes, pressure across the wall
would drive those inside to and fro. No law and no other strain may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.strain_operator import (
    GAUSS,
    N_DOF,
    N_GAUSS,
    ElementGeometry,
    area_factor,
    shape_functions,
    surface_operator,
)
from formulations.element.walls.modes import (
    FACTORS,
    N_ROWS,
    ON_CORNERS,
    ON_GAUSS,
    ROWS,
    mode_slices,
    on_every_surface,
    strains_at,
)
from formulations.geometry.grid import CORNERS, Grid
from formulations.geometry.surfaces import Surface
from formulations.section.sampling import Sampling
from formulations.strains.measure import StrainFunction, strain_and_gradient
from formulations.strains.quantities import N_BETA, OF_SURFACE

N_SURFACE = N_DOF // 2  # displacements of one surface in an element: those of its corners, three each
IDENTITY = (0, 3, 8)  # l1, l2 and beta3 of positions, less 1


@dataclass(frozen=True, eq=False)
class WallGeometry:
    """own (E, T, 24, 12): l, w, t at the points on the surfaces where strains are taken, by their displacements.

    value (1 or E, 12, 12): components of a displacement at the points from those of the nodes.  offset (E, T, 4, 9):
    quantities of the interpolated positions, see :class:`ElementGeometry`; None on components.  area (E,): of the
    reference surface.  growth (E, 3): of areas through the wall, by 1, d and d^2.  stretch (E, 2, T): of lengths along
    both coordinates on the surfaces where strains are taken. On lines of curvature the points are Gauss's.
    """

    sampling: Sampling
    own: np.ndarray
    value: np.ndarray
    offset: np.ndarray | None
    area: np.ndarray
    growth: np.ndarray
    stretch: np.ndarray

    @classmethod
    def of(cls, surface: Surface, grid: Grid, sampling: Sampling, geometry: ElementGeometry) -> WallGeometry:
        """On lines of curvature; raises ValueError for hanging nodes."""
        if grid.hanging is not None:
            raise ValueError("surfaces inside the wall do not support hanging nodes")
        points = grid.points(GAUSS)
        at = surface.geometry(points[..., 0], points[..., 1])
        turn = None
        if geometry.interpolation == "isoparametric":
            turn = geometry.value / shape_functions(GAUSS)[0][:, :, None, None]
        operators = (surface_operator(at, grid, d, geometry.kinematics, turn) for d in sampling.strained)
        own = np.stack(list(operators), axis=1)
        offset = None if geometry.offset is None else _offset(surface, grid, sampling, own, geometry.value)
        centre = surface.geometry(grid.centre[:, 0], grid.centre[:, 1])
        area = 4.0 * grid.half.prod(axis=-1) * area_factor(centre, 0.0)
        k = np.zeros_like(centre.k) if geometry.kinematics.thin else centre.k
        growth = np.stack([np.ones(len(k)), k.sum(axis=1), k.prod(axis=1)], axis=1)  # zeta_1 zeta_2
        stretch = 1.0 + k[:, :, None] * sampling.strained
        by_surface = own.reshape(*own.shape[:2], -1, N_SURFACE)
        return cls(sampling, by_surface, _values(geometry.value), offset, area, growth, stretch)

    def projection_of(self, part: slice) -> np.ndarray:
        """(15, 24): the modes of a surface by the strains at its points; (e, T, 15, 6 points) where they differ."""
        return ON_LINES

    @property
    def angles(self) -> np.ndarray | None:
        """(2, E) [rad] from axis 1 of the laminate to axis 1 of the modes 01 and 10; None where it is the same."""
        return None

    @property
    def at_nodes(self) -> np.ndarray | None:
        """(E, 4, 3, 3): along the normal of a node and across it from its components; None where they are that."""
        return None

    def at_gauss(self, strains: np.ndarray) -> np.ndarray:
        """Strains (E, 4, T, 6) in the axes of the laminate, of mode strains (E, 15 T)."""
        return strains_at(strains, ON_GAUSS)

    @property
    def n_points(self) -> int:
        """How many points strains are taken at on a surface."""
        return self.value.shape[1] // N_BETA

    @property
    def n_dof(self) -> int:
        """Displacements of an element."""
        return N_SURFACE * len(self.sampling.at)

    @property
    def columns(self) -> list[slice]:
        """Places of each surface in the element vector: first both faces, (4, 3, 2), then surface by surface inside."""
        inside = [slice(start, start + N_SURFACE) for start in range(N_DOF, self.n_dof, N_SURFACE)]
        return [slice(0, N_DOF, 2), *inside, slice(1, N_DOF, 2)]

    def value_of(self, part: slice) -> np.ndarray:
        """value (1 or e, 12, 12) of a part of the elements."""
        return self.value if len(self.value) == 1 else self.value[part]

    def by_surface(self, v: np.ndarray) -> np.ndarray:
        """(e, S, 12) of element vectors (e, 12 S)."""
        return np.stack([v[:, columns] for columns in self.columns], axis=1)


def _on_lines() -> np.ndarray:
    """(15, 24): means over the Gauss points."""
    parallel = []
    for rows, factor, at in zip(ROWS, FACTORS, ON_GAUSS, strict=True):
        for row in rows:
            unit = np.zeros((N_GAUSS, N_ROWS))
            unit[:, row] = factor * at / N_GAUSS
            parallel.append(unit.ravel())
    return np.array(parallel)


ON_LINES = _on_lines()


def _values(value: np.ndarray) -> np.ndarray:
    """(1 or E, 12, 12) of (1 or E, Gauss, node, i, j)."""
    return np.ascontiguousarray(value.swapaxes(2, 3)).reshape(len(value), N_GAUSS * N_BETA, N_SURFACE)


def _offset(surface: Surface, grid: Grid, sampling: Sampling, own: np.ndarray, value: np.ndarray) -> np.ndarray:
    """(E, T, 4, 9) quantities of the interpolated positions of the surfaces, less those of the true ones."""
    corners = np.moveaxis(grid.points(CORNERS), -1, 0)
    x, frame = surface.position(*corners), surface.frame(*corners)
    normal = np.einsum("egrij,erj->egi", value, np.broadcast_to([0.0, 0.0, 1.0], (*x.shape[:2], 3)))
    offset = np.empty((*own.shape[:3], len(OF_SURFACE) + N_BETA))
    for t, d in enumerate(sampling.strained):
        local = np.einsum("erix,erx->eri", frame, x + d * frame[:, :, 2])
        offset[:, t, :, :6] = np.einsum("egqri,eri->egq", own[:, t], local)
        offset[:, t, :, 6:] = normal
    offset[..., IDENTITY] -= 1.0
    return offset


@dataclass(frozen=True, eq=False)
class FaceDirector:
    """through: E33 by beta.  onto (4, 8): modes of E33 by what it is at the Gauss points and at the nodes.

    Its beta (e, 8, 3) are those at the Gauss points, then those at the nodes.
    """

    wall: WallGeometry
    through: StrainFunction
    onto: np.ndarray

    @classmethod
    def of(cls, wall: WallGeometry, through: StrainFunction, share: float) -> FaceDirector:
        """``share`` of E33 at the nodes, in the place of as much at the Gauss points."""
        onto = share / N_GAUSS * np.hstack([-FACTORS[:, None] * ON_GAUSS, ON_CORNERS])
        return cls(wall, through, onto)

    def beta(self, of_surfaces: np.ndarray, part: slice) -> np.ndarray:
        """Of displacements (e, S, 12), surface by surface."""
        at_nodes = (of_surfaces[:, -1] - of_surfaces[:, 0]) / self._h
        at_gauss = np.matmul(self._value(part), at_nodes[..., None])
        if self.wall.at_nodes is not None:
            at_nodes = np.matmul(self.wall.at_nodes[part], at_nodes.reshape(-1, 4, N_BETA, 1))[..., 0]
        return np.concatenate([each.reshape(len(at_nodes), 4, N_BETA) for each in (at_gauss, at_nodes)], axis=1)

    def strains(self, beta: np.ndarray, part: slice) -> np.ndarray:
        """What is added to the modes of E33 of every surface, (e, 4)."""
        strain, _ = strain_and_gradient(self.through, beta, self._rest(part))
        return np.asarray(strain[..., 0] @ self.onto.T)

    def add_gradient(self, B: np.ndarray, beta: np.ndarray, part: slice) -> None:
        """Its derivative by the displacements to B (e, 15 T, 12 S)."""
        n, T = len(B), len(self.wall.sampling.strained)
        slope = self.through.gradient(self._at(beta, part))[..., 0, :]
        value = self._value(part).reshape(-1, N_GAUSS, N_BETA, N_SURFACE)
        if self.wall.at_nodes is not None:
            slope[:, 4:] = np.matmul(slope[:, 4:, None], self.wall.at_nodes[part])[:, :, 0]
        by_outer = np.matmul(self.onto[:, :4], np.matmul(slope[:, :4, None], value)[:, :, 0])
        by_outer += (self.onto[:, 4:, None] * slope[:, None, 4:]).reshape(n, 4, N_SURFACE)
        by_outer /= self._h
        for mode, block in enumerate(mode_slices(T)):
            rows = B[:, on_every_surface(block, mode, len(ROWS[mode]) - 1)]
            rows[:, :, self.wall.columns[0]] -= by_outer[:, None, mode]
            rows[:, :, self.wall.columns[-1]] += by_outer[:, None, mode]

    def stiffen(self, tangent: np.ndarray, across: np.ndarray, beta: np.ndarray, part: slice) -> None:
        """Add the geometric stiffness of resultants times area (e, 4), summed over the surfaces."""
        n, value = len(across), self._value(part)
        M = self.through.contract(self._at(beta, part), (across @ self.onto)[..., None])
        turned = np.matmul(M[:, :4], value.reshape(-1, N_GAUSS, N_BETA, N_SURFACE)).reshape(n, -1, N_SURFACE)
        own = np.matmul(value.swapaxes(1, 2), turned)
        if self.wall.at_nodes is not None:
            turn = self.wall.at_nodes[part]
            M[:, 4:] = np.matmul(turn.swapaxes(-1, -2), np.matmul(M[:, 4:], turn))
        np.einsum("erirj->erij", own.reshape(n, 4, N_BETA, 4, N_BETA))[...] += M[:, 4:]
        own /= self._h**2
        inner, outer = self.wall.columns[0], self.wall.columns[-1]
        for one, other, sign in ((inner, inner, 1), (inner, outer, -1), (outer, inner, -1), (outer, outer, 1)):
            tangent[:, one, other] += sign * own

    def _value(self, part: slice) -> np.ndarray:
        """(1 or e, 12, 12) at the Gauss points."""
        return self.wall.value_of(part)[:, : N_GAUSS * N_BETA]

    @property
    def _h(self) -> float:
        return self.wall.sampling.laminate.thickness

    def _at(self, beta: np.ndarray, part: slice) -> np.ndarray:
        rest = self._rest(part)
        return beta if rest is None else rest + beta

    def _rest(self, part: slice) -> np.ndarray | None:
        """(e, 8, 3) of the interpolated positions: at the nodes the director is the true one."""
        if self.wall.offset is None:
            return None
        at_gauss = self.wall.offset[part, 0, :N_GAUSS, -N_BETA:]
        return np.concatenate([at_gauss, np.zeros_like(at_gauss)], axis=1)
