"""Semismooth Newton with friction: states by Alart and Curnier's function, settled before the next linearisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.events import Event, EventKind
from contact.friction.laws import Laws
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.friction.run import FrictionalRun, Point
from contact.friction.step import FrictionalStep
from contact.newton.loop import FEW_UPDATES, MOST_UPDATES, StepError
from contact.newton.step import RESIDUAL_TOLERANCE, NewtonRun
from contact.problem import Outcome
from contact.solvers.sparse import AUTO, SingularMatrixError

SINGLY = Event(EventKind.CYCLE, "cycle of states detected: only the first wrong state was changed, one at a time")
ENDLESS = "cycle of states detected, and changing one at a time does not end on the linearised problem"


@dataclass(frozen=True)
class Semismooth:
    """One linear step under the states that Alart and Curnier's function asks for; repeat.

    The states are updated on one linearisation until at most the fraction ``settle`` of those that touch changes; who
    slips on keeps the direction of the linearisation. States that come back are a cycle: that linearisation is left as
    it is, and where Newton has been before the states are changed one at a time there. No rule ends for every problem:
    where that comes back, too, or where there is no answer, the outcome is CYCLING, or what Newton's iteration ends
    with. mu = 0 gives the iterates of the frictionless algorithm but for its answer to cycles.
    Sources: Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375; Hintermüller, Ito, Kunisch, SIAM J.
    Optim. 13 (2002) 865-888.
    """

    settle: float = 0.05
    max_iterations: int = 40
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    name: ClassVar[str] = "semismooth"

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Iterate from ``start`` until the states repeat and the forces balance."""
        run = FrictionalRun(problem, NewtonRun(problem.contact, np.inf, self.solver, self.tolerance))
        at = run.start(start)
        before, event, begun = at.laws, None, set[bytes]()
        for _ in range(self.max_iterations + 1):
            laws = run.expected(at)
            run.note(at, laws, before, event)
            before = laws
            ended = run.ended(at, laws)
            if ended is not None:
                return run.finish(at, ended)
            again = laws.key in begun and laws.key != at.laws.key
            begun.add(laws.key)
            try:
                linear = run.linear(at, laws)
                laws, event = self._settled(run, at, linear, laws, last=again)
                at = run.advance(at, linear.step(laws), laws)
            except (SingularMatrixError, StepError) as error:
                run.newton.tally.tell(Event(EventKind.FAILED, str(error)))
                return run.finish(at, error.outcome if isinstance(error, StepError) else Outcome.SINGULAR)
        return run.finish(at, Outcome.ITERATION_LIMIT)

    def _settled(
        self, run: FrictionalRun, at: Point, linear: FrictionalStep, laws: Laws, *, last: bool
    ) -> tuple[Laws, Event | None]:
        """The laws that the linearised problem keeps, up to the fraction ``settle``, all if it is the ``last``.

        Raises StepError, SingularMatrixError.
        """
        settle, most, seen = (0.0, MOST_UPDATES, set[bytes]()) if last else (self.settle, FEW_UPDATES, set[bytes]())
        for _ in range(most):
            after = run.foreseen(at, linear.foreseen(laws), laws)
            seen.add(laws.key)
            if np.sum(after.state != laws.state) <= settle * laws.closed.sum():
                return laws, None
            if after.key in seen:
                break
            laws = after
        return (_one_at_a_time(run, at, linear, laws), SINGLY) if last else (laws, None)


def _one_at_a_time(run: FrictionalRun, at: Point, linear: FrictionalStep, laws: Laws) -> Laws:
    """Laws that the linearised problem keeps, by changes of the first wrong one; raises StepError."""
    seen = set[bytes]()
    while laws.key not in seen and len(seen) < MOST_UPDATES:
        seen.add(laws.key)
        after = run.foreseen(at, linear.foreseen(laws), laws)
        wrong = np.flatnonzero(after.state != laws.state)
        if not len(wrong):
            return laws
        laws = laws.changed(after, wrong[:1])
    raise StepError(Outcome.CYCLING, ENDLESS)
