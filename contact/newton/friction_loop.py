"""Newton with friction: the loop that algorithms share, and who says which states a linearisation is to have.

They are settled by exact steps alone, or begin with those of a programme of the condensed linearisation, which exact
steps then make the linearised problem keep.
"""

from collections.abc import Callable, Sequence
from functools import reduce
from operator import add

import numpy as np
from scipy.linalg import norm

from contact.events import Event, EventKind
from contact.newton.friction_compliance import Choose, reach
from contact.newton.friction_run import FAILURES, FrictionalRun, LinearStep, Point
from contact.newton.friction_states import Laws
from contact.newton.friction_step import Stepped
from contact.newton.loop import FEW_UPDATES, MOST_UPDATES, StepError
from contact.problem import Outcome
from contact.solvers.lcp_pivoting import LcpError
from contact.solvers.sparse import SingularMatrixError

SINGLY = Event(EventKind.CYCLE, "cycle of states detected: only the first wrong state was changed, one at a time")
ENDLESS = "cycle of states detected, and changing one at a time does not end on the linearised problem"
REPEATED = 1e-6  # of a step: an iterate that is no farther from the one two steps before it is the same
OF_THE_PROGRAMME = "forces are those of the programme"
Step = Callable[[Point, Laws], tuple[Stepped, Laws, Event | None]]  # from a point and the laws expected there


def newton(run: FrictionalRun, at: Point, step: Step, most: int, *, programmed: bool = False) -> tuple[Point, Outcome]:
    """From a point until the states repeat and the forces balance.

    In turn: laws that are ``expected``, ``linear`` of them, states settled on that, ``advance``, ``ended``.
    step: may raise one of FAILURES.  programmed: states are what the step says, and the end is where they balance.
    Where a gap has a kink, as on the edge of two patches of a face that is folded along it, forces may balance on
    neither side: on the same states the iterate is the one two steps before it then, and so are all that follow.
    """
    before = at.laws
    event: Event | None = None
    trail: tuple[np.ndarray, ...] = ()  # the last two displacements
    for _ in range(most + 1):
        first = at.newton.stepped is None
        laws = run.expected(at) if first or not programmed else at.laws
        run.note(at, laws, before, event)
        before = laws
        ended = run.ended(at, laws)
        if programmed and ended is not Outcome.DIVERGED:
            ended = Outcome.CONVERGED if not first and run.newton.balanced(at.newton) else None
        if ended is not None:
            return at, ended
        u, same = at.newton.u, not first and laws.same(at.laws)
        if same and len(trail) == 2 and norm(u - trail[0], check_finite=False) <= REPEATED * at.newton.moved:
            return at, Outcome.ALTERNATING
        trail = (*trail[-1:], u)
        try:
            stepped, laws, event = step(at, laws)
            at = run.advance(at, stepped, laws)
        except FAILURES as error:
            return at, run.failed(error)
    return at, Outcome.ITERATION_LIMIT


def approach(run: FrictionalRun, at: Point, settle: float, most: int) -> tuple[Point, Outcome]:
    """Each linearisation settled up to the fraction ``settle``.

    States that come back are a cycle: that linearisation is left as it is, and where Newton has been before the states
    are changed one at a time there.
    """
    begun = set[bytes]()

    def step(at: Point, laws: Laws) -> tuple[Stepped, Laws, Event | None]:
        again = laws.key in begun and laws.key != at.laws.key
        begun.add(laws.key)
        linear, laws, event = settled(run, at, run.linear(at, laws), laws, 0.0 if again else settle, last=again)
        return linear.step(laws), laws, event

    return newton(run, at, step, most)


def finished(run: FrictionalRun, at: Point, choose: Choose, words: list[str], most: int) -> tuple[Point, Outcome]:
    """Ask ``choose`` where states change; the steps are exact on the states that it makes the linearised problem keep.

    words: what ``choose`` has to say of its last answer, for the history. Where it has none the states are settled from
    the expected ones, and the history says so, too.
    """
    asked = False

    def step(at: Point, laws: Laws) -> tuple[Stepped, Laws, Event | None]:
        nonlocal asked
        if asked and laws.same(at.laws):
            return run.linear(at, laws).step(laws), laws, None
        claimed, messages = _claimed(run, at, laws, choose, words)
        try:
            linear = run.linear(at, claimed)
        except SingularMatrixError as error:
            messages.append(f"on its states {error}; those expected before it were settled instead")
            claimed, linear = laws, run.linear(at, laws)
        linear, laws, cycle = settled(run, at, linear, claimed)
        wrong = int(np.sum(laws.state != claimed.state))
        messages += [f"states of {wrong} candidates corrected by exact steps"] if wrong else []
        asked = True
        return linear.step(laws), laws, _event(messages, cycle)

    return newton(run, at, step, most)


def unfinished(run: FrictionalRun, at: Point, choose: Choose, words: list[str], most: int) -> tuple[Point, Outcome]:
    """The forces of the programme itself, until they balance."""

    def step(at: Point, laws: Laws) -> tuple[Stepped, Laws, Event | None]:
        words.clear()
        try:
            reached = reach(run, at, laws.closed, choose)
        except LcpError as error:
            raise StepError(Outcome.UNSOLVED, str(error)) from None
        if reached.passes:
            raise StepError(Outcome.REFUSED, "only the foundation holds the body: its forces are no programme's")
        return reached.stepped, reached.laws, _event([OF_THE_PROGRAMME, *words], None)

    return newton(run, at, step, most, programmed=True)


def settled(
    run: FrictionalRun, at: Point, linear: LinearStep, laws: Laws, settle: float = 0.0, *, last: bool = True
) -> tuple[LinearStep, Laws, Event | None]:
    """The laws that the linearised problem keeps, up to the fraction ``settle`` of those that touch, and who steps.

    Where states come back and it is the ``last`` linearisation to decide, they are changed one at a time; else the laws
    are left as they are. Raises StepError, SingularMatrixError, NotHeldError.
    """
    seen = set[bytes]()
    for _ in range(MOST_UPDATES if last else FEW_UPDATES):
        linear = linear.near(laws)
        after = run.foreseen(at, linear.foreseen(laws), laws)
        seen.add(laws.key)
        if np.sum(after.state != laws.state) <= settle * laws.closed.sum():
            return linear, laws, None
        if after.key in seen:
            break
        laws = after
    if not last:
        return linear.near(laws), laws, None
    return *_one_at_a_time(run, at, linear, laws), SINGLY


def _one_at_a_time(run: FrictionalRun, at: Point, linear: LinearStep, laws: Laws) -> tuple[LinearStep, Laws]:
    """By changes of the first wrong one; raises StepError."""
    seen = set[bytes]()
    while laws.key not in seen and len(seen) < MOST_UPDATES:
        seen.add(laws.key)
        linear = linear.near(laws)
        after = run.foreseen(at, linear.foreseen(laws), laws)
        wrong = np.flatnonzero(after.state != laws.state)
        if not len(wrong):
            return linear, laws
        laws = laws.changed(after, wrong[:1])
    raise StepError(Outcome.CYCLING, ENDLESS)


def _claimed(run: FrictionalRun, at: Point, laws: Laws, choose: Choose, words: list[str]) -> tuple[Laws, list[str]]:
    """Laws to begin with, and what there is to say of them; raises StepError of a problem that is refused."""
    words.clear()
    try:
        reached = reach(run, at, laws.closed, choose)
    except (LcpError, StepError) as error:
        if isinstance(error, StepError) and error.outcome is Outcome.REFUSED:
            raise
        return laws, [f"{error}; states settled by exact steps instead"]
    held = f"only the foundation holds the body: states found on springs in {reached.passes} passes"
    return reached.laws, ([held] if reached.passes else []) + words


def _event(messages: Sequence[str], cycle: Event | None) -> Event | None:
    events = [Event(EventKind.SUBSTITUTE, text) for text in messages] + ([cycle] if cycle else [])
    return reduce(add, events) if events else None
