"""One frozen step with friction again, alone, by any algorithm; the judge has the word, and the oracle if asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.algorithms.base import require_friction
from contact.answered import answered
from contact.coulomb import State
from contact.interchange.friction_oracle import confirm
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import Confirmation, OracleError
from contact.problem import ContactAlgorithm, ContactSolution
from contact.verify import judge
from studies.arena.replay import Resolved, of_a_part, said_by
from studies.ask.scene import UsageError


@dataclass(frozen=True, eq=False)
class ResolvedWithFriction(Resolved):
    """The certificate is by the law of ``epsilon``, in both directions."""

    def lines(self) -> list[str]:
        """What a user reads."""
        found, told = self.solution, self.step.meta
        origin = ", ".join(f"{key} {told[key]}" for key in ("scene", "mesh", "stage", "parameter") if key in told)
        sticks, slips = (int(np.sum(found.rubbed.state == each)) for each in (State.STICK, State.SLIP))
        pull, push = np.linalg.norm(found.rubbed.force, axis=1).sum(), self.step.weights @ found.pressure
        lines = [
            f"{len(self.step.r)} unknowns, {len(self.step.gap)} candidates with friction"
            + (f": {origin}" if origin else ""),
            f"{found.outcome.value}: {int(found.counters['newton_iterations'])} iterations, "
            f"{sticks} stick, {slips} slip, normal forces {float(push):.9g} N, "
            f"of friction {float(pull):.9g} N, epsilon {self.epsilon:g}",
            ", ".join(f"{name} {value:.1e}" for name, value in self.certificate["kkt"].items()),
            *(f"wrong: {name}" for name in self.certificate["failures"]),
            *of_a_part(told),
        ]
        return [*lines, *said_by(self.oracle)]


def resolve_with_friction(
    step: FrozenFrictionalStep, algorithm: ContactAlgorithm, *, oracle: bool = False
) -> ResolvedWithFriction:
    """Solve a frozen step from rest and judge it; raises UsageError with one line."""
    problem = step.problem()
    require_friction(algorithm)
    refused = algorithm.supports(problem)
    if refused is not None:
        raise UsageError(f"{algorithm.name} does not apply: {refused}")
    found = answered(algorithm, problem, ContactSolution.at_rest(len(step.r), len(step.mu)))
    said: Confirmation | str | None = None
    if oracle:
        try:
            said = confirm(step, found.u, problem.nodal_forces(found.pressure), found.rubbed.force)
        except OracleError as error:
            said = str(error)
    verdict = judge(problem, found.u, found.pressure, found.rubbed.force, epsilon=algorithm.epsilon)
    return ResolvedWithFriction(step, found, verdict.certificate, algorithm.epsilon, said)
