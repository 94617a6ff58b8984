"""Locally refined grids: a quadtree over every cell of a tensor grid, neighbours at most one level apart.

Every leaf is a rectangle between lines of a1 and of a2, so elements are those of a tensor grid. A corner in the middle
of a neighbour's edge hangs: it moves as the mean of the edge's ends, and has no unknown of its own.
Only coordinates and connectivity live here; no displacement, no material.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy import sparse

from formulations.geometry.grid import CORNERS, Grid, Hanging

DEEPEST = 10  # level: the finest cells are numbered in one array


@dataclass(frozen=True, eq=False)
class Quadtree:
    """The leaves over the cells of a tensor grid.

    lines: of a1 and a2, as of :meth:`formulations.geometry.grid.Grid.tensor`; periodic: in a2.
    leaves (E, 3): level and integer corner (i, j) of each, in cells of that level: a cell of level l is 1/2^l of the
    interval between two lines, by the coordinate. Sorted along a1, then a2.  cut: whether cells are cut along a1 and
    a2; along one only, it is a binary tree.
    """

    lines: tuple[np.ndarray, np.ndarray]
    periodic: bool
    leaves: np.ndarray
    cut: tuple[bool, bool] = (True, True)

    @classmethod
    def over(
        cls,
        lines1: np.ndarray,
        lines2: np.ndarray,
        *,
        periodic: bool = False,
        cut: tuple[bool, bool] = (True, True),
        leaves: Iterable[Sequence[int]] = (),
    ) -> Quadtree:
        """One leaf a cell of the tensor grid, or the ``leaves`` of an earlier tree over it."""
        lines = np.asarray(lines1, float), np.asarray(lines2, float)
        i, j = (index.ravel() for index in np.indices((len(lines[0]) - 1, len(lines[1]) - 1)))
        known = np.array(list(leaves), np.intp).reshape(-1, 3)
        return cls(lines, periodic, known if len(known) else np.stack([np.zeros_like(i), i, j], axis=-1), cut)

    def refined(self, marked: np.ndarray) -> Quadtree:
        """With the ``marked`` leaves (E,) bool cut, and so many more that neighbours are a level apart at most.

        Raises ValueError beyond level DEEPEST.
        """
        level = self.leaves[:, 0]
        if np.any(marked & (level >= DEEPEST)):
            raise ValueError(f"a quadtree has {DEEPEST} levels at most")
        sides = np.array([[1, *side] for side in product(*(range(1 + cut) for cut in self.cut))])
        first = self.leaves[marked] * (1, *(1 + np.array(self.cut)))
        children = (first[:, None] + sides).reshape(-1, 3)
        finer = replace(self, leaves=self.sorted(np.concatenate([self.leaves[~marked], children])))
        coarse = finer._too_coarse()
        return finer.refined(coarse) if coarse.any() else finer

    def everywhere(self) -> Quadtree:
        """All leaves cut."""
        return self.refined(np.ones(len(self.leaves), bool))

    def parents(self, finer: Quadtree) -> np.ndarray:
        """The leaf here that each leaf of a ``finer`` tree over the same lines lies in."""
        finest = int(finer.leaves[:, 0].max())
        first, second = (finer.leaves[:, 1:] * finer._size(finest)).T
        return self._leaf_of_cell(finest)[first, second]

    def interpolation(self, grid: Grid, points: np.ndarray) -> sparse.csr_matrix:
        """Values (P,) at ``points`` (P, 2) from those (N,) at the nodes of its grid, bilinear in every leaf."""
        finest = int(self.leaves[:, 0].max())
        cells = []
        for axis, line in enumerate(self.lines):
            fine = _halved(line, finest * self.cut[axis])
            cells.append(np.clip(np.searchsorted(fine, points[:, axis], "right") - 1, 0, len(fine) - 2))
        leaf = self._leaf_of_cell(finest)[cells[0], cells[1]]
        xi = (points - grid.centre[leaf]) / grid.half[leaf]
        shares = 0.25 * np.prod(1 + xi[:, None] * CORNERS, axis=-1)
        rows = np.repeat(np.arange(len(points)), len(CORNERS))
        shape = len(points), grid.n_nodes
        return sparse.coo_matrix((shares.ravel(), (rows, grid.elements[leaf].ravel())), shape=shape).tocsr()

    def _too_coarse(self) -> np.ndarray:
        """Leaves (E,) with a neighbour across an edge or a corner more than one level finer.

        With those across corners no end of an edge with a hanging node hangs itself.
        """
        level = self.leaves[:, 0]
        of_cell = self._leaf_of_cell(int(level.max()))
        if self.periodic:
            of_cell = np.concatenate([of_cell, of_cell[:, :1]], axis=1)
        coarse = np.zeros(len(level), bool)
        low, high, every = slice(None, -1), slice(1, None), slice(None)
        for here, there in (
            ((low, every), (high, every)),
            ((every, low), (every, high)),
            ((low, low), (high, high)),
            ((low, high), (high, low)),
        ):
            for a, b in ((of_cell[here], of_cell[there]), (of_cell[there], of_cell[here])):
                coarse[a[level[b] - level[a] > 1]] = True
        return coarse

    def _leaf_of_cell(self, finest: int) -> np.ndarray:
        """The leaf over each cell of the finest level."""
        level, i, j = self.leaves.T
        shape = tuple((len(line) - 1) << finest * cut for line, cut in zip(self.lines, self.cut, strict=True))
        of_cell = np.empty(shape, np.intp)
        for one in np.unique(level):
            own = np.flatnonzero(level == one)
            sizes = (1 << (finest - int(one)) * cut for cut in self.cut)
            rows, columns = ((k[own] * size)[:, None] + np.arange(size) for k, size in zip((i, j), sizes, strict=True))
            of_cell[rows[:, :, None], columns[:, None, :]] = own[:, None, None]
        return of_cell

    def grid(self) -> Grid:
        """Nodes, elements and what hangs; elements in the order of the leaves, nodes along a1, then a2."""
        finest = int(self.leaves[:, 0].max())
        corners = (self.leaves[:, 1:] + (CORNERS[:, None] + 1) // 2) * self._size(finest)  # (4, E, 2), finest cells
        lines = [_halved(line, finest * cut) for line, cut in zip(self.lines, self.cut, strict=True)]
        keys, number = np.unique(self._key(corners, finest), return_inverse=True)
        at = np.divmod(keys, len(lines[1]))
        low, high = (np.stack([line[corners[r, :, axis]] for axis, line in enumerate(lines)], axis=-1) for r in (0, 2))
        return Grid(
            nodes=np.stack([line[index] for line, index in zip(lines, at, strict=True)], axis=-1),
            elements=number.reshape(4, -1).T,
            centre=0.5 * (low + high),
            half=0.5 * (high - low),
            periodic=self.periodic,
            hanging=self._hanging(keys, corners, number.reshape(4, -1).T, finest),
        )

    def _size(self, finest: int) -> np.ndarray:
        """Extent (E, 2) of each leaf along a1 and a2, in cells of the finest level."""
        return 1 << (finest - self.leaves[:, :1]) * np.array(self.cut)

    def sorted(self, leaves: np.ndarray) -> np.ndarray:
        """Leaves in the order of their low corners, along a1, then a2."""
        first, second = (leaves[:, 1:] << (DEEPEST - leaves[:, :1]) * np.array(self.cut)).T
        return leaves[np.lexsort((second, first))]

    def _key(self, points: np.ndarray, finest: int) -> np.ndarray:
        """One number for each point (..., 2) of the finest lines; those on a closed seam are the same."""
        around = (len(self.lines[1]) - 1) << finest * self.cut[1]
        second = points[..., 1] % around if self.periodic else points[..., 1]
        return points[..., 0] * (around + 1) + second

    def _hanging(self, keys: np.ndarray, corners: np.ndarray, elements: np.ndarray, finest: int) -> Hanging | None:
        """The nodes in the middle of an edge, None where there are none."""
        following = np.roll(corners, -1, axis=0)
        middles = self._key((corners + following) // 2, finest)
        there = np.isin(middles, keys) & (np.abs(following - corners).max(axis=-1) > 1)
        if not there.any():
            return None
        side, owner = np.nonzero(there)
        return Hanging.on_edges(np.searchsorted(keys, middles[there]), owner, side, elements, len(keys))


def _halved(line: np.ndarray, times: int) -> np.ndarray:
    """The line with each interval halved so many times."""
    parts = 1 << times
    return np.interp(np.arange(parts * (len(line) - 1) + 1) / parts, np.arange(len(line)), line)
