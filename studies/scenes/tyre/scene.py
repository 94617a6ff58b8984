"""The pneumatic tyre of the 2004 paper: an angle-ply torus, inflated, then pressed by a rigid plane.

a1 = psi from the outer equator, a2 = phi around the axis; both edges psi = +-clamp are held. The plane is that of
:mod:`studies.scenes.tyre.press`; it may also be a foundation of :mod:`studies.scenes.tyre.foundation`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.obstacles.foundation import Candidates, Foundation
from contact.problem import ContactProblem, ContactSolution
from formulations.loads.pressure import PRESSURE_AREAS
from formulations.section.laminate import SECTIONS
from formulations.shell import ShellModel
from studies.request import Request, Value
from studies.scene import EPSILON, SOLVER, Reference, Setting, ShellSceneModel, Stage, UsageError
from studies.scenes.data import read_reference
from studies.scenes.element import ELEMENT
from studies.scenes.statics import with_balances
from studies.scenes.tyre import foundation as tyre_foundation
from studies.scenes.tyre.column import InflatedTyre, column
from studies.scenes.tyre.foundation import NORMAL, foundation
from studies.scenes.tyre.grid_lines import GRADING, checked_mesh, tyre_lines
from studies.scenes.tyre.parts import MODELS, Part, base_of, part_of, settle_model
from studies.scenes.tyre.press import Column, PressedTyre, Wall
from studies.scenes.tyre.sector import SECTOR, check_reach, cut_of, sector_stage, settle_sector, with_line_at, within
from studies.scenes.tyre.sizes import TyreSizes
from studies.scenes.tyre.wall import ORTHOTROPIC, checked_wall, inflated_shell

PAPER = "Grigolyuk, Kulikov, Plotnikova, Mech. Compos. Mater. (2004)"
SOLID = "3D solid, NGSolve 6.2 cubic hexahedra 18x16x1; CalculiX C3D20R within 0.3 % on force"

PLY = {
    "E_L_MPa": "modulus of a ply along the cords",
    "E_T_MPa": "modulus of a ply across the cords",
    "G_LT_MPa": "shear modulus of a ply in its plane",
    "G_TT_MPa": "shear modulus of a ply across the cords",
    "nu_LT": "Poisson ratio of a ply, from along to across the cords",
    "nu_TT": "Poisson ratio of a ply, across the cords",
}
AREA_OF = {"dead": "mid", "follower": "face"}  # a follower on the mid-surface is 4 % off a solid
SETTINGS = (
    Setting("gamma_deg", 52.0, "cord angle from the meridian; the plies alternate in sign", low=-90, high=90),
    Setting("p0_MPa", 0.15, "inflation pressure", low=-10, high=10),
    Setting("delta_mm", (5.0, 10.0, 15.0, 20.0), "indentation from first touch; 0: inflation alone", "floats", 0, 100),
    Setting("load", "dead", "whether the pressure follows the wall", "choice", choices=tuple(AREA_OF)),
    Setting(
        "pressure_area",
        None,
        "area that carries pressures: mid-surface or true faces",
        "choice",
        choices=PRESSURE_AREAS,
        otherwise=", ".join(f"{load} {area}" for load, area in AREA_OF.items()),
    ),
    Setting(
        "coupling",
        "lumped",
        "from pressure to nodal forces: shares of area or mass matrix",
        "choice",
        choices=("lumped", "consistent"),
    ),
    EPSILON,
    Setting("section", "constant-s33", "constitutive law through the thickness", "choice", choices=SECTIONS),
    Setting("plies", 4, "number of plies", "int", 1, 64),
    Setting("ply_thickness_mm", 1.2, "thickness of a ply", low=0, high=50, open_low=True),
    *(Setting(key, None, PLY[key], low=0, open_low=True, otherwise=f"{value:g}") for key, value in ORTHOTROPIC.items()),
    Setting(
        "E_MPa", None, "modulus of an isotropic tyre, with nu", low=0, open_low=True, otherwise="orthotropic plies"
    ),
    Setting(
        "nu",
        None,
        "Poisson ratio of an isotropic tyre, with E_MPa",
        low=-1,
        high=0.5,
        open_low=True,
        open_high=True,
        otherwise="orthotropic plies",
    ),
    Setting("R1_mm", 50.0, "radius of the inner meridian", low=0, high=1e4, open_low=True),
    Setting("R0_mm", 250.0, "radius of the inner equator", low=0, high=1e5, open_low=True),
    Setting("clamp_deg", 120.0, "meridian angle of the clamped edges", low=10, high=175),
    GRADING,
    SECTOR,
    *tyre_foundation.SETTINGS,
    *ELEMENT,
    SOLVER,
)


def _references() -> tuple[Reference, ...]:
    paper: dict[str, float | str] = {"E_L_MPa": 510.45, "gamma_deg": 52.0, "load": "dead", "pressure_area": "mid"}
    printed = [Reference("centre_pressure_MPa", 0.156, {"delta_mm": 20.0, **paper}, "printed", PAPER, 0.01)]
    solid = read_reference("isotropic_tyre_3d_solid.csv")
    isotropic: dict[str, float | str] = {"E_MPa": 20.0, "nu": 0.45, "load": "follower", "pressure_area": "face"}
    computed = [
        Reference(name, float(row[column]), {"delta_mm": float(row["delta_mm"]), **isotropic}, "computed", SOLID, error)
        for _, row in solid.iterrows()
        for name, column, error in (
            ("force_N", "force_N_ngsolve", 0.003),
            ("half_length_mm", "half_length_mm", 0.03),
            ("half_width_mm", "half_width_mm", 0.03),
        )
    ]
    equator = (("inflated_equator_inner_mm", 4.6256), ("inflated_equator_outer_mm", 4.3463))
    computed += [Reference(name, value, isotropic, "computed", SOLID, 0.003) for name, value in equator]
    return tuple(printed + computed)


@dataclass(frozen=True)
class Tyre:
    """Inflation, then contact with a plane.

    sizes: of the elements of adapted grids, where they are known already.
    """

    name: str = "tyre"
    title: str = "Pneumatic tyre pressed on a rigid plane (the 2004 paper)"
    default_mesh: tuple[int, int] = (42, 40)
    settings: tuple[Setting, ...] = SETTINGS
    references: tuple[Reference, ...] = _references()
    models: tuple[str, ...] = MODELS
    sizes: TyreSizes | None = None

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """Add the area of the load, and the plies of the paper unless isotropic; raises UsageError on a mixture."""
        settings = {"pressure_area": AREA_OF[str(settings["load"])], **tyre_foundation.complete(settings)}
        isotropic = [key for key in ("E_MPa", "nu") if key in settings]
        given = [key for key in ORTHOTROPIC if key in settings]
        if not isotropic:
            return {**settings, **{key: settings.get(key, value) for key, value in ORTHOTROPIC.items()}}
        if len(isotropic) == 1 or given:
            raise UsageError(f"an isotropic tyre takes E_MPa and nu together and no {', '.join(ORTHOTROPIC)}")
        return settings

    def settle(self, request: Request) -> Request:
        """The smallest valid model, or the one asked for; raises UsageError when that is not valid."""
        model, reason = settle_model(request.model, request.settings)
        settings = settle_sector(model, request.settings)
        return replace(request, model=model, model_reason=reason, settings=settings)

    def build(self, request: Request) -> TyreModel | InflatedTyre:
        """The model of the request; raises UsageError on impossible geometry, plies or meshes."""
        if request.model == "axisymmetric":
            return InflatedTyre.of(request, checked_wall(request.settings)[0], *self.lines(request))
        return self.build_on(request, *self.lines(request))

    def lines(self, request: Request) -> tuple[np.ndarray, np.ndarray]:
        """Grid lines psi, phi [rad]; raises UsageError on impossible geometry, plies or meshes."""
        clamp, grading = checked_wall(request.settings)[3], request.choice("grading")
        checked_mesh(request.mesh)
        sizes = self.adapted(request).sizes if grading == "adapted" else None
        psi, phi = tyre_lines(request.mesh, clamp, grading) if sizes is None else sizes.lines(request.mesh)
        return psi, with_line_at(phi, cut_of(request)) if request.model == "sector" else phi

    def adapted(self, request: Request) -> Tyre:
        """The scene with the sizes of its elements estimated; raises UsageError where a coarse tyre is not solved."""
        if self.sizes is not None:
            return self
        return replace(self, sizes=TyreSizes.estimated(request, checked_wall(request.settings)[3], self.build_on))

    def mesh_of(self, request: Request, elements: float) -> tuple[int, int]:
        """The best proportions of about so many elements."""
        sizes = self.adapted(request).sizes
        assert sizes is not None
        return sizes.proportioned(elements)

    def build_on(self, request: Request, psi: np.ndarray, phi: np.ndarray) -> TyreModel:
        """The model of the request on the given grid lines."""
        settings = request.settings
        laminate, _, _, clamp = checked_wall(settings)
        if request.model == "sector":
            check_reach(
                cut_of(request), settings.number("R0_mm") + laminate.thickness, settings.numbers("delta_mm")[-1]
            )
            part = part_of(base_of(settings), psi, within(phi, cut_of(request)))
        else:
            part = part_of(request.model, psi, phi)
        shell = inflated_shell(request, laminate, part.grid, part.planes, part.images)
        one = None if request.model == "full" else column(request, laminate, part, shell)
        outside = np.union1d(part.grid.on_line(0, np.deg2rad(clamp)), part.grid.on_line(0, -np.deg2rad(clamp)))
        own = part.merging()
        free = np.setdiff1d(np.unique(own), outside)
        merge = sparse.csr_matrix((np.ones(len(own)), (own, np.arange(len(own)))), shape=2 * (len(own),))
        area = "mid" if settings["pressure_area"] == "mid" else "outer"
        mass = sparse.csr_matrix(merge @ shell.discretisation.nodal_mass(area) @ merge.T)[free][:, free]
        candidates = Candidates(
            reference=shell.discretisation.positions()[1][free],
            operator=shell.discretisation.displacement_operator(free, face=1),
            weights=(merge @ shell.discretisation.nodal_areas(area))[free],
            coupling=mass if settings["coupling"] == "consistent" else None,
        )
        return TyreModel.of(shell, part, candidates, free, settings.numbers("delta_mm"), foundation(settings), one)


@dataclass(frozen=True, eq=False)
class TyreModel(ShellSceneModel, PressedTyre):
    """The stages of the tyre as a shell, or as a part of it."""

    shell: ShellModel
    part: Part
    nodes: np.ndarray  # node of the part's grid of each candidate

    @classmethod
    def of(
        cls,
        shell: ShellModel,
        part: Part,
        candidates: Candidates,
        nodes: np.ndarray,
        deltas: Sequence[float],
        foundation: Foundation,
        column: Column | None,
    ) -> TyreModel:
        """The part that is solved, and the wall of the whole tyre that it stands for."""
        candidate = np.full(part.grid.n_nodes, -1)
        candidate[nodes] = np.arange(len(nodes))

        def faces(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            (inner, outer), (du, dv) = shell.discretisation.positions(), shell.discretisation.cartesian(u)
            return part.sign * (inner + du)[part.node], part.sign * (outer + dv)[part.node]

        wall = Wall(part.angles, part.shape, candidate[part.merging()[part.node]], part.copies, faces)
        return cls(shell, wall, candidates, deltas, foundation, shell, part, nodes, column=column)

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

    def outer_pressure(self, solution: ContactSolution) -> np.ndarray:
        """Contact pressure (N,) at the nodes of the part; zero during inflation."""
        pressure = np.zeros(self.part.grid.n_nodes)
        if len(solution.pressure):
            pressure[self.nodes] = solution.pressure
        return pressure[self.part.merging()]
