"""Inflation of one column of elements, the same all around the axis: by itself, or lifted to a larger part of a tyre.

The two sides of the column share their displacements in the turning frame, so that angle plies twist it as they twist
the whole. Nothing that differs along phi may enter here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.obstacles.foundation import Candidates
from contact.problem import ContactProblem, ContactSolution
from formulations.geometry.grid import Grid
from formulations.section.laminate import Laminate
from formulations.shell import ShellModel
from studies.request import Request
from studies.scene import Observation, ShellSceneModel, Stage
from studies.scenes.statics import with_balances
from studies.scenes.tyre.foundation import foundation
from studies.scenes.tyre.parts import Part, column_of, sides_alike
from studies.scenes.tyre.press import Column, PressedTyre, Wall
from studies.scenes.tyre.wall import inflated_shell


def column(request: Request, laminate: Laminate, part: Part, shell: ShellModel) -> Column:
    """Inflation of one column with the mirror plane of the part, if it has one, and how it is lifted to the part."""
    grid, images = column_of(part)
    planes = [(grid.on_line(0, 0.0), 0)] if any(axis == 0 for _, axis in part.planes) else []
    one = inflated_shell(request, laminate, grid, planes, images)
    rows = np.arange(part.grid.n_nodes) // part.grid.node_shape[1]

    def lift(u: np.ndarray) -> np.ndarray:
        return shell.discretisation.map.restrict(one.discretisation.expand(u)[2 * rows])

    return Column(one, one.discretisation.n_free, lift)


@dataclass(frozen=True, eq=False)
class InflatedTyre(ShellSceneModel, PressedTyre):
    """A tyre that is only inflated: its column is all that is solved, and its wall is the column turned around."""

    shell: ShellModel

    @classmethod
    def of(cls, request: Request, laminate: Laminate, psi: np.ndarray, phi: np.ndarray) -> InflatedTyre:
        """On the grid lines psi (n1 + 1,), phi (n2 + 1,) of the whole tyre; the column is as wide as at the crown."""
        crown = int(np.argmin(np.abs(phi)))
        grid = Grid.tensor(psi, phi[crown : crown + 2])
        shell = inflated_shell(request, laminate, grid, (), sides_alike(grid))
        around = phi[:-1]
        angles = np.stack([line.ravel() for line in np.meshgrid(psi, around, indexing="ij")], axis=-1)
        first = np.repeat(grid.on_line(1, phi[crown]), len(around))  # the node that each turns into, by -phi

        def faces(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            (inner, outer), (du, dv) = shell.discretisation.positions(), shell.discretisation.cartesian(u)
            return _turned((inner + du)[first], angles[:, 1]), _turned((outer + dv)[first], angles[:, 1])

        wall = Wall(angles, (len(psi), len(around)), np.full(len(angles), -1), 1, faces)
        nothing = Candidates(np.zeros((0, 3)), sparse.csr_matrix((0, shell.discretisation.n_free)), np.zeros(0))
        return cls(shell, wall, nothing, (0.0,), foundation(request.settings), shell)

    def stages(self) -> Iterator[Stage]:
        """Inflation alone."""
        yield Stage("inflation", self._begin, (1.0,), self._observe)

    def _begin(self, previous: ContactSolution | None) -> tuple[Callable[[float], ContactProblem], ContactSolution]:
        problem_at, start = self._begin_inflation(previous)
        # the forces of the neighbours on the two sides of the column are not counted: no balance of forces
        return lambda t: replace(with_balances(problem_at(t), self.shell.scaled(t)), others=None), start

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        inflated, pressed = self._observe_inflation(problem, state, t), self._observe_press(problem, state, 0.0)
        return replace(pressed, quantities=inflated.quantities | pressed.quantities, tables=inflated.tables)


def _turned(x: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Points (N, 3) turned by the angles phi (N,) about the axis of the tyre, z, from x towards y."""
    cos, sin = np.cos(phi), np.sin(phi)
    return np.stack([cos * x[:, 0] - sin * x[:, 1], sin * x[:, 0] + cos * x[:, 1], x[:, 2]], axis=-1)
