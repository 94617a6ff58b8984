"""Solve one frozen contact step again, alone, by any algorithm; the judge has the word, and the oracle if asked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep, FrozenStepError
from contact.interchange.oracle import Confirmation, OracleError, confirm
from contact.problem import ContactSolution
from studies.certificate import certificate
from studies.scene import UsageError

if TYPE_CHECKING:
    from studies.friction.replay import ResolvedWithFriction

FRICTION = "friction"  # of the meta of a step with friction


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
        ]
        if isinstance(self.oracle, str):
            lines.append(f"no oracle: {self.oracle}")
        elif self.oracle is not None:
            verdict = "agrees" if self.oracle.agrees else f"differs at {len(self.oracle.differing)} candidates"
            lines.append(f"oracle {verdict}: forces to {self.oracle.force_error:.1e}")
        return lines


def resolve_step(
    path: Path, contact: str, epsilon: float | None = None, *, oracle: bool = False
) -> Resolved | ResolvedWithFriction:
    """Read a frozen step, solve it from rest, judge it; raises UsageError with one line. With friction, if it has any.

    epsilon [MPa/mm]: None is the algorithm's own.
    """
    if contact not in ALGORITHMS:
        raise UsageError(f"contact {contact!r} must be one of {', '.join(ALGORITHMS)}")
    try:
        step = FrozenStep.read(path)
    except FrozenStepError as error:
        raise UsageError(str(error)) from None
    algorithm = ALGORITHMS[contact]() if epsilon is None else ALGORITHMS[contact](epsilon=epsilon)
    if FRICTION in step.meta:
        from studies.friction.replay import resolve_with_friction  # nothing of friction is imported without it

        return resolve_with_friction(path, algorithm, oracle=oracle)
    problem = step.problem()
    refused = algorithm.supports(problem)
    if refused is not None:
        raise UsageError(f"{algorithm.name} does not apply: {refused}")
    solution = algorithm.solve(problem, ContactSolution.at_rest(len(step.r), len(step.gap)))
    said: Confirmation | str | None = None
    if oracle:
        try:
            said = confirm(step, solution.u, solution.pressure, algorithm.epsilon)
        except OracleError as error:
            said = str(error)
    return Resolved(step, solution, certificate(problem, solution, algorithm.epsilon), algorithm.epsilon, said)
