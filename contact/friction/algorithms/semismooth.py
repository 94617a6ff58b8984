"""Semismooth Newton with friction: states by Alart and Curnier's function, settled before the next linearisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.algorithms.lcp import Lcp
from contact.friction.algorithms.loop import approach
from contact.friction.algorithms.programmed import finished
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.problem import Outcome


@dataclass(frozen=True)
class Semismooth(FrictionalNewton):
    """One linear step under the states that Alart and Curnier's function asks for; repeat.

    The states are updated on one linearisation until at most the fraction ``settle`` of those that touch changes; who
    slips on keeps the direction of the linearisation. States that come back are a cycle: that linearisation is left as
    it is, and where Newton has been before the states are changed one at a time there. Where that comes back, too, the
    states are those of the complementarity problem on a polygon (:class:`Lcp`), as far as it applies, and the history
    says so. No rule ends for every problem: else, or where there is no answer, the outcome is CYCLING, or what Newton's
    iteration ends with. mu = 0 gives the iterates of the frictionless algorithm but for its answer to cycles.
    Sources: Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375; Hintermüller, Ito, Kunisch, SIAM J.
    Optim. 13 (2002) 865-888.
    """

    settle: float = 0.05
    name: ClassVar[str] = "semismooth"

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Iterate from ``start`` until the states repeat and the forces balance."""
        run, pivots = self.run(problem), Lcp()
        at, outcome = approach(run, run.start(start), self.settle, self.max_iterations)
        if outcome is Outcome.CYCLING and pivots.supports(problem) is None:
            at, outcome = finished(run, at, pivots.choose, [], self.max_iterations)
        return run.finish(at, outcome)
