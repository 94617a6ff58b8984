"""Trial and error, the paper's method: Newton to convergence on a fixed set, then swap every violating node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.newton.loop import CYCLE, first_of
from contact.newton.state import NewtonState
from contact.newton.step import RESIDUAL_TOLERANCE, NewtonRun
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError


@dataclass(frozen=True)
class TrialAndError:
    """Guess a set, solve, release nodes under tension, add nodes that penetrate, repeat.

    epsilon [MPa/mm]: the paper's regularisation, 1e4; infinity enforces exactly.
    Swapping all violators at once can cycle. A set seen before switches to swapping only the first violator (Murty's
    least-index rule, finite for every P-matrix), and the history says so.
    Sources: Grigolyuk et al. (2004), eqs 14-16; Murty, Linear Algebra Appl. 5 (1972) 65-108.
    """

    epsilon: float = 1e4
    max_iterations: int = 40
    max_sets: int = 200
    solver: str = "splu"
    tolerance: float = RESIDUAL_TOLERANCE
    name: ClassVar[str] = "trial-and-error"
    parameters: ClassVar[tuple[Parameter, ...]] = SHARED

    def supports(self, problem: ContactProblem) -> str | None:
        """Applies to every problem."""
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Start from the set of ``start`` and the nodes that already penetrate."""
        run = NewtonRun(problem, self.epsilon, self.solver, tolerance=self.tolerance)
        u, pressure, before = start.u, start.pressure, start.active
        active = before | (problem.gap(u) < 0)
        seen: set[bytes] = set()
        one_at_a_time = False
        state = run.begin(u)
        for _ in range(self.max_sets):
            state, u, pressure, violated, outcome = self._equilibrium(run, state, u, pressure, active, before)
            if not outcome.converged:
                return run.finish(u, pressure, active, outcome)
            if not violated.any():
                return run.finish(u, pressure, active, Outcome.CONVERGED)
            before = active
            if not one_at_a_time and active.tobytes() in seen:
                one_at_a_time = True
                run.tally.tell(CYCLE)
            seen.add(active.tobytes())
            active = active ^ (first_of(violated) if one_at_a_time else violated)
        return run.finish(u, pressure, active, Outcome.CYCLING if one_at_a_time else Outcome.ITERATION_LIMIT)

    def _equilibrium(
        self,
        run: NewtonRun,
        state: NewtonState,
        u: np.ndarray,
        pressure: np.ndarray,
        active: np.ndarray,
        before: np.ndarray,
    ) -> tuple[NewtonState, np.ndarray, np.ndarray, np.ndarray, Outcome]:
        """Newton on a fixed set: state, u, pressure, the candidates that violate their condition there, outcome."""
        pressure, memory, nothing = np.where(active, pressure, 0.0), None, np.zeros_like(active)
        for iteration in range(self.max_iterations + 1):
            lin = run.linearise(u, memory)
            state = run.with_residual(state, lin, u, pressure)
            run.tally.note(state.residual, active, before if iteration == 0 else active)
            if np.isinf(state.residual):
                return state, u, pressure, nothing, Outcome.DIVERGED
            gap = run.problem.gap(u)
            closed = run.closed(state, u, gap, pressure, active)
            if closed and run.balanced(state, lin, u):
                own = np.where(active, 0.0, gap)  # in the set only the pressure decides, out of it only the gap
                violated = run.misplaced(state, lin, u, own, pressure, active)
                return state, u, pressure, violated, Outcome.CONVERGED
            if closed and run.stuck(state, lin, u):
                return state, u, pressure, nothing, Outcome.ROUNDING
            if iteration == self.max_iterations:
                break
            try:
                du, pressure = run.step(lin, u, pressure, active)
            except SingularMatrixError:
                return state, u, pressure, nothing, Outcome.SINGULAR
            state, u, memory = run.advance(state, lin, u, du, active)
        return state, u, pressure, nothing, Outcome.ITERATION_LIMIT
