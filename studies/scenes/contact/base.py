"""Scenes with contact: one outer face before a rigid foundation, on a path of a load or of its travel.

The tyre has stages of its own; see :mod:`studies.scenes.tyre.press`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import Candidates, Foundation, against
from contact.problem import ContactProblem, ContactSolution, Outcome
from formulations.discretisation import Discretisation
from formulations.shell import ShellModel
from studies.scene import Observation, ShellSceneModel, Stage

OUTER = 1  # the face that touches


def outer_face(discretisation: Discretisation, nodes: np.ndarray) -> Candidates:
    """The nodes on the outer face with their shares of its area."""
    return Candidates(
        reference=discretisation.positions()[OUTER][nodes],
        operator=discretisation.displacement_operator(nodes, OUTER),
        weights=discretisation.nodal_areas("outer")[nodes],
    )


@dataclass(frozen=True, eq=False)
class Touch:
    """What a scene may read off a state; everything but u is (m,) over the candidates.

    u (n,): the free displacements.  force [N]: nodal, positive when it pushes.  gap [mm]: positive when open.
    """

    u: np.ndarray
    force: np.ndarray
    pressure: np.ndarray
    gap: np.ndarray
    active: np.ndarray


@dataclass(frozen=True, eq=False)
class ContactModel(ShellSceneModel):
    """One path of the parameter ``key``, from rest.

    body_at(t): the shell under its loads.  plane_at(t): the foundation.  nodes (m,): grid nodes of the candidates.
    measure_at(t, touch): what is read, {name_unit: value}.  lying: everything touches without pressure at rest.
    """

    shell: ShellModel
    key: str
    targets: Sequence[float]
    body_at: Callable[[float], ShellModel]
    plane_at: Callable[[float], Foundation]
    nodes: np.ndarray
    candidates: Candidates
    measure_at: Callable[[float, Touch], dict[str, float]]
    lying: bool = False

    def stages(self) -> Iterator[Stage]:
        """The path from rest."""
        yield Stage("load", self._begin, tuple(self.targets), self._observe)

    def _begin(self, previous: ContactSolution | None) -> tuple[Callable[[float], ContactProblem], ContactSolution]:
        m = len(self.nodes)
        touching = np.full(m, self.lying)
        return self.problem_at, ContactSolution(np.zeros(self.n_unknowns), np.zeros(m), touching, Outcome.CONVERGED)

    def problem_at(self, t: float) -> ContactProblem:
        """The shell and the foundation at a point of the path."""
        body = self.body_at(t)
        return replace(against(body.linearise, self.candidates, self.plane_at(t)), ordered=body.ordered)

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        force, gap = problem.nodal_forces(state.pressure), problem.gap(state.u)
        quantities = self.measure_at(t, Touch(state.u, force, state.pressure, gap, state.active))
        return Observation({self.key: t, **quantities, "contact_nodes": int(state.active.sum())}, quantities)

    def outer_pressure(self, solution: ContactSolution) -> np.ndarray:
        """Contact pressure (N,) at the grid's nodes; zero before the first state that has any."""
        pressure = np.zeros(self.shell.discretisation.grid.n_nodes)
        if len(solution.pressure):
            pressure[self.nodes] = solution.pressure
        return pressure
