"""The fronts of a pattern: what each has of the matrix, and where the Schur complements of its children go.

The analyses of the patterns that were met last are kept: a solve meets one pattern many times.

A front is the dense matrix of its own unknowns and of those that they touch, its boundary: F11 (m, m), F21 (b, m),
F12 (m, b), and F22 (b, b), to which only children contribute. No value of a matrix enters here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy import sparse

from contact.solvers.tree import Nodes, subtrees

Places = tuple[np.ndarray, np.ndarray]  # in the data of a matrix, and in a block, flat and by columns
Part = slice | np.ndarray
SLACK = 0.1  # of the rows of a front, that may be zeros for a node to join it
KEPT = 8  # analyses
PIECES = 12  # of a boundary, up to which each goes to its parent by itself: a slice is ten times as fast as a gather


@dataclass(frozen=True, eq=False)
class Share:
    """What a block of the parent has of a child's Schur complement: ``block[rows, columns] += S[of_rows, of_columns]``.

    block: F11, F21, F22 by number, 0 to 2.  twice: it lies below the diagonal, and has an image above.
    """

    block: int
    to: tuple[Part, Part]
    of: tuple[Part, Part]
    twice: bool


@dataclass(frozen=True, eq=False)
class Front:
    """Own unknowns [start, stop) and the boundary (b,), in the order of the fronts.

    own, below, beside: what F11, F21 and F12 have of the matrix.  children: their numbers, and their shares in the
    lower half of F.
    """

    start: int
    stop: int
    boundary: np.ndarray
    own: Places
    below: Places
    beside: Places
    children: tuple[tuple[int, tuple[Share, ...]], ...]


@dataclass(frozen=True, eq=False)
class Analysis:
    """The fronts of a pattern, children before parents.

    order (n,): the unknowns in their order.  image (nnz,): where the matrix's data have the entry across the diagonal.
    """

    order: np.ndarray
    image: np.ndarray
    fronts: tuple[Front, ...]

    @classmethod
    def of(cls, indptr: np.ndarray, indices: np.ndarray) -> Analysis | None:
        """Of a pattern by columns, its indices sorted, its unknowns in an order of elimination.

        None for a pattern that is not symmetric, or has no whole diagonal.
        """
        image = _image(indptr, indices)
        if image is None:
            return None
        nodes = Nodes.of(indptr, indices)
        front, above, boundaries = _cut(nodes)
        arranged = np.argsort(front, kind="stable")
        number = np.empty(len(arranged), np.intp)
        number[arranged] = np.arange(len(arranged))
        boundaries = [np.sort(number[each]) for each in boundaries]
        # from nodes to unknowns
        ends = np.append(0, np.cumsum(nodes.sizes[arranged]))
        order = _ranges(nodes.first[arranged], nodes.sizes[arranged])
        stop = ends[np.cumsum(np.bincount(front))]
        start = np.append(0, stop[:-1])
        boundary = [_ranges(ends[each], ends[each + 1] - ends[each]) for each in boundaries]
        places = _places(indptr, indices, order, start, stop, boundary)
        children: list[list[tuple[int, tuple[Share, ...]]]] = [[] for _ in above]
        for child, up in enumerate(above):
            if up >= 0:
                to = _within(boundary[child], int(start[up]), int(stop[up]), boundary[up])
                children[up].append((child, tuple(_shares(to, int(stop[up] - start[up])))))
        each = zip(start.tolist(), stop.tolist(), boundary, *places, map(tuple, children), strict=True)
        return cls(order, image, tuple(Front(*parts) for parts in each))

    def above(self, unknowns: np.ndarray) -> np.ndarray:
        """The fronts (bool) that eliminate these unknowns, by their places in the order, and all above them."""
        ends = np.array([front.stop for front in self.fronts])
        touched = np.zeros(len(ends), bool)
        touched[np.searchsorted(ends, unknowns, side="right")] = True
        for number, front in enumerate(self.fronts):
            touched[number] |= any(touched[child] for child, _ in front.children)
        return touched


def _image(indptr: np.ndarray, indices: np.ndarray) -> np.ndarray | None:
    """Where each entry's transpose is; None where it, or an entry on the diagonal, is missing."""
    n = len(indptr) - 1
    across = sparse.csc_matrix(sparse.csr_matrix((np.arange(len(indices)), indices, indptr), shape=(n, n)))
    if not (np.array_equal(across.indptr, indptr) and np.array_equal(across.indices, indices)):
        return None
    columns = np.repeat(np.arange(n), np.diff(indptr))
    return np.asarray(across.data) if np.sum(columns == indices) == n else None


def _cut(nodes: Nodes) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """The front (N,) of each node, the parent of each front, -1 for none, and the nodes of its boundary.

    Small subtrees are fronts, and so is a chain of nodes of which each is the only child of the next and touches what
    the next and its boundary are, but for SLACK: a separator.
    """
    parent = nodes.parents()
    last, front = np.unique(subtrees(parent, nodes.sizes), return_inverse=True)  # children before parents
    above = np.where(parent[last] >= 0, front[parent[last]], -1)
    boundaries = _boundaries(nodes, front, above)
    own = np.bincount(front, nodes.sizes)
    beyond = np.array([float(nodes.sizes[each].sum()) for each in boundaries])
    children = np.bincount(above[above >= 0], minlength=len(above))
    joined, rows = np.arange(len(above)), own + beyond
    for one in reversed(range(len(above))):
        up = above[one]
        if up >= 0 and children[up] == 1 and rows[joined[up]] <= (1 + SLACK) * beyond[one]:
            joined[one] = joined[up]
            rows[joined[up]] += own[one]
    kept, merged = np.unique(joined, return_inverse=True)
    up = above[kept]
    return merged[front], np.where(up >= 0, merged[up], -1), [boundaries[one] for one in kept]


def _boundaries(nodes: Nodes, front: np.ndarray, above: np.ndarray) -> list[np.ndarray]:
    """The nodes beyond each front that it touches once its children are eliminated."""
    later = front[nodes.row] > front[nodes.column]
    of = front[nodes.column[later]]
    touched = nodes.row[later][np.argsort(of, kind="stable")]
    begins = np.append(0, np.cumsum(np.bincount(of, minlength=len(above))))
    parts: list[list[np.ndarray]] = [[touched[a:b]] for a, b in pairwise(begins)]
    boundaries = []
    for one, up in enumerate(above):
        beyond = np.unique(np.concatenate(parts[one]))
        boundaries.append(beyond[front[beyond] > one])
        if up >= 0:
            parts[up].append(boundaries[-1])
    return boundaries


def _places(
    indptr: np.ndarray,
    indices: np.ndarray,
    order: np.ndarray,
    start: np.ndarray,
    stop: np.ndarray,
    boundary: list[np.ndarray],
) -> tuple[list[Places], list[Places], list[Places]]:
    """What F11, F21 and F12 of each front have of the matrix."""
    n, rank = len(order), np.empty(len(order), np.intp)
    rank[order] = np.arange(n)
    front = np.repeat(np.arange(len(start)), stop - start)
    row, column = rank[indices], rank[np.repeat(np.arange(n), np.diff(indptr))]
    own, size = np.minimum(front[row], front[column]), np.array([len(each) for each in boundary])
    keys = np.concatenate([each + one * n for one, each in enumerate(boundary)])
    begins = np.append(0, np.cumsum(size))

    def local(unknown: np.ndarray, one: np.ndarray) -> np.ndarray:
        """Within the boundary of front ``one``."""
        return np.searchsorted(keys, unknown + one * n) - begins[one]

    places = []
    inside = front[row] == front[column]
    for chosen, rows_own, columns_own in (
        (inside, True, True),
        (~inside & (column < row), False, True),
        (~inside & (row < column), True, False),
    ):
        at = np.flatnonzero(chosen)
        at = at[np.argsort(own[at], kind="stable")]
        one = own[at]
        r = row[at] - start[one] if rows_own else local(row[at], one)
        c = column[at] - start[one] if columns_own else local(column[at], one)
        height = (stop - start)[one] if rows_own else size[one]
        cuts = np.searchsorted(one, np.arange(1, len(start)))
        places.append(list(zip(np.split(at, cuts), np.split(r + c * height, cuts), strict=True)))
    return places[0], places[1], places[2]


def _within(unknowns: np.ndarray, start: int, stop: int, boundary: np.ndarray) -> np.ndarray:
    """Places of unknowns in a front: its own come first."""
    return np.where(unknowns < stop, unknowns - start, stop - start + np.searchsorted(boundary, unknowns))


def _shares(to: np.ndarray, m: int) -> Iterator[Share]:
    """What goes where of a Schur complement whose unknowns have the places ``to`` (c,) in a front with m of its own."""
    cuts = np.flatnonzero((np.diff(to) != 1) | (to[1:] == m)) + 1
    if len(cuts) >= PIECES:
        cuts = np.flatnonzero(to[1:] >= m)[:1] + 1 if to[0] < m else cuts[:0]
    pieces = [slice(int(a), int(b)) for a, b in pairwise([0, *cuts, len(to)])]
    for k, rows in enumerate(pieces):
        for columns in pieces[: k + 1]:
            first, second = to[rows.start] >= m, to[columns.start] >= m
            places = to[rows] - m * first, to[columns] - m * second
            yield Share(int(first) + int(second), _slices_or(*places), (rows, columns), rows is not columns)


def _slices_or(rows: np.ndarray, columns: np.ndarray) -> tuple[Part, Part]:
    """Two slices where both are consecutive, a mesh otherwise."""
    if all(each[-1] - each[0] == len(each) - 1 for each in (rows, columns)):
        return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)
    return rows[:, None], columns[None, :]


def _ranges(begins: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Every begins[i], ..., begins[i] + lengths[i] - 1, one after the other."""
    ends = np.cumsum(lengths)
    return np.repeat(begins - ends + lengths, lengths) + np.arange(ends[-1] if len(ends) else 0)


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where the entries of a matrix are, by columns; two are equal where their entries are in the same places."""

    indptr: np.ndarray
    indices: np.ndarray

    def __hash__(self) -> int:
        return hash(self.indices.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pattern) and all(
            np.array_equal(mine, its) for mine, its in ((self.indptr, other.indptr), (self.indices, other.indices))
        )


def analysed(A: sparse.csc_matrix) -> tuple[sparse.csc_matrix, Analysis]:
    """A, with zeros where its pattern is not symmetric or its diagonal not whole, and the analysis of that pattern."""
    A.sort_indices()
    fronts = _analysis(Pattern(A.indptr, A.indices))
    if fronts is None:
        A = _with_zeros(A)
        fronts = _analysis(Pattern(A.indptr, A.indices))
        assert fronts is not None
    return A, fronts


def clear() -> None:
    """Forget all analyses."""
    _analysis.cache_clear()


@lru_cache(maxsize=KEPT)
def _analysis(pattern: Pattern) -> Analysis | None:
    return Analysis.of(pattern.indptr, pattern.indices)


def _with_zeros(A: sparse.csc_matrix) -> sparse.csc_matrix:
    """A with zeros across the diagonal from its entries, and on it."""
    entries, n = A.tocoo(), A.shape[0]
    rows = np.concatenate([entries.row, entries.col, np.arange(n)])
    columns = np.concatenate([entries.col, entries.row, np.arange(n)])
    data = np.concatenate([entries.data, np.zeros(A.nnz + n)])
    return sparse.csc_matrix(sparse.coo_matrix((data, (rows, columns)), shape=A.shape))
