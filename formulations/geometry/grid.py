"""The (a1, a2) grid: a tensor-product mesh of quadrilaterals, graded, possibly periodic in a2.

Only coordinates and connectivity live here; no displacement, no material.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from skfem import MeshQuad

# Corners of the reference square, in the order of ``Grid.elements``.
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def graded_lines(breaks: Sequence[float], counts: Sequence[int]) -> np.ndarray:
    """Coordinates of grid lines: ``counts[i]`` equal intervals between ``breaks[i]`` and ``breaks[i + 1]``.

    Raises ValueError unless the breaks increase and there is one positive count per interval.
    """
    if len(breaks) != len(counts) + 1 or min(counts) < 1 or np.any(np.diff(breaks) <= 0):
        raise ValueError(f"graded lines need increasing breaks and positive counts, got {breaks} and {counts}")
    pieces = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(breaks[:-1], breaks[1:], counts, strict=True)]
    return np.append(np.concatenate(pieces), breaks[-1])


@dataclass(frozen=True, eq=False)
class Grid:
    """Tensor-product grid.

    nodes (N, 2): coordinates, a1 slowest, so that a nodal array reshapes to ``node_shape``.
    elements (E, 4): node numbers in the order of :data:`CORNERS`.
    centre, half (E, 2): element centres and half lengths (unwrapped across a periodic seam).
    lines: of a1 and of a2, both ends included.
    """

    nodes: np.ndarray
    elements: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    node_shape: tuple[int, int]
    periodic: bool
    lines: tuple[np.ndarray, np.ndarray]

    @classmethod
    def tensor(cls, lines1: np.ndarray, lines2: np.ndarray, *, periodic: bool = False) -> Grid:
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
        return cls(nodes, elements, centre, half, (n1, n2), periodic, (lines1, lines2))

    @property
    def mesh(self) -> MeshQuad:
        """The scikit-fem mesh before its seam is closed."""
        from skfem import MeshQuad  # slow to load, and no solve needs it

        return MeshQuad.init_tensor(*self.lines)

    def points(self, xi: np.ndarray) -> np.ndarray:
        """Coordinates (E, k, 2) of the points xi (k, 2) of the reference square in every element."""
        return self.centre[:, None, :] + self.half[:, None, :] * xi

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    def on_line(self, axis: int, value: float) -> np.ndarray:
        """Node numbers on the grid line a_{axis+1} = value (within 1e-9 of the grid's extent)."""
        coordinate = self.nodes[:, axis]
        return np.flatnonzero(np.abs(coordinate - value) <= 1e-9 * max(1.0, np.ptp(coordinate)))

    def node_at(self, a1: float, a2: float) -> int:
        """The node at a point; raises ValueError when the grid has none there."""
        found = np.intersect1d(self.on_line(0, a1), self.on_line(1, a2))
        if len(found) != 1:
            raise ValueError(f"the grid has no node at ({a1:g}, {a2:g})")
        return int(found[0])
