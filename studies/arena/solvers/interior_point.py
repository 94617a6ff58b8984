"""Interior point on the candidates: Mehrotra's predictor and corrector at each Newton step, finished exactly."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import ClassVar

import numpy as np
from scipy.linalg import lapack

from contact.catalogue import ALGORITHMS
from contact.events import Event, EventKind
from contact.newton.condensed import Condensed
from contact.newton.loop import Decide, Step, iterate, settle_set
from contact.newton.solves import holdable
from contact.newton.step import Iterate, NewtonRun
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution
from contact.solvers.lcp_pivoting import unit
from studies.arena.solvers.entry import Entry

MOST = 60  # iterations: 2 to 20 where the path exists
SPENT, PROGRAMMES = "interior_point_iterations", "interior_point_programmes"


@dataclass(frozen=True)
class InteriorPoint(Entry):
    """0 < z, 0 < w = M z + q, z w = mu to zero on the candidates of a linearised step; then exact steps on its set.

    M and q are those of the candidates whose state the expected set has wrong, with their neighbourhood, joined by
    those that the answer misplaces: z is a force outside that set and a slack in it, w the other of the two
    (Condensed). All else is eliminated by one sparse factorisation; an iteration is a dense one with two solutions::

        (M + diag(w/z)) dz = t/z - (M z + q),    w + dw = M (z + dz) + q

    with t = 0 to predict, and with t = sigma mu - dz dw of what was predicted to correct, sigma = (mu'/mu)^3. Steps go
    ``boundary`` of the way to zero, z and w alike. The set is where z > w once the mean of z w is ``complementarity``;
    at 1e-3 exact steps correct it, on thin strips at most candidates, without another factorisation; at 1e-8, by twice
    the iterations, at few.
    Where M is monotone, symmetric or not, there is a path to follow: exchanging states keeps that. A tangent that is
    indefinite on the candidates may have none: the set is left to the exact steps then, and the history says so.
    Sources: Mehrotra, SIAM J. Optim. 2 (1992) 575-601; Wright, Primal-Dual Interior-Point Methods (1997), chapter 8;
    condensed the other way round, on displacements: Petrides et al. (2025), arXiv:2505.18576, with MFEM.
    """

    boundary: float = 0.99
    complementarity: float = 1e-3
    name: ClassVar[str] = "interior-point"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("boundary", "share of the way to zero that a step may go", low=0.5, high=0.99999),
        Parameter("complementarity", "mean z w of the answer, in units of the largest q", low=1e-14, high=0.1),
    )

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs one force per candidate: lumped coupling, and an area for every candidate."""
        if not holdable(problem):
            return "it needs lumped coupling and an area for every candidate: each pressure a force of its own"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Newton from ``start`` on linearised problems whose sets an interior point finds."""
        run = self.run(problem)
        run.tally.counters |= {SPENT: 0, PROGRAMMES: 0}
        return iterate(run, start, self._step, self.max_iterations)

    def _step(self, run: NewtonRun, at: Iterate) -> Step:
        linear, substitutes = run.linear(at.lin, at.u, at.pressure, at.active), list[Event]()
        assert isinstance(linear, Condensed)  # ensured by supports

        def decide(M: np.ndarray, q: np.ndarray, base: np.ndarray, left: np.ndarray) -> np.ndarray:
            with run.tally.timed("contact_s"):
                central = central_path(M, q, self.complementarity, self.boundary)
            run.tally.counters[SPENT] += central.iterations
            run.tally.counters[PROGRAMMES] += 1
            if not central.ended:
                text = f"no end of the path in {central.iterations} iterations: the set is left to exact steps"
                substitutes.append(Event(EventKind.SUBSTITUTE, text))
            return (central.z > central.w) & central.ended

        claimed, linear = _with_neighbours(run, at, linear, decide)
        step = settle_set(run, at, claimed, linear=linear)
        wrong = int(np.sum(claimed ^ step.active))
        if wrong:
            substitutes.append(Event(EventKind.SUBSTITUTE, f"set of the interior point corrected at {wrong} nodes"))
        events = [*substitutes, *([step.event] if step.event else [])]
        return replace(step, event=reduce(add, events) if events else None, updates=0)


def _with_neighbours(run: NewtonRun, at: Iterate, linear: Condensed, decide: Decide) -> tuple[np.ndarray, Condensed]:
    """The set (m,) that ``decide`` makes of the misplaced candidates and of those that are near to being so.

    Near are candidates whose pressure, or gap, is at most the mean violation of the misplaced ones of the same state.
    If only the misplaced were decided, the set would change by one row of elements with each programme, and the number
    of programmes would grow with the mesh.
    """
    active, decided = linear.base, np.zeros(len(at.gap), bool)
    while True:
        linear = linear.near(active)
        gap, pressure = linear.foreseen(active)
        way = max(at.length, float(np.max(np.abs(gap - at.gap), initial=0.0)))
        reached = replace(at, gap=gap, pressure=pressure, active=active, length=way)
        wrong, margin = run.misplaced(reached, solved=True), np.where(active, pressure, gap)
        decided |= active ^ linear.base
        if not np.any(wrong & ~decided):
            return active, linear
        for side in (active, ~active):
            if np.any(wrong & side):
                decided |= side & (margin <= -np.mean(margin[wrong & side]))
        nodes = np.flatnonzero(decided)
        changed = decide(*linear.block(nodes), linear.base[nodes], (active ^ linear.base)[nodes])
        active = linear.base.copy()
        active[nodes[changed]] ^= True


@dataclass(frozen=True, eq=False)
class Central:
    """z, w (n,) in units in which their scales are alike, iterations, and whether the end of the path was reached."""

    z: np.ndarray
    w: np.ndarray
    iterations: int
    ended: bool


def central_path(M: np.ndarray, q: np.ndarray, complementarity: float = 1e-3, boundary: float = 0.99) -> Central:
    """The path of w = M z + q, z w = mu (n,), in units of a unit diagonal and the largest |q|.

    It is entered where it would be at mu = mean(q^2) were M the identity: w - z = q, z w = mu.
    M (n, n): monotone, v.M.v >= 0, or there may be no path.
    """
    size, n = unit(M), len(q)
    M, q = size[:, None] * M * size, size * q / (float(np.max(np.abs(size * q))) or 1.0)
    apart = np.sqrt(q * q + 4 * (float(np.mean(q * q)) or 1.0))  # w + z
    z, w = (apart - q) / 2, (apart + q) / 2
    for iteration in range(MOST):
        mu, off = float(z @ w) / n, M @ z + q - w
        if mu <= complementarity and np.max(np.abs(off)) <= complementarity:
            return Central(z, w, iteration, True)
        spend(DENSE_PIVOTS, dense_solution(n, 2) + 4.0 * M.size)
        lu, pivots, singular = lapack.dgetrf(M + np.diag(w / z))
        if singular or not np.isfinite(mu):
            return Central(z, w, iteration, False)
        correction = np.zeros(n)
        for share in (1.0, boundary):  # to predict, to correct
            dz = lapack.dgetrs(lu, pivots, correction / z - (w + off))[0]
            dw = M @ dz + off
            x, dx = np.append(z, w), np.append(dz, dw)
            length = min(1.0, share * float(np.min(x[dx < 0] / -dx[dx < 0], initial=np.inf)))
            foreseen = float((z + length * dz) @ (w + length * dw)) / n
            correction = min(foreseen / mu, 1.0) ** 3 * mu - dz * dw
        z, w = z + length * dz, w + length * dw
    return Central(z, w, MOST, False)


ALGORITHMS[InteriorPoint.name] = InteriorPoint
