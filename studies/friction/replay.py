"""One frozen step with friction again, alone, by any algorithm; the judge has the word, and the oracle if asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from contact.friction.algorithms.catalogue import twin
from contact.friction.interchange.frozen import MARK, FrozenFrictionalStep
from contact.friction.interchange.oracle import Confirmation, confirm
from contact.friction.problem import FrictionalSolution, State
from contact.friction.verify import FrictionVerdict, judge
from contact.interchange.linearised_step import FrozenStep, FrozenStepError
from contact.interchange.oracle import OracleError
from contact.problem import ContactAlgorithm
from studies.arena.replay import of_a_part, said_by
from studies.scene import UsageError


@dataclass(frozen=True, eq=False)
class ResolvedWithFriction:
    """The step, its solution, the verdict by the law of ``epsilon``, and what the oracle says or why it can not."""

    step: FrozenFrictionalStep
    solution: FrictionalSolution
    verdict: FrictionVerdict
    epsilon: float
    oracle: Confirmation | str | None = None

    @property
    def sound(self) -> bool:
        """Judged without a failure, and not contradicted by the oracle."""
        return not self.verdict.failures() and not (isinstance(self.oracle, Confirmation) and not self.oracle.agrees)

    def lines(self) -> list[str]:
        """What a user reads."""
        found, told = self.solution, self.step.step.meta
        origin = ", ".join(f"{key} {told[key]}" for key in ("scene", "mesh", "stage", "parameter") if key in told)
        sticks, slips = (int(np.sum(found.state == each)) for each in (State.STICK, State.SLIP))
        pull = float(np.linalg.norm(found.friction, axis=1).sum())
        lines = [
            f"{len(self.step.step.r)} unknowns, {len(self.step.mu)} candidates with friction"
            + (f": {origin}" if origin else ""),
            f"{found.outcome.value}: {int(found.counters['newton_iterations'])} iterations, "
            f"{sticks} stick, {slips} slip, normal forces {float(found.normal.sum()):.9g} N, "
            f"of friction {pull:.9g} N, epsilon {self.epsilon:g}",
            ", ".join(f"{name} {value:.1e}" for name, value in self.verdict.kkt.items()),
            *(f"wrong: {name}" for name in self.verdict.failures()),
            *of_a_part(told),
        ]
        return [*lines, *said_by(self.oracle)]


def has_friction(step: FrozenStep) -> bool:
    """Whether a file, read as a step without friction, has some."""
    return all(step.meta.get(key) == value for key, value in MARK.items())


def resolve_with_friction(path: Path, plain: ContactAlgorithm, *, oracle: bool = False) -> ResolvedWithFriction:
    """Read a frozen step, solve it from rest by the twin of ``plain``, judge it; raises UsageError with one line."""
    try:
        step = FrozenFrictionalStep.read(path)
    except FrozenStepError as error:
        raise UsageError(str(error)) from None
    problem, algorithm = step.problem(), twin(plain)
    refused = algorithm.supports(problem)
    if refused is not None:
        raise UsageError(f"{plain.name} does not apply: {refused}")
    found = algorithm.solve(problem, FrictionalSolution.at_rest(len(step.step.r), len(step.mu)))
    said: Confirmation | str | None = None
    if oracle:
        try:
            said = confirm(step, found.u, found.normal, found.friction)
        except OracleError as error:
            said = str(error)
    verdict = judge(problem, found.u, found.normal, found.friction, epsilon=algorithm.epsilon)
    return ResolvedWithFriction(step, found, verdict, algorithm.epsilon, said)
