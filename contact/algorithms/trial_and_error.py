"""Trial and error, the paper's method: Newton to convergence on a fixed set, then swap every violating node."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.newton.loop import CYCLE, first_of
from contact.newton.state import Iterate
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError


@dataclass(frozen=True)
class TrialAndError(NewtonAlgorithm):
    """Guess a set, solve, release nodes under tension, add nodes that penetrate, repeat.

    epsilon [MPa/mm]: the paper's regularisation, 1e4; infinity enforces exactly.
    Swapping all violators at once can cycle. A set seen before switches to swapping only the first violator (Murty's
    least-index rule, finite for every P-matrix), and the history says so.
    Sources: Grigolyuk et al. (2004), eqs 14-16; Murty, Linear Algebra Appl. 5 (1972) 65-108.
    """

    epsilon: float = 1e4
    max_sets: int = 200
    name: ClassVar[str] = "trial-and-error"

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Start from the set of ``start`` and the nodes that already penetrate."""
        run = self.run(problem)
        u, pressure, before = start.u, start.pressure, start.active
        active = before | (problem.gap(u) < 0)
        seen: set[bytes] = set()
        one_at_a_time = False
        at: Iterate | None = None
        for _ in range(self.max_sets):
            pressed = np.where(active, pressure, 0.0)
            at, outcome = self._equilibrium(run, run.at(run.linearise(u, None), u, pressed, active, at), before)
            if not outcome.converged:
                return run.finish(at, outcome)
            own = np.where(active, 0.0, at.gap)  # in the set only the pressure decides, out of it only the gap
            violated = run.misplaced(replace(at, gap=own))
            if not violated.any():
                return run.finish(at, Outcome.CONVERGED)
            u, pressure, before = at.u, at.pressure, active
            if not one_at_a_time and active.tobytes() in seen:
                one_at_a_time = True
                run.tally.tell(CYCLE)
            seen.add(active.tobytes())
            active = active ^ (first_of(violated) if one_at_a_time else violated)
        assert at is not None  # there is at least one set
        ended = Outcome.CYCLING if one_at_a_time else Outcome.ITERATION_LIMIT
        return run.finish(replace(at, active=active), ended)

    def _equilibrium(self, run: NewtonRun, at: Iterate, before: np.ndarray) -> tuple[Iterate, Outcome]:
        """Newton on the set of the iterate; ``before`` (m,): the set before it."""
        for iteration in range(self.max_iterations + 1):
            run.tally.note(at.residual, at.active, before if iteration == 0 else at.active)
            if np.isinf(at.residual):
                return at, Outcome.DIVERGED
            closed = run.closed(at)
            if closed and run.balanced(at):
                return at, Outcome.CONVERGED
            if closed and run.stuck(at):
                return at, Outcome.ROUNDING
            if iteration == self.max_iterations:
                break
            try:
                du, pressure = run.step(at.lin, at.u, at.pressure, at.active)
            except SingularMatrixError:
                return at, Outcome.SINGULAR
            at = run.advance(at, du, pressure, at.active)
        return at, Outcome.ITERATION_LIMIT
