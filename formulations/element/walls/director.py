"""E33 of the director of the faces, (v+ - v-)/h, a share of which is taken at the nodes and not at the Gauss points.

It is that director which is too short between nodes that turn, see :class:`formulations.element.mixed.MixedElement`,
whatever the surfaces between the faces do: were the E33 of every surface taken at the nodes, pressure across the wall
would drive those inside to and fro. No law and no other strain may enter here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from formulations.element.strain_operator import N_GAUSS
from formulations.element.walls.geometry import N_SURFACE, WallGeometry
from formulations.element.walls.modes import FACTORS, ON_CORNERS, ON_GAUSS, ROWS, mode_slices, on_every_surface
from formulations.strains.measure import StrainFunction, strain_and_gradient
from formulations.strains.quantities import N_BETA


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
