"""Equilibrium curves of a body and a foundation that moves: points on planes of x = (m u, t), t the travel.

The travel is an unknown, the last one, on which the gaps depend; the plane is its equation::

    r(u) = G_u^T W p,    g(u, t) >= 0,  p >= 0,  p g = 0,    N . (m u, t) = N . guess

That is a contact problem like any other, but for a row of the tangent that the foundation does not push. An algorithm
that puts its set into the tangent solves it, which is regular where the path turns back in t.
Source: Keller (1977); with contact, Wriggers, Computational Contact Mechanics (2006), section 10.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

from contact.algorithms.base import answered, hasty
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.spectrum import negative_eigenvalues
from contact.events import Event, EventKind
from contact.newton.solves import Tally
from contact.newton.step import NewtonRun
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearisation, Outcome
from contact.swept import crossings

ProblemAt = Callable[[float], ContactProblem]


@dataclass(frozen=True, eq=False)
class PressedCurve:
    """The path of problem_at(t), followed by points (u, t).

    problem: that in (u, t), the ``travel`` of a problem of the path.  m: scale of the displacements.  tally: what all
    points have cost.
    """

    problem_at: ProblemAt
    problem: ContactProblem
    algorithm: ContactAlgorithm
    m: float = 1.0
    tally: Tally = field(default_factory=Tally)

    @classmethod
    def through(
        cls,
        problem_at: Callable[[float], ContactProblem],
        t: float,
        state: ContactSolution,
        algorithm: ContactAlgorithm,
    ) -> tuple[PressedCurve, ArcPoint]:
        """The curve and its point at the converged ``state`` at t, where displacements and travel count alike.

        Raises ValueError on a path on which more than a foundation moves, or another thing.
        """
        travel = problem_at(t).travel
        if travel is None:
            raise ValueError("the path has no travel of a foundation for its parameter")
        curve = cls(problem_at, travel(), hasty(algorithm))
        start = curve.counted(ArcPoint(state.u, t, pressure=state.pressure, active=state.active))
        tangent = curve.tangent(start, np.append(np.zeros_like(state.u), 1.0))
        return curve.scaled(float(np.linalg.norm(tangent[:-1])), float(tangent[-1])), start

    def scaled(self, displacement: float, travel: float) -> PressedCurve:
        """The curve in the scale in which so much displacement counts like so much travel; as it is at rest."""
        return replace(self, m=travel / displacement) if displacement > 0 else self

    def place(self, point: ArcPoint) -> np.ndarray:
        """x = (m u, t) (n + 1,)."""
        return np.append(self.m * point.u, point.factor)

    def tangent(self, point: ArcPoint, along: np.ndarray) -> np.ndarray:
        """Unit tangent at a converged point in the sense of ``along``, while its set stays.

        Raises SingularMatrixError.
        """
        return self._rates(point, along)[0]

    def corner(self, point: ArcPoint, tangent: np.ndarray) -> tuple[float, np.ndarray]:
        """Travel at which the set changes first along the tangent, and the unit tangent behind that.

        Behind it the candidate that has lost its pressure leaves the foundation, or the one that has touched is
        pressed: that is the sense of the tangent on the changed set. Where it leads back, the path turns there, with a
        regular tangent on both sets.  Raises SingularMatrixError.
        """
        x, (along, pressing) = np.append(point.u, point.factor), self._rates(point, tangent)
        closing = self._closing(x, along)
        left = np.where(point.active, point.pressure, self.problem.gap(x))
        rate = np.where(point.active, pressing, closing)
        until = np.full(len(left), np.inf)
        until[rate < 0] = np.maximum(left[rate < 0], 0.0) / -rate[rate < 0]
        changes = int(np.argmin(until))
        active = point.active.copy()
        active[changes] ^= True
        behind, pressing = self._rates(replace(point, active=active), tangent)
        sense = pressing[changes] if active[changes] else self._closing(x, behind)[changes]
        return point.factor + float(until[changes] * along[-1]), np.copysign(1.0, sense) * behind

    def _closing(self, x: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Rates of the gaps (m,) along a direction of (m u, t)."""
        return np.asarray(self.problem.gap_jacobian(x) @ np.append(direction[:-1] / self.m, direction[-1]))

    def _rates(self, point: ArcPoint, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The unit tangent on the set of the point, and the rates of the pressures (m,) along it."""
        x = np.append(point.u, point.factor)
        problem = self._bordered(along / np.linalg.norm(along), x)
        run = NewtonRun(problem, self.algorithm.epsilon, tally=self.tally)
        A, b = problem.stiffness(run.linearise(x, None), x, point.pressure), np.zeros_like(x)
        b[-1] = _size(A)
        rate, pressing = run.response(x, A, np.flatnonzero(point.active), b)
        rate[:-1] *= self.m
        size = float(np.linalg.norm(rate))
        return rate / size, pressing / size

    def on_plane(self, start: ArcPoint, guess: np.ndarray, normal: np.ndarray, event: str) -> ArcPoint | None:
        """The point on the plane through ``guess`` with the given normal, from the converged ``start``; None if none.

        A point that a candidate reaches through the foundation is none.
        ``event`` heads its rows of history.
        """
        problem = self._bordered(normal, np.append(guess[:-1] / self.m, guess[-1]))
        begin = ContactSolution(np.append(start.u, start.factor), start.pressure, start.active, Outcome.CONVERGED)
        solution = answered(self.algorithm, problem, begin)
        passed = (
            crossings(problem.standing, begin.u, problem.standing, solution.u) if solution.outcome.converged else []
        )
        t = float(solution.u[-1])
        rows: list[dict[str, object]] = [
            {"parameter": t, "iteration": i, **row} for i, row in enumerate(solution.history)
        ]
        if rows:
            rows[0].setdefault("event", Event(EventKind.POINT, event))
        if passed:
            rows = rows or [{"parameter": t}]
            rows[-1]["event"] = Event(EventKind.FAILED | EventKind.PASSED, str(passed[0]))
        self.tally.add(replace(solution, history=tuple(rows)))
        if passed or not solution.outcome.converged:
            return None
        spent = int(solution.counters.get("newton_iterations", 0))
        return self.counted(ArcPoint(solution.u[:-1], t, spent, pressure=solution.pressure, active=solution.active))

    def counted(self, point: ArcPoint) -> ArcPoint:
        """The point with the number of negative eigenvalues of the tangent there, at fixed travel."""
        for what in ("assemblies", "factorisations"):
            self.tally.counters[what] += 1
        count = negative_eigenvalues(self.problem_at(point.factor), point.state, self.algorithm.epsilon)
        return replace(point, negative=count)

    def _bordered(self, normal: np.ndarray, through: np.ndarray) -> ContactProblem:
        """The problem with the plane through the given (u, t) for its last row, in the size of the others."""
        row, body = np.append(self.m * normal[:-1], normal[-1]), self.problem.linearise

        def linearise(x: np.ndarray, memory: object) -> Linearisation:
            lin = body(x, memory)
            size, residual = _size(lin.tangent), lin.residual.copy()
            residual[-1] = size * (row @ (x - through))
            # room for all that a set may bring: a pattern that stays is analysed once
            n = len(row) - 1
            last = sparse.csr_matrix((size * row, np.arange(n + 1), np.array([0, n + 1])), shape=(1, n + 1))
            beside = sparse.csc_matrix((np.zeros(n), np.arange(n), np.array([0, n])), shape=(n, 1))
            K = sparse.csc_matrix(sparse.vstack([sparse.hstack([lin.tangent[:-1, :-1], beside]), last], format="csc"))
            return Linearisation(residual, K, lin.scale, lin.remember)

        return replace(self.problem, linearise=linearise)


def _size(K: sparse.csc_matrix) -> float:
    """Mean size of the diagonal of the body."""
    return float(np.mean(np.abs(K.diagonal()[:-1])))
