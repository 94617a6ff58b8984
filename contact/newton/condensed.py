"""The linearised contact problem on one factorisation: other sets by principal pivots of the one it was made for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.newton.exchange import Exchange
from contact.newton.held import Ports
from contact.newton.pivots import holding
from contact.newton.solves import LinearSolves, bound
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.problem import Linearised
from contact.solvers.lcp_pivoting import unit
from contact.solvers.sparse import SingularMatrixError, factor_flops, negative_pivots

SETUP = 200.0  # operations that an entry of the matrix takes as long as, before it is factorised


@dataclass(frozen=True, eq=False)
class Linear:
    """A linearisation at u (n,), the same for every set: K (n, n), r (n,), gaps (m,) and their rows (m, n)."""

    u: np.ndarray
    tangent: sparse.csc_matrix
    residual: np.ndarray
    gap: np.ndarray
    rows: sparse.csr_matrix
    acting: sparse.csr_matrix
    compliance: np.ndarray

    @classmethod
    def at(cls, run: LinearSolves, lin: Linearised, u: np.ndarray, pressure: np.ndarray) -> Linear:
        """With the curvature of the gap under the pressures (m,)."""
        problem = run.problem
        ways = problem.gap(u), problem.gap_jacobian(u), problem.push(u), 1.0 / (run.epsilon * problem.weights)
        with run.tally.timed("contact_s"):
            return cls(u, problem.stiffness(lin, u, pressure), lin.residual, *ways)


class Condensed(Exchange):
    """w = q + M z with w_c = 0 where a candidate's state is not that of the base set, z_c = 0 where it is.

    z is a force outside the base set, a slack inside; w is a gap with its spring, g + G du + E f, outside, a force
    inside. 0 <= z, 0 <= w, z w = 0 is the linearised contact problem: M is a principal pivot transform of the Delassus
    matrix, and a P-matrix where that is one.
    Sources: Cottle, Pang, Stone, The Linear Complementarity Problem (1992), section 2.3; Tsatsomeros, Linear Algebra
    Appl. 307 (2000) 151-165.
    """

    def __init__(self, run: LinearSolves, linear: Linear, base: np.ndarray) -> None:
        """Factorise on the set ``base`` (m,); raises SingularMatrixError, ValueError."""
        self.base, self._linear, self._holdable = base.copy(), linear, base
        with run.tally.timed("contact_s"):
            held = bound(run.problem, linear.u, np.flatnonzero(base), linear.tangent, run.epsilon)
        inside = sparse.csr_matrix(sparse.eye_array(len(base), format="csr")[np.flatnonzero(base)])
        ports = Ports(linear.rows, linear.acting, ~base, inside, sparse.csr_matrix(inside.T))
        super().__init__(run, held, ports, linear.gap, linear.compliance, linear.residual)

    def near(self, active: np.ndarray) -> Condensed:
        """The same linearisation, factorised on the set (m,) where that costs less than to solve for it here."""
        if np.any(active & ~self._holdable):  # what is left of a set that can be held can be held
            self._holdable = _held_together(self._ports.acting, active, self._holdable)
        changed = np.flatnonzero(active ^ self.base)
        again = self._flops + SETUP * self._matrix.nnz if self._flops else np.inf
        if not len(changed) or dense_solution(len(changed)) + self.cost(changed) <= again:
            return self
        return Condensed(self._run, self._linear, active)

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set ``active`` (m,); raises SingularMatrixError, ValueError."""
        changed, z = self._exchanged(active)
        M = self.block(changed)[0] if len(changed) else np.zeros((0, 0))
        du, w = self.solved(z, changed, lambda z, w: _solved(M, -w[changed]))
        forces = np.where(active, np.where(self.base, w, z), 0.0)
        return self._closed(du, forces, active), forces / self._run.problem.weights

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) that the step on the set leads to, by the columns of M alone: for its choice."""
        changed, z = self._exchanged(active)
        w = self.outputs(z, changed)
        slack, forces = np.where(self.base, z, w), np.where(self.base, w, z)
        return slack - self._compliance * forces, np.where(active, forces, 0.0) / self._run.problem.weights

    def block(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """M (c, c) and q (c,) of these candidates."""
        return self.columns(nodes)[nodes], self.q[nodes]

    def negative_pivots(self) -> int:
        """Negative eigenvalues of a symmetric tangent on the motions that obey the base set."""
        forces = self._held.multipliers
        multipliers = self._run.problem.multipliers + forces
        return negative_pivots(self._matrix, self._factor, ordered=forces > 0, multipliers=multipliers)

    def _exchanged(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Candidates (c,) whose state is not that of the base set, and the z (m,) that makes their w zero."""
        changed, z = np.flatnonzero(active ^ self.base), np.zeros(len(active))
        if len(changed):
            M, q = self.block(changed)
            with self._run.tally.timed("contact_s"):
                z[changed] = _solved(M, -q)
        return changed, z

    @cached_property
    def _flops(self) -> float:
        return factor_flops(self._factor)

    def _closed(self, du: np.ndarray, forces: np.ndarray, active: np.ndarray) -> np.ndarray:
        """The du whose gaps on the set are exact: rounding goes into the unknown that holds each most firmly."""
        return closed(du, self._now, self._ports.rows, self._ports.acting, self._compliance * forces, active)


def closed(
    du: np.ndarray,
    gap: np.ndarray,
    rows: sparse.csr_matrix,
    acting: sparse.csr_matrix,
    sprung: np.ndarray,
    active: np.ndarray,
) -> np.ndarray:
    """The du (n,) whose gaps, with their springs, are none on the set.

    Rounding goes into the unknown that holds each most firmly: loads and contact forces cancel in du, and what they
    leave may be large beside gaps that hardly move.
    """
    nodes, du = np.flatnonzero(active), du.copy()
    grip = holding(acting[nodes], nodes)
    du[grip.pivot] -= grip.over(gap[nodes] + sprung[nodes] + rows[nodes] @ du)
    return du


def _held_together(acting: sparse.csr_matrix, active: np.ndarray, before: np.ndarray) -> np.ndarray:
    """The set (m,) with all that could be held ``before``, if they can be held together; else the set alone.

    Raises what :func:`contact.newton.pivots.holding` does.
    """
    both, nodes = np.flatnonzero(active | before), np.flatnonzero(active)
    try:
        holding(acting[both], both)
    except ValueError:
        holding(acting[nodes], nodes)
        return active.copy()
    return active | before


def _solved(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """M^-1 b; raises SingularMatrixError."""
    size = unit(M)
    spend(DENSE_PIVOTS, dense_solution(len(b)))
    try:
        return np.asarray(size * np.linalg.solve(size[:, None] * M * size, size * b))
    except np.linalg.LinAlgError as error:
        raise SingularMatrixError(f"the contact problem on {len(b)} candidates is singular") from error
