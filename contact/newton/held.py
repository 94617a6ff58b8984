"""What is asked of a contact set in a tangent, and a set put into it as motions that obey it.

Motions leave no zeros of a saddle point on its diagonal. No set is chosen here. Gaps that share the unknowns that hold
them do not enter here: :mod:`contact.newton.saddle`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.newton.pivots import Grip, largest
from contact.problem import ContactProblem
from contact.solvers.sparse import added


@dataclass(frozen=True, eq=False)
class Ports:
    """The d ways of all candidates: inputs are forces where ``forced`` (d,) bool, ways where the candidate is held.

    rows, acting: J (d, n), and the same by which forces act.
    to_slack (a, d): slacks of the held rows of unit ways; multiplied (d, a): forces along the ways of unit multipliers.
    """

    rows: sparse.csr_matrix
    acting: sparse.csr_matrix
    forced: np.ndarray
    to_slack: sparse.csr_matrix
    multiplied: sparse.csr_matrix

    @property
    def free(self) -> sparse.dia_array:
        """1 on the diagonal (d, d) where the input is a force."""
        return sparse.diags_array(self.forced.astype(float))


class Bound(Protocol):
    """The step K du - G_A^T f = -r, G_A du + E f = s - g of a set A with slacks s (a,), in unknowns y of its own."""

    @property
    def matrix(self) -> sparse.csc_matrix:
        """Of y."""

    @property
    def multipliers(self) -> int:
        """How many unknowns are forces: as many negative eigenvalues belong to no motion."""

    def load(self, force: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """The right-hand side of y for forces (n,) and slacks s - g (a,)."""

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du (n,)."""

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]; residual (n,): r."""

    def sides(self, ports: Ports) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """What there is of y in outputs, and what inputs put on the right-hand side of y, a column (d of them) each."""

    def direct(self, ports: Ports, places: np.ndarray) -> np.ndarray:
        """Outputs (d, p) of unit inputs at the ``places`` (p,) that do not go by way of y."""


@dataclass(frozen=True, eq=False)
class Held:
    """The step K du - G_A^T f = -r, G_A du + E f = s - g of a set A with slacks s (a,), 0 unless a node is let go.

    f = w p are nodal forces and E = diag(1/(epsilon w)). Each gap is solved for the displacement k that it holds most
    firmly, du = T y + P (s - g), where P has 1/G_k at k. T leaves the others as they are and makes du_k follow them;
    its t at (k, k) is the share of a spring in du_k, 0 where epsilon is infinite. What is left is, with e = E/G_k^2::

        (T^T K T + D) y = -T^T (r + K P (s - g)),    D_kk = kappa/(1 + e kappa),    t^2 = e D_kk,    f = P^T (K du + r)

    kappa is the size of K_k: the diagonal is as large as that of K for any epsilon. A symmetric K leaves a symmetric
    matrix, a definite one a definite one, and every entry is in a place of K's. Where unknowns move the foundation, the
    T on the left is that of the rows by which forces act, without them.
    """

    K: sparse.csc_matrix
    rows: sparse.csr_matrix  # G_A (a, n)
    acting: sparse.csr_matrix  # the same for forces
    grip: Grip
    compliance: np.ndarray  # diagonal of E [mm/N]
    share: np.ndarray  # t
    spring: np.ndarray  # D_kk

    @classmethod
    def on(
        cls,
        problem: ContactProblem,
        u: np.ndarray,
        nodes: np.ndarray,
        K: sparse.csc_matrix,
        epsilon: float,
        grip: Grip,
    ) -> Held:
        """The set of these candidates, each gap held by an unknown of its own."""
        rows = problem.gap_jacobian(u)[nodes]
        acting = problem.push(u)[nodes] if problem.driven else rows
        size = largest(sparse.csc_matrix(K[:, grip.pivot]))
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        compliance = 1.0 / (epsilon * problem.weights[nodes])
        soft = compliance / grip.slope**2
        spring = size / (1 + soft * size)
        return cls(K, rows, acting, grip, compliance, np.sqrt(soft * spring), spring)

    @property
    def pivot(self) -> np.ndarray:
        """All k (a,)."""
        return self.grip.pivot

    @cached_property
    def following(self) -> sparse.csr_matrix:
        """R (a, n): T = 1 - (1 at k) R."""
        return self._following(self.rows)

    @cached_property
    def balancing(self) -> sparse.csr_matrix:
        """R of the T on the left."""
        return self.following if self.acting is self.rows else self._following(self.acting)

    def _following(self, rows: sparse.csr_matrix) -> sparse.csr_matrix:
        a, n = rows.shape
        own = sparse.csr_matrix((self.share, self.pivot, np.arange(a + 1)), shape=(a, n))
        return sparse.csr_matrix(self.grip.reciprocal @ rows - own)

    @cached_property
    def columns(self) -> sparse.csc_matrix:
        """K_k (n, a)."""
        return sparse.csc_matrix(self.K[:, self.pivot])

    @cached_property
    def across(self) -> sparse.csr_matrix:
        """The rows k of K (a, n)."""
        return sparse.csr_matrix(self.K[self.pivot])

    @cached_property
    def matrix(self) -> sparse.csc_matrix:
        """T^T K T + D (n, n)."""
        if len(self.pivot) == 0:
            return self.K
        R, n = self.following, self.K.shape[0]
        change = self.balancing.T @ ((self.columns[self.pivot] @ R) - self.across) - self.columns @ R
        on = sparse.csc_matrix((self.spring, (self.pivot, self.pivot)), shape=(n, n))
        return added(self.K, sparse.csc_matrix(change + on))

    def load(self, force: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """T^T (force - K P slack) (n,), of a slack s - g (a,)."""
        left = force - self.columns @ self.grip.over(slack)
        return np.asarray(left - self.balancing.T @ left[self.pivot])

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du = T y + P slack (n,)."""
        du = y.copy()
        du[self.pivot] += self.grip.over(slack) - self.following @ y
        return du

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]: of springs softer than the shell what they are pushed in by, else all that is left along k."""
        nodal = self.grip.under(self.across @ du + residual[self.pivot])
        soft = self.share**2 > 0.5
        nodal[soft] = -(self.grip.slope * self.share * y[self.pivot])[soft] / self.compliance[soft]
        return nodal

    @property
    def stiffness(self) -> sparse.csc_matrix:
        """P^T K P (a, a): forces of slacks, all else at rest."""
        inner, slope = self.columns[self.pivot].tocoo(), self.grip.slope
        scaled = inner.data / slope[inner.row] / slope[inner.col]
        return sparse.csc_matrix((scaled, (inner.row, inner.col)), shape=inner.shape)

    def sides(self, ports: Ports) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """As :class:`Bound` says, (n, d) each."""
        reciprocal = self.grip.reciprocal
        seen = sparse.csc_matrix(ports.rows.T @ ports.free + self.across.T @ reciprocal @ ports.multiplied.T)
        done = sparse.csc_matrix(ports.acting.T @ ports.free - self.columns @ reciprocal @ ports.to_slack)
        seen = sparse.csc_matrix(seen - self.following.T @ seen[self.pivot])
        return seen, sparse.csc_matrix(done - self.balancing.T @ done[self.pivot])

    def direct(self, ports: Ports, places: np.ndarray) -> np.ndarray:
        """G P, gaps of other candidates under the slacks: a way that is free may push where another one is held."""
        shared = ports.free @ ports.rows[:, self.pivot] @ self.grip.reciprocal
        slack = ports.to_slack[:, places]
        outputs = shared @ slack + ports.multiplied @ (self.stiffness @ slack - shared.T[:, places])
        return np.asarray(outputs.toarray())

    @property
    def multipliers(self) -> int:
        """No unknown is a force."""
        return 0
