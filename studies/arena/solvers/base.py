"""The interface of every solver of the arena: availability, applicability, and a timed answer."""

from __future__ import annotations

import importlib
import importlib.util
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.output.stopwatch import timed


@dataclass(frozen=True, eq=False)
class Answer:
    """The answer of a solver: du (n,) [mm], pressure (m,) [MPa], and whether it claims to have solved the problem.

    iterations: by its own count, NaN where it has none.  seconds: processor time from the step to the answer, including
    the set-up.  reason: its own status text, or why there is no answer.
    """

    du: np.ndarray
    pressure: np.ndarray
    claimed: bool
    iterations: float = np.nan
    seconds: float = np.nan
    reason: str = ""

    @classmethod
    def none(cls, step: FrozenStep, reason: str) -> Answer:
        """No answer."""
        return cls(np.full_like(step.r, np.nan), np.full_like(step.gap, np.nan), False, reason=reason)


@dataclass(frozen=True)
class Solver(ABC):
    """A solver by its name; ``module``: what it imports, ``install``: the argument of pip where that is missing."""

    name: str
    module: str = ""
    install: str = ""

    def missing(self) -> str | None:
        """None, or a line on how to install it."""
        if not self.module or importlib.util.find_spec(self.module) is not None:
            return None
        return f"not installed: pip install {self.install or self.module}"

    def applies(self, step: FrozenStep) -> str | None:
        """None, or why it does not apply to the problem."""
        return None

    def prepare(self, step: FrozenStep) -> None:
        """Untimed preparation: imports, and the initial point of a warm start."""
        if self.module:
            importlib.import_module(self.module)

    @abstractmethod
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """The answer, without its time."""

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """Whether an answer meets the tolerance by the solver's own criterion; None where it has none."""
        return None

    def solve(self, step: FrozenStep, tolerance: float) -> Answer:
        """The answer; an exception counts as no claim. Raises MemoryError."""
        self.prepare(step)
        seconds, answer = timed(lambda: self._tried(step, tolerance))
        return replace(answer, seconds=seconds)

    def _tried(self, step: FrozenStep, tolerance: float) -> Answer:
        try:
            answer = self.answer(step, tolerance)
            return replace(answer, du=np.asarray(answer.du, float), pressure=np.asarray(answer.pressure, float))
        except (KeyboardInterrupt, MemoryError):
            raise
        except BaseException as error:  # a panic of Rust is not even an Exception
            return Answer.none(step, " ".join(f"{type(error).__name__}: {error}".split()))
