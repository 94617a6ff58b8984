"""Where on a grid one class gives way to another, at the cost of the boundary and not of the grid.

Classes are asked for at the corners of coarse blocks; a block in or on whose border two classes have been seen is cut
in four, down to single cells, so that both points of every pair of neighbours between which a boundary was found have
been solved; a block that shows one class is taken to be of it throughout. What is smaller than a block of the first
grid, and touches no boundary that has been met, may be missed; a boundary that has been met is followed to its end,
because a block is looked at again whenever a neighbour finds another class on their common border.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Block = tuple[int, int, int]  # first row, first column, size
FINEST = 1  # cells: nothing lies between the corners of such a block


@dataclass(frozen=True, eq=False)
class Located:
    """Classes (n, m) of all points, and which of them (n, m) were asked for."""

    classes: np.ndarray
    asked: np.ndarray


def locate(
    class_at: Callable[[int, int], str],
    shape: tuple[int, int],
    stride: int,
    *,
    rows_apart: bool = False,
) -> Located:
    """Find the classes on a grid of points; ``stride``, a power of two, must divide shape - 1.

    rows_apart: rows have no order, as names have none, and each is searched by itself. Raises ValueError for a grid
    that the stride does not divide.
    """
    if stride & (stride - 1) or any((n - 1) % stride for n in shape[rows_apart:]):
        raise ValueError(f"blocks of {stride} do not divide a grid of {shape[0]} x {shape[1]} points")
    rows = range(shape[0]) if rows_apart else range(0, shape[0] - 1, stride)
    blocks = [(i, j, stride) for i in rows for j in range(0, shape[1] - 1, stride)]
    classes = np.full(shape, "", dtype=object)
    search = _Search(class_at, classes, blocks, 0 if rows_apart else 1)
    search.run()
    return search.found()


@dataclass(eq=False)
class _Search:
    """classes (n, m): empty where nothing was asked for.  height: of a block over its size, 0 where rows are apart."""

    class_at: Callable[[int, int], str]
    classes: np.ndarray
    blocks: list[Block]
    height: int

    def run(self) -> None:
        """Until no block larger than the finest is mixed; the largest are cut first."""
        for block in self.blocks:
            self.ask_corners(block)
        while mixed := [block for block in self.blocks if block[2] > FINEST and len(self.seen(block)) > 1]:
            size = max(block[2] for block in mixed)
            for block in mixed:
                if block[2] == size:
                    self.cut(block)

    def cut(self, block: Block) -> None:
        """Ask for the corners of its quarters, then put them in its place."""
        i, j, size = block
        half = size // 2
        quarters = [(a, b, half) for a in range(i, i + self.height * half + 1, half) for b in (j, j + half)]
        for quarter in quarters:
            self.ask_corners(quarter)
        self.blocks.remove(block)
        self.blocks += quarters

    def within(self, block: Block) -> tuple[slice, slice]:
        """Its points, the border included."""
        i, j, size = block
        return slice(i, i + self.height * size + 1), slice(j, j + size + 1)

    def seen(self, block: Block) -> set[str]:
        """Classes known in it and on its border."""
        return set(self.classes[self.within(block)].ravel()) - {""}

    def ask_corners(self, block: Block) -> None:
        i, j, size = block
        for a in range(i, i + self.height * size + 1, size):
            for b in (j, j + size):
                if self.classes[a, b] == "":
                    self.classes[a, b] = self.class_at(a, b)

    def found(self) -> Located:
        """Classes of all points, those of a block that shows one class by it."""
        asked, full = self.classes != "", self.classes.copy()
        for block in self.blocks:
            part = full[self.within(block)]
            part[part == ""] = next(iter(self.seen(block)))
        return Located(full, asked)


def edges(classes: np.ndarray, *, rows_apart: bool = False) -> np.ndarray:
    """Middles (k, 2) of the pairs of neighbours that differ, in points of the grid."""
    i, j = np.nonzero(classes[:, 1:] != classes[:, :-1])
    across = np.stack([i, j + 0.5], axis=-1)
    if rows_apart:
        return across
    i, j = np.nonzero(classes[1:] != classes[:-1])
    return np.concatenate([across, np.stack([i + 0.5, j], axis=-1)])


def distance(one: np.ndarray, other: np.ndarray, *, rows_apart: bool = False) -> float:
    """The largest distance of a boundary of one map (n, m) from the nearest of the other, both ways, in cells.

    0 when neither has one; infinite when only one has.
    """
    a, b = (edges(classes, rows_apart=rows_apart) for classes in (one, other))
    if not len(a) or not len(b):
        return 0.0 if len(a) == len(b) else float("inf")
    apart = np.abs(a[:, None] - b[None])
    if rows_apart:
        apart[apart[..., 0] > 0] = np.inf  # a boundary of another row is none of this one
    each = np.max(apart, axis=-1)
    return float(max(each.min(axis=0).max(), each.min(axis=1).max()))
