"""The laws that every contact algorithm and every solver of frozen problems must satisfy, plug-ins included.

As for measures (:mod:`studies.experiments.conformance`), a law is a measured value and the interval it must lie in.
A problem that a part refuses breaks no law. Solvers run in a separate process, as in the trials.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np

from contact.algorithms.base import answered, unsupported
from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from contact.verify import judge
from studies.arena.answers import Scales
from studies.arena.card.problems import (
    HOPELESS,
    OPEN,
    PRESSED,
    TOUCHING,
    Quadratic,
    dual_by_nnls,
    manufactured,
    random_quadratic,
)
from studies.arena.card.trials import REFUSED, Ended, epsilon_of, guarded
from studies.arena.solver_table import judged
from studies.arena.solvers.base import Solver
from studies.arena.solvers.catalogue import SOLVERS
from studies.arena.solvers.process import Child
from studies.ask.scene import Setting, UsageError
from studies.experiments.conformance import Check

ORACLE = 1e-7  # agreement with independent solutions, all quantities are of the order one
KINDS = ("obstacle", "definite", "inclined")
SEEDS = range(4)
SIZES = (1e-6, 1e6)
LIMIT_S = 20.0  # of a law, processor time
STATES = {
    "all open": [OPEN] * 5,
    "all pressed": [PRESSED] * 5,
    "some touch without pressure": [OPEN, TOUCHING, PRESSED, TOUCHING, PRESSED],
    "all touch without pressure": [TOUCHING] * 5,
}
SOLVER_LIMIT_S, TOLERANCE = 5.0, 1e-6  # of a solver: processor time, and the accuracy required
SOLVER_LAWS = (
    "an answer has the shape of its problem",
    "a claim of a built-in answer is true",
    "what has no answer is not said to be solved",
)


Measurement = tuple[float, str]  # a value, and what it was measured on


@dataclass(frozen=True)
class Tried:
    """An algorithm of the catalogue, with the epsilon of its trials."""

    name: str

    @cached_property
    def epsilon(self) -> float:
        """[MPa/mm]."""
        return epsilon_of(self.name)

    def solve(
        self, data: Quadratic, start: ContactSolution | None = None, problem: ContactProblem | None = None
    ) -> ContactSolution:
        """From ``start``, by default from rest; ``problem``: that of the data. Raises UsageError where it refuses."""
        algorithm, problem = ALGORITHMS[self.name](epsilon=self.epsilon), problem or data.problem()
        refused = unsupported(algorithm, problem)
        if refused is not None:
            raise UsageError(refused)
        return answered(algorithm, problem, start or ContactSolution.at_rest(len(data.f), len(data.w)))

    def off(self, data: Quadratic, u: np.ndarray, pressure: np.ndarray, start: ContactSolution | None = None) -> float:
        """Largest deviation of its answer from u and pressure; infinite without convergence, NaN for NaN."""
        solution = self.solve(data, start)
        if not solution.outcome.converged:
            return math.inf
        apart = np.max(np.abs(np.append(solution.u - u, solution.pressure - pressure)), initial=0.0)
        return float(apart) if np.isfinite(apart) else math.nan


def laws_of(name: str) -> Iterator[Check]:
    """Every law of an algorithm of the catalogue in turn; an exception breaks the law."""
    tried = Tried(name)
    for law, measured, high in LAWS:
        measurements: list[Measurement] = []
        ended = guarded(partial(_into, measurements, measured, tried), LIMIT_S)
        if ended.ended:
            refused = ended.reason if ended.ended == REFUSED else ""
            yield Check(law, math.nan, 0.0, high, refused, ended.reason)
        else:
            worst = max(measurements, key=lambda each: (math.inf if math.isnan(each[0]) else each[0], each[1]))
            yield Check(law, worst[0], 0.0, high, said=worst[1])


def _into(measurements: list[Measurement], measured: Callable[[Tried], Iterator[Measurement]], tried: Tried) -> Ended:
    measurements += measured(tried)
    return Ended("")


# --- of an algorithm, each: the measured values, the largest of which counts ------------------------------------------


def _parameters(tried: Tried) -> Iterator[Measurement]:
    """The number of parameters that are no field with a default in range."""
    own = ALGORITHMS[tried.name]
    if not dataclasses.is_dataclass(own):
        yield math.inf, "no dataclass"
        return
    fields = {field.name: field.default for field in dataclasses.fields(own)}
    wrong = [parameter.key for parameter in own.parameters if not parameter.meaning]
    for parameter in own.parameters:
        default = fields[parameter.key]
        try:
            if Setting.of(parameter, None).parse(str(default)) != default:
                wrong.append(parameter.key)
        except UsageError:
            wrong.append(parameter.key)
    if own().name != tried.name:
        wrong.append("name")
    yield len(wrong), ", ".join(wrong)


def _independent(tried: Tried) -> Iterator[Measurement]:
    """Deviation from non-negative least squares on the dual; infinite where it does not converge on an M-matrix."""
    for kind, seed in product(KINDS, SEEDS):
        data = random_quadratic(np.random.default_rng(seed), kind)
        off = tried.off(data, *dual_by_nnls(data, tried.epsilon))
        if off != math.inf or kind == "obstacle":  # a plain active set may fail on any other matrix, if it reports it
            yield off, f"{kind}, seed {seed}"


def _touching(tried: Tried) -> Iterator[Measurement]:
    """Deviation from a built-in answer, including touching candidates without pressure and full contact."""
    for (label, states), kind in product(STATES.items(), KINDS):
        rng = np.random.default_rng(7)
        yield tried.off(*manufactured(rng, kind, np.array(states), tried.epsilon)), f"{kind}, {label}"


def _sizes(tried: Tried) -> Iterator[Measurement]:
    """Relative deviation from an answer a million times smaller, or larger."""
    for size in SIZES:
        data, u, pressure = manufactured(np.random.default_rng(7), "inclined", np.arange(9) % 3, tried.epsilon)
        scaled = replace(data, f=size * data.f, g0=size * data.g0)
        yield tried.off(scaled, size * u, size * pressure) / size, f"times {size:g}"


def _restart(tried: Tried) -> Iterator[Measurement]:
    """Deviation from its own answer after a restart."""
    data = random_quadratic(np.random.default_rng(3), "obstacle")
    first = tried.solve(data)
    yield tried.off(data, first.u, first.pressure, first), ""


def _same_twice(tried: Tried) -> Iterator[Measurement]:
    """Deviation between two answers to the same problem."""
    for seed in SEEDS:
        data = random_quadratic(np.random.default_rng(seed), "definite", 12)
        one, two = (tried.solve(data) for _ in range(2))
        yield max(float(np.max(np.abs(one.u - two.u))), float(one.outcome is not two.outcome)), ""


def _kept(tried: Tried) -> Iterator[Measurement]:
    """The number of entries of the start, of stiffness, gap Jacobian and areas that it has overwritten."""
    data = random_quadratic(np.random.default_rng(3), "definite")
    problem, first = data.problem(), tried.solve(data)

    def parts() -> Iterator[np.ndarray]:
        yield from (first.u, first.pressure, first.active, problem.weights)
        yield from (problem.linearise(first.u, None).tangent.toarray(), problem.gap_jacobian(first.u).toarray())

    before = [part.copy() for part in parts()]
    tried.solve(data, first, problem)
    yield float(sum(np.sum(part != kept) for part, kept in zip(parts(), before, strict=True))), ""


def _set(tried: Tried) -> Iterator[Measurement]:
    """The number of candidates in exactly one of its set and of those that press in a built-in answer."""
    for kind in KINDS:
        states = np.array([OPEN, PRESSED, OPEN, PRESSED, PRESSED])
        solution = tried.solve(manufactured(np.random.default_rng(7), kind, states, tried.epsilon)[0])
        if solution.outcome.converged:
            yield float(np.sum(solution.active != (states == PRESSED))), kind
    yield 0.0, ""


def _no_answer(tried: Tried) -> Iterator[Measurement]:
    """The number of problems without an answer, or with NaN, that it claims to solve against the judge."""
    false = []
    for label, data in HOPELESS.items():
        solution = tried.solve(data)
        if solution.outcome.converged:
            finite = np.all(np.isfinite(solution.u)) and np.all(np.isfinite(data.f))
            if not finite or judge(data.problem(), solution.u, solution.pressure, epsilon=tried.epsilon).failures():
                false.append(label)
    yield len(false), ", ".join(false)


def _no_candidate(tried: Tried) -> Iterator[Measurement]:
    """Deviation from plain equilibrium without candidates."""
    data = Quadratic(np.eye(2), np.array([1.0, 0.5]), np.zeros((0, 2)), np.zeros(0), np.zeros(0))
    yield tried.off(data, data.f, np.zeros(0)), ""


LAWS: tuple[tuple[str, Callable[[Tried], Iterator[Measurement]], float], ...] = (
    ("parameters are fields with a meaning and a default in range", _parameters, 0.0),
    ("answers are those of non-negative least squares", _independent, ORACLE),
    ("touch without pressure and full contact do not matter", _touching, ORACLE),
    ("the size of the numbers does not matter", _sizes, ORACLE),
    ("a restart from the answer stays there", _restart, ORACLE),
    ("the same question has the same answer", _same_twice, ORACLE),
    ("the start and the problem are left as they were", _kept, 0.0),
    ("the set is that of the nodes that press", _set, 0.0),
    ("what has no answer is not said to be solved", _no_answer, 0.0),
    ("without a candidate it is plain equilibrium", _no_candidate, 1e-12),
)


# --- of a solver ------------------------------------------------------------------------------------------------------


def solver_laws(name: str) -> Iterator[Check]:
    """The number of answers that break each law; refused where it is not installed or applies to no problem."""
    solver = SOLVERS[name]
    missing = solver.missing()
    if missing:
        yield from (Check(law, math.nan, refused=missing) for law in SOLVER_LAWS)
        return
    with closing(Child(SOLVER_LIMIT_S)) as child:
        yield from _built_in(child, solver)
        yield _hopeless(child, solver)


def _built_in(child: Child, solver: Solver) -> Iterator[Check]:
    """Shapes and claims of answers to problems with a built-in answer."""
    shapes, false, refusals = [], [], list[str]()
    for (label, states), kind in product(STATES.items(), KINDS):
        step = manufactured(np.random.default_rng(7), kind, np.array(states))[0].step()
        refused = solver.applies(step)
        if refused is not None:
            refusals.append(refused)
            continue
        answer, _ = child.solve(solver, step, TOLERANCE)
        if answer.du.shape != step.r.shape or answer.pressure.shape != step.gap.shape:
            shapes.append(f"{kind}, {label}")
        elif judged(answer, step, TOLERANCE, Scales.of(step))["false"]:
            false.append(f"{kind}, {label}")
    refusal = refusals[-1] if len(refusals) == len(STATES) * len(KINDS) else ""
    for law, wrong in zip(SOLVER_LAWS, (shapes, false), strict=False):
        yield Check(law, len(wrong), refused=refusal, said=", ".join(wrong))


def _hopeless(child: Child, solver: Solver) -> Check:
    """A problem with NaN, and -x - 1 = p, which has no p >= 0 where x >= 0."""
    claimed, refusals = [], []
    for label in ("no number", "no solution"):
        step = HOPELESS[label].step()
        refused = solver.applies(step)
        if refused is not None:
            refusals.append(refused)
        elif child.solve(solver, step, TOLERANCE)[0].claimed:
            claimed.append(label)
    refusal = refusals[0] if len(refusals) == 2 else ""
    return Check(SOLVER_LAWS[2], len(claimed), refused=refusal, said=", ".join(claimed))
