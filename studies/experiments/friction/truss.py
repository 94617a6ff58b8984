"""A truss in space, by any rotation: what :mod:`joint_motion` and :mod:`rolling` put on their foundations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.problem import Linearisation


@dataclass(frozen=True, eq=False)
class Truss:
    """Nodes (n, 3) [mm] and bars (b, 2) of the stiffnesses (b,) [N]: each carries EA (l/L - 1), L its length at first.

    held (n, 3) [N/mm]: springs of the nodes along the axes.
    """

    nodes: np.ndarray
    bars: np.ndarray
    stiffness: np.ndarray
    held: np.ndarray

    @property
    def lengths(self) -> np.ndarray:
        """L (b,) [mm]."""
        return np.asarray(np.linalg.norm(self._along(self.nodes), axis=1))

    def forces(self, u: np.ndarray) -> np.ndarray:
        """Of the bars at u (3n,), tension positive (b,) [N]."""
        ways = self._along(self.nodes + u.reshape(-1, 3))
        return np.asarray(self.stiffness * (np.linalg.norm(ways, axis=1) / self.lengths - 1))

    def linearise(self, u: np.ndarray, load: np.ndarray, carried: np.ndarray) -> Linearisation:
        """r (3n,) and dr/du under dead loads (n, 3) [N]; carried (3n,) [mm]: displacements to which springs hold."""
        size, lengths = u.size, self.lengths
        ways = self._along(self.nodes + u.reshape(-1, 3))
        now = np.linalg.norm(ways, axis=1)
        e, tension = ways / now[:, None], self.forces(u)
        unknowns = (3 * self.bars[:, :, None] + np.arange(3)).reshape(-1, 6)
        both = np.concatenate([-e, e], axis=1) * tension[:, None]
        internal = np.bincount(unknowns.ravel(), both.ravel(), size) + self.held.ravel() * (u - carried)
        along = e[:, :, None] * e[:, None, :]
        material, turning = self.stiffness / lengths, tension / now
        block = material[:, None, None] * along + turning[:, None, None] * (np.eye(3) - along)
        each = np.block([[block, -block], [-block, block]])
        rows, columns = np.repeat(unknowns, 6, axis=1), np.tile(unknowns, 6)
        bars = sparse.coo_matrix((each.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
        K = sparse.csc_matrix(bars + sparse.diags_array(self.held.ravel()))
        scale = max(float(np.linalg.norm(both)), float(np.linalg.norm(load)))
        return Linearisation(internal - load.ravel(), K, scale)

    def _along(self, x: np.ndarray) -> np.ndarray:
        """From the first to the second node of each bar (b, 3)."""
        return np.asarray(x[self.bars[:, 1]] - x[self.bars[:, 0]])
