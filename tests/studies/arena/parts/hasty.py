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
        found = super().solve(problem, start)
        if not found.outcome.converged or not found.active.any():
            return found
        kept = found.active & (RNG.random(len(found.active)) < 0.7)
        run = self.run(problem)
        du, pressure = run.step(problem.linearise(found.u, None), found.u, found.pressure, kept)
        return replace(found, u=found.u + du, pressure=pressure, active=kept)


ALGORITHMS[Hasty.name] = Hasty
