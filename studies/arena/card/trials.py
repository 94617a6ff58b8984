"""One trial of an algorithm on one problem: its end, the verdict of the judge, its cost, and the answer.

Processor seconds and operations are those inside the algorithm, assembly included, without building and judging. Parts
are not compared here.
"""

from __future__ import annotations

import math
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from types import FrameType, MappingProxyType

import numpy as np

from contact.algorithms.base import answered, unsupported
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
from studies.solving.certificate import certificate, refusal
from studies.solving.solve import counted

ENDS = ("solved", "false claim", "not solved", "refused", "raised", "over the limit")
SOLVED, FALSE, FAILED, REFUSED, RAISED, LATE = ENDS
ALIKE = 1e-8  # relative, of displacements and contact forces
CARRIES = 1e-8  # of the largest pressure: smaller ones count as zero
AGREES, DIFFERS = "agrees", "differs"
COSTS = ("iterations", "factorisations", "operations", "seconds")
WATCH_S = 0.05
ASLEEP = 20.0  # times its processor time may a trial take on the clock
BRIEF_S = 10.0  # in which an algorithm says whether it supports a problem
REPEATS, QUICK_S = 2, 0.02  # a quick solve is repeated; the least time counts


class OvertimeError(BaseException):
    """A trial has exceeded its time; no ``except Exception`` of the code under trial catches it."""


@contextmanager
def within(seconds: float) -> Iterator[None]:
    """Raises OvertimeError inside after so many seconds of processor time, on the clock ASLEEP times as many.

    A loaded machine fails nobody. Compiled code returns first. A limit inside another one leaves that in force.
    """
    spent, clock = time.process_time(), time.monotonic()

    def look(number: int, frame: FrameType | None) -> None:
        if time.process_time() - spent > seconds or time.monotonic() - clock > ASLEEP * seconds:
            signal.setitimer(signal.ITIMER_REAL, 0)  # once: what unwinds is not interrupted again
            raise OvertimeError

    # looked at now and then: a timer of processor time makes that clock tick in 4 ms, by which trials are timed
    every = min(max(seconds, 1e-3), WATCH_S)
    handler = signal.signal(signal.SIGALRM, look)
    timer = signal.setitimer(signal.ITIMER_REAL, every, every)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, handler)
        signal.setitimer(signal.ITIMER_REAL, *timer)


@dataclass(frozen=True)
class Trial:
    """A row: part, problem, its end of ENDS and the reason, its cost, and the deviation from the reference (NaN: none).

    away: deviation from the answer with the reference part of the kind, for measures and element options.
    agreement: AGREES, DIFFERS, the explanation of a difference, or empty where nothing is compared.
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
    """Records the cost inside the algorithm: processor seconds, operations, its own counters."""

    spent: dict[str, float] = field(default_factory=lambda: dict.fromkeys(COSTS, 0.0))

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Solve, and add the cost."""
        with counted() as work:
            seconds, solution = timed(lambda: answered(self.inside, problem, start))
        counts = (solution.counters.get(key, 0) for key in ("newton_iterations", "factorisations"))
        for cost, spent in zip(COSTS, (*counts, sum(work.values()), seconds), strict=True):
            self.spent[cost] += spent
        return solution


@dataclass(frozen=True, eq=False)
class Ended:
    """The end of a trial, before any comparison; answer: the last state, where the path was completed."""

    ended: str
    reason: str = ""
    cost: Mapping[str, float] = field(default_factory=dict)
    answer: Answer | None = None


def epsilon_of(name: str) -> float:
    """The epsilon [MPa/mm] of the trials of an algorithm: infinity where it supports it, otherwise its default."""
    own, any_problem = ALGORITHMS[name], random_quadratic(np.random.default_rng(0), "definite").problem()
    exact = guarded(lambda: Ended(unsupported(own(epsilon=math.inf), any_problem) or ""), BRIEF_S)
    return math.inf if not exact.ended else own().epsilon


def alone(name: str, case: Posed, limit_s: float) -> Ended:
    """An algorithm on a single problem, from rest."""
    algorithm = ALGORITHMS[name](epsilon=epsilon_of(name))
    problem = case.problem

    def solve() -> Ended:
        refused = unsupported(algorithm, problem)
        if refused is not None:
            return Ended(REFUSED, refused)
        tried: list[Ended] = []
        while len(tried) < REPEATS and all(each.cost["seconds"] <= QUICK_S for each in tried):
            metered = Metered(algorithm)
            solution = metered.solve(problem, ContactSolution.at_rest(len(case.answer.u), len(case.answer.pressure)))
            tried.append(_judged(problem, solution, algorithm, metered.spent))
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
                reason = visited.said or visited.point.outcome.value
                return Ended(REFUSED if refused else FAILED, reason, metered.spent)
            observation = visited.stage.observe(visited.problem, solution, visited.point.requested)
            answer = Answer(visited.problem, solution, metered.inside)
            if observation.step is not None:
                tolerance = request.number("tolerance")
                verdict = certificate(visited.problem, solution, metered.epsilon, tolerance, visited.passed)
                if verdict["failures"]:
                    at = f"{visited.stage.name} at {visited.point.requested:g}"
                    return Ended(FALSE, f"{at}: {refusal(verdict)}", metered.spent)
        return Ended(SOLVED, "", metered.spent, answer)

    return guarded(solve, limit_s)


def asked(case: Asked, limit_s: float, *, contact: str, part: Mapping[str, str] = MappingProxyType({})) -> Ended:
    """An algorithm on a request, with a measure or an element option, which the scene need not offer."""
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
    who: str, case: Posed | Asked, result: Ended, reference: Answer | None = None, other: Answer | None = None
) -> Trial:
    """The row of a trial, compared with the reference: the same set, displacements and forces to ALIKE.

    other: the answer with the reference measure or element option, from which only the deviation is recorded.
    """
    apart, away, agreement = math.nan, math.nan, ""
    if result.answer is not None and other is not None:
        away = difference(other, result.answer)
    if result.ended == SOLVED and result.answer is not None and reference is not None:
        apart = difference(reference, result.answer)
        agreement = _agreement(reference, result.answer, apart)
    return Trial(
        who,
        case.group,
        case.name,
        result.ended,
        result.reason,
        agreement=agreement,
        apart=apart,
        away=away,
        **result.cost,
    )


def _agreement(one: Answer, other: Answer, apart: float) -> str:
    if apart <= ALIKE and same_set(one, other):
        return AGREES
    error = max(error_of(one), error_of(other))
    if apart <= MARGIN * error:
        return f"within what the tolerance leaves: apart by {apart:.1e}, one more step moves them by {error:.1e}"
    return DIFFERS if apart <= COARSE else compared(one, other) or DIFFERS


def guarded(solve: Callable[[], Ended], limit_s: float) -> Ended:
    """The result of ``solve``, or the end given by an exception or the time limit."""
    with quiet():
        try:
            with within(limit_s):
                return solve()
        except OvertimeError:
            return Ended(LATE, f"stopped after {limit_s:g} s")
        except UsageError as error:
            return Ended(REFUSED, str(error))
        except KeyboardInterrupt:
            raise
        except (Exception, SystemExit) as error:  # the code under trial may raise anything
            return Ended(RAISED, " ".join(f"{type(error).__name__}: {error}".split()))


def same_set(one: Answer, other: Answer) -> bool:
    """Whether the same candidates carry pressure; those that touch without it may be in either set."""
    p, q = one.state.pressure, other.state.pressure
    least = CARRIES * max(float(np.max(np.abs(p), initial=0.0)), float(np.max(np.abs(q), initial=0.0)))
    return not np.any((p > least) != (q > least))


def _judged(
    problem: ContactProblem, solution: ContactSolution, algorithm: ContactAlgorithm, cost: Mapping[str, float]
) -> Ended:
    if solution.outcome is Outcome.REFUSED:
        return Ended(REFUSED, _last(solution), cost)
    if not solution.outcome.converged:
        return Ended(FAILED, _last(solution) or solution.outcome.value, cost)
    verdict = judge(problem, solution.u, solution.pressure, epsilon=algorithm.epsilon)
    tolerance = float(getattr(algorithm, "tolerance", RESIDUAL_TOLERANCE))
    exceeded = verdict.exceeded(**claim(tolerance, len(solution.u)))
    if exceeded:
        return Ended(FALSE, refusal({"failures": list(exceeded), "exceeded": exceeded, "diagnosis": ()}), cost)
    return Ended(SOLVED, "", cost, Answer(problem, solution, algorithm))


def _last(solution: ContactSolution) -> str:
    return str(solution.history[-1].get("event") or "") if solution.history else ""
