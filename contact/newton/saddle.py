"""A contact set put into the tangent as a saddle point, in an order of elimination that meets no zero on its diagonal.

Gaps that share the unknowns that hold them, as averaged ones do, have a condensed matrix that is dense all over the
faces (:class:`contact.newton.held.Held`): with as many unknowns as forces more, ::

    K du - G_A^T f = -r,      G_A du + E f = s - g,

stays sparse. Each force is eliminated after all unknowns that its gap depends on, so that its pivot is the compliance
-E - G K^-1 G^T of what has been eliminated: never zero where K has none. K may be singular without the forces of
bodies that nothing else supports. The order is one of minimum degree of K with the products of the rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.newton.held import Ports
from contact.solvers.sparse import least_degrees


@dataclass(frozen=True, eq=False)
class Saddle:
    """The step of :class:`contact.newton.held.Bound` with y = (du, f/c) (n + a,) in the order of their elimination.

    c [N/mm]: gives rows and columns of forces the size of those of K.
    """

    K: sparse.csc_matrix
    rows: sparse.csr_matrix  # G_A (a, n)
    acting: sparse.csr_matrix  # the same for forces
    compliance: np.ndarray  # diagonal of E [mm/N]
    size: float  # c

    @classmethod
    def of(
        cls, K: sparse.csc_matrix, rows: sparse.csr_matrix, acting: sparse.csr_matrix, compliance: np.ndarray
    ) -> Saddle:
        """The set of these rows, none of them empty."""
        size = float(np.max(np.abs(K.data), initial=0.0) / np.max(np.abs(rows.data)))
        return cls(K, sparse.csr_matrix(rows), sparse.csr_matrix(acting), compliance, size or 1.0)

    @property
    def multipliers(self) -> int:
        """How many unknowns are forces."""
        return self.rows.shape[0]

    @cached_property
    def order(self) -> np.ndarray:
        """The unknowns and the forces (n + a,), from n on, as they are eliminated."""
        n = self.K.shape[0]
        together = abs(self.rows) + abs(self.acting)
        rank = np.empty(n)
        rank[least_degrees(sparse.csc_matrix(abs(self.K) + together.T @ together))] = np.arange(n)
        last = np.maximum.reduceat(rank[together.indices], together.indptr[:-1])
        return np.argsort(np.append(rank, last + 0.5), kind="stable")

    @cached_property
    def matrix(self) -> sparse.csc_matrix:
        """The matrix of y (n + a, n + a)."""
        c = self.size
        soft = sparse.diags_array(-(c**2) * self.compliance, format="csc")
        left = sparse.vstack([self.K, -c * self.rows], format="csc")
        right = sparse.vstack([-c * self.acting.T, soft], format="csc")
        whole = sparse.csc_matrix(sparse.hstack([left, right], format="csc"))
        return sparse.csc_matrix(whole[:, self.order][self.order])

    def _ordered(self, unknowns: np.ndarray, forces: np.ndarray) -> np.ndarray:
        return np.concatenate([unknowns, forces])[self.order]

    def _parts(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        whole = np.empty_like(y)
        whole[self.order] = y
        n = self.K.shape[0]
        return whole[:n], whole[n:]

    def load(self, force: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """The right-hand side (n + a,) of forces (n,) and slacks s - g (a,)."""
        return self._ordered(force, -self.size * slack)

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du (n,)."""
        return self._parts(y)[0]

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]."""
        return self.size * self._parts(y)[1]

    def sides(self, ports: Ports) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """As :class:`contact.newton.held.Bound` says, (n + a, d) each."""
        seen = sparse.vstack([ports.rows.T @ ports.free, self.size * ports.multiplied.T], format="csr")
        done = sparse.vstack([ports.acting.T @ ports.free, -self.size * ports.to_slack], format="csr")
        return sparse.csc_matrix(seen[self.order]), sparse.csc_matrix(done[self.order])

    def direct(self, ports: Ports, places: np.ndarray) -> np.ndarray:
        """Nothing goes past y: zeros (d, p)."""
        return np.zeros((ports.rows.shape[0], len(places)))
