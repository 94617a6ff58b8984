"""Bad on purpose: a QP solver that takes a few steps of projected Gauss-Seidel on the dual for the answer."""

from dataclasses import dataclass

import numpy as np

from contact.solvers.sparse import checked_solve, factorise
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.catalogue import SOLVERS


@dataclass(frozen=True)
class Boastful(Solver):
    """Five sweeps, whatever is asked for."""

    def applies(self, step):
        return "needs lumped coupling" if step.coupling is not None else None

    def answer(self, step, tolerance):
        factor, rows = factorise(step.K), step.G.toarray()
        free = checked_solve(factor, step.K, -step.r)
        C = rows @ np.column_stack([checked_solve(factor, step.K, row) for row in rows])
        gap, forces = step.gap + rows @ free, np.zeros(len(rows))
        for i in [*range(len(rows))] * 5:
            forces[i] = max(0.0, forces[i] - (gap[i] + C[i] @ forces) / C[i, i])
        du = checked_solve(factor, step.K, step.G.T @ forces - step.r)
        return Answer(du, forces / step.weights, True, 5)


SOLVERS["boastful"] = Boastful("boastful")
