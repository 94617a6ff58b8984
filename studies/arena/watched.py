"""An algorithm that is watched at its work: all is asked of the one inside, and what is kept of a solve is another's.

Nothing may be changed here of what the algorithm inside is given, or of what it answers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from contact.parameters import Parameter
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution


@dataclass(eq=False)
class Watched(ABC):
    """An algorithm that stands for the one ``inside`` on a path; a :class:`contact.problem.ContactAlgorithm`."""

    inside: ContactAlgorithm
    name: ClassVar[str] = "watched"
    parameters: ClassVar[tuple[Parameter, ...]] = ()

    @property
    def epsilon(self) -> float:
        """Of the algorithm inside [MPa/mm]."""
        return self.inside.epsilon

    def supports(self, problem: ContactProblem) -> str | None:
        """What the algorithm inside says."""
        return self.inside.supports(problem)

    @abstractmethod
    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """The answer of the algorithm inside, of which something is kept."""
