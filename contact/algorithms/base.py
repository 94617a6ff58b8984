"""What the algorithms share: each is a Newton iteration with a way of its own to choose the contact set."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.newton.loop import MOST_UPDATES
from contact.newton.step import RESIDUAL_TOLERANCE, NewtonRun
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem
from contact.solvers.sparse import AUTO


@dataclass(frozen=True)
class NewtonAlgorithm:
    """The fields of every algorithm, and the run that counts what its iteration spends.

    epsilon [MPa/mm]: infinity enforces the constraint exactly.  solver: of the linear systems.  tolerance: of the
    residual, relative to the forces in balance.
    Of its fields a user sets those in ``parameters``. The others (max_iterations and its like) only say when a solve is
    given up, how fast a penalty grows or whether a backend polishes: no answer depends on them, and a test that wants a
    failure sets them in Python.
    """

    epsilon: float = np.inf
    max_iterations: int = 40
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    max_updates: int = MOST_UPDATES
    parameters: ClassVar[tuple[Parameter, ...]] = SHARED

    def supports(self, problem: ContactProblem) -> str | None:
        """Applies to every problem."""
        return None

    def run(self, problem: ContactProblem) -> NewtonRun:
        """A new run of this algorithm on a problem."""
        return NewtonRun(problem, self.epsilon, self.solver, self.tolerance)
