"""Newton with friction whose states come from a programme of the linearised step, and its forces from exact steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce
from operator import add

import numpy as np

from contact.events import Event, EventKind
from contact.friction.algorithms.compliance import Choose, Reached, reach
from contact.friction.algorithms.loop import settled
from contact.friction.newton.laws import Laws
from contact.friction.newton.run import FAILURES, FrictionalRun, Point
from contact.friction.newton.step import Stepped
from contact.newton.loop import StepError
from contact.problem import Outcome
from contact.solvers.lcp_pivoting import LcpError
from contact.solvers.sparse import SingularMatrixError


def polygon(sides: int) -> np.ndarray:
    """Unit vectors (sides, 2) to the corners of a polygon in the disc of radius 1."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.column_stack([np.cos(angle), np.sin(angle)])


def shortfall(sides: int) -> float:
    """1 - cos(pi/sides): by how much friction on the polygon may be short of the disc."""
    return 1 - math.cos(math.pi / sides)


def finished(run: FrictionalRun, at: Point, choose: Choose, words: list[str], most: int) -> tuple[Point, Outcome]:
    """Ask ``choose`` where states change; the steps are exact on the states that it makes the linearised problem keep.

    words: what ``choose`` has to say of its last answer, for the history. Where it has none the states are settled from
    the expected ones, and the history says so, too.
    """
    before, asked = at.laws, False
    event: Event | None = None
    for _ in range(most + 1):
        laws = run.expected(at)
        run.note(at, laws, before, event)
        before, event = laws, None
        ended = run.ended(at, laws)
        if ended is not None:
            return at, ended
        try:
            if asked and laws.same(at.laws):
                linear = run.linear(at, laws)
            else:
                claimed, told = _claimed(run, at, laws, choose, words)
                try:
                    linear = run.linear(at, claimed)
                except SingularMatrixError as error:
                    told.append(f"on its states {error}; those expected before it were settled instead")
                    claimed, linear = laws, run.linear(at, laws)
                laws, cycle = settled(run, at, linear, claimed)
                wrong = int(np.sum(laws.state != claimed.state))
                told += [f"states of {wrong} candidates corrected by exact steps"] if wrong else []
                event, asked = _event(told, cycle), True
            at = run.advance(at, linear.step(laws), laws)
        except FAILURES as error:
            return at, run.failed(error)
    return at, Outcome.ITERATION_LIMIT


def unfinished(run: FrictionalRun, at: Point, choose: Choose, words: list[str], most: int) -> tuple[Point, Outcome]:
    """The forces of the programme itself, until they balance."""
    laws, before = run.expected(at), at.laws
    event: Event | None = None
    for _ in range(most + 1):
        run.note(at, laws, before, event)
        before = laws
        if np.isinf(at.newton.residual):
            return at, Outcome.DIVERGED
        if event is not None and run.newton.balanced(at.newton):
            return at, Outcome.CONVERGED
        try:
            words.clear()
            found = reach(run, at, laws.closed, choose)
            if found.passes:
                raise StepError(Outcome.REFUSED, "only the foundation holds the body: its forces are no programme's")
        except LcpError as error:
            return at, run.failed(StepError(Outcome.UNSOLVED, str(error)))
        except FAILURES as error:
            return at, run.failed(error)
        event, laws, local = _event(["forces are those of the programme", *words], None), found.laws, found.local
        at = run.advance(at, Stepped(found.du, local.gap, local.slip, local.normal, local.friction), laws)
    return at, Outcome.ITERATION_LIMIT


def _claimed(run: FrictionalRun, at: Point, laws: Laws, choose: Choose, words: list[str]) -> tuple[Laws, list[str]]:
    """Laws to begin with, and what there is to say of them; raises StepError of a problem that is refused."""
    words.clear()
    try:
        found: Reached = reach(run, at, laws.closed, choose)
    except (LcpError, StepError) as error:
        if isinstance(error, StepError) and error.outcome is Outcome.REFUSED:
            raise
        return laws, [f"{error}; states settled by exact steps instead"]
    told = (
        [f"only the foundation holds the body: states found on springs in {found.passes} passes"]
        if found.passes
        else []
    )
    return found.laws, told + words


def _event(told: Sequence[str], cycle: Event | None) -> Event | None:
    events = [Event(EventKind.SUBSTITUTE, text) for text in told] + ([cycle] if cycle else [])
    return reduce(add, events) if events else None
