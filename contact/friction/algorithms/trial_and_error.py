"""Trial and error with friction, the literature's naive set: equilibrium under fixed states, then swap all."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.events import Event, EventKind
from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.newton.laws import Laws
from contact.friction.newton.run import FAILURES, FrictionalRun, Point
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.problem import Outcome

CYCLE = "cycle detected: these states were tried {} sets before"


@dataclass(frozen=True)
class TrialAndError(FrictionalNewton):
    """Guess who is open, sticks and slips, and where to; solve; change every state that is violated; repeat.

    Who slips does so in the direction of the last equilibrium, against its friction where it has stuck there; who comes
    back to the foundation sticks. Nothing answers a cycle: it ends the solve, as CYCLING, and the history shows it. The
    GRECO plate with mu = 1 makes it cycle on every mesh (studies.experiments.friction); it is the rule for those who
    come back that does: where they stick or slip as Alart and Curnier's function says, the same sets end.
    max_sets: given up after so many.
    """

    max_sets: int = 200
    name: ClassVar[str] = "trial-and-error"

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Start from the states of ``start`` and the candidates that already penetrate."""
        run = self.run(problem, lawful=False)
        at = run.start(start)
        laws, tried = _next(run, at), list[bytes]()
        while len(tried) < self.max_sets:
            tried.append(laws.key)
            try:
                at, outcome = self._equilibrium(run, at, laws)
            except FAILURES as error:
                return run.finish(at, run.failed(error))
            if not outcome.converged:
                return run.finish(at, outcome)
            after = _next(run, at)
            if after.same(laws):
                lawful = run.by_law(at)
                if run.newton.balanced(lawful.newton):
                    return run.finish(lawful, Outcome.CONVERGED)
            elif after.key in tried:
                ago = len(tried) - tried.index(after.key)
                run.newton.tally.tell(Event(EventKind.CYCLE, CYCLE.format(ago)))
                return run.finish(at, Outcome.CYCLING)
            laws = after
        return run.finish(at, Outcome.ITERATION_LIMIT)

    def _equilibrium(self, run: FrictionalRun, at: Point, laws: Laws) -> tuple[Point, Outcome]:
        """Newton under these laws, whether what comes out obeys them or not; raises FAILURES."""
        run.note(at, laws, at.laws)
        for _ in range(self.max_iterations):
            at = run.advance(at, run.linear(at, laws).step(laws), laws)
            run.note(at, laws, laws)
            ended = run.ended(at, laws)
            if ended is not None:
                return at, ended
        return at, Outcome.ITERATION_LIMIT


def _next(run: FrictionalRun, at: Point) -> Laws:
    """The laws expected at a point, with the direction of the slip itself where a candidate slips on."""
    laws, slip, was = run.expected(at), at.local.slip, at.laws.state
    size = np.linalg.norm(slip, axis=1)
    on = (laws.state == State.SLIP) & (was == State.SLIP) & (size > 0)
    direction = np.divide(slip, size[:, None], out=laws.direction.copy(), where=on[:, None])
    returns = (was == State.OPEN) & laws.closed & (run.problem.mu > 0)
    direction[returns] = 0.0
    return Laws(np.where(returns, State.STICK, laws.state).astype(np.int8), direction, np.zeros_like(laws.across))
