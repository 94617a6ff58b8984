"""Scenes with contact: one outer face before a rigid foundation, on a path of a load or of its travel.

The tyre has stages of its own; see :mod:`studies.scenes.tyre.press`.

Where a closed form knows the rim of contact, grid lines may have one on it (RIM_LINES). Between even lines the rim lies
elsewhere on every mesh, and its error with it: a sequence of meshes then scatters by as much as it converges. With a
line on the rim only the size of the elements changes along a sequence.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np

from contact.obstacles.foundation import Candidates, Foundation, against
from contact.problem import ContactProblem, ContactSolution, Outcome
from formulations.conditions.boundary import FACES
from formulations.discretisation import Discretisation
from formulations.geometry.grid import graded_lines
from formulations.shell import ShellModel
from studies.ask.layers import write_fields
from studies.ask.request import Request
from studies.ask.scene import Begun, Observation, Setting, ShellSceneModel, Stage, Units, UsageError, candidates_at
from studies.scenes.element import Span, spaced_lines
from studies.scenes.statics import with_elements

OUTER = 1  # the face that touches
OVERLAP, ROUNDING = 1e-6, 1e-12  # of the thickness, and of positions: up to there a wall at rest touches
RIM_LINES = Setting.one_of("lines", ("even", "rim"), "even", "grid lines: evenly spaced, or one on the exact rim")
ON_RIM = {"lines": "rim"}
COARSE = 16  # elements; meshes that come from one no coarser by halving are nested


def outer_face(discretisation: Discretisation, nodes: np.ndarray, face: int = OUTER) -> Candidates:
    """The nodes on the outer face, or on another, with their shares of its area."""
    return Candidates(
        reference=discretisation.positions()[face][nodes],
        operator=discretisation.displacement_operator(nodes, face),
        weights=discretisation.nodal_areas(FACES[face])[nodes],
    )


@dataclass(frozen=True, eq=False)
class Touch:
    """What a scene may read off a state; everything but u is (m,) over the candidates.

    at (m, 2): their coordinates a1, a2.  u (n,): the free displacements.  force [N]: nodal, positive when it pushes.
    gap [mm]: positive when open.  friction (m, 3) [N]: of the foundation on the candidates, in space; none without.
    """

    candidates: Candidates
    at: np.ndarray
    u: np.ndarray
    force: np.ndarray
    pressure: np.ndarray
    gap: np.ndarray
    active: np.ndarray
    friction: np.ndarray


@dataclass(frozen=True, eq=False)
class ContactModel(ShellSceneModel):
    """One path of the parameter ``key``, from rest; every node that is neither ``held`` nor hangs may touch.

    plane_at(t): the foundation.  measure_at(t, touch): what is read, {name_unit: value}.  body_at(t): the shell under
    its loads, t times those it has unless given.  lying: everything touches without pressure at rest.  units: of the
    problem.  face: that may touch.  rubs(t): the share of the coefficient of friction that acts at t, as 0 until the
    body is wrapped.  at_rim: quantities that jump as the rim of contact passes from node to node.
    """

    shell: ShellModel
    held: np.ndarray
    targets: Sequence[float]
    plane_at: Callable[[float], Foundation]
    measure_at: Callable[[float, Touch], dict[str, float]]
    key: str = "load_fraction"
    body_at: Callable[[float], ShellModel] | None = None
    lying: bool = False
    units: Units = Units()  # noqa: RUF009  frozen
    face: int = OUTER
    rubs: Callable[[float], float] = lambda t: 1.0
    at_rim: Collection[str] = ()

    @cached_property
    def nodes(self) -> np.ndarray:
        """Grid nodes (m,) of the candidates; a node that hangs on an edge moves with its ends, which have its area."""
        return np.setdiff1d(self.shell.discretisation.grid.free_nodes, self.held)

    @cached_property
    def candidates(self) -> Candidates:
        """What may touch."""
        return outer_face(self.shell.discretisation, self.nodes, self.face)

    def stages(self) -> Iterator[Stage]:
        """The path from rest."""
        yield Stage("load", self._begin, tuple(self.targets), self._observe, units=self.units, rubs=self.rubs)

    def _begin(self, previous: ContactSolution | None) -> Begun:
        if previous is not None:
            return self.problem_at, previous
        self._stand_before_foundation()
        m = len(self.nodes)
        touching = np.full(m, self.lying)
        return self.problem_at, ContactSolution(np.zeros(self.n_unknowns), np.zeros(m), touching, Outcome.CONVERGED)

    def _stand_before_foundation(self) -> None:
        """Raise UsageError where all of the wall at rest lies in the foundation, or that is nowhere.

        Some of it may: loads lift it out before the foundation is there.
        """
        x = self.candidates.reference
        gap = self.plane_at(0.0).gap(x)
        if np.any(np.isnan(gap)):
            raise UsageError("the position of the foundation at rest is not a number")
        rounding = OVERLAP * self.shell.discretisation.laminate.thickness + ROUNDING * np.max(np.abs(x), initial=0.0)
        if np.all(gap <= rounding) and np.any(gap < -rounding):
            inside = f"the whole wall at rest lies inside the foundation, {-gap.min():.3g} mm deep"
            raise UsageError(f"{inside}: the normal of a plane points from the wall to it, the offset is along that")

    def moved(self, t: float) -> Self:
        """With its supports where they are at t."""
        return self if self.body_at is None else replace(self, shell=self.body_at(t))

    def problem_at(self, t: float) -> ContactProblem:
        """The shell and the foundation at a point of the path."""
        body = (self.body_at or self.shell.scaled)(t)
        problem = against(body.linearise, self.candidates, self.plane_at(t))
        return with_elements(replace(problem, ordered=body.ordered), body)

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        force, gap = problem.nodal_forces(state.pressure), problem.gap(state.u)
        at = self.shell.discretisation.grid.nodes[self.nodes]
        touch = Touch(self.candidates, at, state.u, force, state.pressure, gap, state.active, _friction(problem, state))
        quantities = self.measure_at(t, touch)
        return Observation({self.key: t, **quantities, "contact_nodes": int(state.active.sum())}, quantities)

    def write_fields(self, path: Path, state: ContactSolution) -> None:
        """With the contact pressure on the face that may touch."""
        write_fields(path, self.shell, state.u, self.outer_pressure(state), self.face)

    @property
    def touching_face(self) -> int:
        """That of the candidates."""
        return self.face

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the contact candidate that each node of the grid is, -1 for none."""
        return candidates_at(self.nodes, self.shell.discretisation.grid.n_nodes)


def _friction(problem: ContactProblem, state: ContactSolution) -> np.ndarray:
    """Of the foundation on the candidates (m, 3) [N]."""
    if problem.coulomb is None or state.friction is None:
        return np.zeros((len(problem.weights), 3))
    from studies.scenes.friction_readings import in_space  # loaded with friction alone

    return in_space(problem, state)


def contact_lines(request: Request, axis: int, ends: Span, rim: Callable[[], float]) -> np.ndarray:
    """The lines of a coordinate by RIM_LINES; rim(): its place by the closed form, a ValueError where it has none."""
    if request.choice("lines") == "even":
        return spaced_lines(*ends, request.mesh[axis])
    try:
        return rim_lines(request.mesh[axis], ends, rim())
    except ValueError as error:
        raise UsageError(f"lines=rim needs a rim of contact: {error}") from error


def rim_lines(n: int, ends: Span, rim: float) -> np.ndarray:
    """n + 1 lines, evenly spaced on either side of ``rim``; those of 2 n contain them where n is at least COARSE.

    Raises ValueError when the rim is not between the ends.
    """
    first, last = ends
    coarse = n
    while coarse % 2 == 0 and coarse >= 2 * COARSE:
        coarse //= 2
    before = n // coarse * min(max(round(coarse * (rim - first) / (last - first)), 1), coarse - 1)
    return graded_lines([first, rim, last], [before, n - before])
