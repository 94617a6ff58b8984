"""Friction as a sequence of quadratic programmes: given bounds from pass to pass, and exact steps on what they find."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.algorithms.compliance import Block, Chosen
from contact.friction.algorithms.programmed import finished, unfinished
from contact.friction.algorithms.tresca import Tresca
from contact.friction.problem import FrictionalProblem, FrictionalSolution
from contact.solvers.qp_backends import DISCS, ask, missing

PASSES = 60
NEAR, SAME = 1e-3, 1e-7  # change of bounds, of the largest, at which passes end: before exact steps, and without
CONTRACTS = 0.9  # a change that falls by less is damped


@dataclass(frozen=True)
class Qp(FrictionalNewton):
    """min F.W.F/2 + v.F, f >= 0, |t| <= b, in the forces F of a condensed linearisation; b = mu f of the last; again.

    With given bounds friction has a potential (Tresca), and the pass after takes those of the normal forces before,
    damped where they do not contract: to a fixed point, which is the law of Coulomb.
    backend: clarabel has the disc |t| <= b as a second-order cone, the others a polygon in it of so many ``sides``,
    on which friction is up to 1 - cos(pi/sides) short.  eps, polish: as without friction.
    finish: whether exact steps on the states of the answer follow, so that no digit comes from a backend; without, a
    step ends with the forces of the programme, which the judge refuses.
    A tangent that is not symmetric has no energy: refused.
    Source: Panagiotopoulos, Ingenieur-Archiv 44 (1975) 421-432.
    """

    backend: str = "osqp"
    eps: float = 1e-8
    polish: bool = True
    sides: int = 8
    finish: bool = True
    name: ClassVar[str] = "qp"

    def supports(self, problem: FrictionalProblem) -> str | None:
        """Needs its backend, a polygon with an even number of sides, and finite coefficients."""
        if self.sides < 4 or self.sides % 2:
            return f"a polygon of {self.sides} sides: an even number from 4 on is needed"
        if np.any(np.isinf(problem.mu)):
            return "an infinite coefficient gives no bound of friction"
        return super().supports(problem) or missing(self.backend)

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Newton from ``start``; the outcome is REFUSED where the tangent is not symmetric."""
        run, words = self.run(problem, lawful=self.finish), list[str]()
        by = finished if self.finish else unfinished
        return run.finish(*by(run, run.start(start), partial(self._choose, words), words, self.max_iterations))

    def _choose(self, words: list[str], block: Block) -> Chosen:
        """The fixed point of the passes; raises StepError."""
        tresca, bound = Tresca.of(block, 0 if self.backend in DISCS else self.sides), np.zeros(len(block.mu))
        if tresca.shift:
            words.append(f"not convex: states found with a shift of {tresca.shift:g} of the diagonal")
        damping, before, near = 1.0, np.inf, NEAR if self.finish else SAME
        for _ in range(PASSES):
            programme, chosen = tresca.programme(bound)
            answer = ask(self.backend, programme, self.eps, self.polish)
            forces = tresca.forces(answer.x, chosen)
            wanted = block.mu * np.maximum(forces[:, 0], 0.0)
            change = float(np.max(np.abs(wanted - bound), initial=0.0))
            if not answer.claimed or change <= near * float(np.max(wanted, initial=0.0)):
                break
            damping = damping / 2 if change > CONTRACTS * before else damping
            bound, before = bound + damping * (wanted - bound), change
        else:
            words.append(f"bounds of friction came to no fixed point in {PASSES} passes")
        if not answer.claimed:
            words.append(f"{self.backend} says {answer.status!r}")
        return Chosen(forces, tresca.states(forces, bound))
