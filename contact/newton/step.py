"""The one Newton that all algorithms share: a linear step on a given contact set, and the tests of convergence.

Which nodes belong to the set is the algorithm's business and must not enter here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from contact.newton.pivots import Pivots
from contact.newton.state import NewtonState, Tally
from contact.problem import (
    ROUNDING_ALONE,
    ContactProblem,
    ContactSolution,
    Linearised,
    Outcome,
    excused,
    rounding_floor,
)
from contact.solvers.sparse import Factor, checked_solve, factorise

RESIDUAL_TOLERANCE = 1e-9  # relative to the forces in balance; what every algorithm's ``tolerance`` is by default
GAP_TOLERANCE = 1e-12  # relative to the size of the terms that make up the gap
ROUNDING_MARGIN = 10.0
BLOW_UP = 1e12  # residual, relative to the forces at the start, beyond which nothing can be rescued


@dataclass(frozen=True, eq=False)
class NewtonRun:
    """One solve: a problem, a solver, an epsilon, a tolerance, and the tally of what is spent on them.

    The state of the iteration comes in and goes out: begin, then for each iterate linearise, with_residual, the tests,
    step, advance.
    """

    problem: ContactProblem
    epsilon: float = np.inf
    solver: str = "splu"
    tolerance: float = RESIDUAL_TOLERANCE
    tally: Tally = field(default_factory=Tally)

    def begin(self, u: np.ndarray) -> NewtonState:
        """The state before the first iterate, at u (n,)."""
        return NewtonState(first_gap_size=self.problem.size_of_gaps(u, self.problem.gap(u)))

    def linearise(self, u: np.ndarray, memory: object) -> Linearised:
        """Linearise the mechanics, counted and timed."""
        start = self.tally.clock()
        lin = self.problem.linearise(u, memory)
        self.tally.spend("assembly_s", start)
        self.tally.counters["assemblies"] += 1
        return lin

    def with_residual(self, state: NewtonState, lin: Linearised, u: np.ndarray, pressure: np.ndarray) -> NewtonState:
        """|r - G^T W p| over the largest of the forces in balance; infinite once the iteration has blown up."""
        contact = self.problem.contact_force(u, pressure)
        scale = max(lin.scale, float(norm(contact, check_finite=False)))
        first = state.first_scale or scale
        imbalance = float(norm(lin.residual - contact, check_finite=False))
        if not imbalance <= BLOW_UP * max(first, np.finfo(float).tiny):
            residual = float("inf")
        else:
            residual = imbalance / scale if scale > 0 else imbalance
        # where everything just touches at the start, the first gap that is not zero says what rounding there will be
        gaps = state.first_gap_size or self.problem.size_of_gaps(u, self.problem.gap(u))
        return replace(state, scale=scale, first_scale=first, residual=residual, first_gap_size=gaps)

    def balanced(self, state: NewtonState, lin: Linearised, u: np.ndarray) -> bool:
        """True when the relative residual is within tolerance, or is rounding and does not matter.

        What it still asks for is taken to be what the last step has moved.
        """
        if state.residual <= self.tolerance:
            return True
        size = float(norm(u, check_finite=False))
        return excused(state.residual, _rounding(state, lin, u), state.moved / size if size > 0 else np.inf)

    def stuck(self, state: NewtonState, lin: Linearised, u: np.ndarray) -> bool:
        """True when the residual is rounding and the steps no longer shrink; without balance, that is the end."""
        return state.residual <= _rounding(state, lin, u) and state.moved > 0.5 * state.moved_before

    def closed(
        self, state: NewtonState, u: np.ndarray, gap: np.ndarray, pressure: np.ndarray, active: np.ndarray
    ) -> bool:
        """True when the nodes of the set obey g + p/epsilon = 0."""
        mismatch = np.abs(gap + pressure / self.epsilon)[active]
        return bool(np.max(mismatch, initial=0.0) <= GAP_TOLERANCE * self.gap_size(state, u, gap))

    def misplaced(
        self,
        state: NewtonState,
        lin: Linearised,
        u: np.ndarray,
        gap: np.ndarray,
        pressure: np.ndarray,
        active: np.ndarray,
        c: float = 1.0,
        *,
        solved: bool = False,
    ) -> np.ndarray:
        """Candidates (m,) on the wrong side: in the set with p - c g < 0, or out of it with p - c g > 0.

        A node that just touches without pressure has p and g of the size of rounding, and no set is the right one:
        near equilibrium, and where p and g have just been ``solved`` for, what rounding explains swaps nothing.
        """
        excess = np.where(active, 1.0, -1.0) * (pressure - c * gap)
        wrong = excess < 0
        if wrong.any() and (solved or state.residual <= ROUNDING_ALONE):
            force = ROUNDING_MARGIN * (rounding_floor(lin, u) + np.finfo(float).eps * state.scale)
            in_pressure, in_gap = force / self.problem.weights, c * GAP_TOLERANCE * self.gap_size(state, u, gap)
            # a solved step leaves a pressure in the set and a gap out of it; rounding of the other is none of theirs
            wrong = excess < -(np.where(active, in_pressure, in_gap) if solved else in_pressure + in_gap)
        return wrong

    def gap_size(self, state: NewtonState, u: np.ndarray, gap: np.ndarray) -> float:
        """Size of the terms that make up a gap; their rounding is the gap's, however small the gap itself.

        Not less than the first that was not zero: a body that goes back to zero brings the rounding of its way with it.
        """
        return max(self.problem.size_of_gaps(u, gap), state.first_gap_size)

    def step(
        self, lin: Linearised, u: np.ndarray, pressure: np.ndarray, active: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """One linear step du (n,) on the set ``active``, with the pressures (m,) it brings.

        K du - G^T W p = -r,   G_A du + p_A/epsilon = -g_A,   p = 0 outside the set A.
        Raises SingularMatrixError.
        """
        start = self.tally.clock()
        K = self.problem.stiffness(lin, u, pressure)
        nodes = np.flatnonzero(active)
        A, b, pivots = K, -lin.residual, None
        if len(nodes):
            pivots = Pivots.choose(self.problem, u, nodes, K, self.epsilon)
            A, b = pivots.substitute(K, b)
        self.tally.spend("contact_s", start)
        du = self.solution(self.factorise(A), A, b)
        start = self.tally.clock()
        found = np.zeros_like(pressure)
        if pivots is not None:
            du, found[nodes] = pivots.resolve(du)
        self.tally.spend("contact_s", start)
        return du, found

    def factorise(self, A: sparse.csc_matrix) -> Factor:
        """Factorise, counted and timed; raises SingularMatrixError."""
        start = self.tally.clock()
        factor = factorise(A, self.solver, ordered=self.problem.ordered)
        self.tally.spend("factorisation_s", start)
        self.tally.count(factor)
        return factor

    def solution(self, factor: Factor, A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
        """The checked solution, timed; raises SingularMatrixError."""
        start = self.tally.clock()
        x = checked_solve(factor, A, b)
        self.tally.spend("solve_s", start)
        return x

    def advance(
        self, state: NewtonState, lin: Linearised, u: np.ndarray, du: np.ndarray, active: np.ndarray
    ) -> tuple[NewtonState, np.ndarray, object]:
        """The next u and its memory: one Newton iteration, however many linear systems its step and its set took."""
        if state.active is None or not np.array_equal(active, state.active):
            state = replace(state, active=active, moved=np.inf)
        self.tally.counters["newton_iterations"] += 1
        state, memory = self.remember(state, lin, du)
        return state, u + du, memory

    def remember(self, state: NewtonState, lin: Linearised, du: np.ndarray) -> tuple[NewtonState, object]:
        """The memory of the step, timed as assembly."""
        state = replace(state, moved_before=state.moved, moved=float(norm(du, check_finite=False)))
        start = self.tally.clock()
        memory = lin.remember(du)
        self.tally.spend("assembly_s", start)
        return state, memory

    def finish(self, u: np.ndarray, pressure: np.ndarray, active: np.ndarray, outcome: Outcome) -> ContactSolution:
        """The solution record of this run; pressures of a converged set that rounding made negative become zero."""
        if outcome.converged:
            pressure = np.maximum(pressure, 0.0)
        return ContactSolution(u, pressure, active, outcome, dict(self.tally.counters), tuple(self.tally.history))


def _rounding(state: NewtonState, lin: Linearised, u: np.ndarray) -> float:
    return rounding_floor(lin, u) / state.scale if state.scale > 0 else 0.0
