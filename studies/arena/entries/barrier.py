"""Barrier with crossover: gaps stay open on the way, and exact steps finish from the set that they tell."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.algorithms.base import NewtonAlgorithm
from contact.catalogue import ALGORITHMS
from contact.events import Event, EventKind
from contact.newton.loop import iterate, settle_most
from contact.newton.state import Iterate
from contact.newton.step import NewtonRun
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError, added
from studies.scene import Setting

BOUNDARY = 0.9  # of the way to s = 0, and to p = 0, that a step may go
FULL = 0.5  # a step that goes so far, or farther, lets mu fall
COME = 1e-3  # of the reach: the foundation is where it belongs
SETTLE = 0.05  # of the exact steps, as semismooth
SPENT = "barrier_iterations"


@dataclass(frozen=True)
class Barrier(NewtonAlgorithm):
    """r(u) = G^T W p with p = -kappa b'(s), IPC's clamped barrier b on gaps s > 0, as kappa falls; then exact steps.

    b = -(s - d)^2 ln(s/d) up to s = d and 0 beyond, so that p s = mu phi(s/d), mu = kappa d^2::

        K du - G^T W p = -r,    p = mu phi/s - D (G du + ds),    D = max(p, mu phi/s)/s,    phi(x) = -x b'(x), d = 1

    is the Newton step with phi as it is; D, of the pressures before, gives it the few steps of a primal-dual method.
    A foundation that has come, or that touches, stands back by sigma, s = g + sigma, and comes on by ds = -sigma as the
    body yields. The filter shortens each step until no s is less than a twentieth of what it was; mu falls by
    ``reduction`` after each that goes half of its way.
    Once mu is ``crossover`` of the first, the set is where p > c s, and exact steps settle and correct it there.
    reach: d over the depth h to which the first linearised step enters the foundation when nothing resists; the first
    mu is c h d, with the stiffness per area c of all candidates that do.
    Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020) 49; Wright, Primal-Dual
    Interior-Point Methods (1997), for D and the fraction to the boundary.
    """

    reach: float = 0.1
    reduction: float = 0.1
    crossover: float = 2e-3
    name: ClassVar[str] = "barrier"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("reach", "of the barrier, over the depth that a step without it enters", low=1e-6, high=10),
        Parameter("reduction", "of the barrier from one full step to the next", low=1e-3, high=0.9),
        Parameter("crossover", "share of the first barrier at which the set is read off", low=1e-12, high=1),
    )

    def __post_init__(self) -> None:
        """Raises ValueError with the value and its range."""
        for parameter in self.parameters:
            Setting.of(parameter, None).parse(getattr(self, parameter.key))

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs the exact constraint: gaps that stay open have no penetration p/epsilon."""
        if np.isfinite(self.epsilon):
            return "its gaps stay open: epsilon must be infinite; a finite one is the business of regularised"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """By the barrier from ``start``, and by exact steps from where that ends."""
        run = self.run(problem)
        run.tally.counters[SPENT] = 0
        at = run.at(run.linearise(start.u, None), start.u, start.pressure, start.active)
        told = "the travel is an unknown, no barrier has it" if problem.driven else ""
        if not (problem.driven or _answered(run, at)):
            try:
                for reached in self._approach(run, at):
                    at = reached
                    run.tally.counters[SPENT] += 1
            except SingularMatrixError as error:
                told = str(error)
        near = ContactSolution(at.u, np.where(at.active, at.pressure, 0.0), at.active, Outcome.CONVERGED)
        row, settle = len(run.tally.history), partial(settle_most, settle=SETTLE, most=self.max_updates)
        solution = iterate(run, near, settle, self.max_iterations, lin=at.lin)
        if told:
            event, also = Event(EventKind.SUBSTITUTE, f"exact steps alone: {told}"), run.tally.history[row].get("event")
            run.tally.tell(event + also if isinstance(also, Event) else event, row)
        return solution

    def _approach(self, run: NewtonRun, at: Iterate) -> Iterator[Iterate]:
        """The iterates of the barrier, up to the one whose set is read off; raises SingularMatrixError."""
        depth, c = _scales(run, at)
        if depth <= 0:
            return
        d = self.reach * depth
        first = mu = c * depth * d
        sigma = max(float(np.max(-at.gap)), 0.0) + d / 2
        pressure, noted = np.maximum(at.pressure, 0.0), at.active
        for _ in range(self.max_iterations):
            s = at.gap + sigma
            barrier = mu * clamped(s / d) / s
            pressure = np.maximum(pressure, barrier)
            springs, rows = pressure / s, run.problem.gap_jacobian(at.u)
            du = _sprung(run, at, pressure, springs)(barrier + springs * sigma)
            ds = rows @ du - sigma
            share = min(1.0, BOUNDARY * float(np.min(s[ds < 0] / -ds[ds < 0], initial=np.inf)))
            while np.any(run.problem.gap(at.u + share * du) + (1 - share) * sigma < (1 - BOUNDARY) / 2 * s):
                share /= 2
            pressure = np.maximum(barrier - springs * ds, (1 - BOUNDARY) * pressure)
            sigma *= 1 - share
            run.tally.note(at.residual, at.active, noted)
            noted = at.active
            at = run.advance(at, share * du, pressure, pressure > c * (s + share * ds))
            yield at
            if np.isinf(at.residual) or (mu <= self.crossover * first and sigma <= COME * d):
                return
            if share >= FULL:
                mu *= self.reduction


def clamped(x: np.ndarray) -> np.ndarray:
    """phi = -x b'(x) of b = -(x - 1)^2 ln x: 1 for x = 0, and 0 from x = 1 on with a continuous slope."""
    x = np.clip(x, np.finfo(float).tiny, 1.0)
    return np.asarray((1 - x) ** 2 - 2 * x * (1 - x) * np.log(x))


def _sprung(
    run: NewtonRun, at: Iterate, pressure: np.ndarray, springs: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """What gives du (n,) of (K + G^T W D G) du = G^T W q - r, with springs D (m,), for pressures q (m,) at du = 0.

    Raises SingularMatrixError.
    """
    problem = run.problem
    with run.tally.timed("contact_s"):
        push = sparse.csc_matrix(problem.push(at.u).T @ problem.weight_matrix)
        change = sparse.csc_matrix(push @ sparse.diags_array(springs) @ problem.gap_jacobian(at.u))
        matrix = added(problem.stiffness(at.lin, at.u, pressure), change)
    factor = run.factorise(matrix)
    return lambda load: run.solution(factor, matrix, push @ load - at.lin.residual)


def _answered(run: NewtonRun, at: Iterate) -> bool:
    """Whether there is nothing to solve, or no candidate."""
    return len(at.gap) == 0 or (run.balanced(at) and run.closed(at) and not run.misplaced(at).any())


def _scales(run: NewtonRun, at: Iterate) -> tuple[float, float]:
    """The depth [mm] that a step enters the foundation if nothing new resists, and the stiffness per area of who does.

    Candidates of the set are held by springs of their own stiffness. The depth is 0 where no candidate is concerned.
    Raises SingularMatrixError.
    """
    rows, own = run.problem.gap_jacobian(at.u), at.stiffness.per_area or 1.0
    held = np.where(at.active, own, 0.0)
    step, before = _sprung(run, at, at.pressure, held), np.where(at.active, at.pressure - held * at.gap, 0.0)
    free = rows @ step(before)
    pressed = at.active | (at.gap + free < 0)
    if not pressed.any():
        return 0.0, own
    depth = max(float(np.max(np.abs(at.gap + free)[pressed])), float(np.max(-at.gap)))
    give = float(np.mean((rows @ step(before + pressed) - free)[pressed]))
    load = float(np.max(at.pressure)) / depth if depth > 0 else 0.0
    return depth, max(1 / give if give > 0 else own, load)


ALGORITHMS[Barrier.name] = Barrier
