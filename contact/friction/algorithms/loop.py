"""Newton with friction that settles its states before the next linearisation: the loop that algorithms share."""

from __future__ import annotations

import numpy as np

from contact.events import Event, EventKind
from contact.friction.newton.laws import Laws
from contact.friction.newton.run import FAILURES, FrictionalRun, LinearStep, Point
from contact.friction.problem import FrictionalSolution
from contact.newton.loop import FEW_UPDATES, MOST_UPDATES, StepError
from contact.problem import Outcome

SINGLY = Event(EventKind.CYCLE, "cycle of states detected: only the first wrong state was changed, one at a time")
ENDLESS = "cycle of states detected, and changing one at a time does not end on the linearised problem"


def iterate(run: FrictionalRun, start: FrictionalSolution, settle: float, most: int) -> FrictionalSolution:
    """From ``start`` until the states repeat and the forces balance; each linearisation settled up to ``settle``."""
    return run.finish(*approach(run, run.start(start), settle, most))


def approach(run: FrictionalRun, at: Point, settle: float, most: int) -> tuple[Point, Outcome]:
    """The same from a point to a point.

    States that come back are a cycle: that linearisation is left as it is, and where Newton has been before the states
    are changed one at a time there.
    """
    before, begun = at.laws, set[bytes]()
    event: Event | None = None
    for _ in range(most + 1):
        laws = run.expected(at)
        run.note(at, laws, before, event)
        before = laws
        ended = run.ended(at, laws)
        if ended is not None:
            return at, ended
        again = laws.key in begun and laws.key != at.laws.key
        begun.add(laws.key)
        try:
            linear = run.linear(at, laws)
            laws, event = settled(run, at, linear, laws, 0.0 if again else settle, last=again)
            at = run.advance(at, linear.step(laws), laws)
        except FAILURES as error:
            return at, run.failed(error)
    return at, Outcome.ITERATION_LIMIT


def settled(
    run: FrictionalRun, at: Point, linear: LinearStep, laws: Laws, settle: float = 0.0, *, last: bool = True
) -> tuple[Laws, Event | None]:
    """The laws that the linearised problem keeps, up to the fraction ``settle`` of those that touch.

    Where states come back and it is the ``last`` linearisation to decide, they are changed one at a time; else the laws
    are left as they are. Raises StepError, SingularMatrixError, NotHeldError.
    """
    seen = set[bytes]()
    for _ in range(MOST_UPDATES if last else FEW_UPDATES):
        after = run.foreseen(at, linear.foreseen(laws), laws)
        seen.add(laws.key)
        if np.sum(after.state != laws.state) <= settle * laws.closed.sum():
            return laws, None
        if after.key in seen:
            break
        laws = after
    return (_one_at_a_time(run, at, linear, laws), SINGLY) if last else (laws, None)


def _one_at_a_time(run: FrictionalRun, at: Point, linear: LinearStep, laws: Laws) -> Laws:
    """By changes of the first wrong one; raises StepError."""
    seen = set[bytes]()
    while laws.key not in seen and len(seen) < MOST_UPDATES:
        seen.add(laws.key)
        after = run.foreseen(at, linear.foreseen(laws), laws)
        wrong = np.flatnonzero(after.state != laws.state)
        if not len(wrong):
            return laws
        laws = laws.changed(after, wrong[:1])
    raise StepError(Outcome.CYCLING, ENDLESS)
