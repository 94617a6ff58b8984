"""Tensor grids whose nodes are moved: what a mesh of quadrilaterals looks like that follows no coordinates.

Nodes on an edge of the grid, or on the seam of a closed one, stay on it; its corners stay. Nothing of a surface or an
element enters here.
"""

from dataclasses import replace

import numpy as np

from formulations.geometry.grid import CORNERS, QuadGrid, TensorGrid

DISTORTIONS = ("random", "trapezoid", "skew")
LARGEST = 0.4  # amount: at 0.5 neighbours may meet


def distorted(grid: TensorGrid, kind: str, amount: float, stay: np.ndarray | None = None, *, seed: int = 0) -> QuadGrid:
    """The grid with its nodes moved by ``amount`` in [0, 0.4], a share of the size of the smaller element beside each.

    "random": each node by itself, along both coordinates, evenly within that share; ``seed`` draws another mesh.
    "trapezoid": each along a1, forwards and back in turn in both directions, so that neighbours are trapezoids on every
    mesh. "skew": as a smooth map of the whole grid, whose elements become parallelograms and whose edges stay, so that
    a seam can; amount is the largest slope of its lines, over the ratio of the two extents. ``stay``: numbers of nodes
    that are not moved. Shares are of the side along each coordinate: where elements are eight times as long as wide,
    0.2 leaves random ones angles down to 11 degrees, and what such a mesh converges like is decided by these.
    Raises ValueError for another kind or amount.
    """
    if kind not in DISTORTIONS:
        raise ValueError(f"distortion {kind!r} is not one of {', '.join(DISTORTIONS)}")
    if not 0 <= amount <= LARGEST:
        raise ValueError(f"distort = {amount:g} must be in [0, {LARGEST:g}]")
    shape = grid.node_shape
    lengths = [_smaller_side(line, len(line) - n) for line, n in zip(grid.lines, shape, strict=True)]
    room = [lengths[0][:, None], lengths[1][None, :]]  # 0 at the ends
    moved = np.zeros((*shape, 2))
    if kind == "random":
        draw = np.random.default_rng(seed).uniform(-1.0, 1.0, moved.shape)
        for axis in (0, 1):
            moved[..., axis] = amount * room[axis] * draw[..., axis]
    elif kind == "trapezoid":
        i, j = np.indices(shape)
        moved[..., 0] = amount * room[0] * (-1.0) ** (i + j)
    else:
        (first, last), (low, high) = grid.ends
        s, t = ((grid.nodes - [first, low]) / [last - first, high - low]).reshape(*shape, 2).transpose(2, 0, 1)
        moved[..., 0] = amount * (last - first) * 4 * s * (1 - s) * np.sin(2 * np.pi * t) / (2 * np.pi)
    by_node = moved.reshape(-1, 2)
    if stay is not None:
        by_node[stay] = 0.0
    corners = grid.points(CORNERS) + by_node[grid.elements]
    moved_grid = QuadGrid.of(grid.nodes + by_node, grid.elements, corners, periodic=grid.periodic)
    return replace(moved_grid, node_shape=grid.node_shape)


def _smaller_side(line: np.ndarray, closed: int) -> np.ndarray:
    """Of the intervals beside each node; 0 at both ends, and on the seam of a closed line."""
    sides = np.diff(line)
    inner = np.pad(np.minimum(sides[1:], sides[:-1]), 1)
    return inner[:-1] if closed else inner
