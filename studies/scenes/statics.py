"""Scenes without contact: a shell under dead forces that grow with a load fraction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from contact.judge import judge
from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.shell import ShellModel
from studies.scene import Observation, Setting, Stage

LOAD_FRACTIONS = Setting(
    "load_fraction",
    (0.25, 0.5, 0.75, 1.0),
    "fractions of the published load to report",
    kind="floats",
    low=0.0,
    high=10.0,
    open_low=True,
)


@dataclass(frozen=True, eq=False)
class StaticModel:
    """One path of the load fraction; ``measure_at(shell, u)`` reads the displacements {name_unit: value}."""

    shell: ShellModel
    fractions: Sequence[float]
    measure_at: Callable[[ShellModel, np.ndarray], dict[str, float]]

    def stages(self) -> Iterator[Stage]:
        """The load path from rest."""
        yield Stage("load", self._begin, tuple(self.fractions), self._observe)

    def outer_pressure(self, solution: ContactSolution) -> np.ndarray:
        """Zero: nothing is touched."""
        return np.zeros(self.shell.discretisation.grid.n_nodes)

    def _begin(self, previous: ContactSolution | None) -> tuple[Callable[[float], ContactProblem], ContactSolution]:
        n = self.shell.discretisation.n_free
        return lambda t: without_contact(self.shell.scaled(t).linearise, n), ContactSolution.at_rest(n, 0)

    def _observe(self, problem: ContactProblem, state: ContactSolution, fraction: float) -> Observation:
        displacements = self.measure_at(self.shell, state.u)
        verdict = judge(problem, state.u, state.pressure)
        return Observation(
            {"load_fraction": fraction, **displacements, "kkt": verdict.kkt, "rounding": verdict.rounding},
            displacements,
        )
