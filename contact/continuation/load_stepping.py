"""Load stepping that adapts: a failed step is cut in half, an easy one lets the next grow back; the history says so."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import norm

from contact.algorithms.base import hasty
from contact.continuation.candidates import (
    EASY_ITERATIONS,
    Attempt,
    Good,
    Start,
    Starts,
    State,
    after_in_vain,
    factorisations,
    none_known,
    solve_within_reach,
    why,
)
from contact.events import Ending, Event, EventKind, PathEnd
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome

if TYPE_CHECKING:
    from contact.swept import Crossing

SMALLEST = 2.0**-10  # of the step asked for
PATIENCE = 3  # attempts on the way to a target may fail before a path that has a travel is followed by arc length
FIRST_ARC = 0.125  # of the step that has failed last
BRIEF = 20  # iterations of an attempt after a failure on the way to a target: a step that is small enough is easy
WORTH = 20  # good steps: what may be spent in vain on the way to a target, beyond what has led on
SMOOTH = 2.0**-0.5  # of the way to a state, with half the step: half on a smooth path, all of it in a jump
ARC = 2  # times as much for the arc: on less it has lost limit points that it was about to find (measured)


@dataclass(frozen=True, eq=False)
class PathPoint:
    """The state at a requested parameter, or the last converged one when the path ended before it.

    requested, reached: the path parameter asked for and got.  outcome: CONVERGED, or why the path ends here.
    cause: outcome of the last attempt at a step, which tells what failed at the smallest one.
    solution: the converged state at ``reached`` with the counters and history of ALL sub-steps since the last point.
    end: what the tangent says of the end of the path, where no step is small enough; it is the last event, too.
    way: all converged states from the last point to ``solution``, both with theirs.
    """

    requested: float
    reached: float
    outcome: Outcome
    solution: ContactSolution
    substeps: int
    cause: Outcome = Outcome.CONVERGED
    end: Ending | None = None
    way: tuple[State, ...] = ()


def follow(
    problem_at: Callable[[float], ContactProblem],
    start: float,
    targets: Sequence[float],
    algorithm: ContactAlgorithm,
    solution: ContactSolution,
    steps: int = 1,
    smallest: float = SMALLEST,
    starts: Starts = none_known,
) -> Iterator[PathPoint]:
    """Follow the path of problems from the converged ``solution`` at ``start`` through the targets, in order.

    ``steps``: equal steps between two targets; ``smallest``: fraction of one of them below which it is not cut. The
    iteration ends with the first point that is not converged. Once a step has been cut, a state in contact with more
    negative eigenvalues than that at the last target lies beyond the path: the step is cut again.
    Without contact, paths of large rotations pass bifurcations and are followed.
    At the smallest step the way there decides: what half a step brings half as near is not a jump but the path itself,
    which has passed a bifurcation and is followed as an unstable one.
    A state which a candidate reaches through the foundation is not a state of the path, either: the step is cut.
    Where only a foundation moves (``travel`` of the problems), three failures on the way to a target are answered by
    arc length: it gets there, or finds the limit point at which the path turns back, in a bounded number of steps.
    A path with contact is given up when as much was spent in vain as WORTH good steps take, and on those that led on;
    the arc may take twice as much again: what it ends at is the cause.
    starts: where a step sets out from, if that leads to a state of the path; else it does from the last state.
    No step is foreseen from the states before. Extrapolated with their resultants it took 55 iterations in place of 82
    (hemisphere, 20 loads), 74 of 75 (tyre, 20 travels), but 35 of 27 (annulus) and 136 of 113 (semicylinder); without
    the resultants up to three times as many.
    """
    at, good = start, Good()
    for index, target in enumerate(targets):
        asked = (target - at) / steps
        begin, known = ((at, solution),), partial(starts, index)
        stepper = Stepper(problem_at, algorithm, target, asked, smallest * abs(asked), begin, asked, begin, good, known)
        while stepper.outcome.converged and stepper.reached != target:
            attempt = stepper.attempt()
            stepper = stepper.accept(attempt) if attempt.failure is None else stepper.reject(attempt, attempt.failure)
        point = stepper.point()
        yield point
        if not point.outcome.converged:
            return
        at, solution, good = target, point.solution, stepper.good


@dataclass(frozen=True, eq=False)
class Stepper:
    """Steps of adapted size to ``target``; each attempt is accepted or rejected, which gives the next stepper.

    asked: the step that is asked for, the largest; smallest: size below which it is not cut.  states: converged, the
    first and the last three; step: the next one; way: all states; good: the steps of the path so far.  start_at: a
    start known from elsewhere.  cut: whether a step has been; failures: how many; vain: factorisations of those that
    found nothing; passed: negative eigenvalues that the path has come by; jump: the last attempt that found a state
    beyond it, and the step to that; the rest goes into the :class:`PathPoint`.
    """

    problem_at: Callable[[float], ContactProblem]
    algorithm: ContactAlgorithm
    target: float
    asked: float
    smallest: float
    states: tuple[State, ...]
    step: float
    way: tuple[State, ...]
    good: Good = field(default_factory=Good)
    start_at: Callable[[State, float], Start | None] = field(default=partial(none_known, 0))
    cut: bool = False
    failures: int = 0
    vain: float = 0.0
    passed: int = 0
    jump: tuple[float, float] = (0.0, np.inf)
    substeps: int = 0
    counters: Mapping[str, float] = field(default_factory=dict)
    history: tuple[Mapping[str, Any], ...] = ()
    outcome: Outcome = Outcome.CONVERGED
    cause: Outcome = Outcome.CONVERGED
    end: Ending | None = None

    @property
    def allowed(self) -> float:
        """Factorisations in vain on the way to the target: those of WORTH good steps beyond what has led on."""
        return WORTH * self.good.each + self.counters.get("factorisations", 0.0) - self.vain

    @property
    def bounded(self) -> bool:
        """Whether a path may be given up: one with candidates; without, what was vain may still lead on (measured)."""
        return len(self.states[0][1].active) > 0

    @property
    def reached(self) -> float:
        """Parameter of the last converged state."""
        return self.states[-1][0]

    def attempt(self) -> Attempt:
        """The next step from the last converged state."""
        last = abs(self.target - self.reached) <= abs(self.step) * (1 + 1e-9)
        trial = self.target if last else self.reached + self.step
        (before, state), problem = self.states[-1], self.problem_at(trial)
        if problem.guide is not None:
            state = replace(state, u=state.u + problem.guide - self.problem_at(before).guide)
        most = min(BRIEF, getattr(self.algorithm, "max_iterations", BRIEF))
        brief = self.vain and self.bounded and problem.coulomb is None  # with friction no step is easy
        algorithm = hasty(self.algorithm, most) if brief else self.algorithm
        start = self.start_at(self.states[-1], trial)
        if start is None:
            return self._tried(trial, problem, solve_within_reach(algorithm, problem, state))
        tried = self._tried(trial, problem, solve_within_reach(algorithm, problem, state, start))
        if tried.failure is None:
            return tried
        solution = solve_within_reach(algorithm, problem, state)
        return self._tried(trial, problem, after_in_vain(tried.solution, solution, tried.failure))

    def _tried(self, trial: float, problem: ContactProblem, solution: ContactSolution) -> Attempt:
        """The state found at a parameter, or why it is not one of the path."""
        before, state = self.states[-1]
        failure = None if solution.outcome.converged else why(solution)
        if failure is None and problem.standing is not None:  # where it was is only then looked at
            through = passed_through(self.problem_at(before), state, problem, solution)
            failure = Event(EventKind.FAILED | EventKind.PASSED, str(through[0])) if through else None
        beyond = 0
        counted = problem.coulomb is None  # friction has no potential: negative eigenvalues say nothing of its path
        if failure is None and self.cut and counted and solution.active.any():  # is the difficult way still the same?
            from contact.continuation.critical_points import branches_passed  # loaded once a step has been cut

            more = branches_passed(self.problem_at, self.states[0], (trial, solution), self.algorithm.epsilon)
            beyond = max(0, more - self.passed)
        if beyond:
            eigenvalues = "1 more eigenvalue is" if beyond == 1 else f"{beyond} more eigenvalues are"
            since = f"than at {(before if self.passed else self.states[0][0]) + 0.0:g}"
            failure = Event(EventKind.FAILED, f"a state beyond the path, {eigenvalues} negative {since}")
        return Attempt(trial, solution, failure, beyond, float(norm(solution.u - state.u, check_finite=False)))

    def accept(self, attempt: Attempt, passing: Event | None = None) -> Stepper:
        """At the new state; after an easy step the next one grows, up to the one asked for."""
        first, *others = self.states
        reached = (attempt.parameter, replace(attempt.solution, history=()))
        states, way = (first, *others[-2:], reached), (*self.way, reached)
        easy = attempt.solution.counters["newton_iterations"] <= EASY_ITERATIONS
        grows = easy and abs(self.step) < abs(self.asked) and attempt.parameter != self.target
        step = 2 * self.step if grows else self.step
        event = Event(EventKind.STEP_GROWN, f"easy step: the next one grows to {step:.6g}") if grows else None
        event = passing or event
        reached_by = replace(self._spent(attempt, event), states=states, way=way, substeps=self.substeps + 1)
        return replace(reached_by, step=step, good=self.good.after(attempt.solution))

    def reject(self, attempt: Attempt, failure: Event) -> Stepper:
        """Where it was, with half the step; with an outcome where no smaller one would do."""
        if attempt.solution.outcome is Outcome.REFUSED and not self._lost(attempt):
            return replace(self._spent(attempt, None), outcome=Outcome.REFUSED)
        if self.failures + 1 >= PATIENCE and self.target > self.reached and self.problem_at(self.reached).travel:
            return self._by_arc_length(attempt, failure)
        vain = self.vain + (0.0 if attempt.solution.outcome.converged else factorisations(attempt.solution))
        shorter = self.vain > 0 or attempt.solution.friction is None  # with friction a first failure is as dear as many
        spent = self.bounded and shorter and vain + BRIEF > self.allowed  # the next attempt would be beyond it
        width = attempt.parameter - self.reached
        smallest = abs(self.step) / 2 < self.smallest
        if smallest and attempt.beyond and self._smooth(attempt):
            text = f"{failure}: a bifurcation, {attempt.moved / self.jump[1]:.2g} of the way with half the step"
            return replace(
                self.accept(attempt, Event(EventKind.BIFURCATION, text)), passed=self.passed + attempt.beyond
            )
        if spent or smallest:
            outcome = Outcome.GIVEN_UP if spent else Outcome.STEP_LIMIT
            end = self._end(attempt)
            text = f"{failure}; {outcome.value}; {end.sentence}"
            ended = self._spent(attempt, Event(failure.kind | EventKind.PATH_END, text))
            return replace(ended, outcome=outcome, end=end)
        step = width / 2
        event = Event(failure.kind | EventKind.STEP_CUT, f"{failure}: step cut to {step:.6g}")
        asked = step if EventKind.PASSED & failure.kind else self.asked  # a longer one would pass again
        cut = replace(self._spent(attempt, event), step=step, asked=asked, cut=True, vain=vain)
        return replace(cut, failures=self.failures + 1, jump=(width, attempt.moved) if attempt.beyond else self.jump)

    def _lost(self, attempt: Attempt) -> bool:
        """Whether it was no problem that was refused, but what Newton's method with friction has come to from there."""
        return attempt.solution.friction is not None and attempt.solution.counters.get("newton_iterations", 0) > 1

    def _end(self, attempt: Attempt) -> Ending:
        """Why there is no next state; where no digit of one is sure, a tangent in its neighbourhood tells nothing."""
        if attempt.solution.outcome is Outcome.ROUNDING:
            return Ending(PathEnd.NEITHER, "the rounding of the displacements allows no state nearer to balance")
        if attempt.solution.friction is not None:
            return Ending(PathEnd.NEITHER, "with friction the tangent alone gives no reason")
        from contact.continuation.critical_points import why_it_ends  # loaded at the end of a path alone

        return why_it_ends(self.problem_at, self.states, self.algorithm.epsilon)

    def _smooth(self, attempt: Attempt) -> bool:
        """Whether a state beyond the path is on it, after all: half the step has brought it nearer by as much."""
        width, moved = self.jump
        half = abs(attempt.parameter - self.reached) <= 0.5 * abs(width) * (1 + 1e-9)
        return half and attempt.moved <= SMOOTH * moved

    def _by_arc_length(self, attempt: Attempt, failure: Event) -> Stepper:
        """At the target or at the limit point before it, after the last failure that is put up with."""
        from contact.continuation.turning_points import by_arc_length  # no path without a turn loads it

        event = Event(failure.kind | EventKind.STEP_CUT, f"{failure}: by arc length from {self.reached:.6g} on")
        begun = self._spent(attempt, event)
        first = FIRST_ARC * (attempt.parameter - self.reached)
        most = ARC * WORTH * self.good.each
        turned = by_arc_length(self.problem_at, self.states, self.target, self.algorithm, first, most)
        said = None if turned.end is None else Event(EventKind.PATH_END, turned.end.sentence)
        ended = begun._spent(Attempt(turned.t, turned.solution, None), said)
        first_state, *others = self.states
        states = (first_state, *others[-2:], (turned.t, replace(turned.solution, counters={}, history=())))
        return replace(
            ended,
            states=states,
            way=(*self.way, *turned.way),
            substeps=self.substeps + turned.points,
            outcome=turned.outcome,
            cause=turned.outcome if turned.outcome.converged else attempt.solution.outcome,
            end=turned.end,
        )

    def point(self) -> PathPoint:
        """What has come of it."""
        solution = replace(self.states[-1][1], counters=self.counters, history=self.history)
        spent = (self.substeps, self.cause, self.end, self.way)
        return PathPoint(self.target, self.reached, self.outcome, solution, *spent)

    def _spent(self, attempt: Attempt, event: Event | None) -> Stepper:
        """With the counters and the history of the attempt, whose last row tells the event."""
        solution = attempt.solution
        counters = {key: self.counters.get(key, 0) + value for key, value in solution.counters.items()}
        # an algorithm without a history still gets a row, for the event
        rows = [
            {"parameter": attempt.parameter, "iteration": i, **row} for i, row in enumerate(solution.history or ({},))
        ]
        if event is not None:
            rows[-1]["event"] = event
        return replace(self, counters=counters, history=(*self.history, *rows), cause=solution.outcome)


def passed_through(
    before: ContactProblem, state: ContactSolution, after: ContactProblem, reached: ContactSolution
) -> list[Crossing]:
    """What goes through the foundation on the way from a state to the next one."""
    from contact.swept import crossings  # loaded with a foundation alone

    return crossings(before.standing, state.u, after.standing, reached.u)
