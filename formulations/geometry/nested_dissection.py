"""Nested dissection of a tensor grid: an order of elimination in which a sparse factorisation fills in least.

A line of nodes across the longer side separates the rest in two that share no element; each is dissected in turn, and
the line comes last. A grid of n nodes then fills O(n log n) entries in O(n^1.5) operations.
Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np


def dissection(shape: tuple[int, int], *, periodic: bool = False, last: np.ndarray | None = None) -> np.ndarray:
    """Nodes (N,) of a grid of ``shape`` (the second axis fastest) in the order of their elimination.

    periodic: the second axis is closed; its first line is cut out of the ring before all others.  last: nodes that are
    tied to nodes elsewhere on the grid, which no line separates; they are cut out, too.
    """
    number = np.arange(shape[0] * shape[1]).reshape(shape)
    cut = number[:, 0] if periodic else np.zeros(0, np.intp)
    if last is not None:
        cut = np.union1d(cut, last)
    order = np.concatenate([block.ravel() for block in _blocks(number[:, 1:] if periodic else number)])
    return np.append(order[~np.isin(order, cut)], cut)


def _blocks(number: np.ndarray) -> Iterator[np.ndarray]:
    """Pieces of a block of node numbers (n1, n2), its separators after what they separate."""
    if number.shape[0] < number.shape[1]:
        number = number.T
    middle = len(number) // 2
    if len(number) < 3:
        yield number
        return
    yield from _blocks(number[:middle])
    yield from _blocks(number[middle + 1 :])
    yield number[middle]
