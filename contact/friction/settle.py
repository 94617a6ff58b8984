"""Laws that a linearised problem keeps: what the algorithms share that work on one linearisation at a time."""

from __future__ import annotations

import numpy as np

from contact.events import Event, EventKind
from contact.friction.laws import Laws
from contact.friction.run import FrictionalRun, Point
from contact.friction.step import FrictionalStep
from contact.newton.loop import FEW_UPDATES, MOST_UPDATES, StepError
from contact.problem import Outcome

SINGLY = Event(EventKind.CYCLE, "cycle of states detected: only the first wrong state was changed, one at a time")
ENDLESS = "cycle of states detected, and changing one at a time does not end on the linearised problem"


def settled(
    run: FrictionalRun, at: Point, linear: FrictionalStep, laws: Laws, settle: float = 0.0, *, last: bool = True
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


def _one_at_a_time(run: FrictionalRun, at: Point, linear: FrictionalStep, laws: Laws) -> Laws:
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
