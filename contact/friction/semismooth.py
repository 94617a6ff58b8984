"""Semismooth Newton with friction: states by Alart and Curnier's function, settled before the next linearisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.events import Event, EventKind
from contact.friction.laws import Laws
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.friction.run import FrictionalRun, Point
from contact.friction.step import FrictionalStep, Stepped
from contact.newton.step import RESIDUAL_TOLERANCE, NewtonRun
from contact.problem import Outcome
from contact.solvers.sparse import AUTO, SingularMatrixError

FEW_UPDATES, MOST_UPDATES = 12, 60


@dataclass(frozen=True)
class Semismooth:
    max_iterations: int = 60
    settle: float = 0.05
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    name: ClassVar[str] = "semismooth"

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        run = FrictionalRun(problem, NewtonRun(problem.contact, np.inf, self.solver, self.tolerance))
        at = run.start(start)
        before, event = at.laws, {}
        for iteration in range(self.max_iterations + 1):
            laws = run.expected(at)
            run.note(at, laws, before, **event)
            before = laws
            if np.isinf(at.newton.residual):
                return run.finish(at, Outcome.DIVERGED)
            same = laws.same(at.laws) and run.settled(at)
            if same and run.newton.balanced(at.newton):
                return run.finish(at, Outcome.CONVERGED)
            if same and run.newton.stuck(at.newton):
                return run.finish(at, Outcome.ROUNDING)
            if iteration == self.max_iterations: break
            try:
                stepped, laws, event = self._settle(run, at, laws)
            except SingularMatrixError as error:
                run.newton.tally.tell(Event(EventKind.FAILED, str(error)))
                return run.finish(at, Outcome.SINGULAR)
            at = run.advance(at, stepped, laws)
        return run.finish(at, Outcome.ITERATION_LIMIT)

    def _settle(self, run, at, laws):
        linear = run.linear(at, laws)
        seen = []
        import os
        for _ in range(MOST_UPDATES):
            after = run.foreseen(at, linear.foreseen(laws), laws)
            wrong = np.sum(after.state != laws.state)
            if os.environ.get("DBG"): print("   settle", wrong, np.bincount(laws.state, minlength=3))
            seen.append(laws.state.tobytes()+np.sign(laws.direction).tobytes())
            if wrong <= self.settle * laws.closed.sum():
                break
            if after.state.tobytes()+np.sign(after.direction).tobytes() in seen:
                if os.environ.get("DBG"): print("CYCLE", len(seen)-seen.index(after.state.tobytes()+np.sign(after.direction).tobytes()))
                break
            laws = after
        return linear.step(laws), laws, {}
