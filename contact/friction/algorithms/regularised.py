"""Regularised friction: springs in both directions, pulled back to the disc."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.algorithms.loop import iterate
from contact.friction.problem import FrictionalProblem, FrictionalSolution


@dataclass(frozen=True)
class Regularised(FrictionalNewton):
    """f = w epsilon <-g> and t = -w epsilon s, pulled back radially to the disc of radius mu f.

    epsilon [MPa/mm]: stiffness of the foundation in both directions, as without friction. Of a slip s the part
    -t/(w epsilon) is elastic: an anchor of the next step is that much behind.
    """

    epsilon: float = 1e4
    name: ClassVar[str] = "regularised"

    def supports(self, problem: FrictionalProblem) -> str | None:
        """Needs a finite epsilon."""
        if np.isinf(self.epsilon):
            return "its law f = w epsilon <-g> needs a finite epsilon: infinity is a constraint, not a spring"
        return None

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Iterate from ``start``."""
        return iterate(self.run(problem), start, 1.0, self.max_iterations)
