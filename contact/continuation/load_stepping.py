"""Load stepping that adapts: a failed step is cut in half, an easy one lets the next grow back; the history says so."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from contact.continuation.candidates import solve_within_reach
from contact.continuation.critical_points import Ending, State, branches_passed, why_it_ends
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome

EASY_ITERATIONS = 12  # a step with no more Newton iterations than this lets the next one double
SMALLEST = 2.0**-10  # of the step asked for


@dataclass(frozen=True, eq=False)
class PathPoint:
    """The state at a requested parameter, or the last converged one when the path ended before it.

    requested, reached: the path parameter asked for and got.  outcome: CONVERGED, or why the path ends here.
    solution: the converged state at ``reached`` with the counters and history of ALL sub-steps since the last point.
    end: what the tangent says of the end of the path, where no step is small enough; it is the last event, too.
    """

    requested: float
    reached: float
    outcome: Outcome
    solution: ContactSolution
    substeps: int
    end: Ending | None = None


def follow(
    problem_at: Callable[[float], ContactProblem],
    start: float,
    targets: Sequence[float],
    algorithm: ContactAlgorithm,
    solution: ContactSolution,
    steps: int = 1,
    on_substep: Callable[[float], None] | None = None,
    smallest: float = SMALLEST,
) -> Iterator[PathPoint]:
    """Follow the path of problems from the converged ``solution`` at ``start`` through the targets, in order.

    ``steps``: equal steps between two targets; ``smallest``: fraction of one of them below which it is not cut. The
    iteration ends with the first point that is not converged. Once a step has been cut, a state in contact with more
    negative eigenvalues than that at the last target is no state of the path, but one beyond it: the step is cut again.
    Without contact, paths of large rotations pass bifurcations and are followed.
    """
    at = start
    for target in targets:
        point = _reach(problem_at, at, target, algorithm, solution, steps, on_substep, smallest)
        yield point
        if not point.outcome.converged:
            return
        at, solution = target, point.solution


def _reach(
    problem_at: Callable[[float], ContactProblem],
    at: float,
    target: float,
    algorithm: ContactAlgorithm,
    solution: ContactSolution,
    steps: int,
    on_substep: Callable[[float], None] | None,
    smallest: float,
) -> PathPoint:
    asked = (target - at) / steps
    step, substeps = asked, 0
    counters: dict[str, float] = {}
    history: list[dict[str, object]] = []
    reached, outcome, end, cut = at, Outcome.CONVERGED, None, False
    states: list[State] = [(at, solution)]
    while reached != target:
        last = abs(target - reached) <= abs(step) * (1 + 1e-9)
        trial = target if last else reached + step
        attempt = solve_within_reach(algorithm, problem_at(trial), solution)
        counters = {key: counters.get(key, 0) + value for key, value in attempt.counters.items()}
        # an algorithm without a history still gets a row, for the event
        rows = [{"parameter": trial, "iteration": i, **row} for i, row in enumerate(attempt.history or ({},))]
        history += rows
        failure = None if attempt.outcome.converged else _why(attempt)
        if failure is None and cut and attempt.active.any():  # the way is difficult: is it still the same?
            passed = branches_passed(problem_at, states[0], (trial, attempt), algorithm.epsilon)
            if passed:
                failure = f"a state beyond the path, {passed} more eigenvalues are negative than at {at:g}"
        if failure is None:
            solution, reached, substeps = attempt, trial, substeps + 1
            states = [states[0], *states[1:][-2:], (reached, replace(attempt, history=()))]
            if on_substep is not None:
                on_substep(trial)
            easy = attempt.counters["newton_iterations"] <= EASY_ITERATIONS
            if easy and abs(step) < abs(asked) and reached != target:
                step = 2 * step
                rows[-1]["event"] = f"easy step: the next one grows to {step:.6g}"
            continue
        if attempt.outcome is Outcome.REFUSED:  # no smaller step would change that
            outcome = Outcome.REFUSED
            break
        if abs(step) / 2 < smallest * abs(asked):
            outcome = Outcome.STEP_LIMIT
            end = why_it_ends(problem_at, states, algorithm.epsilon)
            rows[-1]["event"] = f"{failure}; {outcome.value}; {end.sentence}"
            break
        step, cut = (trial - reached) / 2, True
        rows[-1]["event"] = f"{failure}: step cut to {step:.6g}"
    spent = replace(solution, counters=counters, history=tuple(history))
    return PathPoint(target, reached, outcome, spent, substeps, end)


def _why(failed: ContactSolution) -> str:
    """The outcome, with what the algorithm itself has said of it."""
    said = failed.history[-1].get("event") if failed.history else None
    return f"{failed.outcome.value} ({said})" if said else failed.outcome.value
