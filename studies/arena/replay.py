"""Solve one frozen contact step again, alone, by any algorithm; the judge has the word, and the oracle if asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact.answered import answered
from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep, FrozenStepError
from contact.interchange.oracle import Confirmation, OracleError, confirm
from contact.problem import ContactAlgorithm, ContactSolution
from studies.ask.scene import UsageError
from studies.solving.certificate import certificate


@dataclass(frozen=True, eq=False)
class Resolved:
    """The step, its solution, its certificate by the law of ``epsilon``, and what the oracle says or why it can not."""

    step: FrozenStep
    solution: ContactSolution
    certificate: dict[str, Any]
    epsilon: float
    oracle: Confirmation | str | None = None

    @property
    def sound(self) -> bool:
        """Judged without a failure, and not contradicted by the oracle."""
        return not self.certificate["failures"] and not (
            isinstance(self.oracle, Confirmation) and not self.oracle.agrees
        )

    def lines(self) -> list[str]:
        """What a user reads."""
        step, found, told = self.step, self.solution, self.step.meta
        origin = ", ".join(f"{key} {told[key]}" for key in ("scene", "mesh", "stage", "parameter") if key in told)
        force = float(np.sum(step.problem().nodal_forces(found.pressure)))
        lines = [
            f"{len(step.r)} unknowns, {len(step.gap)} candidates" + (f": {origin}" if origin else ""),
            f"{found.outcome.value}: {int(found.counters['newton_iterations'])} iterations, "
            f"{int(found.active.sum())} contact nodes, force {force:.9g} N, epsilon {self.epsilon:g}",
            ", ".join(f"{name} {value:.1e}" for name, value in self.certificate["kkt"].items()),
            *self.certificate["diagnosis"],
            *of_a_part(told),
        ]
        return [*lines, *said_by(self.oracle)]


FULL = "full"  # the model that is the whole scene


def of_a_part(meta: Mapping[str, Any]) -> list[str]:
    """That a step is of a part of its scene, where it is: whoever solved the whole saw more nodes and another force."""
    model = meta.get("model", FULL)
    return [] if model == FULL else [f"of the model {model} alone: forces and nodes are those of that part"]


def said_by(oracle: Confirmation | str | None) -> list[str]:
    """What a user reads of the oracle: nothing where it was not asked."""
    if oracle is None:
        return []
    if isinstance(oracle, str):
        return [f"no oracle: {oracle}"]
    verdict = "agrees" if oracle.agrees else f"differs at {len(oracle.differing)} candidates"
    return [f"oracle {verdict}: forces to {oracle.force_error:.1e}"]


def read_step(path: Path) -> FrozenStep:
    """The frozen step in a file; raises UsageError with one line."""
    try:
        return FrozenStep.read(path)
    except FrozenStepError as error:
        raise UsageError(str(error)) from None


def algorithm_of(contact: str, epsilon: float | None = None) -> ContactAlgorithm:
    """One of the catalogue, with an epsilon [MPa/mm] or its own; raises UsageError."""
    if contact not in ALGORITHMS:
        raise UsageError(f"contact {contact!r} must be one of {', '.join(ALGORITHMS)}")
    return ALGORITHMS[contact]() if epsilon is None else ALGORITHMS[contact](epsilon=epsilon)


def resolve_step(step: FrozenStep, algorithm: ContactAlgorithm, *, oracle: bool = False) -> Resolved:
    """Solve a frozen step from rest, judge it; raises UsageError with one line."""
    problem = step.problem()
    refused = algorithm.supports(problem)
    if refused is not None:
        raise UsageError(f"{algorithm.name} does not apply: {refused}")
    solution = answered(algorithm, problem, ContactSolution.at_rest(len(step.r), len(step.gap)))
    said: Confirmation | str | None = None
    if oracle:
        try:
            said = confirm(step, solution.u, solution.pressure, algorithm.epsilon)
        except OracleError as error:
            said = str(error)
    return Resolved(step, solution, certificate(problem, solution, algorithm.epsilon), algorithm.epsilon, said)
