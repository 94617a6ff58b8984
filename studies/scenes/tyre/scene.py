"""The pneumatic tyre of the 2004 paper: an angle-ply torus, inflated, then pressed by a rigid plane.

a1 = psi from the outer equator, a2 = phi around the axis; both edges psi = +-clamp are held. The plane is that of
:mod:`studies.scenes.tyre.press`; any foundation of :mod:`studies.scenes.foundations` can replace it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from formulations.loads import PRESSURE_AREAS
from formulations.section.laminate import SECTIONS
from studies.ask.declarations import TYRE, Ladder, Sheet, ShellLimit, meshes
from studies.ask.request import Request, Value
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Setting, UsageError
from studies.scenes import foundations
from studies.scenes.data import At, Row, reference_rows, references
from studies.scenes.element import ELEMENT
from studies.scenes.tyre.grid_lines import GRADING, TyreSizes, checked_mesh, tyre_lines
from studies.scenes.tyre.model import ORTHOTROPIC, InflatedTyre, TyreModel, checked_wall
from studies.scenes.tyre.parts import MODELS, settle_model
from studies.scenes.tyre.press import PATH_SETTINGS
from studies.scenes.tyre.sector import SECTOR, cut_of, settle_sector, with_line_at

PAPER = "Grigolyuk, Kulikov, Plotnikova, Mech. Compos. Mater. (2004)"
SOLID = "3D solid, NGSolve 6.2 cubic hexahedra 18x16x1; CalculiX C3D20R within 0.3 % on force"
REFINED = "limit of grids cut where the force is decided, the mean of both elements: table work_precision"

PLY = {
    "E_L_MPa": "modulus of a ply along the cords",
    "E_T_MPa": "modulus of a ply across the cords",
    "G_LT_MPa": "shear modulus of a ply in its plane",
    "G_TT_MPa": "shear modulus of a ply across the cords",
    "nu_LT": "Poisson ratio of a ply, from along to across the cords",
    "nu_TT": "Poisson ratio of a ply, across the cords",
}
ISOTROPIC = {
    "E_MPa": "20",
    "nu": "0.45",
    "plies": "1",
    "ply_thickness_mm": "4.8",
    "load": "follower",
    "pressure_area": "face",
}
JUMPS = (
    "the rim of the patch, an oval that no grid line follows, passes from line to line, and that changes the value as"
    " much as the size of the elements still does"
)
PATCH = ("force_N", "centre_pressure_MPa")
LADDER = Ladder(
    TYRE,
    meshes(14, 18),  # those of the solid, and one more
    PATCH,
    settings={"delta_mm": "20"},
    causes=dict.fromkeys(PATCH, JUMPS),
    whole={"delta_mm": "20,35"},
)
AREA_OF = {"dead": "mid", "follower": "face"}  # a follower on the mid-surface differs from a solid by 4 %
BY_LOAD = ", ".join(f"{load} {area}" for load, area in AREA_OF.items())
TRAVELS = "indentation from first touch; 0: inflation alone"
RIM = "rim of the patch in half_length_mm and half_width_mm: half-way to the first open node, or by pressure"
COUPLING = "nodal forces from pressures: by shares of area or by the mass matrix"
POISSON = Setting("nu", None, "Poisson ratio of an isotropic tyre, with E_MPa", otherwise="orthotropic plies")
SETTINGS = (
    Setting("gamma_deg", 52.0, "cord angle from the meridian; the plies alternate in sign", low=-90, high=90),
    Setting("p0_MPa", 0.15, "inflation pressure", low=-10, high=10),
    Setting("delta_mm", (5.0, 10.0, 15.0, 20.0), TRAVELS, "floats", 0, 100),
    Setting.one_of("load", AREA_OF, "dead", "whether the pressure follows the wall"),
    Setting.one_of(
        "pressure_area",
        PRESSURE_AREAS,
        None,
        "area that carries pressures: mid-surface or true faces",
        otherwise=BY_LOAD,
    ),
    Setting.one_of("coupling", ("lumped", "consistent"), "lumped", COUPLING),
    Setting.one_of("rim", ("half-way", "pressure"), "half-way", RIM),
    EPSILON,
    Setting.one_of("section", SECTIONS, "constant-s33", "constitutive law through the thickness"),
    Setting("plies", 4, "number of plies", "int", 1, 64),
    Setting.positive("ply_thickness_mm", 1.2, "thickness of a ply", 50),
    *(Setting.positive(key, None, PLY[key], otherwise=f"{value:g}") for key, value in ORTHOTROPIC.items()),
    Setting.positive("E_MPa", None, "modulus of an isotropic tyre, with nu", otherwise="orthotropic plies"),
    replace(POISSON, low=-1, high=0.5, open_low=True, open_high=True),
    Setting.positive("R1_mm", 50.0, "radius of the inner meridian", 1e4),
    Setting.positive("R0_mm", 250.0, "radius of the inner equator", 1e5),
    Setting("clamp_deg", 120.0, "meridian angle of the clamped edges", low=10, high=175),
    GRADING,
    SECTOR,
    *PATH_SETTINGS,
    *foundations.SETTINGS,
    *ELEMENT,
    SOLVER,
)


def with_wall(settings: Mapping[str, Value]) -> dict[str, Value]:
    """Add the area of the load, and the plies of the paper unless isotropic; raises UsageError on a mixture."""
    settings = {"pressure_area": AREA_OF[str(settings["load"])], **settings}
    isotropic = [key for key in ("E_MPa", "nu") if key in settings]
    given = [key for key in ORTHOTROPIC if key in settings]
    if not isotropic:
        return {**settings, **{key: settings.get(key, value) for key, value in ORTHOTROPIC.items()}}
    if len(isotropic) == 1 or given:
        raise UsageError(f"an isotropic tyre needs both E_MPa and nu, and takes no {', '.join(ORTHOTROPIC)}")
    return dict(settings)


def _references() -> tuple[Reference, ...]:
    paper: At = {"delta_mm": 20.0, "E_L_MPa": 510.45, "gamma_deg": 52.0, "load": "dead", "pressure_area": "mid"}
    as_here: At = {**paper, "p0_MPa": 0.15, "section": "constant-s33"}
    isotropic: At = {"E_MPa": 20.0, "nu": 0.45, "load": "follower", "pressure_area": "face"}
    errors = {"force_N": 0.003, "half_length_mm": 0.03, "half_width_mm": 0.03}
    column_of = dict(zip(errors, ("force_N_ngsolve", "half_length_mm", "half_width_mm"), strict=True))
    pressed: list[Row] = [
        ({"delta_mm": row["delta_mm"], **isotropic}, {name: row[column] for name, column in column_of.items()})
        for row in reference_rows("isotropic_tyre_3d_solid.csv")
    ]
    equator = {"inflated_equator_inner_mm": 4.6256, "inflated_equator_outer_mm": 4.3463}
    return (
        *references("printed", PAPER, 0.01, [(paper, {"centre_pressure_MPa": 0.156})]),
        *references("refined", REFINED, 1e-3, [(as_here, {"force_N": 1877.3})]),
        *references("computed", SOLID, errors, pressed),
        *references("computed", SOLID, 0.003, [(isotropic, equator)]),
    )


@dataclass(frozen=True)
class Tyre(Declared):
    """Inflation, then contact with a plane.

    sizes: of the elements of adapted grids, where they are known already.
    """

    name: str = "tyre"
    title: str = "Pneumatic tyre pressed on a rigid plane (the 2004 paper)"
    default_mesh: tuple[int, int] = (42, 40)
    coarsest_mesh: tuple[int, int] = (16, 46)  # k l^2/h of its elements is below 1
    settings: tuple[Setting, ...] = SETTINGS
    references: tuple[Reference, ...] = _references()
    quantities = {
        "centre_pressure_MPa": "contact pressure at the centre of the patch, psi = phi = 0",
        "mean_pressure_MPa": "mean of the contact pressure over its own force: int p^2 dA/int p dA",
        "half_length_mm": "from the centre of the patch to its rim around the axis, along the deformed outer face",
        "half_width_mm": "from the centre of the patch to its rim along the meridian, on the deformed outer face",
        "patch_to_clamp_mm": "from the rim of the patch to the nearest clamped edge, along the meridian",
        "inflated_equator_inner_mm": "radial displacement of the inner face at psi = 0 after inflation",
        "inflated_equator_outer_mm": "radial displacement of the outer face at psi = 0 after inflation",
    }
    ladders = (
        LADDER,
        replace(LADDER, name="tyre-isotropic", at="delta_mm=10", settings=ISOTROPIC, whole={}),
    )
    sheet = Sheet("-x", 42.0, 14.0, "42x60", {"delta_mm": "20"}, model="full")
    shell_limit = ShellLimit(
        "pressed tyre",
        lambda settings: settings.number("plies") * settings.number("ply_thickness_mm") / settings.number("R1_mm"),
        only_with="E_MPa",
        solid="tyre-solid",
        quantities={"force": "force", "inflated": "growth"},
    )
    models: tuple[str, ...] = MODELS
    slides: bool = True
    sizes: TyreSizes | None = None

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """Add the measures of the foundation and what the wall leaves open; raises UsageError on a mixture."""
        return with_wall(foundations.complete(settings))

    def settle(self, request: Request) -> Request:
        """The smallest valid model, or the one asked for; raises UsageError when that is not valid."""
        model, reason = settle_model(request.model, request.settings)
        settings = settle_sector(model, request.settings)
        return replace(request, model=model, model_reason=reason, settings=settings)

    def build(self, request: Request) -> TyreModel | InflatedTyre:
        """Raises UsageError for impossible geometry, plies or meshes."""
        return _built(request, self) if self.sizes is None else _kept(request, self.sizes)

    def lines(self, request: Request) -> tuple[np.ndarray, np.ndarray]:
        """Grid lines psi, phi [rad]; raises UsageError on impossible geometry, plies or meshes."""
        clamp, grading = checked_wall(request.settings)[3], request.choice("grading")
        checked_mesh(request.mesh)
        sizes = self.adapted(request).sizes if grading == "adapted" else None
        if sizes is not None and not np.isclose(sizes.psi.at[-1], np.deg2rad(clamp)):
            raise UsageError(f"grading 'adapted': the sizes known are not those for clamp_deg = {clamp:g}")
        psi, phi = tyre_lines(request.mesh, clamp, grading) if sizes is None else sizes.lines(request.mesh)
        return psi, with_line_at(phi, cut_of(request)) if request.model == "sector" else phi

    def adapted(self, request: Request) -> Tyre:
        """The scene with the sizes of its elements estimated; raises UsageError where a coarse tyre is not solved."""
        return self if self.sizes is not None else replace(self, sizes=TyreSizes.estimated(request))

    def mesh_of(self, request: Request, elements: float) -> tuple[int, int]:
        """The best proportions of about so many elements."""
        sizes = self.adapted(request).sizes
        assert sizes is not None
        return sizes.proportioned(elements)


def _built(request: Request, scene: Tyre) -> TyreModel | InflatedTyre:
    model = InflatedTyre if request.model == "axisymmetric" else TyreModel
    return model.on(request, *scene.lines(request))


@lru_cache(maxsize=1)
def _kept(request: Request, sizes: TyreSizes) -> TyreModel | InflatedTyre:
    """A grid of a cascade is tried, and then followed on."""
    return _built(request, Tyre(sizes=sizes))


SCENES = (Tyre(),)
