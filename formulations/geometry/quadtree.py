"""Locally refined grids: a quadtree over every cell of a tensor grid, neighbours at most one level apart.

Every leaf is a rectangle between lines of a1 and of a2, so elements are those of a tensor grid. A corner in the middle
of a neighbour's edge hangs: it moves as the mean of the edge's ends, and has no unknown of its own.
Only coordinates and connectivity live here; no displacement, no material.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from formulations.geometry.grid import CORNERS, Grid, Hanging

DEEPEST = 10  # level: the finest cells are numbered in one array


@dataclass(frozen=True, eq=False)
class Quadtree:
    """The leaves over the cells of a tensor grid.

    lines: of a1 and a2, as of :meth:`formulations.geometry.grid.Grid.tensor`; periodic: in a2.
    leaves (E, 3): level and integer corner (i, j) of each, in cells of that level: a cell of level l is 1/2^l of the
    interval between two lines, by the coordinate. Sorted along a1, then a2.
    """

    lines: tuple[np.ndarray, np.ndarray]
    periodic: bool
    leaves: np.ndarray

    @classmethod
    def over(cls, lines1: np.ndarray, lines2: np.ndarray, *, periodic: bool = False) -> Quadtree:
        """One leaf a cell of the tensor grid."""
        lines = np.asarray(lines1, float), np.asarray(lines2, float)
        i, j = (index.ravel() for index in np.indices((len(lines[0]) - 1, len(lines[1]) - 1)))
        return cls(lines, periodic, np.stack([np.zeros_like(i), i, j], axis=-1))

    def refined(self, marked: np.ndarray) -> Quadtree:
        """With the ``marked`` leaves (E,) bool cut in four, and so many more that neighbours are a level apart at most.

        Raises ValueError beyond level DEEPEST.
        """
        level, i, j = self.leaves.T
        if np.any(marked & (level >= DEEPEST)):
            raise ValueError(f"a quadtree has {DEEPEST} levels at most")
        sides = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        children = np.stack([level[marked] + 1, 2 * i[marked], 2 * j[marked]], axis=-1)[:, None, :].repeat(4, axis=1)
        children[..., 1:] += sides
        cut = replace(self, leaves=_sorted(np.concatenate([self.leaves[~marked], children.reshape(-1, 3)])))
        coarse = cut._too_coarse()
        return cut.refined(coarse) if coarse.any() else cut

    def everywhere(self) -> Quadtree:
        """All leaves cut in four."""
        return self.refined(np.ones(len(self.leaves), bool))

    def _too_coarse(self) -> np.ndarray:
        """Leaves (E,) with a neighbour across an edge more than one level finer."""
        level, *_ = self.leaves.T
        finest = int(level.max())
        of_cell = self._leaf_of_cell(finest)
        coarse = np.zeros(len(level), bool)
        for axis in (0, 1):
            wraps = self.periodic and axis == 1
            here = of_cell if wraps else np.delete(of_cell, -1, axis)
            there = np.roll(of_cell, -1, 1) if wraps else np.delete(of_cell, 0, axis)
            for a, b in ((here, there), (there, here)):
                coarse[a[level[b] - level[a] > 1]] = True
        return coarse

    def _leaf_of_cell(self, finest: int) -> np.ndarray:
        """The leaf over each cell of the finest level."""
        level, i, j = self.leaves.T
        shape = tuple((len(line) - 1) << finest for line in self.lines)
        found = np.empty(shape, np.intp)
        for one in np.unique(level):
            own, size = np.flatnonzero(level == one), 1 << (finest - int(one))
            rows, columns = ((k[own] * size)[:, None] + np.arange(size) for k in (i, j))
            found[rows[:, :, None], columns[:, None, :]] = own[:, None, None]
        return found

    def grid(self) -> Grid:
        """Nodes, elements and what hangs; elements in the order of the leaves, nodes along a1, then a2."""
        finest = int(self.leaves[:, 0].max())
        size = 1 << (finest - self.leaves[:, 0])
        corners = (self.leaves[:, 1:] + (CORNERS[:, None] + 1) // 2) * size[:, None]  # (4, E, 2), finest cells
        lines = [_halved(line, finest) for line in self.lines]
        keys, number = np.unique(self._key(corners, finest), return_inverse=True)
        at = np.divmod(keys, len(lines[1]))
        low, high = (np.stack([line[corners[r, :, axis]] for axis, line in enumerate(lines)], axis=-1) for r in (0, 2))
        return Grid(
            nodes=np.stack([line[index] for line, index in zip(lines, at, strict=True)], axis=-1),
            elements=number.reshape(4, -1).T,
            centre=0.5 * (low + high),
            half=0.5 * (high - low),
            periodic=self.periodic,
            hanging=self._hanging(keys, corners, finest),
        )

    def _key(self, points: np.ndarray, finest: int) -> np.ndarray:
        """One number for each point (..., 2) of the finest lines; those on a closed seam are the same."""
        around = (len(self.lines[1]) - 1) << finest
        second = points[..., 1] % around if self.periodic else points[..., 1]
        return points[..., 0] * (around + 1) + second

    def _hanging(self, keys: np.ndarray, corners: np.ndarray, finest: int) -> Hanging | None:
        """The nodes in the middle of an edge, None where there are none."""
        first, second = corners, np.roll(corners, -1, axis=0)
        middles = self._key((first + second) // 2, finest)
        there = np.isin(middles, keys) & (np.abs(second - first).max(axis=-1) > 1)
        if not there.any():
            return None
        nodes, *ends = (
            np.searchsorted(keys, at[there]) for at in (middles, *(self._key(e, finest) for e in (first, second)))
        )
        return Hanging.between(nodes, np.stack(ends, axis=-1), len(keys))


def _halved(line: np.ndarray, times: int) -> np.ndarray:
    """The line with each interval halved so many times."""
    parts = 1 << times
    return np.interp(np.arange(parts * (len(line) - 1) + 1) / parts, np.arange(len(line)), line)


def _sorted(leaves: np.ndarray) -> np.ndarray:
    """Leaves in the order of their low corners, along a1, then a2."""
    level, i, j = leaves.T
    up = DEEPEST - level
    return leaves[np.lexsort((j << up, i << up))]
