"""Newton on the contact problem linearised as a whole: the shared loop of all algorithms that solve such a step.

The step is K du - G^T W p = -r with 0 <= p, 0 <= g + G du + p/epsilon, and their product zero. Who solves it, and how
exactly, is the algorithm's business. Its Newton converges like Newton without contact: the number of iterations does
not grow with the mesh, because no node waits for the next linearisation to leave a set that the last one got wrong.
Source: Josephy, MRC Report 1965, University of Wisconsin (1979); for its use as a globalisation, measured here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from contact.events import Event, EventKind
from contact.newton.solves import LinearStep, Substituted
from contact.newton.step import Iterate, NewtonRun
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.problem import ContactSolution, Linearised, Outcome
from contact.solvers.sparse import SingularMatrixError

if TYPE_CHECKING:  # loaded with candidates alone
    from contact.newton.condensed import Condensed

FEW_UPDATES = 12  # of the set on one linearisation, unless it is the last to decide; none counts that makes it smaller
MOST_UPDATES = 60  # on the last one, and beyond one an iteration in all of a solve
CREEPING = 2  # steps in succession that leave some of the set to settle, after which the next one leaves none
LAST_ATTEMPTS = 4  # linearised problems solved to the end once so many updates have not settled the set
CYCLE = Event(EventKind.CYCLE, "cycle detected: from here on only the first violating node is swapped")
PIVOTS = Event(EventKind.CYCLE, "cycle detected, or no end in sight: the linearised problem was solved by pivots")


class StepError(ArithmeticError):
    """The linearised contact problem was not solved: outcome and the reason for the history."""

    def __init__(self, outcome: Outcome, reason: str) -> None:
        super().__init__(reason)
        self.outcome = outcome


@dataclass(frozen=True, eq=False)
class Step:
    """What solves the linearised problem: du (n,), pressure (m,), set (m,) bool; ``event`` goes into the history.

    updates: of the set, after the first one, that have not made it smaller.  left: whether the linearised problem has
    another set.
    """

    du: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    event: Event | None = None
    updates: int = 0
    left: bool = False


StepSolver = Callable[[NewtonRun, Iterate], Step]


def iterate(
    run: NewtonRun,
    start: ContactSolution,
    solve_step: StepSolver,
    max_iterations: int,
    c: float = 1.0,
    lin: Linearised | None = None,
) -> ContactSolution:
    """From ``start`` until the set repeats and the forces balance; c [-] as for :meth:`NewtonRun.misplaced`.

    Iterations that only release nodes, and none that an earlier one has released, do not count against
    ``max_iterations``. Between two others there are no more of them than candidates.  lin: of the start, where known.
    Without candidates there is no set to choose, and nothing to condense: ``solve_step`` is not asked.
    """
    solve_step = solve_step if len(run.problem.weights) else _alone
    at = run.at(lin or run.linearise(start.u, None), start.u, start.pressure, start.active)
    noted, counted, updates, short, begun = at.active, 0, 0, 0, set[bytes]()
    released: np.ndarray | None = None  # what is left of the set since the last iteration that counts
    event: Event | None = None
    last: Iterate | None = None
    while True:
        expected = at.active ^ run.misplaced(at, c)
        run.tally.note(at.residual, expected, noted, event)
        noted = expected
        if np.isinf(at.residual):
            return run.finish(at, Outcome.DIVERGED)
        settled = np.array_equal(expected, at.active) and run.closed(at)
        known = run.known(at, last) if settled and run.balanced(at) else None
        if known is not None:
            return run.finish(known, Outcome.CONVERGED)
        if settled and run.stuck(at):
            return run.finish(at, Outcome.ROUNDING)
        if only_released(at.active, expected) and (released is None or only_released(released, expected)):
            released = expected
        else:
            counted, released = counted + 1, None
        if counted > max_iterations:
            endless = event is not None and EventKind.FAILED in event.kind
            return run.finish(at, Outcome.CYCLING if endless else Outcome.ITERATION_LIMIT)
        again = expected.tobytes() in begun
        begun.add(expected.tobytes())
        try:
            step = solve_step(run, replace(at, active=expected, again=again, updates=updates, short=short))
        except (SingularMatrixError, StepError) as error:
            run.tally.tell(Event(EventKind.FAILED, str(error)))
            return run.finish(at, error.outcome if isinstance(error, StepError) else Outcome.SINGULAR)
        last, at = at, run.advance(at, step.du, step.pressure, step.active)
        event, updates, short = step.event, updates + step.updates, short + 1 if step.left else 0


def _alone(run: NewtonRun, at: Iterate) -> Step:
    """Of a body without candidates: to condense none costs a small beam as much again as its steps."""
    return Step(*Substituted(run, at.lin, at.u, at.pressure).step(at.active), at.active)


def settle_most(run: NewtonRun, at: Iterate, settle: float, c: float = 1.0, most: int = MOST_UPDATES) -> Step:
    """The step on the set that the linearised problem keeps, up to the fraction ``settle`` of it.

    Two iterations that begin with the same set are a cycle, or the end: what is left to settle is settled there. Where
    every set has a linearisation of its own (``settle`` 1) only a set that comes back after another one is a cycle.
    A fraction allows the rim of a fine mesh one row of elements a linearisation, where a beam or a plate carries a line
    force and lets go of no other: once steps have left some of the set CREEPING times in succession, the next one
    leaves none. Only on a definite tangent: an indefinite one, far from equilibrium, may have sets that mean nothing.
    After ``most`` updates a few linearised problems are solved to the end. A path that has no next state would go on
    like that for hundreds of factorisations: it is given up then.
    Raises StepError, SingularMatrixError.
    """
    from contact.newton.condensed import Condensed  # loaded with candidates alone

    if at.updates > 2 * most:
        raise StepError(Outcome.ITERATION_LIMIT, f"the set was updated {at.updates} times beyond one an iteration")
    if at.updates > most:
        step = settle_exactly(run, at, run.linear(at.lin, at.u, at.pressure, at.active), at.active, c)
        return replace(step, updates=step.updates + most // LAST_ATTEMPTS)
    if at.again and (settle < 1 or came_back(at)):
        return settle_set(run, at, at.active, 0.0, c)
    linear = run.linear(at.lin, at.u, at.pressure, at.active)
    if settle < 1 and at.short >= CREEPING and isinstance(linear, Condensed) and not linear.negative_pivots():
        return settle_set(run, at, at.active, 0.0, c, most=FEW_UPDATES, linear=linear)
    return settle_set(run, at, at.active, settle, c, last=False, most=FEW_UPDATES, linear=linear)


def came_back(at: Iterate) -> bool:
    """Whether the expected set has been that of an earlier step, but not of the last one."""
    return at.again and at.stepped is not None and not np.array_equal(at.active, at.stepped)


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

    most: updates that do not make it smaller.  linear: the linearisation, where it is factorised already.
    If this is the ``last`` linearisation to decide the set, a cycle, or very many updates, are answered by solving its
    problem to the end (:func:`settle_exactly`). Otherwise, and where it has none, the step is returned as it is: a
    tangent far from equilibrium may have no consistent set, and another one is not far.
    Raises SingularMatrixError.
    """
    linear, seen = linear or run.linear(at.lin, at.u, at.pressure, active), set[bytes]()
    updates = 0
    while True:
        linear = linear.near(active)
        wrong = _misplaced(run, at, linear, active, c)
        after = active ^ wrong
        seen.add(active.tobytes())
        enough = wrong.sum() <= settle * (active | after).sum()
        cycling = after.tobytes() in seen or updates == most
        if enough or (cycling and not last):
            return Step(*linear.step(active), active, updates=updates, left=bool(wrong.any()))
        if cycling:
            try:
                return replace(settle_exactly(run, at, linear, active, c), updates=updates)
            except StepError as error:
                return Step(
                    *linear.step(active), active, Event(EventKind.CYCLE | EventKind.FAILED, str(error)), updates
                )
        updates += after.sum() >= active.sum()
        active = after


def settle_exactly(run: NewtonRun, at: Iterate, linear: LinearStep, active: np.ndarray, c: float = 1.0) -> Step:
    """The step that solves the linearised problem, from the set ``active`` (m,): finite for every P-matrix.

    Condensed on the misplaced candidates, it is a dense complementarity problem for block pivots with a safeguard, and
    for Lemke's where those give up. An indefinite tangent makes none: the problem may have no solution, and both end
    without one. Raises StepError then.
    A linearisation that is factorised anew on every set swaps the first misplaced node alone (Murty), up to
    MOST_UPDATES times beyond releases.
    Sources: Júdice, Pires, Comput. Oper. Res. 21 (1994) 587-596; Cottle, Pang, Stone, The Linear Complementarity
    Problem (1992), section 4.4; Murty, Linear Algebra Appl. 5 (1972) 65-108.
    """
    from contact.newton.condensed import Condensed  # loaded with candidates alone
    from contact.solvers.lcp_pivoting import LcpError

    if not isinstance(linear, Condensed):
        return _one_at_a_time(run, at, linear, active, c)
    try:
        return replace(decide_set(run, at, linear, _by_pivots, active)[0], event=PIVOTS)
    except LcpError as error:
        message = f"cycle detected, and pivots do not end on the linearised problem: {error}"
        raise StepError(Outcome.CYCLING, message) from None


def _one_at_a_time(run: NewtonRun, at: Iterate, linear: LinearStep, active: np.ndarray, c: float) -> Step:
    """Murty's least index on one linearisation."""
    updates = 0
    while True:
        linear = linear.near(active)
        wrong = _misplaced(run, at, linear, active, c)
        if updates == MOST_UPDATES or not wrong.any():
            return Step(*linear.step(active), active, CYCLE, updates)
        after = active ^ first_of(wrong)
        updates += not only_released(active, after)
        active = after


def _by_pivots(M: np.ndarray, q: np.ndarray, base: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Who leaves the state that it has in the base set, from a guess of it; raises LcpError."""
    from contact.solvers.lcp_pivoting import LcpError, active_set, lemke, unit  # loaded with candidates alone

    size = unit(M)
    M, q = size[:, None] * M * size, size * q
    try:
        return np.asarray(active_set(M, q, left).z > 0)
    except LcpError:
        spend(DENSE_PIVOTS, dense_solution(len(q), 0))
        if np.linalg.slogdet(M)[0] <= 0:  # no P-matrix: there may be no end to find
            raise
        return np.asarray(lemke(M, q).z > 0)


# M (c, c), q (c,), and (c,) bool: in the base set, so far in another state than there -> in another state than there
Decide = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def decide_set(
    run: NewtonRun, at: Iterate, linear: Condensed, decide: Decide, active: np.ndarray | None = None
) -> tuple[Step, Condensed]:
    """The step on the set that ``decide`` makes of the misplaced candidates, joined by others until there are none.

    With it goes the linearisation that it comes from, as it is factorised then.

    decide: of candidates that the linear complementarity problem w = M z + q is about, those with z > 0: their state is
    not the one that they have in the set of ``linear``. A candidate that was decided is decided again with every later
    one, never alone.  active (m,): the set to begin with, by default that of ``linear``.
    Raises what decide and the linearisation raise.
    """
    active = linear.base if active is None else active
    linear = linear.near(active)
    wrong = _misplaced(run, at, linear, active)
    decided = active ^ linear.base
    while wrong.any():
        decided |= wrong
        nodes = np.flatnonzero(decided)
        changed = decide(*linear.block(nodes), linear.base[nodes], (active ^ linear.base)[nodes])
        active = linear.base.copy()
        active[nodes[changed]] ^= True
        linear = linear.near(active)
        wrong = _misplaced(run, at, linear, active) & ~decided
    return Step(*linear.step(active), active), linear


def _misplaced(run: NewtonRun, at: Iterate, linear: LinearStep, active: np.ndarray, c: float = 1.0) -> np.ndarray:
    """Candidates (m,) on the wrong side after the step on the set ``active``."""
    gap, pressure = linear.foreseen(active)
    way = max(at.length, float(np.max(np.abs(gap - at.gap), initial=0.0)))
    return run.misplaced(replace(at, gap=gap, pressure=pressure, active=active, length=way), c, solved=True)


def first_of(wrong: np.ndarray) -> np.ndarray:
    """The set (m,) of only the first member: Murty's least-index rule, finite for every P-matrix."""
    only = np.zeros_like(wrong)
    only[np.argmax(wrong)] = True
    return only


def only_released(before: np.ndarray, after: np.ndarray) -> bool:
    """Whether some have left the set and none has joined it."""
    return bool(np.any(before & ~after) and not np.any(after & ~before))
