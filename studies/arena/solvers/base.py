"""What every solver of the arena offers: whether it is there, whether it applies, and an answer with its time."""

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
    """What a solver says: du (n,) [mm], pressure (m,) [MPa], and whether it claims that they are the solution.

    iterations: in its own count, NaN where it keeps none.  seconds: of the processor, from the step to the answer, with
    whatever has to be set up.  reason: its own words, or why there is no answer.
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
    """A solver by its name; ``module`` is what it imports, ``install`` what pip is told where that is missing."""

    name: str
    module: str = ""
    install: str = ""

    def missing(self) -> str | None:
        """None, or the line that says how to get it."""
        if not self.module or importlib.util.find_spec(self.module) is not None:
            return None
        return f"not installed: pip install {self.install or self.module}"

    def applies(self, step: FrozenStep) -> str | None:
        """None, or why it is not made for such a problem."""
        return None

    def prepare(self, step: FrozenStep) -> None:
        """What is not timed: imports, and whatever a warm start sets out from."""
        if self.module:
            importlib.import_module(self.module)

    @abstractmethod
    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """The answer, without its time."""

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """Whether an answer keeps the tolerance by the solver's own criterion; None where it has none of its own."""
        return None

    def solve(self, step: FrozenStep, tolerance: float) -> Answer:
        """The answer; whatever compiled code raises is no claim. Raises MemoryError."""
        self.prepare(step)
        seconds, found = timed(lambda: self._tried(step, tolerance))
        return replace(found, seconds=seconds)

    def _tried(self, step: FrozenStep, tolerance: float) -> Answer:
        try:
            return self.answer(step, tolerance)
        except (KeyboardInterrupt, SystemExit, MemoryError):
            raise
        except BaseException as error:  # a panic of Rust is not even an Exception
            return Answer.none(step, " ".join(f"{type(error).__name__}: {error}".split()))
