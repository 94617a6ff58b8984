"""Public solvers of quadratic programmes, each taken at its word on min du.K.du/2 + r.du subject to G du >= -g.

The multipliers are nodal forces. Sources of the solvers: Stellato et al., Math. Program. Comput. 12 (2020) 637-672
(OSQP); Goulart, Chen, arXiv:2405.12762 (Clarabel); Bambade et al., IEEE Trans. Robot. (2025) (ProxQP); Schwan et al.,
CDC 2023 (PIQP); Arnström et al., IEEE Trans. Autom. Control 67 (2022) 4362-4369 (DAQP); Huangfu, Hall, Math. Program.
Comput. 10 (2018) 119-142 (HiGHS); O'Donoghue, SIAM J. Optim. 31 (2021) 1999-2023 (SCS); Hermans et al., Math. Program.
Comput. 14 (2022) 497-541 (QPALM); Goldfarb, Idnani, Math. Program. 27 (1983) 1-33 (quadprog).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy import sparse

from contact.algorithms.qp import Scaled
from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import refusal
from contact.solvers.lcp_pivoting import unit
from contact.solvers.qp_backends import Answer as Found
from contact.solvers.qp_backends import Programme
from contact.solvers.sparse import checked_solve, factorise, response
from studies.arena.solvers.base import Answer, Solver
from studies.arena.solvers.programmes import cvxopt, cvxpy, highs, known, osqp, qpalm, qpsolvers, quadprog, scs
from studies.experiments.obstacle_problems.false_success import keeps

DENSE = 3000  # unknowns beyond which K is not written out with its zeros: 72 MB, and a cubic number of operations


@dataclass(frozen=True)
class Outside(Solver):
    """One call of a public solver from nothing, with the tolerance for all that it can be asked for.

    scaled: the programme as contact/algorithms/qp.py scales it, with a unit diagonal, unit rows and displacements about
    1; otherwise as it is in the file, in N and mm.  dense: whether the solver knows no zeros.
    """

    call: Callable[[Programme, float], Found] = osqp
    scaled: bool = False
    dense: bool = False

    def applies(self, step: FrozenStep) -> str | None:
        """Only a convex programme whose multipliers are forces on some area."""
        if len(step.gap) == 0:
            return "no candidate: a linear system"
        if self.dense and len(step.r) > DENSE:
            return f"dense: {len(step.r)} unknowns are more than {DENSE}"
        return _refusal(step)

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """What it says, in mm and MPa."""
        whole = self._scaled(step)
        found = self._found(step, whole, tolerance)
        du, forces = (found.x, found.y) if whole is None else whole.unscaled(found)
        return Answer(du, forces / step.weights, found.claimed, found.iterations, reason=found.status)

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """By the criterion of OSQP, in the units of the programme that was put to it."""
        whole, forces = self._scaled(step), step.weights * answer.pressure
        x = answer.du if whole is None else answer.du / (whole.size * whole.stretch)
        y = forces if whole is None else whole.multipliers(forces)
        return keeps(programme(step, whole), Found(x, y, True, ""), tolerance)

    def _found(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> Found:
        return self.call(programme(step, whole), tolerance)

    def _scaled(self, step: FrozenStep) -> Scaled | None:
        return Scaled.of(step.K, step.r, step.G, step.gap, step.weights, np.inf) if self.scaled else None


@dataclass(frozen=True)
class Condensed(Outside):
    """A solver of quadratic programmes on the dense dual, with a unit diagonal and gaps of 1 at most.

    min f.C.f/2 + s.f over nodal forces f >= 0, as many unknowns as there are candidates. C = G K^-1 G^T is the
    compliance of the candidates [mm/N] (Delassus), s = g - G K^-1 r their gaps without any force. The equilibrium of
    du = K^-1 (G^T f - r) is then exact, whatever f is. Source: Delassus, Ann. Sci. Éc. Norm. Supér. 34 (1917) 95-179.
    """

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


def programme(step: FrozenStep, whole: Scaled | None) -> Programme:
    """The quadratic programme of a step, as it is or ``whole`` scaled."""
    if whole is not None:
        return whole.programme
    return Programme(sparse.csc_matrix((step.K + step.K.T) / 2), step.r, sparse.csc_matrix(step.G), -step.gap)


@lru_cache(maxsize=2)
def _refusal(step: FrozenStep) -> str | None:
    if not np.all(step.weights > 0):
        return "a candidate without area has no force for a multiplier"
    return refusal(step)


def _both(solver: Outside) -> tuple[Solver, Solver]:
    return solver, replace(solver, name=f"{solver.name}, scaled", scaled=True)


# licences: cvxopt and quadprog are under the GPL, qpsolvers and QPALM under the LGPL; none is an extra of ours
OUTSIDE: tuple[Solver, ...] = (
    *_both(Outside("OSQP", "osqp", call=osqp)),
    *_both(Outside("Clarabel", "clarabel", call=known("clarabel"))),
    *_both(Outside("ProxQP", "proxsuite", call=known("proxqp"))),
    *_both(Outside("PIQP", "piqp", call=known("piqp"))),
    *_both(Outside("DAQP", "daqp", call=known("daqp"), dense=True)),
    *_both(Outside("HiGHS", "highspy", call=highs)),
    *_both(Outside("SCS", "scs", call=scs)),
    *_both(Outside("QPALM", "qpalm", call=qpalm)),
    *_both(Outside("CVXOPT", "cvxopt", call=cvxopt)),
    *_both(Outside("quadprog", "quadprog", call=quadprog, dense=True)),
    *_both(Outside("cvxpy", "cvxpy", call=cvxpy)),
    Outside("qpsolvers", "qpsolvers", "'qpsolvers[quadprog]'", call=qpsolvers, dense=True),
)
CONDENSED: tuple[Solver, ...] = (
    Condensed("OSQP, condensed", "osqp"),
    Condensed("Clarabel, condensed", "clarabel", call=known("clarabel")),
    Condensed("PIQP, condensed", "piqp", call=known("piqp")),
    Condensed("DAQP, condensed", "daqp", call=known("daqp")),
)
