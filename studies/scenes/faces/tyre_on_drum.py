"""The tyre pressed on a drum with a rubber coat: a shell against a solid of opposite curvature.

The axes are parallel. The default is the drum of a test rig, 854 mm in radius, with a 10 mm rubber lagging as soft as a
tread. The drum is rigid. The coat is bonded to it and is modelled under the patch and for some of its thickness around.
On a stiff coat the tyre is that on the rigid drum. A coat that is thin compared with the patch acts as a bed of
springs, p = M w/t, see :mod:`studies.scenes.faces.ring_on_layer`: the rigid drum with a finite epsilon = M/t.
On a coat softer than 1 MPa/mm and with a finer mesh than the tyre, nodes of the tyre sink in one by one: slave=second
is needed.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import LAWS, Laminate, Ply
from formulations.solid_mesh import SolidMesh
from studies.ask.scene import Request, SceneModel, Setting, UsageError
from studies.scenes.data import references
from studies.scenes.faces import pressed_tyre
from studies.scenes.faces.bodies import Side
from studies.scenes.faces.model import Meeting, of_second, uncut
from studies.scenes.faces.pressed_tyre import Inflated, OnGround, lines, reach
from studies.scenes.faces.ring_on_layer import LAW, LAYER, POISSON, THROUGH, YOUNG
from studies.scenes.faces.solids import PlacedSolid, tied

TURN = np.diag([-1.0, -1.0, 1.0])  # half a turn about the axis: a2 = 0 looks at the tyre
BEYOND = 1.2  # half length of the coat over that of the patch of a stiff tyre
AROUND = 2.0  # thicknesses of the coat beside the patch
COARSER = 50  # %: quadratic elements of a body that hardly yields
RADIUS = Setting("drum_radius_mm", 854.0, "radius of the drum with its coat", low=100, high=1e5)
COAT = (
    replace(LAYER, default=10.0),
    replace(YOUNG, default=5.0),
    replace(POISSON, default=0.49),
    *(THROUGH, LAW),
)


RIGID: Mapping[str, float | str] = {"E_layer_MPa": 1e4, "delta_mm": 20.0, "E_MPa": 20.0, "nu": 0.45, "load": "follower"}
LIMIT = references(
    "refined", "isotropic tyre on the rigid drum, 84x80 and 112x112", 2e-3, [(RIGID, {"force_N": 1192.27})]
)


class TyreOnDrum(OnGround):
    """The mesh is that of the whole tyre; a1 of the coat along the axis, a2 around it."""

    name = "tyre-on-drum"
    title = "Tyre pressed on a drum coated with rubber"
    settings = (
        *(RADIUS, *COAT),
        *(replace(each, default=COARSER) if each.key == "other_elements" else each for each in pressed_tyre.SETTINGS),
    )
    references = LIMIT
    quantities = {
        **pressed_tyre.QUANTITIES,
        "indentation_mm": "largest depth to which the face of the coat is pressed in",
    }

    def build(self, request: Request) -> SceneModel:
        """The tyre is the first body."""
        request = uncut(request)
        tyre, coat, radius = Inflated.on(request), _coat(request), request.number("drum_radius_mm")
        corners = coat.points_of(1)
        outwards = coat.solid.solid.discretisation.mesh.x[corners] * [1, 1, 0] / radius

        def reading(meeting: Meeting) -> dict[str, float]:
            depth = -np.sum(coat.solid.expand(meeting.u[len(tyre.u) :])[corners] * outwards, axis=1)
            return {"indentation_mm": float(np.max(depth))}

        return pressed_tyre.pressed(
            request,
            tyre,
            lambda shift: replace(coat, turn=TURN, shift=shift),
            radius,
            (Side(1, 1), np.arange(len(corners))),
            reading,
        )


def _coat(request: Request) -> PlacedSolid:
    t, radius = request.number("layer_mm"), request.number("drum_radius_mm")
    if not t < radius:
        raise UsageError(f"layer_mm must be below drum_radius_mm = {radius:g}, got {t:g}")
    wide, long = reach(request, radius)
    half = wide + AROUND * t, min((BEYOND * long + AROUND * t) / radius, math.pi / 2)
    across, around = (
        lines(request, of_second(count, request), end, end, down=down)
        for end, count, down in zip(half, request.mesh, (False, True), strict=True)
    )
    laminate = Laminate((Ply.isotropic(request.number("E_layer_MPa"), request.number("nu_layer"), t),), -t)
    mesh = SolidMesh.build(cylinder(radius), across, around, laminate, per_ply=int(request.number("through")))
    mirrors = ((mesh.on(0, 0.0), 2), (mesh.on(1, 0.0), 1)) if request.model == "quarter" else ()
    fixed = mesh.supports((np.unique(mesh.inner), slice(None)), *mirrors)
    return tied(request, mesh, laminate, fixed, mesh.outer, law=LAWS[request.choice("layer_law")])


SCENES = (TyreOnDrum(),)
