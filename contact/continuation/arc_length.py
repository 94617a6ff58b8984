"""Pseudo arc length: follow r(u) = t f through limit points and snap-backs, t the load factor.

Every point is looked for on a plane of the space of x = (m u, t): normal to the tangent of the curve while marching, so
that neither the load nor any displacement has to grow (Keller, 1977); normal to the chord across a maximum or minimum
of the load to find that limit point; t = constant at a given load. The curve is that of a body without contact under a
load, or of one that a moving foundation presses; t is then the travel.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from contact.continuation.equilibrium_curve import ArcPoint, Curve
from contact.continuation.power_series import SeriesCurve
from contact.continuation.pressed_curve import PressedCurve
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import Linearise, Outcome
from contact.solvers.sparse import AUTO, SingularMatrixError

LIMIT_TOLERANCE = 1e-5  # distance of a limit point from its last estimate, relative to its distance from rest
LIMIT_ATTEMPTS = 20
AnyCurve = Curve | PressedCurve


@dataclass(frozen=True, eq=False)
class Trace:
    """The curve in order, rest first; how it ended and why; counters and one history row an iteration.

    curve: itself, where it was followed by power series; the points are then those that were asked for, and its limits.
    """

    points: tuple[ArcPoint, ...]
    outcome: Outcome
    reason: str
    counters: dict[str, float]
    history: list[dict[str, Any]]
    curve: SeriesCurve | None = None

    def at(self, factor: float, passage: int = 0) -> ArcPoint:
        """The point where the load passes this factor for the first time, or later (``passage`` 1, 2, ...).

        Raises LookupError where it does not, and of a curve that is known by points alone.
        """
        if self.curve is None:
            raise LookupError("a curve followed by arc length is known at its points alone")
        return self.curve.at(factor, passage)


@dataclass(frozen=True)
class ArcLength:
    """Parameters of the continuation.

    first_factor: load factor of the first step.  easy, hard: iterations at which the step grows or shrinks.
    smallest, largest: bounds of the step, as fractions and multiples of the first one.  straight: least cosine between
    tangent and chord of a step; a sharper turn is taken in smaller steps, or the march could return on its own trace.
    watched: fraction of the first step above which a point must belong to the curve by its negative eigenvalues, where
    they are counted; smaller steps pass branches.  to_limit: end with the first limit point.  lowest: load factor below
    which a curve that goes back is followed no further.  most: factorisations after which the march is given up.
    tolerance: residual relative to the forces in balance at which the Newton of a point ends.  ordered: as for a
    problem; minimum degree is led astray by the full row of the border, and fills in twice as much as without it.
    """

    first_factor: float
    easy: int = 3
    hard: int = 8
    max_iterations: int = 10
    smallest: float = 1e-6
    largest: float = 8.0
    straight: float = 0.9
    watched: float = 1e-2
    to_limit: bool = False
    lowest: float = -np.inf
    max_points: int = 1000
    most: float = np.inf
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    ordered: bool = False

    def trace(
        self,
        linearise: Linearise,
        load: np.ndarray,
        targets: Sequence[float],
        on_point: Callable[[float], None] = lambda t: None,
    ) -> Trace:
        """The curve from rest to the last target, with its limit points and a point at every target.

        ``linearise`` must not contain the load; ``load`` (n,) is the force at t = 1.  targets: increasing positive load
        factors; each counts where the load first reaches it.
        """
        curve = Curve.at_rest(linearise, load, self.max_iterations, self.solver, self.tolerance, self.ordered)
        return self.along(curve, ArcPoint(np.zeros_like(load), 0.0), targets, on_point)

    def along(
        self,
        curve: AnyCurve,
        start: ArcPoint,
        targets: Sequence[float],
        on_point: Callable[[float], None] = lambda t: None,
    ) -> Trace:
        """The same of any curve, from one of its points."""
        points, outcome, reason = self._march(curve, start, targets, on_point)
        refined, unresolved = _with_limits(curve, points)
        if unresolved and outcome.converged:
            outcome, reason = Outcome.STEP_LIMIT, unresolved
        return Trace(tuple(refined), outcome, reason, curve.tally.counters, curve.tally.history)

    def _march(
        self, curve: AnyCurve, start: ArcPoint, targets: Sequence[float], on_point: Callable[[float], None]
    ) -> tuple[list[ArcPoint], Outcome, str]:
        """From the start through the targets; the last point lies at the last of them.

        The scale follows the march: all the displacement so far counts like all the load, up and down, so far.
        """
        first = float(np.sqrt(2.0)) * self.first_factor
        points, step, ahead = [start], first, list(targets)
        direction = curve.tangent(start, np.append(np.zeros_like(start.u), 1.0))
        moved, loaded = 0.0, 0.0
        while len(points) <= self.max_points:
            last = points[-1]
            if curve.tally.counters["factorisations"] > self.most:
                return points, Outcome.GIVEN_UP, f"arc length after t = {last.factor:.6g}"
            reached, onwards = self._advance(curve, last, step * direction, watchful=step > self.watched * first)
            crossings = [
                _at_factor(curve, last, reached, t) for t in ahead if reached is not None and reached.factor >= t
            ]
            if reached is None or None in crossings:
                step /= 2
                if step < self.smallest * first:
                    return points, Outcome.STEP_LIMIT, f"arc length after t = {last.factor:.6g}"
                continue
            points += [point for point in crossings if point is not None]
            del ahead[: len(crossings)]
            if not ahead:
                return points, Outcome.CONVERGED, ""
            moved += float(np.linalg.norm(reached.u - last.u))
            loaded += abs(reached.factor - last.factor)
            before, curve = curve.m, curve.scaled(moved, loaded)
            onwards[:-1] *= curve.m / before
            direction = onwards / np.linalg.norm(onwards)
            points.append(reached)
            on_point(reached.factor)
            if self.to_limit and not reached.rising:
                return points, Outcome.LIMIT_POINT, f"the path turns back after t = {last.factor:.6g}"
            if reached.factor < self.lowest:
                return points, Outcome.LIMIT_POINT, f"the path goes back below t = {self.lowest:g}"
            step = self._next_step(step, reached.iterations, self.largest * first)
        return points, Outcome.ITERATION_LIMIT, f"{self.max_points} points of the curve did not reach t = {ahead[0]:g}"

    def _advance(
        self, curve: AnyCurve, last: ArcPoint, ahead: np.ndarray, *, watchful: bool
    ) -> tuple[ArcPoint | None, np.ndarray]:
        """The point on the plane normal to ``ahead`` at its end, and the tangent there.

        None where there is none or it has no tangent, where the curve turns too sharply or, if ``watchful``, where the
        point is none of this curve: the number of negative eigenvalues changes by one where the curve turns back, and
        by none elsewhere.
        """
        length = float(np.linalg.norm(ahead))
        reached = curve.on_plane(last, curve.place(last) + ahead, ahead / length, f"step {length:.6g}")
        if reached is None:
            return None, ahead
        chord = curve.place(reached) - curve.place(last)
        if length < self.straight * np.linalg.norm(chord) or ahead @ chord < 0.5 * length**2:
            return None, ahead  # too sharp; or a tolerance so loose that the plane itself is not met
        try:
            onwards = curve.tangent(reached, chord)
        except SingularMatrixError:
            return None, ahead
        reached = replace(reached, rising=bool(onwards[-1] > 0))
        return (None if watchful and _elsewhere(last, reached) else reached), onwards

    def _next_step(self, step: float, iterations: int, largest: float) -> float:
        if iterations <= self.easy:
            return min(2.0 * step, largest)
        return 0.6 * step if iterations >= self.hard else step


def _elsewhere(last: ArcPoint, reached: ArcPoint) -> bool:
    """Whether the numbers of negative eigenvalues say that branches lie between the points."""
    if last.negative is None or reached.negative is None:
        return False
    return abs(reached.negative - last.negative) > (reached.rising != last.rising)


def _at_factor(curve: AnyCurve, before: ArcPoint, after: ArcPoint, factor: float) -> ArcPoint | None:
    """The point at a given load factor between two points."""
    x, y = curve.place(before), curve.place(after)
    guess = x + (factor - before.factor) / (after.factor - before.factor) * (y - x)
    return curve.on_plane(before, guess, np.append(np.zeros_like(before.u), 1.0), f"at t = {factor:g}")


def _with_limits(curve: AnyCurve, points: Sequence[ArcPoint]) -> tuple[list[ArcPoint], str]:
    """Insert the points where the load is stationary; the reason names the first that could not be found."""
    refined, unresolved = [points[0]], ""
    for before, after in pairwise(points):
        if before.rising != after.rising:
            turning = limit_point(curve, before, after)
            if turning is not None:
                refined.append(turning)
            elif not unresolved:
                unresolved = f"the limit point after t = {before.factor:.6g} could not be resolved"
        refined.append(after)
    return refined, unresolved


@dataclass(frozen=True, eq=False)
class _End:
    """An end of an interval of s: the point, its x, s, and dx/ds along the curve."""

    point: ArcPoint
    x: np.ndarray
    s: float
    slope: np.ndarray

    @classmethod
    def of(cls, curve: AnyCurve, point: ArcPoint, normal: np.ndarray) -> _End:
        x, tangent = curve.place(point), curve.tangent(point, normal)
        return cls(point, x, float(normal @ x), tangent / (normal @ tangent))


def limit_point(curve: AnyCurve, before: ArcPoint, after: ArcPoint) -> ArcPoint | None:
    """The limit point between two points on either side of it, or None.

    With s the coordinate along their chord, dx/ds is known exactly at a point; the zero of dt/ds is bracketed and
    interpolated linearly (so t quadratically) until it moves no more. The displacement, which moves, sets the scale.
    """
    curve = curve.scaled(float(np.linalg.norm(after.u - before.u)), 1.0)
    chord = curve.place(after) - curve.place(before)
    normal = chord / np.linalg.norm(chord)
    s_last = np.inf
    try:
        low, high = _End.of(curve, before, normal), _End.of(curve, after, normal)
        for _ in range(LIMIT_ATTEMPTS):
            guess = _hermite(low, high, low.slope[-1] / (low.slope[-1] - high.slope[-1]))
            middle = curve.on_plane(low.point, guess, normal, "limit point")
            if middle is None:
                return None
            s = float(normal @ guess)
            if abs(s - s_last) <= LIMIT_TOLERANCE * np.linalg.norm(guess):
                return replace(middle, limit=True)
            end, s_last = _End.of(curve, middle, normal), s
            low, high = (end, high) if end.slope[-1] * low.slope[-1] > 0 else (low, end)
    except SingularMatrixError:  # a bifurcation
        return None
    return None


def _hermite(low: _End, high: _End, part: float) -> np.ndarray:
    """x at the fraction ``part`` of the interval on the cubic with the ends' values and slopes."""
    rest, length = 1.0 - part, high.s - low.s
    value = rest**2 * (1 + 2 * part) * low.x + part**2 * (1 + 2 * rest) * high.x
    return value + length * part * rest * (rest * low.slope - part * high.slope)
