"""Every linearised contact problem that Newton meets on the way of a scene, as it was met.

A problem is what an algorithm gets at one iterate: tangent and residual with the memory of the element, gaps, and the
curvature of the gap under the forces there. Nothing is chosen or judged here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy import sparse

from contact.interchange.linearised_step import FrozenStep
from contact.problem import ContactProblem, ContactSolution, Linearised
from studies.algorithm_settings import configured
from studies.arena.watched import Watched
from studies.complete import complete
from studies.walk import walk


@dataclass(eq=False)
class Iterate:
    """What was linearised at u (n,), and the nodal forces (m,) under which its gaps were curved, if they were."""

    problem: ContactProblem
    u: np.ndarray
    lin: Linearised
    forces: np.ndarray | None = None

    @property
    def step(self) -> FrozenStep:
        """The problem of the Newton step from here."""
        problem, lin, K = self.problem, self.lin, self.lin.tangent
        if problem.gap_curvature is not None and self.forces is not None:
            K = sparse.csc_matrix(K - problem.gap_curvature(self.u, self.forces))
        G = sparse.csr_matrix(problem.gap_jacobian(self.u))
        return FrozenStep(K, lin.residual, G, problem.gap(self.u), problem.weights, lin.scale, problem.coupling)


@dataclass(frozen=True, eq=False)
class Met:
    """An iterate: the stage, the target it is on the way to, which solve of the path, which of its linearisations.

    arrived: whether that solve converged.
    """

    stage: str
    target: float
    solve: int
    iteration: int
    arrived: bool
    at: Iterate


@dataclass(eq=False)
class Recorder(Watched):
    """Keeps what the algorithm inside linearises: in ``solves`` a list for each call of it."""

    solves: list[tuple[list[Iterate], bool]] = field(default_factory=list)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Solve, and keep each linearisation; not without candidates, nor where their foundation is an unknown, too."""
        seen: list[Iterate] = []
        kept = len(problem.weights) and not problem.driven
        found = self.inside.solve(_noting(problem, seen) if kept else problem, start)
        self.solves.append((seen, found.outcome.converged))
        return found


def _noting(problem: ContactProblem, seen: list[Iterate]) -> ContactProblem:
    def linearise(u: np.ndarray, memory: object) -> Linearised:
        seen.append(Iterate(problem, u.copy(), problem.linearise(u, memory)))
        return seen[-1].lin

    def curvature(u: np.ndarray, forces: np.ndarray) -> sparse.csc_matrix:
        assert problem.gap_curvature is not None
        if seen and np.array_equal(u, seen[-1].u):
            seen[-1].forces = forces.copy()
        return problem.gap_curvature(u, forces)

    return replace(problem, linearise=linearise, gap_curvature=None if problem.gap_curvature is None else curvature)


def newton_path(scene_name: str, settings: Mapping[str, object], mesh: str | None, **options: Any) -> Iterator[Met]:
    """The iterates of a scene from rest to its last target, or to where the path ends; raises UsageError."""
    scene, request = complete(scene_name, settings, mesh, **options)
    recorder = Recorder(configured(request.contact, request.settings))
    number = 0
    for visited in walk(scene.build(request).stages(), recorder, request.steps):
        for iterates, arrived in recorder.solves:
            number += 1
            for i, at in enumerate(iterates):
                yield Met(visited.stage.name, visited.point.requested, number, i, arrived, at)
        recorder.solves.clear()
