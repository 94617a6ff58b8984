"""One try of an algorithm on one problem: what it ends in, whether the judge takes it, what it costs, and the answer.

Processor seconds and operations are those inside the algorithm, assembly included; building and judging are not. Who is
better is not asked here.
"""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from types import FrameType, MappingProxyType

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.verify import claim, judge
from studies.arena.card.problems import Asked, Posed, random_quadratic
from studies.arena.collected.candidates import Watched
from studies.ask.request import Request, Value
from studies.ask.scene import Scene, UsageError
from studies.ask.settings import configured
from studies.fuzz.attempt import quiet
from studies.fuzz.comparing import ALIKE as COARSE
from studies.fuzz.comparing import MARGIN, Answer, compared, difference, error_of
from studies.output.stopwatch import timed
from studies.scenes.complete import complete
from studies.scenes.walk import walk
from studies.solving.certificate import certificate
from studies.solving.solve import counted

ENDS = ("solved", "false claim", "not solved", "refused", "raised", "over the limit")
SOLVED, FALSE, FAILED, REFUSED, RAISED, LATE = ENDS
ALIKE = 1e-8  # relative, of displacements and contact forces
CARRIES = 1e-8  # of the largest pressure: less is none
AGREES, DIFFERS = "agrees", "differs"
COSTS = ("iterations", "factorisations", "operations", "seconds")
REPEATS, QUICK_S = 2, 0.02  # a quick solve is timed again; the least counts


class OvertimeError(BaseException):
    """A try has taken too long; no ``except Exception`` of whoever is tried keeps it."""


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raises OvertimeError inside after so many seconds on the clock; compiled code is left to return first."""

    def late(number: int, frame: FrameType | None) -> None:
        raise OvertimeError

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-3))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@dataclass(frozen=True)
class Trial:
    """A row: who on what, its end of ENDS and why, what it cost, and how far it is from the reference (NaN: unknown).

    away: from the answer by the part that the kind is compared with, of measures and element options.
    agreement: AGREES, DIFFERS, what explains a difference, or nothing where there is nothing to compare.
    """

    who: str
    group: str
    problem: str
    ended: str
    reason: str = ""
    iterations: float = math.nan
    factorisations: float = math.nan
    operations: float = math.nan
    seconds: float = math.nan
    apart: float = math.nan
    away: float = math.nan
    agreement: str = ""


@dataclass(eq=False)
class Metered(Watched):
    """Keeps what has been spent inside the algorithm: seconds of the processor, operations, its own counters."""

    spent: dict[str, float] = field(default_factory=lambda: dict.fromkeys(COSTS, 0.0))

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Solve, and keep what it cost."""
        with counted() as work:
            seconds, found = timed(lambda: self.inside.solve(problem, start))
        counts = (found.counters.get(key, 0) for key in ("newton_iterations", "factorisations"))
        for cost, spent in zip(COSTS, (*counts, sum(work.values()), seconds), strict=True):
            self.spent[cost] += spent
        return found


@dataclass(frozen=True, eq=False)
class Ended:
    """What a try has come to, before it is compared; answer: the last state that was reached, if it was the last."""

    ended: str
    reason: str = ""
    cost: Mapping[str, float] = field(default_factory=dict)
    answer: Answer | None = None


def epsilon_of(name: str) -> float:
    """The epsilon [MPa/mm] that an algorithm is tried with: infinity where it has it, otherwise its default."""
    own, any_problem = ALGORITHMS[name], random_quadratic(np.random.default_rng(0), "definite").problem()
    return math.inf if own(epsilon=math.inf).supports(any_problem) is None else own().epsilon


def alone(name: str, case: Posed, limit_s: float) -> Ended:
    """An algorithm on a problem by itself, from rest."""
    algorithm = ALGORITHMS[name](epsilon=epsilon_of(name))
    problem = case.problem

    def solve() -> Ended:
        refused = algorithm.supports(problem)
        if refused is not None:
            return Ended(REFUSED, refused)
        tried: list[Ended] = []
        while len(tried) < REPEATS and all(each.cost["seconds"] <= QUICK_S for each in tried):
            metered = Metered(algorithm)
            found = metered.solve(problem, ContactSolution.at_rest(len(case.answer.u), len(case.answer.pressure)))
            tried.append(_judged(problem, found, algorithm, metered.spent))
        return min(tried, key=lambda each: each.cost["seconds"])

    return guarded(solve, limit_s)


def followed(scene: Scene, request: Request, limit_s: float) -> Ended:
    """An algorithm along the path of a request, each requested load judged."""
    metered = Metered(configured(request.contact, request.settings))

    def solve() -> Ended:
        answer = None
        for visited in walk(scene.build(request).stages(), metered, request.steps):
            solution = visited.point.solution
            if not visited.converged:
                refused = visited.point.outcome is Outcome.REFUSED
                said = visited.said or visited.point.outcome.value
                return Ended(REFUSED if refused else FAILED, said, metered.spent)
            seen = visited.stage.observe(visited.problem, solution, visited.point.requested)
            answer = Answer(visited.problem, solution, metered.inside)
            if seen.step is not None:
                tolerance = request.number("tolerance")
                told = certificate(visited.problem, solution, metered.epsilon, tolerance, visited.passed)
                if told["failures"]:
                    at = f"{visited.stage.name} at {visited.point.requested:g}"
                    return Ended(FALSE, f"{at}: {_told(told['failures'], told['kkt'])}", metered.spent)
        return Ended(SOLVED, "", metered.spent, answer)

    return guarded(solve, limit_s)


def asked(case: Asked, limit_s: float, *, contact: str, part: Mapping[str, str] = MappingProxyType({})) -> Ended:
    """An algorithm on a request, with a measure or an element option, which need not be known to the scene."""
    more: dict[str, Value] = {key: value for key, value in part.items() if key != "measure"}
    measure = part.get("measure", "exact")
    try:
        scene, request = complete(case.scene, case.settings, case.mesh, contact=contact, measure=measure)
    except UsageError as error:
        return Ended(REFUSED, str(error))
    if "epsilon" in request.settings:
        more["epsilon"] = epsilon_of(contact)
    return followed(scene, replace(request, settings=request.settings.with_values(**more)), limit_s)


def against(
    who: str, case: Posed | Asked, found: Ended, reference: Answer | None = None, other: Answer | None = None
) -> Trial:
    """The row of a try beside the answer that it should have: the same set, displacements and forces to ALIKE.

    other: the answer by another law, that it is only measured from.
    """
    apart, away, agreement = math.nan, math.nan, ""
    if found.answer is not None and other is not None:
        away = difference(other, found.answer)
    if found.ended == SOLVED and found.answer is not None and reference is not None:
        apart = difference(reference, found.answer)
        agreement = _agreement(reference, found.answer, apart)
    return Trial(
        who, case.group, case.name, found.ended, found.reason, agreement=agreement, apart=apart, away=away, **found.cost
    )


def _agreement(one: Answer, other: Answer, apart: float) -> str:
    if apart <= ALIKE and same_set(one, other):
        return AGREES
    error = max(error_of(one), error_of(other))
    if apart <= MARGIN * error:
        return f"within what the tolerance leaves: apart by {apart:.1e}, one more step moves them by {error:.1e}"
    return DIFFERS if apart <= COARSE else compared(one, other) or DIFFERS


def guarded(solve: Callable[[], Ended], limit_s: float) -> Ended:
    """What it returns, or the end that an exception or the clock makes of it."""
    with quiet():
        try:
            with within(limit_s):
                return solve()
        except OvertimeError:
            return Ended(LATE, f"stopped after {limit_s:g} s")
        except UsageError as error:
            return Ended(REFUSED, str(error))
        except (MemoryError, KeyboardInterrupt):
            raise
        except Exception as error:  # whoever is tried may raise anything
            return Ended(RAISED, " ".join(f"{type(error).__name__}: {error}".split()))


def same_set(one: Answer, other: Answer) -> bool:
    """Whether the same candidates carry pressure; who touches without may be in a set or not."""
    p, q = one.state.pressure, other.state.pressure
    least = CARRIES * max(float(np.max(np.abs(p), initial=0.0)), float(np.max(np.abs(q), initial=0.0)))
    return not np.any((p > least) != (q > least))


def _judged(
    problem: ContactProblem, found: ContactSolution, algorithm: ContactAlgorithm, cost: Mapping[str, float]
) -> Ended:
    if found.outcome is Outcome.REFUSED:
        return Ended(REFUSED, _last(found), cost)
    if not found.outcome.converged:
        return Ended(FAILED, _last(found) or found.outcome.value, cost)
    verdict = judge(problem, found.u, found.pressure, epsilon=algorithm.epsilon)
    tolerance = float(getattr(algorithm, "tolerance", RESIDUAL_TOLERANCE))
    failures = verdict.failures(**claim(tolerance, len(found.u)))
    if failures:
        return Ended(FALSE, _told(failures, {**verdict.kkt, **verdict.balances}), cost)
    return Ended(SOLVED, "", cost, Answer(problem, found, algorithm))


def _last(found: ContactSolution) -> str:
    return str(found.history[-1].get("event") or "") if found.history else ""


def _told(failures: Sequence[str], residuals: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {residuals[name]:.1e}" if name in residuals else name for name in failures)
