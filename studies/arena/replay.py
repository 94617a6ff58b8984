"""Solve one frozen step again with any algorithm, or judge an answer to it; on request the oracle confirms it."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact.algorithms.base import answered, require_friction, unsupported
from contact.catalogue import ALGORITHMS
from contact.coulomb import State
from contact.interchange import friction_oracle, oracle
from contact.interchange.linearised_step import FrozenFrictionalStep, FrozenStep, FrozenStepError
from contact.interchange.oracle import Confirmation, OracleError
from contact.problem import ContactAlgorithm, ContactSolution
from contact.verify import judge
from studies.arena.answers import CERTIFIED, Judgement, judge_answer, judge_friction_answer, read_answer
from studies.ask.scene import UsageError
from studies.solving.certificate import certificate

WHOLE = "full"  # the model that is the whole scene


@dataclass(frozen=True, eq=False)
class Resolved:
    """The step, its solution, its certificate by the law of ``epsilon``, and the confirmation, or why there is none."""

    step: FrozenStep
    solution: ContactSolution
    certificate: dict[str, Any]
    epsilon: float
    oracle: Confirmation | str | None = None

    @property
    def sound(self) -> bool:
        """Whether the judge has no failure and the oracle does not contradict."""
        return not self.certificate["failures"] and not (
            isinstance(self.oracle, Confirmation) and not self.oracle.agrees
        )

    def lines(self) -> list[str]:
        """The report for the user."""
        step, solution, meta = self.step, self.solution, self.step.meta
        rubs = isinstance(step, FrozenFrictionalStep)
        meta = {key: " ".join(str(value).split()) for key, value in meta.items()}  # no line feeds
        origin = ", ".join(f"{key} {meta[key]}" for key in ("scene", "mesh", "stage", "parameter") if key in meta)
        size = f"{len(step.r)} unknowns, {len(step.gap)} candidates{' with friction' if rubs else ''}"
        lines = [
            size + (f": {origin}" if origin else ""),
            f"{solution.outcome.value}: {int(solution.counters['newton_iterations'])} iterations, "
            f"{self._friction() if rubs else self._contact()}, epsilon {self.epsilon:g}",
            ", ".join(f"{name} {value:.1e}" for name, value in self.certificate["kkt"].items()),
        ]
        lines += [f"wrong: {name}" for name in self.certificate["failures"]] if rubs else self.certificate["diagnosis"]
        model = meta.get("model", WHOLE)
        if model != WHOLE:  # the solve of the whole model has more nodes and another force
            lines.append(f"of the model {model} alone: forces and nodes are those of that part")
        if isinstance(self.oracle, Confirmation):
            verdict = "agrees" if self.oracle.agrees else f"differs at {len(self.oracle.differing)} candidates"
            lines.append(f"oracle {verdict}: forces to {self.oracle.force_error:.1e}")
        elif self.oracle is not None:
            lines.append(f"no oracle: {self.oracle}")
        return lines

    def _contact(self) -> str:
        force = float(np.sum(self.step.problem().nodal_forces(self.solution.pressure)))
        return f"{int(self.solution.active.sum())} contact nodes, force {force:.9g} N"

    def _friction(self) -> str:
        friction = self.solution.rubbed
        sticks, slips = (int(np.sum(friction.state == each)) for each in (State.STICK, State.SLIP))
        push, pull = self.step.weights @ self.solution.pressure, np.linalg.norm(friction.force, axis=1).sum()
        return f"{sticks} stick, {slips} slip, normal forces {float(push):.9g} N, of friction {float(pull):.9g} N"


def read_step(path: Path) -> FrozenStep:
    """The frozen step in a file; raises UsageError with one line."""
    try:
        return FrozenStep.read(path)
    except FrozenStepError as error:
        raise UsageError(str(error)) from None


def judge_files(problem: Path, answer: Path, tolerance: float | None = None) -> Judgement:
    """The judgement of an answer in a file; tolerance: the accuracy asked for, default CERTIFIED, none with friction.

    Raises UsageError with one line, and OSError where there is no file.
    """
    step = read_step(problem)
    if isinstance(step, FrozenFrictionalStep):
        if tolerance is not None:
            raise UsageError("a tolerance is for problems without friction: the judge of friction has its own bounds")
        return judge_friction_answer(step, answer)
    if tolerance is not None and not 0 < tolerance < math.inf:
        raise UsageError(f"tolerance = {tolerance} must be a number in (0, inf)")
    return judge_answer(step, read_answer(answer), CERTIFIED if tolerance is None else tolerance)


def algorithm_of(contact: str, epsilon: float | None = None) -> ContactAlgorithm:
    """One of the catalogue, with an epsilon [MPa/mm] or its own; raises UsageError."""
    if contact not in ALGORITHMS:
        raise UsageError(f"contact {contact!r} must be one of {', '.join(ALGORITHMS)}")
    return ALGORITHMS[contact]() if epsilon is None else ALGORITHMS[contact](epsilon=epsilon)


def resolve_step(step: FrozenStep, algorithm: ContactAlgorithm, *, ask_oracle: bool = False) -> Resolved:
    """Solve a frozen step from rest, judge it, in both directions with friction; raises UsageError with one line."""
    problem = step.problem()
    if isinstance(step, FrozenFrictionalStep):
        require_friction(algorithm)
    refused = unsupported(algorithm, problem)
    if refused is not None:
        raise UsageError(f"{algorithm.name} does not apply: {refused}")
    lent = deepcopy(step).problem()  # what is judged is the file, whatever the algorithm overwrites
    solution = answered(algorithm, lent, ContactSolution.at_rest(len(step.r), len(step.gap)))
    confirmation: Confirmation | str | None = None
    if ask_oracle:
        try:
            confirmation = _confirmation(step, solution, algorithm.epsilon)
        except OracleError as error:
            confirmation = str(error)
    if isinstance(step, FrozenFrictionalStep):
        verdict = judge(problem, solution.u, solution.pressure, solution.rubbed.force, epsilon=algorithm.epsilon)
        return Resolved(step, solution, verdict.certificate, algorithm.epsilon, confirmation)
    return Resolved(step, solution, certificate(problem, solution, algorithm.epsilon), algorithm.epsilon, confirmation)


def _confirmation(step: FrozenStep, solution: ContactSolution, epsilon: float) -> Confirmation:
    """Of the oracle; raises OracleError where it does not apply."""
    if isinstance(step, FrozenFrictionalStep):
        forces = step.problem().nodal_forces(solution.pressure)
        return friction_oracle.confirm(step, solution.u, forces, solution.rubbed.force)
    return oracle.confirm(step, solution.u, solution.pressure, epsilon)
