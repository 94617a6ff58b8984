"""A contact algorithm of one's own: on each linearisation the set is settled exactly, one violating node at a time.

``footprint card my_algorithm.py`` tries it; ``footprint solve ring --use my_algorithm.py --contact my-algorithm --out
out`` solves a scene with it.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.catalogue import ALGORITHMS
from contact.newton.loop import Step, StepError, iterate
from contact.newton.step import Iterate, NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome


@dataclass(frozen=True)
class MyAlgorithm(NewtonAlgorithm):
    """Swap all violating nodes at first, then the first one alone: least index, finite for every P-matrix.

    Source: Murty, Opsearch 11 (1974) 138-144.
    """

    name: ClassVar[str] = "my-algorithm"

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Newton from ``start``; what follows the linearisation is :meth:`settled`."""
        return iterate(self.run(problem), start, self.settled, self.max_iterations)

    def settled(self, run: NewtonRun, at: Iterate) -> Step:
        """Step du (n,), pressures and set (m,) that solve the problem linearised at ``at``; raises StepError."""
        active = at.active
        for swaps in range(10 + 20 * len(active)):
            du, pressure = run.step(at.lin, at.u, at.pressure, active)
            gap = at.gap + run.problem.gap_jacobian(at.u) @ du
            least = 1e-12 * np.max(np.abs(at.gap), initial=0.0)
            wrong = np.where(active, pressure < 0, gap < -least)
            if not wrong.any():
                return Step(du, pressure, active)
            if swaps >= 10:  # all at once may go round in a circle
                wrong &= np.arange(len(wrong)) == np.argmax(wrong)
            active = active ^ wrong
        raise StepError(Outcome.UNSOLVED, "the set does not settle")


ALGORITHMS[MyAlgorithm.name] = MyAlgorithm
