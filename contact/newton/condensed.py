"""The linearised contact problem on one factorisation: other sets by principal pivots of the one it was made for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from contact.newton.held import Held
from contact.newton.pivots import holding
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.problem import Linearised
from contact.solvers.lcp_pivoting import unit
from contact.solvers.sparse import SingularMatrixError, factor_flops, negative_pivots, response, response_flops

if TYPE_CHECKING:
    from contact.newton.step import NewtonRun

REFINED = 1e-12  # relative change of the forces and slacks that a step has found, above which it is solved again
REFINEMENTS = 3


class Condensed:
    """w = q + M z with w_c = 0 where a candidate's state is not that of the base set, z_c = 0 where it is.

    z is a force outside the base set, a slack inside; w is a gap with its spring, g + G du + E f, outside, a force
    inside. 0 <= z, 0 <= w, z w = 0 is the linearised contact problem: M is a principal pivot transform of the Delassus
    matrix, and a P-matrix where that is one. Its columns are found when they are asked for.
    Sources: Cottle, Pang, Stone, The Linear Complementarity Problem (1992), section 2.3; Tsatsomeros, Linear Algebra
    Appl. 307 (2000) 151-165.
    """

    def __init__(self, run: NewtonRun, lin: Linearised, u: np.ndarray, pressure: np.ndarray, base: np.ndarray) -> None:
        """Factorise on the set ``base`` (m,); raises SingularMatrixError, ValueError."""
        self._run, self._residual, self._u = run, lin.residual, u
        self._rows, self._acting, self._gap = run.problem.gap_jacobian(u), run.problem.push(u), run.problem.gap(u)
        self._compliance = 1.0 / (run.epsilon * run.problem.weights)
        with run.tally.timed("contact_s"):
            self._tangent = run.problem.stiffness(lin, u, pressure)
        self._factorise(base)

    def _factorise(self, base: np.ndarray) -> None:
        run, nothing = self._run, np.zeros(len(base))
        with run.tally.timed("contact_s"):
            self._held = Held.on(run.problem, self._u, np.flatnonzero(base), self._tangent, run.epsilon)
            self._matrix = self._held.matrix
        self.base, self._factor = base.copy(), run.factorise(self._matrix)
        self._flops: float | None = None
        self._free = self._solution(nothing)
        self.q = self._violation(nothing, *self._free)
        self._known, self._columns = np.zeros(0, int), np.zeros((len(base), 0))
        self._all: tuple[sparse.csc_matrix, sparse.csc_matrix] | None = None

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set ``active`` (m,); raises SingularMatrixError, ValueError."""
        changed, z = self._exchanged(active)
        du, forces = self._free
        if len(changed):
            M, _ = self.block(changed)
            for _ in range(REFINEMENTS):
                du, forces = self._solution(z)
                change = _solved(M, -self._violation(z, du, forces)[changed])
                if np.all(np.abs(change) <= REFINED * np.max(np.abs(z))):
                    break
                z[changed] += change
        found = np.where(self.base, 0.0, z)
        found[self.base] = forces
        found[~active] = 0.0
        return self._closed(du, found, active), found / self._run.problem.weights

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) that the step on the set leads to, by the columns of M alone: for its choice."""
        changed, z = self._exchanged(active)
        w = self.q.copy()
        if len(changed):
            w += self._columns[:, self._place(changed)] @ z[changed]
        slack, forces = np.where(self.base, z, w), np.where(self.base, w, z)
        return slack - self._compliance * forces, np.where(active, forces, 0.0) / self._run.problem.weights

    def _exchanged(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Candidates (c,) whose state is not that of the base set, and the z (m,) that makes their w zero.

        The set becomes the base set where it would cost more than a factorisation to solve for it.
        """
        nodes = np.flatnonzero(active)
        holding(self._acting[nodes], nodes)
        changed = np.flatnonzero(active ^ self.base)
        new, cost = np.setdiff1d(changed, self._known), dense_solution(len(changed))
        if len(new):
            cost += response_flops(self._factor, *self._sides(new))
        if len(changed) and self._flops is None:
            self._flops = factor_flops(self._factor)
        if self._flops and cost > self._flops:
            self._factorise(active)
            changed = changed[:0]
        z = np.zeros(len(active))
        if len(changed):
            M, q = self.block(changed)
            with self._run.tally.timed("contact_s"):
                z[changed] = _solved(M, -q)
        return changed, z

    def negative_pivots(self) -> int:
        """Negative eigenvalues of a symmetric tangent on the motions that obey the base set."""
        return negative_pivots(self._matrix, self._factor)

    def block(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """M (c, c) and q (c,) of these candidates."""
        new = np.setdiff1d(nodes, self._known)
        if len(new):
            with self._run.tally.timed("contact_s"):
                self._columns = np.hstack([self._columns, self._found(new)])
            self._known = np.append(self._known, new)
        return self._columns[np.ix_(nodes, self._place(nodes))], self.q[nodes]

    def _place(self, nodes: np.ndarray) -> np.ndarray:
        """The columns of these candidates."""
        place = np.empty(len(self.base), int)
        place[self._known] = np.arange(len(self._known))
        return place[nodes]

    def _solution(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and the forces (a,) of the base set under the forces and slacks z."""
        slack = z[self.base] - self._gap[self.base]
        pushed = self._acting.T @ np.where(self.base, 0.0, z)
        y = self._run.solution(self._factor, self._matrix, self._held.load(pushed - self._residual, slack))
        du = self._held.motion(y, slack)
        return du, self._held.forces(y, du, self._residual - pushed)

    def _violation(self, z: np.ndarray, du: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """w (m,)."""
        w = self._gap + self._rows @ du + self._compliance * z
        w[self.base] = forces
        return w

    def _closed(self, du: np.ndarray, forces: np.ndarray, active: np.ndarray) -> np.ndarray:
        """The du whose gaps on the set are exact: rounding goes into the unknown that holds each most firmly."""
        nodes, du = np.flatnonzero(active), du.copy()
        rows = self._rows[nodes]
        pivot, slope = holding(self._acting[nodes], nodes)
        du[pivot] -= (self._gap[nodes] + self._compliance[nodes] * forces[nodes] + rows @ du) / slope
        return du

    def _sides(self, nodes: np.ndarray) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """What of y there is in w (n, m), and what the z of these candidates put on the right-hand side of y (n, k)."""
        if self._all is None:
            order, held = np.argsort(np.append(np.flatnonzero(~self.base), np.flatnonzero(self.base))), self._held
            seen = held.opened(self._rows[~self.base]), held.felt()
            done = held.pushed(self._acting[~self.base]), held.let_go()
            all_seen, all_done = (sparse.hstack(both, format="csc")[:, order] for both in (seen, done))
            self._all = sparse.csc_matrix(all_seen), sparse.csc_matrix(all_done)
        return self._all[0], sparse.csc_matrix(self._all[1][:, nodes])

    def _found(self, nodes: np.ndarray) -> np.ndarray:
        """Columns of M (m, k): by way of y, and what holds where all else is at rest."""
        held, sides = self._held, self._sides(nodes)
        columns = response(self._factor, *sides)
        inside, each, place = self.base[nodes], np.arange(len(nodes)), np.cumsum(self.base) - 1
        let_go, pushed = nodes[inside], nodes[~inside]
        shared = held.shared(self._rows)  # a candidate outside may push where one inside is held
        columns[np.ix_(self.base, inside)] += held.stiffness(place[let_go])
        columns[np.ix_(~self.base, inside)] += shared[~self.base][:, place[let_go]].toarray()
        columns[np.ix_(self.base, ~inside)] -= shared[pushed].toarray().T
        columns[pushed, each[~inside]] += self._compliance[pushed]
        return columns


def _solved(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """M^-1 b; raises SingularMatrixError."""
    size = unit(M)
    spend(DENSE_PIVOTS, dense_solution(len(b)))
    try:
        return np.asarray(size * np.linalg.solve(size[:, None] * M * size, size * b))
    except np.linalg.LinAlgError as error:
        raise SingularMatrixError(f"the contact problem on {len(b)} candidates is singular") from error
