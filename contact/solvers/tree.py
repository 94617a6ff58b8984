"""Elimination trees: which unknowns are one node, which node is the parent of which, which nodes are one front.

Unknowns are eliminated in the order they come in. Struct(j), the later nodes that node j touches once all before it are
eliminated, has the parent of j as its first member. Source: Liu, SIAM J. Matrix Anal. Appl. 11 (1990) 134-172.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

WHOLE = 120  # unknowns of a subtree that is one front


@dataclass(frozen=True, eq=False)
class Nodes:
    """Unknowns [first[i], first[i + 1]) with one and the same pattern are node i.

    row, column: pairs of nodes that touch, each pair both ways, in the order of the columns.
    """

    first: np.ndarray
    row: np.ndarray
    column: np.ndarray

    @classmethod
    def of(cls, indptr: np.ndarray, indices: np.ndarray) -> Nodes:
        """Of a symmetric pattern by columns, with sorted indices and a whole diagonal."""
        begins, number = indptr[:-1], np.diff(indptr)
        before = np.arange(len(indices)) - np.repeat(number, number)  # the same place in a column before, as long
        alike = (before >= 0) & (indices == indices[np.maximum(before, 0)])
        alike = np.add.reduceat(alike, begins) == number
        alike[1:] &= number[1:] == number[:-1]
        alike[0] = False
        first = np.flatnonzero(~alike)
        node = np.cumsum(~alike) - 1
        length = number[first]
        column = np.repeat(np.arange(len(first)), length)
        row = node[indices[np.repeat(begins[first] - np.cumsum(length) + length, length) + np.arange(length.sum())]]
        new = np.append(True, (row[1:] != row[:-1]) | (column[1:] != column[:-1]))
        return cls(np.append(first, len(number)), row[new], column[new])

    @property
    def sizes(self) -> np.ndarray:
        """Unknowns (N,) of each node."""
        return np.diff(self.first)

    def parents(self) -> np.ndarray:
        """The parent (N,) of each node, -1 for a root."""
        number = len(self.first) - 1
        before = self.row < self.column
        pairs = zip(self.column[before].tolist(), self.row[before].tolist(), strict=True)
        parent, oldest = [-1] * number, [-1] * number  # oldest: the root so far, by the shortest known way
        for column, row in pairs:
            while oldest[row] not in (-1, column):
                oldest[row], row = column, oldest[row]
            if oldest[row] == -1:
                oldest[row] = parent[row] = column
        return np.array(parent)


def subtrees(parent: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The last node (N,) of the subtree of up to WHOLE unknowns that each node lies in; elsewhere the node itself."""
    weight, parents = sizes.tolist(), parent.tolist()
    for node, up in enumerate(parents):
        if up >= 0:
            weight[up] += weight[node]
    last = list(range(len(parents)))
    for node in reversed(range(len(parents))):
        if parents[node] >= 0 and weight[parents[node]] <= WHOLE:
            last[node] = last[parents[node]]
    return np.array(last)
