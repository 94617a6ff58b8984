"""Semismooth Newton: the contact set is updated at EVERY iteration (primal-dual active set)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.linear import SingularMatrixError
from contact.newton import NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome


@dataclass(frozen=True)
class Semismooth:
    """A node is in contact when p - c g > 0; one linear step on that set; repeat.

    epsilon [MPa/mm]: infinity enforces the constraint exactly.  c [MPa/mm] only weighs pressure against gap while both
    are non-zero, that is in the first iteration of a step: after a full step one of them vanishes at every node.
    max_iterations: those that only release nodes do not count. With an M-matrix (membranes, strings) that is all that
    happens once the first step has closed too much: finite, but one row of elements at a time at epsilon = infinity, so
    that their number grows with the mesh.
    Source: Hintermüller, Ito, Kunisch, SIAM J. Optim. 13 (2002) 865-888.
    """

    epsilon: float = np.inf
    c: float = 1.0
    max_iterations: int = 40
    solver: str = "splu"
    name: str = "semismooth"

    def supports(self, problem: ContactProblem) -> str | None:
        """Applies to every problem."""
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Iterate from ``start`` until the set repeats and the forces balance."""
        run = NewtonRun(problem, self.epsilon, self.solver)
        u, pressure, active, memory = start.u, start.pressure, start.active, None
        counted = 0
        while True:
            lin = run.linearise(u, memory)
            gap = problem.gap(u)
            residual = run.imbalance(lin, u, pressure)
            wanted = active ^ run.misplaced(lin, u, gap, pressure, active, self.c)
            run.note(residual, wanted, active)
            if np.isinf(residual):
                return run.finish(u, pressure, active, Outcome.DIVERGED)
            settled = np.array_equal(wanted, active) and run.closed(u, gap, pressure, active)
            if settled and run.balanced(lin, u, residual):
                return run.finish(u, pressure, active, Outcome.CONVERGED)
            if settled and run.stuck(lin, u, residual):
                return run.finish(u, pressure, active, Outcome.ROUNDING)
            counted += not _only_released(active, wanted)
            if counted > self.max_iterations:
                return run.finish(u, pressure, active, Outcome.ITERATION_LIMIT)
            active = wanted
            try:
                du, pressure = run.step(lin, u, pressure, active)
            except SingularMatrixError:
                return run.finish(u, pressure, active, Outcome.SINGULAR)
            u, memory = u + du, run.remember(lin, du)


def _only_released(before: np.ndarray, after: np.ndarray) -> bool:
    return bool(np.any(before & ~after) and not np.any(after & ~before))
