"""Regularised contact, the paper's perturbed Lagrangian: a foundation of springs, p = epsilon <-g>.

With friction t = -w epsilon s is pulled back radially to the disc of radius mu f: of a slip s the part -t/(w epsilon)
is elastic, and an anchor of the next step is that much behind.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.newton.friction_loop import approach
from contact.newton.loop import Step, came_back, iterate, settle_set
from contact.newton.step import Iterate, NewtonRun
from contact.problem import ContactProblem, ContactSolution


@dataclass(frozen=True)
class Regularised(NewtonAlgorithm):
    """The displacement is the only unknown; the set is where g < 0, updated at every Newton iteration.

    epsilon [MPa/mm]: stiffness of the foundation, 1e4 in the paper; the penetration is p/epsilon. The pressure of an
    iterate comes from its linear step, not from epsilon times a rounded gap: no digit is lost at 1e14.
    A set that recurs after a different one is a cycle: the linearised problem is then settled as in semismooth.
    On a stiff foundation the rim moves by one row of elements per iteration, so the number of iterations grows with the
    mesh (plate-contact: 97 on 64 elements, 1251 on 256, with load cuts). In semismooth, lcp and qp it does not.
    Source: Grigolyuk et al. (2004), eqs 14-16; Simo, Wriggers, Taylor, Comput. Methods Appl. Mech. Eng. 50 (1985)
    163-180.
    """

    epsilon: float = 1e4
    name: ClassVar[str] = "regularised"
    friction: ClassVar[bool] = True
    springs: ClassVar[bool] = True

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs a finite epsilon."""
        if np.isinf(self.epsilon):
            return "its law p = epsilon <-g> needs a finite epsilon: infinity is a constraint, not a spring"
        return super().supports(problem)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Iterate from the displacement of ``start``; its set and pressures follow from the gap."""
        if problem.coulomb is not None:
            run = self.rubbing(problem, start)
            return run.finish(*approach(run, run.start(), 1.0, self.max_iterations))
        gap = problem.gap(start.u)
        sprung = replace(start, pressure=np.where(start.active, self.epsilon * np.maximum(-gap, 0.0), 0.0))
        return iterate(self.run(problem), sprung, _on_penetrated, self.max_iterations)


def _on_penetrated(run: NewtonRun, at: Iterate) -> Step:
    if came_back(at):
        return settle_set(run, at, at.active)
    du, pressure = run.step(at.lin, at.u, at.pressure, at.active)
    return Step(du, pressure, at.active)
