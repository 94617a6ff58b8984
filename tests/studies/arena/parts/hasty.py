"""Bad on purpose: nodes are dropped from the set at random, and it says that it has converged."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS

RNG = np.random.default_rng(4)


@dataclass(frozen=True)
class Hasty(Semismooth):
    name: ClassVar[str] = "hasty"

    def solve(self, problem, start):
        solution = super().solve(problem, start)
        if not solution.outcome.converged or not solution.active.any():
            return solution
        kept = solution.active & (RNG.random(len(solution.active)) < 0.7)
        run = self.run(problem)
        du, pressure = run.step(problem.linearise(solution.u, None), solution.u, solution.pressure, kept)
        return replace(solution, u=solution.u + du, pressure=pressure, active=kept)


ALGORITHMS[Hasty.name] = Hasty
