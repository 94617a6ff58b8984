"""Pseudo arc length: follow r(u) = t f through limit points and snap-backs, t the load factor.

Each step looks for the next point of the curve on a hyperplane normal to the last chord (or, at first, the tangent), so
that neither the load nor any displacement has to grow (Keller, 1977). No contact: the set does not change along it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from contact.linear import SingularMatrixError, checked_solve, factorise
from contact.problem import Linearisation, Outcome, rounding_floor

RESIDUAL_TOLERANCE = 1e-9
WORST_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class ArcPoint:
    """A converged point of the curve: u (n,), load factor, arc length from the start, iterations it took."""

    u: np.ndarray
    factor: float
    arc: float
    iterations: int


@dataclass(frozen=True)
class ArcLength:
    """Parameters of the continuation.

    first_factor: load factor of the first step.  easy, hard: iterations at which the step grows or shrinks.
    smallest, largest: bounds of the step, as fractions and multiples of the first one.
    """

    first_factor: float
    easy: int = 4
    hard: int = 8
    max_iterations: int = 14
    smallest: float = 1e-6
    largest: float = 8.0
    solver: str = "splu"

    def follow(
        self, linearise: Callable[[np.ndarray, object], Linearisation], load: np.ndarray, max_points: int = 1000
    ) -> Iterator[ArcPoint | Outcome]:
        """Points of the curve from rest, or an Outcome as the last item when a step fails at its smallest size.

        ``linearise`` must not contain the load; ``load`` (n,) is the force at t = 1.
        """
        at = ArcPoint(np.zeros_like(load), 0.0, 0.0, 0)
        lin = linearise(at.u, None)
        direction = checked_solve(factorise(lin.tangent, self.solver), lin.tangent, load)
        metric = 1.0 / max(float(direction @ direction), np.finfo(float).tiny)  # du and dt count alike at the start
        chord = (direction, 1.0)
        first = float(np.sqrt(2.0)) * self.first_factor
        step = first
        for _ in range(max_points):
            length = np.sqrt(metric * (chord[0] @ chord[0]) + chord[1] ** 2)
            tangent = (chord[0] / length, chord[1] / length)
            found = self._correct(linearise, load, at, tangent, step, metric)
            if found is None:
                step /= 2
                if step < self.smallest * first:
                    yield Outcome.STEP_LIMIT
                    return
                continue
            yield found
            chord = (found.u - at.u, found.factor - at.factor)
            at = found
            if found.iterations <= self.easy:
                step = min(1.5 * step, self.largest * first)
            elif found.iterations >= self.hard:
                step = 0.6 * step

    def _correct(
        self,
        linearise: Callable[[np.ndarray, object], Linearisation],
        load: np.ndarray,
        at: ArcPoint,
        tangent: tuple[np.ndarray, float],
        step: float,
        metric: float,
    ) -> ArcPoint | None:
        """Newton on the hyperplane at the distance ``step`` along the tangent; None when it fails."""
        u, factor = at.u + step * tangent[0], at.factor + step * tangent[1]
        memory = linearise(at.u, None).remember(u - at.u)
        size = float(np.linalg.norm(load))
        for iteration in range(self.max_iterations + 1):
            lin = linearise(u, memory)
            residual = factor * load - lin.residual
            error = float(np.linalg.norm(residual))
            scale = max(lin.scale, abs(factor) * size)
            if not error <= 1e12 * size:
                return None
            if error <= RESIDUAL_TOLERANCE * scale or (
                error <= WORST_ROUNDING * scale and error <= rounding_floor(lin, u)
            ):
                return ArcPoint(u, factor, at.arc + step, iteration)
            if iteration == self.max_iterations:
                break
            try:
                solve = factorise(lin.tangent, self.solver)
                a = checked_solve(solve, lin.tangent, residual)
                b = checked_solve(solve, lin.tangent, load)
            except SingularMatrixError:
                return None
            off = step - metric * (tangent[0] @ (u - at.u)) - tangent[1] * (factor - at.factor)
            change = (off - metric * (tangent[0] @ a)) / (metric * (tangent[0] @ b) + tangent[1])
            du = a + change * b
            memory = lin.remember(du)
            u, factor = u + du, factor + change
        return None
