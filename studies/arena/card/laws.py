"""The laws that every contact algorithm keeps, alone and from outside as well as in the catalogue.

As of measures (:mod:`studies.experiments.conformance`), a law is a number found and the interval that it must lie in.
What an algorithm refuses by ``supports`` is refused, not broken.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, ContactSolution
from contact.verify import judge
from studies.arena.card.quadratics import (
    OPEN,
    PRESSED,
    TOUCHING,
    Quadratic,
    dual_by_nnls,
    manufactured,
    random_quadratic,
)
from studies.arena.card.trials import Ended, epsilon_of, guarded
from studies.experiments.conformance import Check
from studies.scene import Setting, UsageError

ORACLE = 1e-7  # agreement with independent solutions, all quantities are of the order one
KINDS = ("obstacle", "definite", "inclined")
SEEDS = range(4)
SIZES = (1e-6, 1e6)
LIMIT_S = 20.0  # of a law, on the clock
STATES = {
    "all open": [OPEN] * 5,
    "all pressed": [PRESSED] * 5,
    "some touch without pressure": [OPEN, TOUCHING, PRESSED, TOUCHING, PRESSED],
    "all touch without pressure": [TOUCHING] * 5,
}


@dataclass(frozen=True)
class Law:
    """A law: the number found, the interval [low, high] that it must lie in, and why it was refused, or what failed."""

    law: str
    found: float
    low: float = 0.0
    high: float = 0.0
    refused: str = ""
    said: str = ""

    @classmethod
    def of(cls, check: Check) -> Law:
        """A check of the conformance kit."""
        return cls(check.law, check.found, check.low, check.high)

    @property
    def kept(self) -> bool:
        """False for NaN, too; what is refused is not broken."""
        return bool(self.refused) or self.low <= self.found <= self.high


def laws_of(name: str) -> Iterator[Law]:
    """Every law of an algorithm of the catalogue, one after another; what one raises breaks it."""
    for law, measured, high in LAWS:
        found: list[tuple[float, str]] = []
        ended = guarded(partial(_into, found, measured, name), LIMIT_S)
        if ended.ended:
            refused = ended.ended == "refused"
            yield Law(law, math.nan, 0.0, high, ended.reason if refused else "", ended.reason)
        else:
            yield Law(law, found[0][0], 0.0, high, said=found[0][1])


def _into(found: list[tuple[float, str]], measured: Callable[[str], tuple[float, str]], name: str) -> Ended:
    found.append(measured(name))
    return Ended("")


# --- each: (the number found, what was worst) -------------------------------------------------------------------------


def _parameters(name: str) -> tuple[float, str]:
    """How many parameters are no fields with a default in their range."""
    own = ALGORITHMS[name]
    if not dataclasses.is_dataclass(own):
        return math.inf, "no dataclass"
    fields = {field.name: field.default for field in dataclasses.fields(own)}
    wrong = [parameter.key for parameter in own.parameters if not parameter.meaning]
    for parameter in own.parameters:
        default = fields[parameter.key]
        try:
            if Setting.of(parameter, None).parse(str(default)) != default:
                wrong.append(parameter.key)
        except UsageError:
            wrong.append(parameter.key)
    if own().name != name:
        wrong.append("name")
    return len(wrong), ", ".join(wrong)


def _independent(name: str) -> tuple[float, str]:
    """Distance to non-negative least squares on the dual; infinite where it does not converge on an M-matrix."""
    worst, where = 0.0, ""
    for kind in KINDS:
        for seed in SEEDS:
            data = random_quadratic(np.random.default_rng(seed), kind)
            found = _from_rest(name, data.problem(), data)
            off = _off(found, *dual_by_nnls(data, epsilon_of(name))) if found.outcome.converged else math.inf
            if not found.outcome.converged and kind != "obstacle":
                continue  # a plain active set may fail on any other matrix, if it says so
            worst, where = max((worst, where), (off, f"{kind}, seed {seed}"))
    return worst, where


def _touching(name: str) -> tuple[float, str]:
    """Distance to an answer that is built in, candidates that touch without pressure and full contact included."""
    worst, where = 0.0, ""
    for said, states in STATES.items():
        for kind in KINDS:
            rng = np.random.default_rng(7)
            data, u, pressure = manufactured(rng, kind, np.array(states), epsilon_of(name))
            found = _from_rest(name, data.problem(), data)
            off = _off(found, u, pressure) if found.outcome.converged else math.inf
            worst, where = max((worst, where), (off, f"{kind}, {said}"))
    return worst, where


def _sizes(name: str) -> tuple[float, str]:
    """Relative distance to an answer a million times smaller, or larger."""
    worst, where = 0.0, ""
    for size in SIZES:
        data, u, pressure = manufactured(np.random.default_rng(7), "inclined", np.arange(9) % 3, epsilon_of(name))
        scaled = Quadratic(data.K, size * data.f, data.G, size * data.g0, data.w)
        found = _from_rest(name, scaled.problem(), scaled)
        off = _off(found, size * u, size * pressure) / size if found.outcome.converged else math.inf
        worst, where = max((worst, where), (off, f"times {size:g}"))
    return worst, where


def _restart(name: str) -> tuple[float, str]:
    """How far it goes from its own answer."""
    data = random_quadratic(np.random.default_rng(3), "obstacle")
    first = _from_rest(name, data.problem(), data)
    again = ALGORITHMS[name](epsilon=epsilon_of(name)).solve(data.problem(), first)
    return _off(again, first.u, first.pressure) if again.outcome.converged else math.inf, ""


def _same_twice(name: str) -> tuple[float, str]:
    """Distance between two answers to the same question."""
    worst = 0.0
    for seed in SEEDS:
        data = random_quadratic(np.random.default_rng(seed), "definite", 12)
        one, two = (_from_rest(name, data.problem(), data) for _ in range(2))
        worst = max(worst, float(np.max(np.abs(one.u - two.u))), float(one.outcome is not two.outcome))
    return worst, ""


def _start_kept(name: str) -> tuple[float, str]:
    """How much of the state that it is given it has written over."""
    data = random_quadratic(np.random.default_rng(3), "definite")
    first = _from_rest(name, data.problem(), data)
    parts = (first.u, first.pressure, first.active)
    before = [part.copy() for part in parts]
    ALGORITHMS[name](epsilon=epsilon_of(name)).solve(data.problem(), first)
    return float(sum(np.sum(part != kept) for part, kept in zip(parts, before, strict=True))), ""


def _no_answer(name: str) -> tuple[float, str]:
    """How many problems without an answer, or with no numbers, are said to be solved against the judge."""
    hopeless = {
        "no number": Quadratic(np.eye(2), np.array([np.nan, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2)),
        "no solution": Quadratic(np.diag([-1.0, 1.0]), np.array([1.0, 0.0]), np.eye(2), np.zeros(2), np.ones(2)),
        "no stiffness": Quadratic(
            np.zeros((2, 2)), np.array([1.0, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2)
        ),
    }
    false = []
    for said, data in hopeless.items():
        problem = data.problem()
        found = _from_rest(name, problem, data)
        if found.outcome.converged:
            finite = np.all(np.isfinite(found.u)) and np.all(np.isfinite(data.f))
            if not finite or judge(problem, found.u, found.pressure, epsilon=epsilon_of(name)).failures():
                false.append(said)
    return len(false), ", ".join(false)


def _no_candidate(name: str) -> tuple[float, str]:
    """Distance to plain equilibrium where nothing can touch."""
    data = Quadratic(np.eye(2), np.array([1.0, 0.5]), np.zeros((0, 2)), np.zeros(0), np.zeros(0))
    found = _from_rest(name, data.problem(), data)
    return _off(found, data.f, np.zeros(0)) if found.outcome.converged else math.inf, ""


def _from_rest(name: str, problem: ContactProblem, data: Quadratic) -> ContactSolution:
    """Solved from rest; raises UsageError where the algorithm refuses."""
    algorithm = ALGORITHMS[name](epsilon=epsilon_of(name))
    refused = algorithm.supports(problem)
    if refused is not None:
        raise UsageError(refused)
    return algorithm.solve(problem, ContactSolution.at_rest(len(data.f), len(data.w)))


def _off(found: ContactSolution, u: np.ndarray, pressure: np.ndarray) -> float:
    apart: Sequence[np.ndarray] = (found.u - u, found.pressure - pressure)
    return max(float(np.max(np.abs(part), initial=0.0)) for part in apart)


LAWS: tuple[tuple[str, Callable[[str], tuple[float, str]], float], ...] = (
    ("parameters are fields with a meaning and a default in range", _parameters, 0.0),
    ("answers are those of non-negative least squares", _independent, ORACLE),
    ("touch without pressure and full contact do not matter", _touching, ORACLE),
    ("the size of the numbers does not matter", _sizes, ORACLE),
    ("a restart from the answer stays there", _restart, ORACLE),
    ("the same question has the same answer", _same_twice, ORACLE),
    ("the start is left as it was", _start_kept, 0.0),
    ("what has no answer is not said to be solved", _no_answer, 0.0),
    ("without a candidate it is plain equilibrium", _no_candidate, 1e-12),
)
