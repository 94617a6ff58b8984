"""A ring pressed on an elastic layer: a shell against a solid.

The model is a quarter of the ring of :mod:`studies.scenes.contact.ring`; an elastic layer of solid elements in plane
strain is bonded to the plate. On a stiff layer it is the ring on a rigid plate. A layer that is thin compared with the
length of the contact acts as a bed of springs, because almost only the strain across it stores energy: p = M w/t with
the indentation w, the thickness t and the modulus M = E (1 - nu)/((1 + nu)(1 - 2 nu)) for no motion along the layer
(Johnson, Contact Mechanics (1985), 5.8, recalled). That is the ring on a rigid plate with a finite epsilon = M/t. Where
the ring is far stiffer than the layer, it is a rigid cylinder on springs: with the outer radius R ::

    a = sqrt(2 R delta),    F = 4/3 (M/t) delta a,    p0 = (M/t) delta
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import LAWS, LINEAR, Laminate, Ply
from formulations.solid.ties import TiedSolid
from formulations.solid_mesh import SolidMesh
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting, Sheet
from studies.scenes.contact import ring
from studies.scenes.data import references
from studies.scenes.element import ELEMENT, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import FacesModel, Facing, Meeting, of_second, paired, uncut
from studies.scenes.faces.solids import PlacedSolid, towards_start
from studies.scenes.statics import loaded_shell

TURN = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])  # the layer faces -x
LONG = 1.2  # half length of the layer over R: nothing touches beyond R
ON_PLATE = ("P_R2_over_EI", "flat_half_length")
SOURCE = "inextensible elastica on a rigid plate, elliptic integrals"
STIFF: Mapping[str, float | str] = {"E_layer_MPa": 1e7, "slave": "first"}
BED: Mapping[str, float | str] = {
    **{"h_mm": 20.0, "layer_mm": 2e-3, "E_layer_MPa": 0.1, "nu_layer": 0.0, "lines": "closer"},
    **{"delta_mm": 1e-5, "slave": "second"},
}  # a contact 23 times as long as the layer is thick, and strains of 0.005
IN_CONTACT = 0.25  # share of the elements
SOFTER = paired(slave="second")  # gaps of a stiff slave on a soft master with fewer nodes are too many
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
    springs = references(
        "exact",
        "rigid cylinder on springs",
        1e-2,
        [(BED, {"force_over_springs": 1.0, "peak_over_springs": 1.0})],
    )
    return (*ring.elastica(SOURCE, 1e-3, ON_PLATE, **STIFF), *springs)


class RingOnLayer(Declared):
    """a1 along the axis, a2 from the middle of the contact over a quarter of the ring, and along the layer."""

    name = "ring-on-layer"
    title = "Ring pressed on an elastic layer: a shell against a solid"
    default_mesh = (1, 64)
    settings = (
        *(ring.TRAVELS, ring.THICKNESS, LAYER, YOUNG, POISSON, LAW, THROUGH),
        *(*SOFTER, LINES, EPSILON, *ELEMENT, SOLVER),
    )
    references = _references()
    quantities = {
        "P_R2_over_EI": "force of the layer times R^2/(E I)",
        "flat_half_length": "centre of the nodal contact forces from the middle of the contact, over R",
        "peak_MPa": "largest pressure",
        "force_over_springs": "force over that of a rigid cylinder on springs as stiff as the layer",
        "peak_over_springs": "largest pressure over that of a rigid cylinder on springs",
    }
    sheet = Sheet("-x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """All four sides of the ring and the middle of the layer are symmetric; the back of the layer is held."""
        request = uncut(request)
        deltas, h, t = request.numbers("delta_mm"), request.number("h_mm"), request.number("layer_mm")
        count = of_second(request.mesh[1], request)
        side, last = np.pi / 2 * ring.RADIUS, deltas[-1]
        part = ring.part_around(request, h, _lines(request, request.mesh[1], side, last) / ring.RADIUS)
        shell, layer = loaded_shell(part, request), PlacedSolid(_layer(request, count, t, last), TURN)
        stiffness = constrained(request.number("E_layer_MPa"), request.number("nu_layer")) / t

        def bodies(delta: float) -> Bodies:
            away = np.array([ring.RADIUS + h / 2 - delta, 0.0, 0.0])
            return Bodies((Placed(shell), replace(layer, shift=away)))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            read = ring.flattened(delta, h, meeting.force, meeting.position[:, 1])
            force, peak = 2 * float(meeting.force.sum()) / ring.WIDTH, float(meeting.pressure.max())
            return {
                **{name: read[name] for name in ON_PLATE},
                "peak_MPa": peak,
                "force_over_springs": force / on_springs(delta, ring.RADIUS + h / 2, stiffness)[0],
                "peak_over_springs": peak / (stiffness * delta),
            }

        sides = (Side(0, 1), ring.may_touch(part.grid)), (Side(1, 1), np.arange(len(layer.points_of(1))))
        return FacesModel.of(request, bodies, [Facing.between(request, *sides)], measured)


def _lines(request: Request, n: int, length: float, delta: float) -> np.ndarray:
    """Along a length [mm], by LINES."""
    if request.choice("lines") == "even":
        return spaced_lines(0.0, length, n)
    return towards_start(n, length, on_springs(delta, ring.RADIUS + request.number("h_mm") / 2, 1.0)[1], IN_CONTACT)


def _layer(request: Request, count: int, t: float, delta: float) -> TiedSolid:
    laminate = Laminate((Ply.isotropic(request.number("E_layer_MPa"), request.number("nu_layer"), t),), -t)
    across, along = spaced_lines(0, ring.WIDTH, request.mesh[0]), _lines(request, count, LONG * ring.RADIUS, delta)
    mesh = SolidMesh.build(Plate(), across, along, laminate, per_ply=int(request.number("through")))
    fixed = mesh.supports((slice(None), 0), (mesh.on(1, 0.0), 1), (np.unique(mesh.inner), slice(None)))
    return TiedSolid.build(mesh, laminate, fixed, mesh.outer, uniform=True, law=LAWS[request.choice("layer_law")])


SCENES = (RingOnLayer(),)
