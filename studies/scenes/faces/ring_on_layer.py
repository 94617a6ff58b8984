"""A ring pressed on an elastic layer: a shell against a solid.

The ring of :mod:`studies.scenes.contact.ring`, a quarter of it, whose plate has a coat bonded to it: solid elements in
plane strain. On a stiff layer it is the ring on a rigid plate. A layer that is thin beside the length of the contact is
a bed of springs, for next to nothing but the strain across it stores energy: p = M w/t with the indentation w, the
thickness t and the modulus M = E (1 - nu)/((1 + nu)(1 - 2 nu)) that it has while nothing moves along it (Johnson,
Contact Mechanics (1985), 5.8, recalled). That is the ring on a rigid plate with the law of a finite epsilon = M/t, and
where the ring is far stiffer than the layer, a rigid cylinder on springs: with its outer radius R ::

    a = sqrt(2 R delta),    F = 4/3 (M/t) delta a,    p0 = (M/t) delta
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import Plate, cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS, LINEAR
from formulations.shell import ShellModel
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from studies.ask.declarations import Sheet
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Reference, Scene, SceneModel, Setting
from studies.scenes.closed_forms.contact import flattened_ring
from studies.scenes.contact.ring import DELTAS, RADIUS, THICKNESS, THIN, TRAVELS, WIDTH, E
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, grid_over, on_grid, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import (
    OTHER,
    PAIRING,
    SHAPE_OF_FACES,
    SLAVE,
    SLAVES,
    FacesModel,
    Facing,
    Meeting,
    of_second,
    pairing_of,
)
from studies.scenes.faces.solids import PlacedSolid, towards_start
from studies.scenes.statics import loaded_shell

TURN = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])  # the layer faces -x
LONG = 1.2  # half length of the layer over R: nothing touches beyond R
STIFF: Mapping[str, float | str] = {"h_mm": THIN, "E_layer_MPa": 1e7, "slave": "first", "measure": "exact"}
BED: Mapping[str, float | str] = {
    **{"h_mm": 20.0, "layer_mm": 2e-3, "E_layer_MPa": 0.1, "nu_layer": 0.0, "lines": "closer"},
    **{"delta_mm": 1e-5, "slave": "second"},
}  # a contact 23 times as long as the layer is thick, and strains of 0.005
IN_CONTACT = 0.25  # share of the elements
SOFTER = replace(SLAVE, default=SLAVES[1])  # gaps of a stiff slave on a soft master with fewer nodes are too many
LAYER = Setting("layer_mm", 5.0, "thickness of the layer", low=1e-3, high=100)
YOUNG = Setting("E_layer_MPa", 10.0, "Young's modulus of the layer", low=1e-3, high=1e8)
POISSON = Setting("nu_layer", 0.0, "Poisson's ratio of the layer", low=0.0, high=0.499)
LAW = Setting.one_of("layer_law", LAWS.keys(), LINEAR, "material law of the layer")
THROUGH = Setting("through", 2, "elements through the layer", "int", 1, 16)
LINES = Setting.one_of(
    "lines", ("even", "closer"), "even", "grid lines: evenly spaced, or closer towards a small contact on springs"
)


def on_springs(delta: float, radius: float, stiffness: float) -> tuple[float, float]:
    """Force [N/mm] and half width [mm] of a rigid cylinder on springs p = k w; delta, radius [mm], k [MPa/mm]."""
    a = math.sqrt(2 * radius * delta)
    return 4 / 3 * stiffness * delta * a, a


def constrained(young: float, nu: float) -> float:
    """M [MPa] of a layer that nothing moves along."""
    return young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def _references() -> tuple[Reference, ...]:
    found: list[Row] = []
    for delta in DELTAS:
        load, flat = flattened_ring(1 - delta / RADIUS)
        found.append(
            (
                {**STIFF, "delta_mm": delta},
                {"P_R2_over_EI": load, "flat_half_length": flat},
            )
        )
    springs = references(
        "exact",
        "rigid cylinder on springs",
        1e-2,
        [(BED, {"force_over_springs": 1.0, "peak_over_springs": 1.0})],
    )
    return (*references("exact", "inextensible elastica on a rigid plate, elliptic integrals", 1e-3, found), *springs)


class RingOnLayer:
    """a1 along the axis, a2 from the middle of the contact over a quarter of the ring, and along the layer."""

    name: str = "ring-on-layer"
    title: str = "Ring pressed on an elastic layer: a shell against a solid"
    default_mesh: tuple[int, int] = (1, 64)
    settings: tuple[Setting, ...] = (
        *(TRAVELS, THICKNESS, LAYER, YOUNG, POISSON, LAW, THROUGH, OTHER),
        *(PAIRING, SHAPE_OF_FACES, SOFTER, LINES, EPSILON, *ELEMENT, SOLVER),
    )
    references: tuple[Reference, ...] = _references()
    quantities: Mapping[str, str] = {
        "P_R2_over_EI": "force of the layer times R^2/(E I)",
        "flat_half_length": "centre of the nodal contact forces from the middle of the contact, over R",
        "peak_MPa": "largest pressure",
        "force_over_springs": "force over that of a rigid cylinder on springs as stiff as the layer",
        "peak_over_springs": "largest pressure over that of a rigid cylinder on springs",
    }
    sheet: Sheet = Sheet("-x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """Symmetry on all four sides of the ring and in the middle of the layer, whose back is held."""
        request = replace(request, leaves=())  # both bodies follow the mesh
        deltas, h, t = request.numbers("delta_mm"), request.number("h_mm"), request.number("layer_mm")
        count = of_second(request.mesh[1], request)
        ring, layer = _ring(request, h, deltas[-1]), _layer(request, count, t, deltas[-1])
        stiffness = constrained(request.number("E_layer_MPa"), request.number("nu_layer")) / t
        own, EI = SLAVES.index(request.choice("slave")), E * h**3 / 12 * WIDTH

        def bodies(delta: float) -> Bodies:
            away = np.array([RADIUS + h / 2 - delta, 0.0, 0.0])
            return Bodies((Placed(ring), PlacedSolid(layer, TURN, away)))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            total = float(meeting.force.sum())
            centre = float(meeting.force @ np.abs(meeting.position[:, 1])) / total / RADIUS if total > 0 else 0.0
            peak = float(meeting.pressure.max())
            return {
                "P_R2_over_EI": 2 * total * RADIUS**2 / EI,
                "flat_half_length": centre,
                "peak_MPa": peak,
                "force_over_springs": 2 * total / WIDTH / on_springs(delta, RADIUS + h / 2, stiffness)[0],
                "peak_over_springs": peak / (stiffness * delta),
            }

        grid = ring.discretisation.grid
        on_ring = np.setdiff1d(grid.free_nodes, grid.on_line(1, np.pi / 2))
        nodes = (on_ring, np.arange(len(bodies(0.0).parts[1].points_of(1))))[own]
        pair = Facing(Side(own, 1), Side(1 - own, 1), nodes)
        return FacesModel(bodies, (pair,), pairing_of(request), deltas, measured, "delta_mm")


def _lines(request: Request, n: int, length: float, delta: float) -> np.ndarray:
    """Along a length [mm], by LINES."""
    if request.choice("lines") == "even":
        return spaced_lines(0.0, length, n)
    return towards_start(n, length, on_springs(delta, RADIUS + request.number("h_mm") / 2, 1.0)[1], IN_CONTACT)


def _ring(request: Request, h: float, delta: float) -> ShellModel:
    laminate, side = Laminate.single(Ply.isotropic(E, 0.0, h)), np.pi / 2 * RADIUS
    around = _lines(request, request.mesh[1], side, delta) / RADIUS
    grid = grid_over(request, spaced_lines(0, WIDTH, request.mesh[0]), around)
    return loaded_shell(on_grid(request, cylinder(RADIUS), grid, laminate, ("symmetric",) * 4), request)


def _layer(request: Request, count: int, t: float, delta: float) -> TiedSolid:
    laminate = Laminate((Ply.isotropic(request.number("E_layer_MPa"), request.number("nu_layer"), t),), -t)
    across, along = spaced_lines(0, WIDTH, request.mesh[0]), _lines(request, count, LONG * RADIUS, delta)
    mesh = SolidMesh.build(Plate(), across, along, laminate, per_ply=int(request.number("through")))
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[:, 0] = True
    fixed[mesh.on(1, 0.0), 1] = True
    fixed[np.unique(mesh.inner)] = True
    return TiedSolid.build(mesh, laminate, fixed, mesh.outer, uniform=True, law=LAWS[request.choice("layer_law")])


SCENES: tuple[Scene, ...] = (RingOnLayer(),)
