"""The (a1, a2) grid: rectangles between lines, graded, possibly periodic in a2; most are tensor products.

Nodes may be moved: what a mesh of quadrilaterals looks like that follows no coordinates.

Only coordinates and connectivity live here; no displacement, no material.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from scipy import sparse

if TYPE_CHECKING:
    from skfem import MeshQuad

T = TypeVar("T", np.ndarray, sparse.csr_matrix)

# Corners of the reference square, in the order of ``Grid.elements``.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
DISTORTIONS = ("random", "trapezoid", "skew")
LARGEST = 0.4  # amount: at 0.5 neighbours may meet


def graded_lines(breaks: Sequence[float], counts: Sequence[int]) -> np.ndarray:
    """Coordinates of grid lines: ``counts[i]`` equal intervals between ``breaks[i]`` and ``breaks[i + 1]``.

    Raises ValueError unless the breaks increase and there is one positive count per interval.
    """
    if len(breaks) != len(counts) + 1 or min(counts) < 1 or np.any(np.diff(breaks) <= 0):
        raise ValueError(f"graded lines need increasing breaks and positive counts, got {breaks} and {counts}")
    pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)]
    return np.append(np.concatenate(pieces), breaks[-1])


class FoldedQuadError(ValueError):
    """An element of a mesh that is not a convex quadrilateral, or is bent too far around to be seen as one."""


@dataclass(frozen=True, eq=False)
class Hanging:
    """Nodes (k,) in the middle of an edge of a larger element, its ``owner`` (k,), whose ends do not hang.

    corners (k, 2), ends (k, 2): both ends of the edge, as corners of the owner and as nodes.  shares (N, N): what each
    of all nodes takes of those that do not hang, itself, or 1/2 of both ends of its edge.
    """

    nodes: np.ndarray
    owner: np.ndarray
    corners: np.ndarray
    ends: np.ndarray
    shares: sparse.csr_matrix

    @classmethod
    def on_edges(cls, nodes: np.ndarray, owner: np.ndarray, side: np.ndarray, elements: np.ndarray, n: int) -> Hanging:
        """Those of n nodes (k,) that hang in the middle of a ``side`` (k,) of an element, from corner to next."""
        corners = np.stack([side, (side + 1) % len(CORNERS)], axis=-1)
        ends = elements[owner[:, None], corners]
        hangs = np.isin(np.arange(n), nodes)
        halves = sparse.coo_matrix((np.full(2 * len(nodes), 0.5), (np.repeat(nodes, 2), ends.ravel())), shape=(n, n))
        return cls(nodes, owner, corners, ends, sparse.csr_matrix(halves + sparse.diags(np.where(hangs, 0.0, 1.0))))


@dataclass(frozen=True, eq=False)
class Grid:
    """Rectangles in the parameter plane.

    nodes (N, 2): coordinates.  elements (E, 4): node numbers in the order of :data:`CORNERS`.
    centre, half (E, 2): element centres and half lengths (unwrapped across a periodic seam).
    periodic: closed in a2.  hanging: nodes that move as the edge they lie on, None where there are none.
    """

    nodes: np.ndarray
    elements: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    periodic: bool
    hanging: Hanging | None = None

    @staticmethod
    def tensor(lines1: np.ndarray, lines2: np.ndarray, *, periodic: bool = False) -> TensorGrid:
        """Grid of the given lines; ``periodic`` identifies the last line of a2 with the first."""
        lines1, lines2 = np.asarray(lines1, float), np.asarray(lines2, float)
        n1, n2 = len(lines1), len(lines2) - periodic
        i, j = (index.ravel() for index in np.indices((n1 - 1, len(lines2) - 1)))
        side = (CORNERS + 1) // 2
        elements = (i[:, None] + side[:, 0]) * n2 + (j[:, None] + side[:, 1]) % n2
        low = np.stack([lines1[i], lines2[j]], axis=-1)
        high = np.stack([lines1[i + 1], lines2[j + 1]], axis=-1)
        first, second = np.meshgrid(lines1, lines2[:n2], indexing="ij")
        nodes = np.stack([first.ravel(), second.ravel()], axis=-1)
        centre, half = 0.5 * (low + high), 0.5 * (high - low)
        return TensorGrid(nodes, elements, centre, half, periodic, node_shape=(n1, n2), lines=(lines1, lines2))

    def points(self, xi: np.ndarray) -> np.ndarray:
        """Coordinates (E, k, 2) of the points xi (k, 2) of the reference square in every element."""
        return self.centre[:, None, :] + self.half[:, None, :] * xi

    def carried(self, values: T) -> T:
        """Values at all nodes (N, ...), those at hanging nodes replaced by what they take of the others."""
        return values if self.hanging is None else self.hanging.shares @ values

    @property
    def free_nodes(self) -> np.ndarray:
        """The nodes that do not hang."""
        return np.delete(np.arange(self.n_nodes), [] if self.hanging is None else self.hanging.nodes)

    @property
    def ends(self) -> np.ndarray:
        """First and last coordinate (2, 2) of a1, then of a2; those of a closed coordinate are the same line."""
        return np.stack([(self.centre - self.half).min(axis=0), (self.centre + self.half).max(axis=0)], axis=-1)

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    def on_line(self, axis: int, value: float) -> np.ndarray:
        """Node numbers on the grid line a_{axis+1} = value (within 1e-9 of the grid's extent)."""
        coordinate = self.nodes[:, axis]
        return np.flatnonzero(np.abs(coordinate - value) <= 1e-9 * np.ptp(coordinate))

    def node_at(self, a1: float, a2: float) -> int:
        """The node at a point; raises ValueError when the grid has none there."""
        nodes = np.intersect1d(self.on_line(0, a1), self.on_line(1, a2))
        if len(nodes) != 1:
            raise ValueError(f"the grid has no node at ({a1:g}, {a2:g})")
        return int(nodes[0])


@dataclass(frozen=True, eq=False, kw_only=True)
class TensorGrid(Grid):
    """Every line of a1 meets every line of a2.

    node_shape: a nodal array reshapes to it, a1 slowest.  lines: of a1 and of a2, both ends included.
    """

    node_shape: tuple[int, int]
    lines: tuple[np.ndarray, np.ndarray]

    @property
    def mesh(self) -> MeshQuad:
        """The scikit-fem mesh before its seam is closed."""
        from skfem import MeshQuad  # slow to load, and no solve needs it

        return MeshQuad.init_tensor(*self.lines)


@dataclass(frozen=True, eq=False, kw_only=True)
class QuadGrid(Grid):
    """Any quadrilaterals in the parameter plane; ``corners`` (E, 4, 2) are theirs, unwrapped across a periodic seam.

    node_shape: of the tensor grid whose nodes were moved, None where there was none.
    """

    corners: np.ndarray
    node_shape: tuple[int, int] | None = None

    @classmethod
    def of(cls, nodes: np.ndarray, elements: np.ndarray, corners: np.ndarray, *, periodic: bool = False) -> QuadGrid:
        """Centre and half lengths are those of the rectangle around an element."""
        low, high = corners.min(axis=1), corners.max(axis=1)
        return cls(nodes, elements, 0.5 * (low + high), 0.5 * (high - low), periodic, corners=corners)

    @classmethod
    def over(cls, elements: np.ndarray) -> QuadGrid:
        """A mesh whose nodes have no coordinates but their numbers, see :class:`NodalSurface`."""
        nodes = np.stack([np.arange(elements.max() + 1.0), np.zeros(elements.max() + 1)], axis=-1)
        return cls.of(nodes, elements, nodes[elements])

    def points(self, xi: np.ndarray) -> np.ndarray:
        """Coordinates (E, k, 2) of the points xi (k, 2) of the reference square in every element."""
        weights = 0.25 * np.prod(1.0 + xi[:, None] * CORNERS, axis=-1)
        return np.einsum("kr,erx->ekx", weights, self.corners)


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
