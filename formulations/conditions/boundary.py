"""Supports by their names: clamped, symmetric, on a diaphragm, hinged; one small vocabulary for grid lines and nodes.

Every word returns a new record; supports that meet at a node add up. No stiffness and no load enters here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from formulations.geometry.grid import Grid
from formulations.strains.quantities import N_V

FACES = ("inner", "outer")
_ALL = (0, 1, 2)


@dataclass(frozen=True, eq=False)
class Supports:
    """held (N, 6) bool: face displacements; middle (N, 3) bool: components held midway between the faces.

    Components are those of the local frame: 0 along a1, 1 along a2, 2 normal. Pass ``*supports.masks`` to
    :meth:`formulations.discretisation.Discretisation.build`.
    """

    held: np.ndarray
    middle: np.ndarray

    @classmethod
    def none(cls, grid: Grid) -> Supports:
        """Free everywhere."""
        return cls(np.zeros((grid.n_nodes, N_V), bool), np.zeros((grid.n_nodes, 3), bool))

    @classmethod
    def of_edges(cls, grid: Grid, *edges: str) -> Supports:
        """Supports of the edges, one of :data:`EDGES` each: the first and the last line of a1, then those of a2.

        Raises ValueError for another word, and unless there are four.
        """
        supports = cls.none(grid)
        for (axis, end), edge in zip(product((0, 1), (0, -1)), edges, strict=True):
            if edge not in EDGES:
                raise ValueError(f"an edge {edge!r} is not one of {', '.join(EDGES)}")
            supports = EDGES[edge](supports, grid.on_line(axis, float(grid.ends[axis, end])), axis)
        return supports

    def hold(self, nodes: np.ndarray | int, components: Sequence[int], faces: Sequence[str] = FACES) -> Supports:
        """Components of the named faces held."""
        held = self.held.copy()
        for i in components:
            for face in faces:
                held[nodes, 2 * i + FACES.index(face)] = True
        return replace(self, held=held)

    def clamped(self, nodes: np.ndarray) -> Supports:
        """Nothing moves."""
        return self.hold(nodes, _ALL)

    def symmetric(self, nodes: np.ndarray, axis: int) -> Supports:
        """Nodes on a plane of symmetry normal to a_{axis+1}: nothing moves along it, on either face."""
        return self.hold(nodes, (axis,))

    def diaphragm(self, nodes: np.ndarray, axis: int) -> Supports:
        """An end a_{axis+1} = constant on a diaphragm stiff in its plane and soft across it: it holds the middle.

        The director turns with the wall. Were both faces held, it would have to grow by 1/cos of its rotation.
        """
        return self.hinged(nodes, (1 - axis, 2))

    def hard_diaphragm(self, nodes: np.ndarray, axis: int) -> Supports:
        """A diaphragm that lets the director turn about the edge only: along the edge, it holds both faces.

        For small rotations: that of Kirchhoff's shells, which have no other, and of a solid, on whose end nothing moves
        along the edge. Under finite ones an edge that warps across the diaphragm is too stiff on it.
        """
        return self.hold(nodes, (1 - axis,)).hinged(nodes, (2,))

    def end_of_solid(self, nodes: np.ndarray, axis: int) -> Supports:
        """An end a_{axis+1} = constant of a solid on which nothing moves along the edge or across the surface.

        For small rotations, as :meth:`diaphragm` says. Through a thick wall the deflection differs from its middle's.
        """
        return self.hold(nodes, (1 - axis, 2))

    def hinged(self, nodes: np.ndarray, components: Sequence[int] = _ALL) -> Supports:
        """Components held at the middle; the director may turn. For a hinge at a face hold that face alone."""
        middle = self.middle.copy()
        for i in components:
            middle[nodes, i] = True
        return replace(self, middle=middle)

    @property
    def masks(self) -> tuple[np.ndarray, np.ndarray]:
        """(fixed, hinged) for :class:`formulations.conditions.dof_map.DofMap`.

        A face held and the middle held hold both faces.
        """
        pair = self.held.reshape(-1, 3, 2)
        both = pair | (pair.any(axis=2) & self.middle)[..., None]
        return both.reshape(-1, N_V), self.middle & ~both.any(axis=2)


EDGES: dict[str, Callable[[Supports, np.ndarray, int], Supports]] = {  # of nodes on a line a_{axis+1} = constant
    "free": lambda supports, nodes, axis: supports,
    "clamped": lambda supports, nodes, axis: supports.clamped(nodes),
    "symmetric": Supports.symmetric,
    "diaphragm": Supports.diaphragm,
    "hard-diaphragm": Supports.hard_diaphragm,
    "end-of-solid": Supports.end_of_solid,
    "hinged": lambda supports, nodes, axis: supports.hinged(nodes),
}
