"""What an answer from outside to a step with friction is worth, from the two files alone.

An answer is ``du`` (n,) [mm], ``normal`` (m,) [N] and ``friction`` (m, 2) [N], in a .npz or as lists in a .json; no
claims are made. The residuals and their bounds are those of :mod:`contact.verify`. No algorithm is run here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.untrusted import read_arrays, read_json
from contact.verify import Verdict, judge
from studies.request import UsageError

PARTS = ("du", "normal", "friction")


@dataclass(frozen=True, eq=False)
class FrictionAnswer:
    """du (n,), normal (m,), friction (m, 2)."""

    du: np.ndarray
    normal: np.ndarray
    friction: np.ndarray


@dataclass(frozen=True, eq=False)
class FrictionJudgement:
    """The residuals, and the names of those beyond their bounds."""

    verdict: Verdict
    failures: tuple[str, ...]

    @property
    def sound(self) -> bool:
        """Whether every residual is within its bound."""
        return not self.failures

    def lines(self) -> list[str]:
        """In words: each residual, the verdict last."""
        told = [f"{name}: {value:.2e}" for name, value in self.verdict.kkt.items()]
        scales = self.verdict.certificate["scales"]
        told.append(f"relative to {scales['force_N']:.6g} N and {scales['length_mm']:.6g} mm")
        wrong = f"NOT certified: {', '.join(self.failures)}"
        return [*told, "certified: every residual within its bound" if self.sound else wrong]


def read_friction_answer(path: Path) -> FrictionAnswer:
    """From a .npz or a .json; raises UsageError with the fault, OSError when there is no file."""
    try:
        return _given(read_json(path) if path.suffix == ".json" else read_arrays(path, (), PARTS))
    except (ValueError, KeyError, TypeError) as error:
        why = f"{error} is missing" if isinstance(error, KeyError) else str(error).splitlines()[0]
        raise UsageError(f"{path} is no answer to a problem with friction: {why}") from None


def _given(told: Mapping[str, Any]) -> FrictionAnswer:
    if not isinstance(told, Mapping):
        raise ValueError("it must be a JSON object")
    return FrictionAnswer(*(np.asarray(told[name], dtype=float) for name in PARTS))


def judge_friction_answer(step: FrozenFrictionalStep, given: FrictionAnswer) -> FrictionJudgement:
    """Every residual recomputed; raises UsageError for the wrong number of values."""
    if given.du.shape != step.r.shape:
        raise UsageError(f"du of the shape {given.du.shape} for {len(step.r)} unknowns")
    try:
        by_forces = replace(step.problem(), weights=np.ones(len(step.mu)))  # normal forces for pressures
        verdict = judge(by_forces, given.du, given.normal, given.friction)
    except ValueError as error:
        raise UsageError(str(error)) from None
    return FrictionJudgement(verdict, tuple(verdict.failures()))
