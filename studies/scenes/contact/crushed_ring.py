"""The polyurethane ring of Saleeb, Chen and Chang, crushed between rigid plates: an experiment, and thick for a shell.

h/R = 0.42 at the middle radius. The model is a quarter of the ring with one element across the width. Its sides do not
move along the axis: plane strain, as in the computations published with the test. The solid of the same ring is in
:mod:`studies.scenes.contact.crushed_ring_solid`.
"""

from collections.abc import Mapping

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.geometry.surfaces import SurfaceOfRevolution, cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import CRUSHED, Sheet, ShellLimit
from studies.ask.request import Request, Settings
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, SceneModel, Setting, UsageError
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.data import Row, reference_rows, references
from studies.scenes.element import ELEMENT, even_grid, on_grid
from studies.scenes.statics import loaded_shell

WIDTH, TOP = 10.0, np.pi / 2  # mm; a2 at half the height, the plate is at a2 = 0
AWAY = np.array([1.0, 0.0, 0.0])
FILE = "contact_crushed_ring.csv"
TEST = "Saleeb, Chen, Chang (1994), test and computation, read off their curve by Code_Aster SSNP501 (V6.03.501)"
# To which the four readings off one printed curve are known: an assumption, a hundredth of the largest
READING = 0.32  # N

TRAVELS = Setting.positive(
    "delta_mm",
    (5.5625, 11.125, 16.6875, 22.25),
    "travel of each plate from first touch; the plates approach by twice that",
    high=24.0,
    kind="floats",
)
OUTER = Setting("outer_mm", 63.5, "outer radius", low=10, high=200)
INNER = Setting("inner_mm", 41.5, "inner radius", low=5, high=200)
QUANTITIES: Mapping[str, str] = {
    "force_N": "contact force of half a plate",
    "least_stretch": "smallest principal stretch in the ring",
    "largest_stretch": "largest principal stretch in the ring",
}
SHEET = Sheet("-x", -62.0, 14.0)
YOUNG = Setting.positive("E_MPa", 4.07, "Young's modulus")
POISSON = Setting("nu", 0.48, "Poisson's ratio", low=0.0, high=0.499)
RING = (TRAVELS, OUTER, INNER, YOUNG, POISSON)
DATA = {setting.key: float(setting.default) for setting in RING[1:] if isinstance(setting.default, float)}


def _thickness(settings: Settings) -> float:
    """Over the middle radius."""
    outer, inner = settings.number("outer_mm"), settings.number("inner_mm")
    return 2 * (outer - inner) / (outer + inner)


def experiment() -> tuple[Reference, ...]:
    """The forces of the test, for the ring that was tested."""
    measured: tuple[Reference, ...] = ()
    for row in reference_rows(FILE):
        force = row["measured_N"]
        at: list[Row] = [({"delta_mm": row["delta_mm"], **DATA}, {"force_N": force})]
        measured += references("read", TEST, READING / force, at)
    return measured


def plate(request: Request, delta: float) -> RigidPlane:
    """A plate after its travel."""
    return RigidPlane(AWAY, request.number("outer_mm") - delta)


def ring(request: Request) -> tuple[SurfaceOfRevolution, Laminate]:
    """The middle surface and the wall; raises UsageError for a wall without thickness."""
    outer, inner = request.number("outer_mm"), request.number("inner_mm")
    if not inner < outer:
        raise UsageError(f"inner_mm = {inner:g} must be smaller than outer_mm = {outer:g}")
    ply = Ply.isotropic(request.number("E_MPa"), request.number("nu"), outer - inner)
    return cylinder((outer + inner) / 2), Laminate.single(ply)


class CrushedRing(Declared):
    """a1 along the axis, a2 from the plate over a quarter of the ring; the force is that on half a plate."""

    name = "crushed-ring"
    title = "Thick polyurethane ring crushed between rigid plates: an experiment"
    default_mesh = (1, 64)
    settings = (*RING, EPSILON, *ELEMENT, SOLVER)
    references = experiment()
    quantities = QUANTITIES
    sheet = SHEET
    shell_limit = ShellLimit(CRUSHED, _thickness, solid="crushed-ring-solid")

    def build(self, request: Request) -> SceneModel:
        """All four sides are symmetric, so nothing moves along the axis."""
        surface, laminate = ring(request)
        grid = even_grid(request, (0, WIDTH), (0, TOP))
        quarter = on_grid(request, surface, grid, laminate, ("symmetric",) * 4)
        shell = loaded_shell(quarter, request)

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            return {"force_N": float(touch.force.sum())}

        return ContactModel(
            shell,
            quarter.grid.on_line(1, TOP),
            request.numbers("delta_mm"),
            lambda delta: plate(request, delta),
            measured,
            key="delta_mm",
            body_at=lambda delta: shell,
        )


SCENES = (CrushedRing(),)
