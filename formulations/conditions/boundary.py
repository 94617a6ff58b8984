"""Supports by their names: clamped, symmetric, on a diaphragm, hinged; one small vocabulary for grid lines and nodes.

Every word returns a new record; supports that meet at a node add up. A hanging node a in the middle of an edge b-c
moves on the arc of :mod:`formulations.geometry.arcs`, u_a = x_a(x + u) - x_a(x), in components v = T u; the rows of T
are the directions of a local frame. A support that it has holds it where its ends leave it free. No stiffness and no
load enters here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from formulations.geometry.grid import Grid, Hanging
from formulations.geometry.surfaces import Surface
from formulations.section.laminate import Laminate
from formulations.strains.quantities import N_V

if TYPE_CHECKING:
    from formulations.geometry.arcs import Arcs

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


_FACE_BY_FACE = np.array([0, 2, 4, 1, 3, 5])  # the components (2 i + face) of a node, its inner face first


@dataclass(frozen=True, eq=False)
class Hangers:
    """The hanging nodes (k,) of a grid with their ends (k, 2), and the arcs they move on, in components of both ends.

    own (k, 6, 6): from the place on the arc, face by face, to the components at the node, what its supports hold taken
    off.  linear: the arcs do not turn, as a linear measure asks for.
    """

    grid: Grid
    hanging: Hanging
    arcs: Arcs
    own: np.ndarray
    linear: bool = False

    @classmethod
    def of(
        cls,
        grid: Grid,
        surface: Surface,
        laminate: Laminate,
        interpolation: str,
        fixed: np.ndarray,
        hinged: np.ndarray | None = None,
    ) -> Hangers | None:
        """Those of the grid, None where no node hangs; supports as of :class:`DofMap`."""
        hanging = grid.hanging
        if hanging is None:
            return None
        arcs, turn = _of_positions(grid, hanging, surface, laminate, exact=interpolation == "curvilinear")
        support = np.zeros((len(hanging.nodes), N_V, N_V))
        support[:, range(N_V), range(N_V)] = ~fixed[hanging.nodes]
        if hinged is not None:
            for i in range(3):
                on = np.flatnonzero(hinged[hanging.nodes, i])
                support[on, 2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[0.5, -0.5], [-0.5, 0.5]]
        return cls(grid, hanging, arcs, support[:, :, _FACE_BY_FACE] @ np.kron(np.eye(2), turn))

    def linearised(self) -> Hangers:
        """The same with arcs that do not turn."""
        return replace(self, linear=True)

    def place(self, v: np.ndarray) -> np.ndarray:
        """Displacements (N, 6) with those of the hanging nodes as their ends ask for."""
        ends = self._of_ends(v)
        moved = np.einsum("kfxn,kn->kfx", self.arcs.slope(0 * ends), ends) if self.linear else self.arcs.moved(ends)
        placed = v.copy()
        placed[self.hanging.nodes] = np.einsum("kin,kn->ki", self.own, moved.reshape(-1, N_V))
        return placed

    def matrix(self, v: np.ndarray) -> sparse.csr_matrix:
        """C (6N, 6N), dv = C dw of the displacements w of the other nodes, at the displacements v (N, 6).

        The places of its entries do not depend on v.
        """
        k, n = len(self.hanging.nodes), self.grid.n_nodes
        local = self.own @ self.arcs.slope(self._turned(v)).reshape(k, N_V, -1)
        rows = (N_V * self.hanging.nodes[:, None] + np.arange(N_V))[..., None]
        columns = (N_V * self.hanging.ends[:, :, None] + _FACE_BY_FACE).reshape(k, 1, -1)
        rows, columns = (each.ravel() for each in np.broadcast_arrays(rows, columns))
        others = (N_V * self.grid.free_nodes[:, None] + np.arange(N_V)).ravel()
        entries = np.concatenate([np.ones(len(others)), local.ravel()])
        places = np.append(others, rows), np.append(others, columns)
        return sparse.csr_matrix((entries, places), shape=(n * N_V, n * N_V))

    def stiffen(self, tangents: np.ndarray, v: np.ndarray, forces: np.ndarray) -> None:
        """Add to the element tangents (E, 24, 24) what turning arcs make of the forces (N, 6) on hanging nodes."""
        if self.linear:
            return
        on = np.einsum("kin,ki->kn", self.own, forces[self.hanging.nodes]).reshape(-1, 2, 3)
        dofs = (N_V * self.hanging.corners[:, :, None] + _FACE_BY_FACE).reshape(len(on), -1)
        places = self.hanging.owner[:, None, None], dofs[:, :, None], dofs[:, None, :]
        np.add.at(tangents, places, self.arcs.curvature(self._turned(v), on))

    def _of_ends(self, v: np.ndarray) -> np.ndarray:
        """Components (k, 12) at the ends, face by face."""
        return v[self.hanging.ends][..., _FACE_BY_FACE].reshape(len(self.hanging.nodes), -1)

    def _turned(self, v: np.ndarray) -> np.ndarray:
        ends = self._of_ends(v)
        return 0 * ends if self.linear else ends


def _of_positions(
    grid: Grid, hanging: Hanging, surface: Surface, laminate: Laminate, *, exact: bool
) -> tuple[Arcs, np.ndarray]:
    """Arcs of the positions, and the frames at the hanging nodes; ``exact``: their middles lie on the surface."""
    from formulations.geometry.arcs import Arcs  # loaded with hanging nodes alone

    frames = surface.frame(*grid.nodes.T)
    at_ends = np.moveaxis(surface.position(*grid.nodes.T)[hanging.ends], 1, 0), np.moveaxis(frames[hanging.ends], 1, 0)
    x = [at + d * frame[:, 2] for at, frame in zip(*at_ends, strict=True) for d in (laminate.d_minus, laminate.d_plus)]
    turned = np.zeros((len(hanging.nodes), 4, 3, 4, 3))
    for point in range(4):
        turned[:, point, :, point] = at_ends[1][point // 2].swapaxes(1, 2)
    arcs = Arcs.between(np.concatenate(x, axis=-1), laminate.thickness, turned.reshape(-1, 12, 12))
    if exact:
        middle, normal = surface.position(*grid.nodes[hanging.nodes].T), frames[hanging.nodes, 2]
        faces = [middle + d * normal for d in (laminate.d_minus, laminate.d_plus)]
        ends = np.concatenate(x, axis=-1).reshape(-1, 2, 2, 3)
        arcs = arcs.through(np.stack(faces, axis=1) - ends.mean(axis=1))
    return arcs, frames[hanging.nodes]
