"""The tyre as a shell on given grid lines: its wall, and the part that is pressed, or the column that is only inflated.

Cords of 510 MPa in rubber of 2 MPa: where the wall is bent beside the patch, its faces are compressed by more than the
shear of the rubber resists. Beyond that travel the problem has no length of its own (:mod:`formulations.short_waves`),
and the limit point of a pressed tyre moves down with every refinement of the grid.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.obstacles.foundation import Candidates
from contact.problem import ContactProblem, ContactSolution
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import TensorGrid
from formulations.geometry.surfaces import torus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.short_waves import short_waves
from studies.ask.request import Request, Settings
from studies.ask.scene import Begun, Observation, ShellSceneModel, Stage, UsageError, candidates_at
from studies.scenes.element import discretise
from studies.scenes.foundations import NORMAL, foundation
from studies.scenes.statics import loaded_shell, with_balances
from studies.scenes.tyre.parts import Part, base_of, column_of, distorted, locally_refined, part_of
from studies.scenes.tyre.press import Column, PressedTyre, Wall, arc_of, begin_inflation
from studies.scenes.tyre.sector import check_reach, cut_of, sector_stage, within

CLAMPED = 0.85  # of the clamp angle: beyond it the clamp decides


def beside_the_patch(shell: ShellModel, part: Part, u: np.ndarray, touching: np.ndarray) -> dict[str, float]:
    """Least stiffness of short waves [N/mm] over the elements without a node in contact, and where it is [deg].

    touching: nodes of the part's grid in contact.  The neighbourhood of the clamp is left out.
    """
    grid, merged = part.grid, part.merging()
    held = np.zeros(grid.n_nodes, bool)
    held[touching] = True
    free = ~held[merged][grid.elements].any(axis=1)
    free &= np.abs(grid.centre[:, 0]) < CLAMPED * np.max(np.abs(grid.nodes[:, 0]))
    least = short_waves(shell, u).least
    at = np.flatnonzero(free)[np.argmin(least[free])]
    psi, phi = np.rad2deg(np.abs(grid.centre[at]))
    return {"short_wave_N_mm": float(least[at]), "short_wave_psi_deg": float(psi), "short_wave_phi_deg": float(phi)}


ORTHOTROPIC = {"E_L_MPa": 510.45, "E_T_MPa": 6.91, "G_LT_MPa": 2.33, "G_TT_MPa": 1.77, "nu_LT": 0.46, "nu_TT": 0.95}


def inflated_shell(request: Request, part: Part) -> ShellModel:
    """The shell on the grid of the part under the pressure inside."""
    settings = request.settings
    laminate, R1, R0, _ = checked_wall(settings)
    supports = Supports.of_edges(part.grid, *part.edges)
    discretisation = discretise(request, torus(R0 - R1, R1), part.grid, laminate, *supports.masks, images=part.images)
    return loaded_shell(discretisation, request, section=settings.choice("section"), pressure=inflation(settings))


def checked_wall(settings: Settings) -> tuple[Laminate, float, float, float]:
    """Laminate, R1, R0 [mm] and clamp [deg]; raises UsageError on impossible geometry or plies."""
    try:
        laminate = _laminate(settings)
    except ValueError as error:
        raise UsageError(str(error)) from None
    R1, R0, clamp = (settings.number(key) for key in ("R1_mm", "R0_mm", "clamp_deg"))
    if not laminate.thickness < R1:
        raise UsageError(
            f"thickness plies*ply_thickness_mm = {laminate.thickness:g} mm must be below R1_mm = {R1:g} mm"
        )
    if not R0 - R1 + (R1 + laminate.thickness) * np.cos(np.deg2rad(clamp)) > 0 or not R0 >= R1:
        raise UsageError(f"R0_mm = {R0:g} is too small: the wall at clamp_deg = {clamp:g} would cross the axis")
    return laminate, R1, R0, clamp


def inflation(settings: Settings) -> Pressure:
    """The pressure inside."""
    return Pressure(settings.number("p0_MPa"), settings["load"] == "follower", area=settings.choice("pressure_area"))


def _laminate(settings: Settings) -> Laminate:
    thickness, plies = settings.number("ply_thickness_mm"), int(settings.number("plies"))
    if "E_MPa" in settings:
        ply = Ply.isotropic(settings.number("E_MPa"), settings.number("nu"), thickness)
        return Laminate((ply,) * plies, d_minus=0.0)
    E_L, E_T, G_LT, G_TT, nu_LT, nu_TT = (settings.number(key) for key in ORTHOTROPIC)
    gamma = np.deg2rad(settings.number("gamma_deg"))
    angles = [(-1) ** k * gamma for k in range(plies)]
    return Laminate(tuple(Ply(E_L, E_T, G_LT, G_TT, nu_LT, nu_TT, a, thickness) for a in angles), d_minus=0.0)


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
        part = distorted(part, request)
        shell = inflated_shell(request, part)
        alike = isinstance(part.grid, TensorGrid) and request.model != "full"  # all columns of elements are one
        column = column_over(request, part, shell) if alike else None
        area = "mid" if settings["pressure_area"] == "mid" else "outer"
        nodes, candidates = _candidates(shell, part, area, coupled=settings["coupling"] == "consistent")
        wall = Wall(part, nodes, lambda u: faces_of(shell, u))
        arc, here = arc_of(request), foundation(settings)
        by_pressure = settings["rim"] == "pressure"
        pressed = (shell, wall, candidates, deltas, here, shell, part, nodes)
        return cls(*pressed, column=column, arc=arc, rim_by_pressure=by_pressure)

    def with_balances(self, problem: ContactProblem) -> ContactProblem:
        """Energy and forces of the inflated shell; of a part only those along the normal of the plane balance."""
        balanced = with_balances(problem, self.shell)
        if not self.part.whole:  # the seam at the cut carries what is not counted
            return replace(balanced, others=None)
        if self.part.copies == 1 or balanced.directions is None or balanced.others is None:
            return balanced
        directions, others = balanced.directions, balanced.others
        return replace(balanced, directions=lambda u: directions(u) * NORMAL, others=lambda u: others(u) * NORMAL)

    def stages(self) -> Iterator[Stage]:
        """The stages of every tyre; a sector also estimates what it leaves out."""
        for stage in super().stages():
            cut = stage.name == "press" and not self.part.whole
            yield sector_stage(stage, self.shell, self.part, self.outer_pressure) if cut else stage

    def _see_mode(self, state: ContactSolution, mode: np.ndarray) -> Observation:
        observation = super()._see_mode(state, mode)
        if self.shell.discretisation.wall is not None:
            return observation
        waves = beside_the_patch(self.shell, self.part, state.u, self.nodes[state.active])
        message, least = observation.said, waves["short_wave_N_mm"]
        if least < 0:
            message += f"; beside the patch short waves cost {least:.3g} N/mm: a finer grid may turn back earlier"
        return replace(observation, quantities=observation.quantities | waves, said=message)

    @property
    def candidate_of_node(self) -> np.ndarray:
        """(N,) the candidate that each node of the part is or mirrors, -1 for none."""
        return candidates_at(self.nodes, self.part.grid.n_nodes)[self.part.merging()]


def _candidates(shell: ShellModel, part: Part, area: str, *, coupled: bool) -> tuple[np.ndarray, Candidates]:
    """Every free node between the clamps that mirrors no other, with the areas of all that mirror or hang on it."""
    grid, merged = part.grid, part.merging()
    clamp = float(grid.ends[0, 1])
    free = np.intersect1d(np.unique(merged), grid.free_nodes)
    nodes = np.setdiff1d(free, np.union1d(grid.on_line(0, clamp), grid.on_line(0, -clamp)))
    merge = sparse.csr_matrix((np.ones(len(merged)), (merged, np.arange(len(merged)))), shape=2 * (len(merged),))
    mass = sparse.csr_matrix(merge @ shell.discretisation.nodal_mass(area) @ merge.T)[nodes][:, nodes]
    return nodes, Candidates(
        reference=shell.discretisation.positions()[1][nodes],
        operator=shell.discretisation.displacement_operator(nodes, face=1),
        weights=(merge @ shell.discretisation.nodal_areas(area))[nodes],
        coupling=mass if coupled else None,
    )


def faces_of(shell: ShellModel, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Deformed inner and outer face of the grid."""
    (inner, outer), (du, dv) = shell.discretisation.positions(), shell.discretisation.cartesian(u)
    return inner + du, outer + dv


def column_over(request: Request, part: Part, shell: ShellModel) -> Column:
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
            inner, outer = (_turned(x[first], part.angles[:, 1]) for x in faces_of(shell, u))
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
