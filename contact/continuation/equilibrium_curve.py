"""Equilibrium curves r(u) = t f in the space of x = (m u, t): their points on planes, and their tangents.

The load factor t is an unknown, the plane its equation: the bordered matrix is regular at limit points, where K is not.
The scale m says how much displacement counts like one unit of load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

from contact.events import Event, EventKind
from contact.newton.solves import Tally
from contact.newton.step import Iterate, NewtonRun
from contact.problem import ContactSolution, Linearisation, Linearise, Linearised, Outcome, without_contact
from contact.solvers.sparse import SingularMatrixError, checked_solve, row_norm, solution

NO_CONTACT = np.zeros(0)
NO_SET = np.zeros(0, bool)


@dataclass(frozen=True, eq=False)
class ArcPoint:
    """A converged point of the curve: u (n,), load factor, iterations it took.

    rising: the load grows along the curve; limit: it is stationary.  pressure, active (m,): of the contact candidates,
    where there are any.  negative: eigenvalues of the tangent at fixed load, where they are counted.
    along: length from rest on, where the curve itself is known.
    """

    u: np.ndarray
    factor: float
    iterations: int = 0
    rising: bool = True
    limit: bool = False
    pressure: np.ndarray = field(default_factory=lambda: NO_CONTACT)
    active: np.ndarray = field(default_factory=lambda: NO_SET)
    negative: int | None = None
    along: float = np.nan

    @property
    def state(self) -> ContactSolution:
        """As a solution."""
        return ContactSolution(self.u, self.pressure, self.active, Outcome.CONVERGED)


@dataclass(frozen=True, eq=False)
class Curve:
    """The curve of one model under one load; ``run`` counts what is spent on it.

    load (n,): force at t = 1.  m: scale of the displacements.
    """

    run: NewtonRun
    load: np.ndarray
    m: float
    max_iterations: int

    @classmethod
    def at_rest(
        cls,
        linearise: Linearise,
        load: np.ndarray,
        max_iterations: int,
        solver: str,
        tolerance: float,
        ordered: bool = False,
    ) -> Curve:
        """Displacements and load count alike on the tangent at rest; ``linearise`` must not contain the load."""
        run = NewtonRun(without_contact(linearise, len(load), ordered=ordered), solver=solver, tolerance=tolerance)
        curve = cls(run, load, 1.0, max_iterations)
        tangent = curve.tangent(ArcPoint(np.zeros_like(load), 0.0), np.append(np.zeros_like(load), 1.0))
        return curve.scaled(float(np.linalg.norm(tangent[:-1])), float(tangent[-1]))

    @property
    def tally(self) -> Tally:
        """What all points have cost."""
        return self.run.tally

    def scaled(self, displacement: float, factor: float) -> Curve:
        """The curve in the scale in which so much displacement counts like so much load."""
        return replace(self, m=factor / max(displacement, np.finfo(float).tiny))

    def place(self, point: ArcPoint) -> np.ndarray:
        """x = (m u, t) (n + 1,)."""
        return np.append(self.m * point.u, point.factor)

    def tangent(self, point: ArcPoint, along: np.ndarray) -> np.ndarray:
        """Unit tangent at a converged point, K du = f dt, in the sense of ``along``."""
        forward = np.append(np.zeros_like(point.u), 1.0)
        t = self._solve(self.run.linearise(point.u, None), along / np.linalg.norm(along), forward)
        t[:-1] *= self.m
        return t / np.linalg.norm(t)

    def on_plane(self, start: ArcPoint, guess: np.ndarray, normal: np.ndarray, event: str) -> ArcPoint | None:
        """Newton from ``guess`` on the plane through it with the given normal; None when it fails.

        ``start`` is the converged point that the guess was made from; ``event`` heads its rows of history.
        """
        u, factor, tally = guess[:-1] / self.m, float(guess[-1]), self.run.tally
        memory, moved = self.run.remember(self.run.linearise(start.u, None), u - start.u)
        at: Iterate | None = None
        for iteration in range(self.max_iterations + 1):
            lin = self.loaded(u, factor, memory)
            at = replace(self.run.at(lin, u, NO_CONTACT, NO_SET, at), moved=moved)
            tally.note(at.residual, NO_SET, NO_SET, Event(EventKind.POINT, event) if iteration == 0 else None)
            tally.history[-1] |= {"parameter": factor, "iteration": iteration}
            if self.run.balanced(at):
                return ArcPoint(u, factor, iteration)
            if iteration == self.max_iterations or not np.isfinite(at.residual):
                return None
            try:
                step = self._solve(lin, normal, np.append(-lin.residual, 0.0))  # every iterate stays on the plane
            except SingularMatrixError:
                return None
            memory, moved = self.run.remember(lin, step[:-1])
            u, factor = u + step[:-1], factor + float(step[-1])
            tally.counters["newton_iterations"] += 1
        return None

    def loaded(self, u: np.ndarray, factor: float, memory: object = None) -> Linearisation:
        """The model under the load: residual r(u) - t f."""
        lin = self.run.linearise(u, memory)
        scale = max(lin.scale, abs(factor) * float(np.linalg.norm(self.load)))
        return Linearisation(lin.residual - factor * self.load, lin.tangent, scale, lin.remember)

    def _solve(self, lin: Linearised, normal: np.ndarray, b: np.ndarray) -> np.ndarray:
        return self.bordered(lin, normal)(b)

    def bordered(
        self, lin: Linearised, normal: np.ndarray, *, checked: bool = True
    ) -> Callable[[np.ndarray], np.ndarray]:
        """b (n + 1,) -> (du, dt) with K du - f dt = b_1..n and normal . (m du, dt) = b_n+1, factorised once.

        checked: each solution by its residual; else the caller looks at what comes of them.

        Row and column of the border are scaled to the size of K, for the sake of the pivots.
        """
        size = float(np.mean(np.abs(lin.tangent.diagonal())))
        row = size / max(float(np.max(np.abs(self.m * normal[:-1]))), abs(normal[-1]))
        column = size / float(np.max(np.abs(self.load)))
        upper = sparse.hstack([lin.tangent, sparse.csc_matrix(-column * self.load[:, None])], format="csr")
        lower = np.append(row * self.m * normal[:-1], row * column * normal[-1])
        A = sparse.csc_matrix(sparse.vstack([upper, sparse.csr_matrix(lower[None, :])], format="csr"))
        factor, norm = self.run.factorise(A), row_norm(A)

        def solve(b: np.ndarray) -> np.ndarray:
            with self.tally.timed("solve_s"):
                scaled = np.append(b[:-1], row * b[-1])
                x = checked_solve(factor, A, scaled, norm) if checked else solution(factor, scaled)
            return np.append(x[:-1], column * x[-1])

        return solve
