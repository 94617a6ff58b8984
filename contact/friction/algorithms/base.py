"""What algorithms with friction share: each is a frozen record of parameters with fields of its frictionless twin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np

from contact.friction.newton.run import FrictionalRun
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.newton.step import RESIDUAL_TOLERANCE, NewtonRun
from contact.solvers.sparse import AUTO


class FrictionalAlgorithm(Protocol):
    """One algorithm: a frozen record of parameters.

    name: in the catalogue.  epsilon [MPa/mm]: of springs in both directions; infinity is the exact law.
    """

    name: ClassVar[str]

    def __init__(self, **parameters: Any) -> None: ...

    @property
    def epsilon(self) -> float:
        """Of the laws f = w epsilon <-g> and, in stick, t = -w epsilon s."""

    def supports(self, problem: FrictionalProblem) -> str | None:
        """None, or the reason why the algorithm does not apply to the problem."""

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Solve from ``start``; failure is a value, not an exception."""


@dataclass(frozen=True)
class FrictionalNewton:
    """The fields of every algorithm; they mean what they do without friction (:mod:`contact.algorithms.base`).

    epsilon [MPa/mm]: of springs in both directions; infinity is the exact law.
    """

    epsilon: float = np.inf
    max_iterations: int = 40
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE

    def supports(self, problem: FrictionalProblem) -> str | None:
        """Applies to every problem as far as that is known before a linearisation.

        With an infinite epsilon candidates are held by unknowns of their own: where they have none the outcome is
        REFUSED.
        """
        return None

    def run(self, problem: FrictionalProblem, *, lawful: bool = True) -> FrictionalRun:
        """A new run of this algorithm on a problem."""
        return FrictionalRun(problem, NewtonRun(problem.contact, self.epsilon, self.solver, self.tolerance), lawful)
