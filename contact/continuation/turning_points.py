"""Where a path of moving foundations turns back: its first limit point by arc length, and the mode there."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.continuation.arc_length import ArcLength, Trace
from contact.continuation.candidates import State
from contact.continuation.critical_points import why_it_ends
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.pressed_curve import PressedCurve
from contact.events import Ending, EventKind, PathEnd
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError

EASY, HARD = 5, 8  # iterations of a point with contact, whose set takes some of them
POINTS = 60
SMALLEST = 1e-5  # of the first step
CORNER = 1e-3  # of the way by arc length: a change of the set further ahead is not why no step succeeds


@dataclass(frozen=True, eq=False)
class Turned:
    """The end of a path towards a target: at the target, at the limit point before it, or where no step succeeds.

    t, solution: the last state, of which counters and history are those of all points; points: their number; way: the
    states from the first one on, which is left out, to the last.
    """

    t: float
    solution: ContactSolution
    outcome: Outcome
    points: int
    end: Ending | None = None
    way: tuple[State, ...] = ()


def by_arc_length(
    problem_at: Callable[[float], ContactProblem],
    states: tuple[State, ...],
    target: float,
    algorithm: ContactAlgorithm,
    first: float,
    most: float = np.inf,
) -> Turned:
    """The path from the last of the converged ``states`` (parameter, solution) to the target or to its limit point.

    first: change of the parameter in the first step.  most: factorisations after which it is given up.
    Raises ValueError where only its parameter moves the path.
    """
    start, state = states[-1]
    arc = ArcLength(first, EASY, HARD, smallest=SMALLEST, max_points=POINTS, to_limit=True, most=most)
    curve, begin = PressedCurve.through(problem_at, start, state, algorithm)
    trace = arc.along(curve, begin, [target])
    outcome, end = trace.outcome, None
    if trace.outcome is Outcome.LIMIT_POINT:
        last = next((point for point in trace.points if point.limit), trace.points[-2])
        end = _limit(curve, trace, last)
    else:
        last = trace.points[-1]
    if outcome is Outcome.STEP_LIMIT:
        end = _corner(curve, trace)
        outcome = Outcome.STEP_LIMIT if end is None else Outcome.LIMIT_POINT
    if not outcome.converged and end is None:
        reached = [(point.factor, point.state) for point in trace.points[-3:]]
        outcome = outcome if outcome is Outcome.GIVEN_UP else Outcome.STEP_LIMIT
        end = why_it_ends(problem_at, (states[0], *reached), algorithm.epsilon)
    end_state = replace(last.state, counters=trace.counters, history=tuple(trace.history))
    event = trace.history[-1].get("event") if trace.history else None
    if end is not None and event is not None and EventKind.PASSED & event.kind:
        end = replace(end, sentence=f"{event}; {end.sentence}")
    way = tuple((point.factor, point.state) for point in trace.points[1 : trace.points.index(last) + 1])
    return Turned(last.factor, end_state, outcome, len(trace.points) - 1, end, way)


def _corner(curve: PressedCurve, trace: Trace) -> Ending | None:
    """The limit point where the set changes just ahead, if the path turns back there."""
    last = trace.points[-1]
    chord = curve.place(last) - curve.place(trace.points[-2]) if len(trace.points) > 1 else None
    try:
        ahead = curve.tangent(last, np.append(np.zeros_like(last.u), 1.0) if chord is None else chord)
        at, behind = curve.corner(last, ahead)
    except SingularMatrixError:
        return None
    if not (ahead[-1] > 0 > behind[-1] and at - last.factor <= CORNER * (last.factor - trace.points[0].factor)):
        return None
    message = (
        f"limit point of the path at {at:.7g}: it turns back where the contact set changes, with a regular tangent"
    )
    mode = behind[:-1] / (float(np.linalg.norm(behind[:-1])) or 1.0)
    return Ending(PathEnd.LIMIT_POINT, message, at, mode)


def _limit(curve: PressedCurve, trace: Trace, last: ArcPoint) -> Ending:
    """What the points on both sides of the limit point say of it."""
    before, after = trace.points[-3 if last.limit else -2], trace.points[-1]
    message = f"limit point of the path at {last.factor:.7g}: it turns back"
    if before.negative is not None and after.negative is not None:
        message += "; negative eigenvalues of the tangent on the motions that the contact set leaves free: "
        message += f"{before.negative} before, {after.negative} after it"
    try:
        mode = curve.tangent(last, curve.place(after) - curve.place(before))[:-1]
    except SingularMatrixError:
        mode = after.u - last.u
    return Ending(PathEnd.LIMIT_POINT, message, last.factor, mode / (float(np.linalg.norm(mode)) or 1.0))
