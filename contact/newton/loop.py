"""Newton on the contact problem linearised as a whole: the shared loop of all algorithms that solve such a step.

The step is K du - G^T W p = -r with 0 <= p, 0 <= g + G du + p/epsilon, and their product zero. Who solves it, and how
exactly, is the algorithm's business. Its Newton converges like Newton without contact: the number of iterations does
not grow with the mesh, because no node waits for the next linearisation to leave a set that the last one got wrong.
Source: Josephy, MRC Report 1965, University of Wisconsin (1979); for its use as a globalisation, measured here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.events import Event, EventKind
from contact.newton.condensed import Condensed
from contact.newton.state import Iterate
from contact.newton.step import LinearStep, NewtonRun
from contact.problem import ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError

FEW_UPDATES = 12  # of the set on one linearisation, a factorisation each, unless it is the last to decide
MOST_UPDATES = 60  # on one linearisation, and beyond one an iteration in all of a solve; releases are not counted
CYCLE = Event(EventKind.CYCLE, "cycle detected: from here on only the first violating node is swapped")


class StepError(ArithmeticError):
    """The linearised contact problem was not solved: outcome and the reason for the history."""

    def __init__(self, outcome: Outcome, reason: str) -> None:
        super().__init__(reason)
        self.outcome = outcome


@dataclass(frozen=True, eq=False)
class Step:
    """What solves the linearised problem: du (n,), pressure (m,), set (m,) bool; ``event`` goes into the history.

    updates: of the set, after the first one, that did more than release nodes.
    """

    du: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    event: Event | None = None
    updates: int = 0


StepSolver = Callable[[NewtonRun, Iterate], Step]


def iterate(
    run: NewtonRun, start: ContactSolution, solve_step: StepSolver, max_iterations: int, c: float = 1.0
) -> ContactSolution:
    """From ``start`` until the set repeats and the forces balance; c [MPa/mm] weighs pressure against gap.

    Iterations that only release nodes do not count against ``max_iterations``.
    """
    at = run.at(run.linearise(start.u, None), start.u, start.pressure, start.active)
    noted, counted, updates, begun = at.active, 0, 0, set[bytes]()
    event: Event | None = None
    while True:
        expected = at.active ^ run.misplaced(at, c)
        run.tally.note(at.residual, expected, noted, event)
        noted = expected
        if np.isinf(at.residual):
            return run.finish(at, Outcome.DIVERGED)
        settled = np.array_equal(expected, at.active) and run.closed(at)
        if settled and run.balanced(at):
            return run.finish(at, Outcome.CONVERGED)
        if settled and run.stuck(at):
            return run.finish(at, Outcome.ROUNDING)
        counted += not _only_released(at.active, expected)
        if counted > max_iterations:
            return run.finish(at, Outcome.ITERATION_LIMIT)
        again = expected.tobytes() in begun
        begun.add(expected.tobytes())
        try:
            step = solve_step(run, replace(at, active=expected, again=again, updates=updates))
        except (SingularMatrixError, StepError) as error:
            run.tally.tell(Event(EventKind.FAILED, str(error)))
            return run.finish(at, error.outcome if isinstance(error, StepError) else Outcome.SINGULAR)
        at = run.advance(at, step.du, step.pressure, step.active)
        event, updates = step.event, updates + step.updates


def settle_most(run: NewtonRun, at: Iterate, settle: float, c: float = 1.0, most: int = MOST_UPDATES) -> Step:
    """The step on the set that the linearised problem keeps, up to the fraction ``settle`` of it.

    Two iterations that begin with the same set are a cycle, or the end: what is left to settle is settled there.
    A path that has no next state would go on like that for hundreds of factorisations: ``most`` updates end it.
    Raises StepError, SingularMatrixError.
    """
    if at.updates > most:
        raise StepError(Outcome.ITERATION_LIMIT, f"the set was updated {at.updates} times beyond one an iteration")
    again = settle < 1 and at.again
    return settle_set(run, at, at.active, 0.0 if again else settle, c, last=again, most=most)


def settle_set(
    run: NewtonRun,
    at: Iterate,
    active: np.ndarray,
    settle: float = 0.0,
    c: float = 1.0,
    *,
    last: bool = True,
    most: int = MOST_UPDATES,
    linear: LinearStep | None = None,
) -> Step:
    """Update the set on one linearisation, from ``active`` (m,), until at most the fraction ``settle`` of it changes.

    linear: the linearisation, where it is factorised already.
    If this is the ``last`` linearisation to decide the set, a cycle is answered by swapping only the first misplaced
    node: finite for a P-matrix. Otherwise, and after very many updates, the step is returned as it is: a tangent far
    from equilibrium may have no consistent set, and another one is not far.
    Raises SingularMatrixError.
    """
    linear, seen = linear or run.linear(at.lin, at.u, at.pressure, active), set[bytes]()
    event: Event | None = None
    most, updates = most if last else min(most, FEW_UPDATES), 0
    while True:
        wrong = _misplaced(run, at, linear, active, c)
        after = active ^ wrong
        seen.add(active.tobytes())
        cycling = event is not None or after.tobytes() in seen
        enough = wrong.sum() <= settle * (active | after).sum()
        if enough or updates == most or (cycling and not last):
            return Step(*linear.step(active), active, event, updates)
        if cycling:
            event, after = CYCLE, active ^ first_of(wrong)
        updates += not _only_released(active, after)
        active = after


Decide = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]  # M (c, c), q (c,), base (c,) -> (c,) bool


def decide_set(run: NewtonRun, at: Iterate, linear: Condensed, decide: Decide) -> Step:
    """The step on the set that ``decide`` makes of the misplaced candidates, joined by others until there are none.

    decide: of candidates that the linear complementarity problem w = M z + q is about, those with z > 0: their state is
    not the one that they have in the set of ``linear``. A candidate that was decided is decided again with every later
    one, never alone.
    Raises what decide and the linearisation raise.
    """
    decided, active = np.zeros(len(at.gap), bool), linear.base
    while True:
        wrong = _misplaced(run, at, linear, active) & ~decided
        if not wrong.any():
            return Step(*linear.step(active), active)
        decided |= wrong
        nodes = np.flatnonzero(decided)
        changed = decide(*linear.block(nodes), linear.base[nodes])
        active = linear.base.copy()
        active[nodes[changed]] ^= True


def _misplaced(run: NewtonRun, at: Iterate, linear: LinearStep, active: np.ndarray, c: float = 1.0) -> np.ndarray:
    """Candidates (m,) on the wrong side after the step on the set ``active``."""
    gap, pressure = linear.foreseen(active)
    return run.misplaced(replace(at, gap=gap, pressure=pressure, active=active), c, solved=True)


def first_of(wrong: np.ndarray) -> np.ndarray:
    """The set (m,) of only the first member: Murty's least-index rule, finite for every P-matrix."""
    only = np.zeros_like(wrong)
    only[np.argmax(wrong)] = True
    return only


def _only_released(before: np.ndarray, after: np.ndarray) -> bool:
    return bool(np.any(before & ~after) and not np.any(after & ~before))
