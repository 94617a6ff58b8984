"""The tyre as a shell on given grid lines: the part that is pressed, or the column that is only inflated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.obstacles.foundation import Candidates
from contact.problem import ContactProblem, ContactSolution
from formulations.geometry.grid import TensorGrid
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.ask.scene import Begun, Observation, ShellSceneModel, Stage, candidates_at
from studies.scenes.statics import with_balances
from studies.scenes.tyre.foundation import NORMAL, foundation
from studies.scenes.tyre.parts import Part, base_of, column_of, locally_refined, part_of
from studies.scenes.tyre.press import Column, PressedTyre, Wall, begin_inflation
from studies.scenes.tyre.press_path import arc_of
from studies.scenes.tyre.sector import check_reach, cut_of, sector_stage, within
from studies.scenes.tyre.stability import beside_the_patch
from studies.scenes.tyre.wall import checked_wall, inflated_shell


@dataclass(frozen=True, eq=False)
class TyreModel(ShellSceneModel, PressedTyre):
    """The stages of the tyre as a shell, or as a part of it."""

    shell: ShellModel
    part: Part
    nodes: np.ndarray  # node of the part's grid of each candidate

    @classmethod
    def on(cls, request: Request, psi: np.ndarray, phi: np.ndarray) -> TyreModel:
        """The model of the request on the grid lines; raises UsageError on impossible geometry, plies or sectors."""
        settings, deltas = request.settings, request.numbers("delta_mm")
        if request.model == "sector":
            laminate, _, R0, _ = checked_wall(settings)
            check_reach(cut_of(request), R0 + laminate.thickness, deltas[-1])
            part = part_of(base_of(settings), psi, within(phi, cut_of(request)))
        else:
            part = part_of(request.model, psi, phi)
        if request.leaves:
            base = base_of(settings) if request.model == "sector" else request.model
            part = locally_refined(part, request, base)
        shell = inflated_shell(request, part)
        alike = isinstance(part.grid, TensorGrid) and request.model != "full"  # all columns of elements are one
        column = _column(request, part, shell) if alike else None
        area = "mid" if settings["pressure_area"] == "mid" else "outer"
        nodes, candidates = _candidates(shell, part, area, coupled=settings["coupling"] == "consistent")
        wall = Wall(part, nodes, lambda u: _faces(shell, u))
        arc, here = arc_of(request), foundation(settings)
        by_pressure = settings["rim"] == "pressure"
        pressed = (shell, wall, candidates, deltas, here, shell, part, nodes)
        return cls(*pressed, column=column, arc=arc, rim_by_pressure=by_pressure)

    def with_balances(self, problem: ContactProblem) -> ContactProblem:
        """Energy and forces of the inflated shell; of a part only those along the normal of the plane balance."""
        seen = with_balances(problem, self.shell)
        if not self.part.whole:  # the seam at the cut carries what is not counted
            return replace(seen, others=None)
        if self.part.copies == 1 or seen.directions is None or seen.others is None:
            return seen
        directions, others = seen.directions, seen.others
        return replace(seen, directions=lambda u: directions(u) * NORMAL, others=lambda u: others(u) * NORMAL)

    def stages(self) -> Iterator[Stage]:
        """The stages of every tyre; a sector also tells what it leaves out."""
        for stage in super().stages():
            cut = stage.name == "press" and not self.part.whole
            yield sector_stage(stage, self.shell, self.part, self.outer_pressure) if cut else stage

    def _see_mode(self, state: ContactSolution, mode: np.ndarray) -> Observation:
        seen = super()._see_mode(state, mode)
        waves = beside_the_patch(self.shell, self.part, state.u, self.nodes[state.active])
        said, least = seen.said, waves["short_wave_N_mm"]
        if least < 0:
            said += f"; beside the patch short waves cost {least:.3g} N/mm: a finer grid may turn back earlier"
        return replace(seen, quantities=seen.quantities | waves, said=said)

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the candidate that each node of the part is or mirrors, -1 for none."""
        return candidates_at(self.nodes, self.part.grid.n_nodes)[self.part.merging()]


def _candidates(shell: ShellModel, part: Part, area: str, *, coupled: bool) -> tuple[np.ndarray, Candidates]:
    """Every free node between the clamps that mirrors no other, with the areas of all that mirror or hang on it."""
    grid, own = part.grid, part.merging()
    clamp = float(grid.ends[0, 1])
    free = np.intersect1d(np.unique(own), grid.free_nodes)
    nodes = np.setdiff1d(free, np.union1d(grid.on_line(0, clamp), grid.on_line(0, -clamp)))
    merge = sparse.csr_matrix((np.ones(len(own)), (own, np.arange(len(own)))), shape=2 * (len(own),))
    mass = sparse.csr_matrix(merge @ shell.discretisation.nodal_mass(area) @ merge.T)[nodes][:, nodes]
    return nodes, Candidates(
        reference=shell.discretisation.positions()[1][nodes],
        operator=shell.discretisation.displacement_operator(nodes, face=1),
        weights=(merge @ shell.discretisation.nodal_areas(area))[nodes],
        coupling=mass if coupled else None,
    )


def _faces(shell: ShellModel, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Deformed inner and outer face of the grid."""
    (inner, outer), (du, dv) = shell.discretisation.positions(), shell.discretisation.cartesian(u)
    return inner + du, outer + dv


def _column(request: Request, part: Part, shell: ShellModel) -> Column:
    """Inflation of one column with the mirror plane of the part, if it has one, and how it is lifted to the part."""
    one = inflated_shell(request, column_of(part))
    assert isinstance(part.grid, TensorGrid)
    rows = np.arange(part.grid.n_nodes) // part.grid.node_shape[1]

    def lift(u: np.ndarray) -> np.ndarray:
        return shell.discretisation.map.restrict(one.discretisation.expand(u)[2 * rows])

    return Column(one, lift)


@dataclass(frozen=True, eq=False)
class InflatedTyre(ShellSceneModel, PressedTyre):
    """A tyre that is only inflated: its column is all that is solved, and its wall is the column turned around.

    The two sides of the column share their displacements in the turning frame, so that angle plies twist it as they
    twist the whole. Nothing that differs along phi may enter here.
    """

    shell: ShellModel

    @classmethod
    def on(cls, request: Request, psi: np.ndarray, phi: np.ndarray) -> InflatedTyre:
        """On the grid lines psi (n1 + 1,), phi (n2 + 1,) of the whole tyre; the column is as wide as at the crown."""
        part = part_of("full", psi, phi)
        shell = inflated_shell(request, column_of(part))
        first = 2 * (np.arange(part.grid.n_nodes) // part.shape[1])  # the node that each turns into, by -phi

        def turned(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            inner, outer = (_turned(x[first], part.angles[:, 1]) for x in _faces(shell, u))
            return inner, outer

        nothing = Candidates(np.zeros((0, 3)), sparse.csr_matrix((0, shell.discretisation.n_free)), np.zeros(0))
        wall = Wall(part, np.zeros(0, np.intp), turned)
        return cls(shell, wall, nothing, (0.0,), foundation(request.settings), shell)

    def stages(self) -> Iterator[Stage]:
        """Inflation alone."""
        yield Stage("inflation", self._begin, (1.0,), self._observe)

    def _begin(self, previous: ContactSolution | None) -> Begun:
        problem_at, start = begin_inflation(self.body, previous)
        # the forces of the neighbours on the two sides of the column are not counted: no balance of forces
        return lambda t: replace(with_balances(problem_at(t), self.shell.scaled(t)), others=None), start

    def _observe(self, problem: ContactProblem, state: ContactSolution, t: float) -> Observation:
        inflated, pressed = self._observe_inflation(problem, state, t), self._observe_press(problem, state, 0.0)
        return replace(pressed, quantities=inflated.quantities | pressed.quantities, tables=inflated.tables)


def _turned(x: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Points (N, 3) turned by the angles phi (N,) about the axis of the tyre, z, from x towards y."""
    cos, sin = np.cos(phi), np.sin(phi)
    return np.stack([cos * x[:, 0] - sin * x[:, 1], sin * x[:, 0] + cos * x[:, 1], x[:, 2]], axis=-1)
