"""Nested dissection of a grid: an order of elimination in which a sparse factorisation fills in least.

A line of nodes across the longer side separates the rest in two that share no element; each is dissected in turn, and
the line comes last. On a refined grid a line separates where it crosses no element. A grid of n nodes then fills
O(n log n) entries in O(n^1.5) operations.
Source: George, SIAM J. Numer. Anal. 10 (1973) 345-363.
"""

from collections.abc import Iterator

import numpy as np

from formulations.geometry.grid import Grid, QuadGrid, TensorGrid

SMALLEST = 8  # elements of a block of a refined grid that is not cut any more
UNEVEN, TRIED = 0.1, 8  # share of a half that it may be off, and cuts tried on either side


def elimination_order(grid: Grid, last: np.ndarray | None = None, positions: np.ndarray | None = None) -> np.ndarray:
    """Nodes (N,) of a grid in the order of their elimination; ``last``: see :func:`dissection`.

    positions (N, 3): of the nodes in space, by which a mesh of quadrilaterals is divided.
    """
    shape = grid.node_shape if isinstance(grid, TensorGrid | QuadGrid) else None
    if shape is not None:
        return dissection(shape, periodic=grid.periodic, last=last)
    cut = np.zeros(0, np.intp) if last is None else last
    if isinstance(grid, QuadGrid):
        positions = grid.nodes if positions is None else positions
        blocks = _bisected(grid.elements, positions[grid.elements].mean(axis=1))
        return each_last(np.concatenate([*blocks, cut]))
    if grid.periodic:
        cut = np.union1d(cut, grid.on_line(1, float(grid.nodes[:, 1].min())))
    boxes = np.stack([grid.centre - grid.half, grid.centre + grid.half], axis=-1)
    return each_last(np.concatenate([*_separated(grid, np.arange(len(boxes)), boxes), cut]))


def each_last(order: np.ndarray) -> np.ndarray:
    """Every node once, where it comes last."""
    _, back = np.unique(order[::-1], return_index=True)
    return order[np.sort(len(order) - 1 - back)]


def _bisected(elements: np.ndarray, centres: np.ndarray) -> Iterator[np.ndarray]:
    """Nodes of the elements (e, 4), those between two halves after both; a node may come more than once.

    The halves lie along one of the two directions in which the centres (e, 3) extend most; near the middle the cut goes
    where it meets the fewest nodes. Source: recursive coordinate bisection, Simon, Comput. Systems Eng. 2 (1991) 135.
    """
    n = len(elements)
    if n <= SMALLEST:
        yield elements.ravel()
        return
    away = centres - centres.mean(axis=0)
    cuts = np.unique(np.linspace(n * (0.5 - UNEVEN), n * (0.5 + UNEVEN), 2 * TRIED + 1).astype(int))
    candidates = []
    for direction in np.linalg.eigh(away.T @ away)[1].T[:-3:-1]:
        order = np.argsort(away @ direction, kind="stable")
        first, last = _first_and_last(elements[order])
        candidates += [(np.count_nonzero((first < cut) & (last >= cut)), cut, order) for cut in cuts]
    _, cut, order = min(candidates, key=lambda each: each[0])
    one, other = order[:cut], order[cut:]
    yield from _bisected(elements[one], centres[one])
    yield from _bisected(elements[other], centres[other])
    yield np.intersect1d(elements[one], elements[other])


def _first_and_last(elements: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Places of the first and of the last element that have each node."""
    nodes, inverse = np.unique(elements, return_inverse=True)
    place = np.repeat(np.arange(len(elements)), elements.shape[1])
    first, last = np.full(len(nodes), len(elements)), np.zeros(len(nodes), np.intp)
    np.minimum.at(first, inverse.ravel(), place)
    np.maximum.at(last, inverse.ravel(), place)
    return first, last


def _separated(grid: Grid, elements: np.ndarray, boxes: np.ndarray) -> Iterator[np.ndarray]:
    """Nodes of the elements, those on a separating line after what it separates; a node may come more than once."""
    separator = None if len(elements) <= SMALLEST else _line(boxes[elements])
    if separator is None:
        yield grid.elements[elements].ravel()
        return
    axis, value = separator
    before = boxes[elements, axis, 1] <= value
    yield from _separated(grid, elements[before], boxes)
    yield from _separated(grid, elements[~before], boxes)
    corners = grid.elements[elements].ravel()
    yield corners[np.isin(corners, grid.on_line(axis, value))]


def _line(boxes: np.ndarray) -> tuple[int, float] | None:
    """Axis and coordinate of the line that best halves the boxes (b, 2, 2), the shorter of two; None without one."""
    lines = []
    for axis in (0, 1):
        low, high = np.sort(boxes[:, axis], axis=0).T
        inner = np.unique(low)[1:]
        begun, done = np.searchsorted(low, inner), np.searchsorted(high, inner, side="right")
        clear = begun == done
        if clear.any():
            value = inner[clear][np.argmin(np.abs(done[clear] - len(boxes) / 2))]
            lines.append((np.count_nonzero(low == value), axis, float(value)))
    return min(lines)[1:] if lines else None


def dissection(
    shape: tuple[int, int], *, periodic: bool = False, last: np.ndarray | None = None, lines: int = 1
) -> np.ndarray:
    """Nodes (N,) of a grid of ``shape`` (the second axis fastest) in the order of their elimination.

    periodic: the second axis is closed; its first line is cut out of the ring before all others.  last: nodes that are
    tied to nodes elsewhere on the grid, which no line separates; they are cut out, too.  lines: how many side by side
    it takes to separate the rest: 2 where neighbours of elements are coupled, too.
    """
    number = np.arange(shape[0] * shape[1]).reshape(shape)
    cut = number[:, :lines].ravel() if periodic else np.zeros(0, np.intp)
    if last is not None:
        cut = np.union1d(cut, last)
    order = np.concatenate([block.ravel() for block in _blocks(number[:, lines:] if periodic else number, lines)])
    return np.append(order[~np.isin(order, cut)], cut)


def _blocks(number: np.ndarray, lines: int) -> Iterator[np.ndarray]:
    """Pieces of a block of node numbers (n1, n2), its separators after what they separate."""
    if number.shape[0] < number.shape[1]:
        number = number.T
    middle = len(number) // 2
    if len(number) < 2 + lines:
        yield number
        return
    first = middle - lines // 2
    yield from _blocks(number[:first], lines)
    yield from _blocks(number[first + lines :], lines)
    yield number[first : first + lines]
