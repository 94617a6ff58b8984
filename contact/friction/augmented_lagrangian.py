"""Augmented Lagrangian with friction: springs beside known forces in both directions, until they carry nothing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.events import Event, EventKind
from contact.friction.base import FrictionalNewton
from contact.friction.loop import approach
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.friction.run import FrictionalRun, Point
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
    ``growth`` when an update has not brought the error of the law down to a quarter. The outer loop ends when that is
    rounding: penetration, slip of those that stick, and what slips have across their friction; the forces are exact.
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
            known, row = at.local, len(tally.history)
            inner = _beside(exact, at, c, tolerance, tally)
            begun = inner.at(at.lin, at.newton.u, known.normal, known.friction, at.laws)
            reached, outcome = approach(inner, begun, SETTLE, self.max_iterations)
            local = reached.local
            at = exact.at(reached.lin, reached.newton.u, local.normal, local.friction, reached.laws)
            if not outcome.converged:
                return exact.finish(at, outcome)
            error = _error(exact, at)
            tally.tell(Event(EventKind.UPDATE, f"update {outer}: c = {c:g}, inner tolerance {tolerance:.0e}"), row)
            if error <= 1 and tolerance == self.tolerance and exact.newton.balanced(at.newton):
                return exact.finish(at, Outcome.CONVERGED)
            if error > max(1.0, SLOW * before):
                c = min(self.growth * c, STIFFEST * unit)
            relative = _change(local.normal - known.normal, local.friction - known.friction) / _size(local.normal)
            tolerance = self.tolerance if error <= 1 else float(np.clip(TIGHTENING * relative, self.tolerance, loosest))
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


def _error(exact: FrictionalRun, at: Point) -> float:
    """By how much gaps and slips break the exact law, over what rounding explains."""
    gap, slip, state, margins = at.local.gap, at.local.slip, at.laws.state, exact.margins(at)
    closed = at.laws.closed
    unit = -at.friction / np.maximum(np.linalg.norm(at.friction, axis=1), np.finfo(float).tiny)[:, None]
    along = np.maximum(np.einsum("mk,mk->m", slip, unit), 0.0)
    slips = (state == State.SLIP) & (exact.problem.mu > 0)
    wrong = np.where(slips[:, None], slip - along[:, None] * unit, np.where(closed[:, None], slip, 0.0))
    wrong[closed & (exact.problem.mu == 0)] = 0.0
    off = float(np.max(np.where(closed, np.abs(gap), np.maximum(-gap, 0.0)), initial=0.0))
    return max(
        off / (margins.gap or 1.0), float(np.max(np.linalg.norm(wrong, axis=1), initial=0.0)) / (margins.slip or 1.0)
    )


def _change(normal: np.ndarray, friction: np.ndarray) -> float:
    return max(float(np.max(np.abs(normal), initial=0.0)), float(np.max(np.abs(friction), initial=0.0)))


def _size(normal: np.ndarray) -> float:
    return float(np.max(normal, initial=0.0)) or np.finfo(float).tiny
