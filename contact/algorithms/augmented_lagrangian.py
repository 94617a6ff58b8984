"""Augmented Lagrangian: Newton on springs beside a known pressure, updated until the springs carry nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.events import Event, EventKind
from contact.newton.loop import iterate, settle_most
from contact.newton.state import Tally
from contact.newton.step import NewtonRun, gap_rounding
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.scales import Stiffness, length, motion

LOOSEST, TIGHTENING = 1e-3, 0.1  # of the inner Newton
SLOW = 0.25  # an outer error that falls less than to this fraction asks for a larger c
STIFFEST = 1e10  # over the stiffness of the candidates
SETTLE = 0.05  # as semismooth


@dataclass(frozen=True)
class AugmentedLagrangian(NewtonAlgorithm):
    """Uzawa's outer loop p <- max(0, p - c g); the inner Newton balances r = G^T W max(0, p - c g) at fixed p.

    c [-]: stiffness of the springs, not of the answer, over that of the candidates per area. It grows by ``growth``
    when an update has not brought penetration and complementarity down to a quarter. The outer loop ends when both are
    rounding: the multiplier is exact, epsilon is infinite.
    The inner Newton stops at a tenth of the last relative change of the pressure, between 1e-3 and ``tolerance``, which
    the last one keeps.
    Sources: Hestenes, J. Optim. Theory Appl. 4 (1969) 303-320; Simo, Laursen, Comput. Struct. 42 (1992) 97-116.
    """

    c: float = 1e3
    growth: float = 10.0
    max_outer: int = 60
    name: ClassVar[str] = "augmented-lagrangian"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("c", "stiffness of the first springs, over that of the body per area", low=0, open_low=True),
    )

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs the exact constraint."""
        if np.isfinite(self.epsilon):
            return "its multiplier is exact: epsilon must be infinite; a finite one is the business of regularised"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Outer loop from the pressure and set of ``start``."""
        tally, loosest = Tally(), max(LOOSEST, self.tolerance)
        at_start = NewtonRun(problem, tally=tally).linearise(start.u, None)
        stiffness = Stiffness.of(problem, at_start, start.u)
        unit, first = stiffness.per_area or 1.0, motion(problem, start.u)
        state, c, before, tolerance = start, self.c * unit, np.inf, loosest
        for outer in range(self.max_outer):
            known = state.pressure
            shifted = replace(problem, gap=partial(_shifted_gap, problem, known / c))
            inner, first_row = NewtonRun(shifted, c, self.solver, tolerance, tally), len(tally.history)
            lin, spent = None if outer else at_start, tally.counters["newton_iterations"]
            state = iterate(inner, state, partial(settle_most, settle=SETTLE), self.max_iterations, lin=lin)
            if not state.outcome.converged:
                return state
            gap = problem.gap(state.u)
            # a node in the set is off by its spring, which is what the pressure has just changed by
            error = float(np.max(np.where(state.active, np.abs(gap), np.maximum(-gap, 0.0)), initial=0.0))
            push = float(np.linalg.norm(problem.contact_force(state.u, state.pressure)))
            bound = gap_rounding(problem, max(length(problem, stiffness, state.u, push), first))
            if gap_rounding(problem, max(motion(problem, state.u), first)) < error <= bound:
                # the forces decide what a large gap is: those that a body of the stiffness of now would need for it
                stiffness = Stiffness.of(problem, inner.linearise(state.u, None), state.u)
                bound = gap_rounding(problem, max(length(problem, stiffness, state.u, push), first))
            # the problem of this update was solved already, for all that its Newton can tell: stiffer springs tell more
            repeats, stiffest = tally.counters["newton_iterations"] == spent, STIFFEST * unit
            exact = (repeats and c >= stiffest) or error <= bound
            update = f"update {outer}: c = {c:g}, inner tolerance {tolerance:.0e}"
            tally.tell(Event(EventKind.UPDATE, update), first_row)
            if exact and tolerance == self.tolerance:
                return state
            if repeats or error > SLOW * before:
                c = min(self.growth * c, stiffest)
            change = float(np.max(np.abs(state.pressure - known), initial=0.0))
            relative = change / max(float(np.max(state.pressure, initial=0.0)), np.finfo(float).tiny)
            tolerance = self.tolerance if exact else float(np.clip(TIGHTENING * relative, self.tolerance, loosest))
            before = error
        return replace(state, outcome=Outcome.ITERATION_LIMIT)


def _shifted_gap(problem: ContactProblem, lead: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Gaps g - p/c: springs on it push with p where g = 0."""
    return problem.gap(u) - lead
