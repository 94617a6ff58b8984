"""Augmented Lagrangian: Newton on springs beside a known pressure, updated until the springs carry nothing.

With friction t <- t - k s, pulled back to the disc of radius mu f, beside f <- <f - k g> with springs k = w c. The
outer loop ends where an exact algorithm would, without springs: the forces are exact. That friction follows the normal
force makes it no minimum, and no proof of convergence is known.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from contact.algorithms.base import NewtonAlgorithm
from contact.coulomb import State
from contact.events import Event, EventKind
from contact.newton.friction_loop import approach
from contact.newton.friction_run import FrictionalRun, Point
from contact.newton.friction_states import Local
from contact.newton.loop import iterate, settle_most
from contact.newton.solves import Tally
from contact.newton.step import NewtonRun, gap_rounding
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.scales import Stiffness, length, motion

LOOSEST, TIGHTENING = 1e-3, 0.1  # of the inner Newton
SLOW = 0.25  # an outer error that falls less than to this fraction asks for a larger c
STIFFEST, STIFFEST_WITH_FRICTION = 1e10, 1e8  # over the stiffness of the candidates
SETTLE = 0.05  # as semismooth


@dataclass(frozen=True)
class AugmentedLagrangian(NewtonAlgorithm):
    """Uzawa's outer loop p <- max(0, p - c g); the inner Newton balances r = G^T W max(0, p - c g) at fixed p.

    c [-]: stiffness of the springs over that of the candidates per area; the answer does not depend on it. It grows by
    ``growth`` when an update has not reduced penetration and complementarity to a quarter. The outer loop stops when
    both are rounding: the multiplier is exact, epsilon is infinite.
    The inner tolerance is a tenth of the last relative change of the pressure, between 1e-3 and ``tolerance``. The last
    inner solve uses ``tolerance``.
    Sources: Hestenes, J. Optim. Theory Appl. 4 (1969) 303-320; Simo, Laursen, Comput. Struct. 42 (1992) 97-116.
    """

    c: float = 1e3
    growth: float = 10.0
    max_outer: int = 60
    name: ClassVar[str] = "augmented-lagrangian"
    friction: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("c", "stiffness of the first springs, over that of the body per area", low=0, open_low=True),
    )

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs the exact constraint, epsilon = inf."""
        if np.isfinite(self.epsilon):
            return "its multiplier is exact, so epsilon must be inf; for a finite epsilon use regularised"
        return super().supports(problem)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Outer loop from the forces and the set, or the states, of ``start``."""
        if problem.coulomb is not None:
            return self._with_friction(self.rubbing(problem, start))
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

    def _with_friction(self, exact: FrictionalRun) -> ContactSolution:
        tally, at, loosest = exact.newton.tally, exact.start(), max(LOOSEST, self.tolerance)
        unit = at.newton.stiffness.per_area or 1.0
        c, before, tolerance, stiffest = self.c * unit, np.inf, loosest, STIFFEST_WITH_FRICTION * unit
        for outer in range(self.max_outer):
            known, row, spent = at.local, len(tally.history), tally.counters["newton_iterations"]
            inner = _beside(exact, at, c, tolerance, tally)
            begun = inner.at(at.lin, at.newton.u, known.normal, known.friction, at.laws)
            reached, outcome = approach(inner, begun, SETTLE, self.max_iterations)
            local = reached.local
            at = exact.at(reached.lin, reached.newton.u, local.normal, local.friction, reached.laws)
            if not outcome.converged:
                return exact.finish(at, outcome)
            tally.tell(Event(EventKind.UPDATE, f"update {outer}: c = {c:g}, inner tolerance {tolerance:.0e}"), row)
            if exact.ended(at, exact.expected(at)) is Outcome.CONVERGED:
                return exact.finish(at, Outcome.CONVERGED)
            # the problem of this update was solved already, for all that its Newton can tell
            error, repeats = _error(at), tally.counters["newton_iterations"] == spent
            if repeats and tolerance == self.tolerance and c >= stiffest:
                return exact.finish(at, Outcome.ROUNDING)
            if repeats or error > SLOW * before:
                c = min(self.growth * c, stiffest)
            tolerance = float(np.clip(TIGHTENING * _change(local, known), self.tolerance, loosest))
            before = error
        return exact.finish(at, Outcome.ITERATION_LIMIT)


def _beside(exact: FrictionalRun, at: Point, c: float, tolerance: float, tally: Tally) -> FrictionalRun:
    """The problem on springs of c [MPa/mm] that push with the forces of ``at`` where gaps and slips are none."""
    contact, law = exact.newton.problem, exact.law
    give = np.divide(1 / c, contact.weights, out=np.zeros_like(contact.weights), where=contact.weights > 0)
    slip = give[:, None] * at.local.friction
    shifted = replace(contact, gap=partial(_shifted_gap, contact, give * at.local.normal))
    moved = replace(law, slip=lambda u: law.slip(u) - slip)
    return replace(exact, newton=NewtonRun(shifted, c, exact.newton.solver, tolerance, tally), law=moved)


def _error(at: Point) -> float:
    """The largest gap of those that touch, penetration of those that do not, and slip of those that stick [mm]."""
    gap, sticks = at.local.gap, at.laws.state == State.STICK
    off = np.where(at.laws.closed, np.abs(gap), np.maximum(-gap, 0.0))
    return max(float(np.max(off, initial=0.0)), float(np.max(np.abs(at.local.slip[sticks]), initial=0.0)))


def _change(local: Local, known: Local) -> float:
    """The largest change of a force over the largest normal one."""
    normal, friction = np.abs(local.normal - known.normal), np.abs(local.friction - known.friction)
    largest = max(float(np.max(normal, initial=0.0)), float(np.max(friction, initial=0.0)))
    return largest / (float(np.max(local.normal, initial=0.0)) or np.finfo(float).tiny)


def _shifted_gap(problem: ContactProblem, lead: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Gaps g - p/c: springs on it push with p where g = 0."""
    return problem.gap(u) - lead
