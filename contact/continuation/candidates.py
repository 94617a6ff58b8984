"""Where a step of a path sets out from, the candidates that it can bring into contact, and what an attempt was worth.

A start may be the state at the same parameter on another grid, which is near. It changes how many iterations a state
takes, and neither the problem nor what a path remembers: slips are counted from the last state of the path itself.
Candidates that cannot touch are left out of a step, and looked at afterwards: how it is solved is the business of the
algorithm, which does not see that anything was left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.algorithms.base import answered
from contact.events import Event, EventKind
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearised

State = tuple[float, ContactSolution]  # of a path, with its parameter
EASY_ITERATIONS = 12  # a step with no more Newton iterations than this lets the next one double


@dataclass(frozen=True, eq=False)
class Start:
    """u (n,), pressures and set (m,) to set out from.

    memory: of the linearisation at u, where nothing else is remembered.  traction (m, 2) [MPa], state (m,): of
    friction, None without it.
    """

    u: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    memory: object = None
    traction: np.ndarray | None = None
    state: np.ndarray | None = None

    def instead_of(self, last: ContactSolution, weights: np.ndarray) -> ContactSolution:
        """The start, with what the path remembers at its ``last`` state; weights (m,) [mm^2] of the candidates."""
        rubbed = last.friction
        if rubbed is not None and self.traction is not None and self.state is not None:
            rubbed = replace(rubbed, force=weights[:, None] * self.traction, state=self.state)
        return replace(last, u=self.u, pressure=self.pressure, active=self.active, friction=rubbed)

    def remembered(self, problem: ContactProblem) -> ContactProblem:
        """The problem whose linearisation at the start has its memory."""
        if self.memory is None:
            return problem
        only, linearise = problem.only, problem.linearise

        def at(u: np.ndarray, memory: object) -> Linearised:
            begins = memory is None and np.array_equal(u, self.u)
            return linearise(u, self.memory if begins else memory)

        def chosen(which: np.ndarray) -> ContactProblem:
            assert only is not None
            return self.remembered(only(which))

        return replace(problem, linearise=at, only=None if only is None else chosen)


Starts = Callable[[int, State, float], Start | None]  # index of the requested point, last state, parameter of the next


def none_known(index: int, last: State, parameter: float) -> Start | None:
    """Every step sets out from the last state of the path."""
    return None


def after_in_vain(vain: ContactSolution, answer: ContactSolution, why: Event) -> ContactSolution:
    """What was found from the last state of the path, after a start from elsewhere that has led to none."""
    counters = {key: vain.counters.get(key, 0) + value for key, value in answer.counters.items()}
    *rows, last = vain.history or ({},)
    event = Event(EventKind.FAILED, f"not from the state of another grid: {why}; from the last of the path")
    return replace(answer, counters=counters, history=(*rows, {**last, "event": event}, *answer.history))


REACH = 1.0  # of the deepest penetration at the start of the step: who is nearer than that may touch


def solve_within_reach(
    algorithm: ContactAlgorithm, problem: ContactProblem, start: ContactSolution, nearer: Start | None = None
) -> ContactSolution:
    """The solution with only those candidates that can touch from ``start`` on, where the problem tells how to choose.

    nearer: what is set out from instead, if anything is known.
    A foundation that has come by d penetrates by no more than d. A gap changes by no more than its point moves, so one
    above d stays open unless its point moves by more than the foundation has: that is looked at when the step is
    solved. Who did is taken in, and the step goes on from there: the answer is that with all candidates. With friction
    a foundation that slides along itself by d may take points as far along.
    """
    gap = problem.gap(start.u)
    depth = max(-float(np.min(gap, initial=0.0)), _slid(problem, start))
    reached = (gap <= REACH * depth) | start.active
    if nearer is not None:
        start, problem = nearer.instead_of(laid(problem, start), problem.weights), nearer.remembered(problem)
    if problem.only is None or depth <= 0:
        return answered(algorithm, problem, start)
    start = laid(problem, start)
    chosen = reached | start.active
    before: ContactSolution | None = None
    while True:
        kept = {name: getattr(problem, name) for name in ("gap_size", "ordered", "driven", "multipliers")}
        near = replace(problem.only(chosen), **kept)
        at = start if before is None else before
        rubbed = None if start.friction is None else start.friction.only(chosen)
        begin = replace(at, pressure=at.pressure[chosen], active=at.active[chosen], friction=rubbed)
        spread = _spread(problem, answered(algorithm, near, begin), chosen, before)
        missed = ~chosen & (problem.gap(spread.u) < 0)
        if not (spread.outcome.converged and missed.any()):
            return spread
        *rows, last = spread.history or ({},)
        message = f"{int(missed.sum())} candidates that were left out penetrate: they are taken in"
        event = Event(EventKind.TAKEN_IN, message)
        before = replace(spread, history=(*rows, {**last, "event": event}))
        chosen |= missed


def laid(problem: ContactProblem, start: ContactSolution) -> ContactSolution:
    """The start with its places as anchors, from which all slip is counted, whoever is taken in later.

    Who is in contact and has never rubbed sticks.
    """
    if problem.coulomb is None or problem.coulomb.sliding is None or start.friction is not None:
        return start
    from contact.coulomb import Friction  # no solve without friction loads it

    places = problem.coulomb.sliding.places(start.u)
    return replace(start, friction=Friction(np.zeros((len(places), 2)), start.active.astype(np.int8), places, places))


def _slid(problem: ContactProblem, start: ContactSolution) -> float:
    """How far [mm] the foundation has slid under a body with friction that stays where it is."""
    if problem.only is None or problem.coulomb is None or problem.coulomb.sliding is None or start.friction is None:
        return 0.0
    way = problem.coulomb.sliding.places(start.u) - start.friction.anchors
    return float(np.max(np.linalg.norm(way, axis=1), initial=0.0))


def _spread(
    problem: ContactProblem, part: ContactSolution, chosen: np.ndarray, before: ContactSolution | None
) -> ContactSolution:
    """The solution for all candidates (m,); counters and history go on from those of the attempt before it."""
    pressure, active = np.zeros(len(chosen)), np.zeros(len(chosen), bool)
    pressure[chosen], active[chosen] = part.pressure, part.active
    counters, history = part.counters, part.history
    if before is not None:
        counters = {key: before.counters.get(key, 0) + value for key, value in counters.items()}
        history = (*before.history, *history)
    friction = part.friction
    if friction is not None and problem.coulomb is not None and problem.coulomb.sliding is not None:
        friction = friction.of_all(chosen, problem.coulomb.sliding.places(part.u))
    return replace(part, pressure=pressure, active=active, counters=counters, history=history, friction=friction)


@dataclass(frozen=True)
class Good:
    """The steps that were accepted on a path: their number and their factorisations."""

    steps: int = 0
    factorisations: float = 0.0

    @property
    def each(self) -> float:
        """Factorisations of a good step: their mean, but no fewer than those of one that counts as easy."""
        return max(self.factorisations / max(self.steps, 1), EASY_ITERATIONS)

    def after(self, solution: ContactSolution) -> Good:
        """With one step more."""
        return Good(self.steps + 1, self.factorisations + factorisations(solution))


@dataclass(frozen=True, eq=False)
class Attempt:
    """A step to ``parameter``: what the algorithm makes of it, and why that is not a state of the path, or None.

    beyond: more negative eigenvalues than the path has had.  moved: |du| of the step.
    """

    parameter: float
    solution: ContactSolution
    failure: Event | None
    beyond: int = 0
    moved: float = 0.0


def factorisations(solution: ContactSolution) -> float:
    """All that it took."""
    return solution.counters.get("factorisations", 0.0)


def why(failed: ContactSolution) -> Event:
    """The outcome, with what the algorithm itself has said of it."""
    said = failed.history[-1].get("event") if failed.history else None
    if said is None:
        return Event(EventKind.FAILED, failed.outcome.value)
    return Event(EventKind.FAILED | said.kind, f"{failed.outcome.value} ({said})")
