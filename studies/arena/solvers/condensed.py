"""Public solvers on the dual: min f.C.f/2 + s.f over nodal forces f >= 0, as many unknowns as there are candidates.

C = G K^-1 G^T is the compliance of the candidates [mm/N] (Delassus), s = g - G K^-1 r their gaps without any force. The
equilibrium of du = K^-1 (G^T f - r) is then exact, whatever f is. Source: Delassus, Ann. Sci. Éc. Norm. Supér. 34
(1917) 95-179.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.lcp_pivoting import unit
from contact.solvers.qp_backends import Programme
from contact.solvers.sparse import checked_solve, factorise, response
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.outside import DENSE, Outside
from studies.arena.solvers.programmes import known


@dataclass(frozen=True)
class Condensed(Outside):
    """A solver of quadratic programmes on the dense dual, with a unit diagonal and gaps of 1 at most."""

    scaled: bool = True

    def applies(self, step: FrozenStep) -> str | None:
        """As the others, with few enough candidates."""
        if len(step.gap) > DENSE:
            return f"dense: {len(step.gap)} candidates are more than {DENSE}"
        return super().applies(step)

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """One factorisation, a solution for each candidate, and the programme."""
        factor, G = factorise(step.K), sparse.csc_matrix(step.G.T)
        gap = step.gap + step.G @ checked_solve(factor, step.K, -step.r)
        C = response(factor, G, G)
        size = unit(C)
        C, gap = size[:, None] * (C + C.T) / 2 * size, size * gap
        far = float(np.max(np.abs(gap))) or 1.0
        none = np.zeros_like(gap)
        whole = sparse.csc_matrix(sparse.eye_array(len(gap), format="csc"))
        found = self.call(Programme(sparse.csc_matrix(C), gap / far, whole, none), tolerance)
        forces = far * size * np.maximum(found.x, 0.0)
        du = checked_solve(factor, step.K, step.G.T @ forces - step.r)
        return Answer(du, forces / step.weights, found.claimed, found.iterations, reason=found.status)

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """Its own criterion is one of the dual, which is gone with the factors."""
        return None


CONDENSED: tuple[Solver, ...] = (
    Condensed("OSQP, condensed", "osqp"),
    Condensed("Clarabel, condensed", "clarabel", call=known("clarabel")),
    Condensed("PIQP, condensed", "piqp", call=known("piqp")),
    Condensed("DAQP, condensed", "daqp", call=known("daqp")),
)
