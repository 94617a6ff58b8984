"""Fields carried from a tensor grid to another grid over the same coordinates: cubics at nodes, and modes of elements.

Nothing of a shell, a load or a state enters here. Source: nested iteration, Hackbusch, Multi-Grid Methods (1985) ch. 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from formulations.geometry.grid import Grid, TensorGrid

CUBIC = 3  # bilinear interpolation never converges: its kinks are parasitic strain
SAME = 1e-9  # of the length of a coordinate, within which two grids end alike


@dataclass(frozen=True, eq=False)
class Transfer:
    """From the nodes and elements of a tensor grid to those of another grid; see :meth:`between`."""

    here: TensorGrid
    there: Grid

    @classmethod
    def between(cls, here: Grid, there: Grid) -> Transfer | None:
        """None unless the first is a tensor product, and both cover the same part of the surface."""
        if not isinstance(here, TensorGrid) or here.periodic != there.periodic:
            return None
        apart = np.abs(here.ends - there.ends).max(axis=1)
        return cls(here, there) if np.all(apart <= SAME * np.ptp(here.ends, axis=1)) else None

    def nodal(self, values: np.ndarray, degree: int = CUBIC) -> np.ndarray:
        """Values (N, ...) at the nodes here -> (M, ...) there, by cubics through the four lines around each."""
        field = values.reshape(*self.here.node_shape, -1)
        transferred = _tensor(field, self.here.lines, self.there.nodes, degree, closed=self.here.periodic)
        return transferred.reshape(self.there.n_nodes, *values.shape[1:])

    def modes(self, values: np.ndarray, powers: Sequence[tuple[int, int]]) -> np.ndarray:
        """Coefficients (E, m) of xi1^r1 xi2^r2 in the elements here -> (F, m) in those there; powers: (r1, r2) of each.

        They are interpolated as derivatives, over the half lengths: an element half as long has half the coefficient.
        """
        r = np.array(powers)
        lines = self.here.lines
        centres = [0.5 * (line[1:] + line[:-1]) for line in lines]
        field = values / np.prod(self.here.half[:, None, :] ** r, axis=-1)
        field = field.reshape(len(centres[0]), len(centres[1]), -1)
        if self.here.periodic:
            way = float(np.ptp(lines[1]))
            centres[1] = np.concatenate([centres[1][-1:] - way, centres[1], centres[1][:1] + way])
            field = np.concatenate([field[:, -1:], field, field[:, :1]], axis=1)
        transferred = _tensor(field, centres, self.there.centre, 1)
        return transferred * np.prod(self.there.half[:, None, :] ** r, axis=-1)


def _tensor(
    field: np.ndarray, lines: Sequence[np.ndarray], points: np.ndarray, degree: int, closed: bool = False
) -> np.ndarray:
    """The field (n1, n2, m) on lines, at points (k, 2): (k, m).  closed: the second coordinate is a circle."""
    where = []
    for axis, line in enumerate(lines):
        wanted, inverse = np.unique(points[:, axis], return_inverse=True)
        where.append(inverse.ravel())
        first, weights = _lagrange(line, wanted, degree, closed=closed and axis == 1)
        around = np.arange(weights.shape[1]) + first[:, None]
        if closed and axis == 1:
            around %= len(line) - 1
        along = np.moveaxis(field, axis, 0)[around]
        field = np.moveaxis(np.einsum("kc,kc...->k...", weights, along), 0, axis)
    return np.asarray(field[where[0], where[1]])


def _lagrange(
    line: np.ndarray, wanted: np.ndarray, degree: int, *, closed: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """The first of the lines around each wanted coordinate (k,), and the weights (k, degree + 1) of these lines.

    closed: lines go on around the circle; at other ends the lines are those nearest to the end.
    """
    count = min(degree, len(line) - 1) + 1
    if closed:
        way, n = line[-1] - line[0], len(line) - 1
        line = np.concatenate([line[:-1] - way, line[:-1], line[:-1] + way])
    cell = np.clip(np.searchsorted(line, wanted, side="right") - 1, 0, max(len(line) - 2, 0))
    first = np.clip(cell - (count - 1) // 2, 0, len(line) - count)
    at = line[first[:, None] + np.arange(count)]
    weights = np.ones((len(wanted), count))
    for j in range(count):
        for i in range(count):
            if i != j:
                weights[:, j] *= (wanted - at[:, i]) / (at[:, j] - at[:, i])
    return (first - n if closed else first), weights
