"""Augmented Lagrangian with friction: springs beside known forces in both directions, until they carry nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.events import Event, EventKind
from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.algorithms.loop import approach
from contact.friction.newton.laws import Local
from contact.friction.newton.run import FrictionalRun, Point
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.newton.state import Tally
from contact.newton.step import NewtonRun
from contact.problem import Outcome

LOOSEST, TIGHTENING = 1e-3, 0.1  # of the inner Newton
SLOW = 0.25  # an outer error that falls less than to this fraction asks for a larger c
STIFFEST = 1e8  # over the stiffness of the candidates
SETTLE = 0.05  # as semismooth


@dataclass(frozen=True)
class AugmentedLagrangian(FrictionalNewton):
    """f <- <f - k g>, t <- t - k s pulled back to the disc of radius mu f; an inner Newton balances them at fixed f, t.

    c [-]: stiffness of the springs k = w c, not of the answer, over that of the candidates per area. It grows by
    ``growth`` when an update has not brought gaps of those that touch and slips of those that stick down to a quarter.
    The outer loop ends where an exact algorithm would, without springs: the forces are exact.
    That friction follows the normal force makes it no minimum, and no proof of convergence is known.
    Source: Simo, Laursen, Comput. Struct. 42 (1992) 97-116.
    """

    c: float = 1e3
    growth: float = 10.0
    max_outer: int = 60
    name: ClassVar[str] = "augmented-lagrangian"

    def supports(self, problem: FrictionalProblem) -> str | None:
        """Needs the exact law."""
        if np.isfinite(self.epsilon):
            return "its forces are exact: epsilon must be infinite; a finite one is the business of regularised"
        return None

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Outer loop from the forces and states of ``start``."""
        exact, loosest = self.run(problem), max(LOOSEST, self.tolerance)
        tally, at = exact.newton.tally, exact.start(start)
        unit = at.newton.stiffness.per_area or 1.0
        c, before, tolerance = self.c * unit, np.inf, loosest
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
            if repeats and tolerance == self.tolerance and c >= STIFFEST * unit:
                return exact.finish(at, Outcome.ROUNDING)
            if repeats or error > SLOW * before:
                c = min(self.growth * c, STIFFEST * unit)
            tolerance = float(np.clip(TIGHTENING * _change(local, known), self.tolerance, loosest))
            before = error
        return exact.finish(at, Outcome.ITERATION_LIMIT)


def _beside(exact: FrictionalRun, at: Point, c: float, tolerance: float, tally: Tally) -> FrictionalRun:
    """The problem on springs of c [MPa/mm] that push with the forces of ``at`` where gaps and slips are none."""
    problem, contact = exact.problem, exact.problem.contact
    give = np.divide(1 / c, contact.weights, out=np.zeros_like(contact.weights), where=contact.weights > 0)
    gap, slip = give * at.local.normal, give[:, None] * at.local.friction
    shifted = replace(contact, gap=lambda u: contact.gap(u) - gap)
    moved = replace(problem, contact=shifted, slip=lambda u: problem.slip(u) - slip)
    return FrictionalRun(moved, NewtonRun(shifted, c, exact.newton.solver, tolerance, tally))


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
