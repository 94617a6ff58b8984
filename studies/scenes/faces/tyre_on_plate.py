"""The tyre pressed on a plate that bends: two shells, the softer one inflated.

The default is an aluminium ramp, 6 mm thick, between beams 600 mm apart: under the tyre it bends by about its
thickness, and its stresses stay elastic. Its edges are supported, and hinged or clamped. On a stiff plate the tyre is
that on the rigid plane. Where the deflection of the plate is small compared with its thickness, it is the sum of
Navier's solutions for the contact forces.
"""

from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, Ladder, meshes
from studies.ask.scene import Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.closed_forms.plates import navier_deflection
from studies.scenes.data import references
from studies.scenes.element import grid_over, on_grid
from studies.scenes.faces import pressed_tyre
from studies.scenes.faces.bodies import Placed, Side
from studies.scenes.faces.model import Meeting, of_second, uncut
from studies.scenes.faces.pressed_tyre import Inflated, OnGround, lines, reach
from studies.scenes.faces.ring_on_layer import TURN
from studies.scenes.statics import loaded_shell
from studies.scenes.tyre.scene import ISOTROPIC, JUMPS, Tyre

NEAR = (1.2, 1.7)  # of the patch of a stiff tyre: across and along, what of the plate may meet the tyre
STIFF = {"E_plate_MPa": 1e8}
THICK = Setting.positive("plate_mm", 6.0, "thickness of the plate", 100)
LONG = Setting.positive("plate_length_mm", 600.0, "length of the plate, in the way of the tyre", 1e5)
WIDE = Setting.positive("plate_width_mm", 600.0, "width of the plate, along the axis of the tyre", 1e5)
YOUNG = Setting.positive("E_plate_MPa", 70e3, "Young's modulus of the plate", 1e12)
POISSON = Setting("nu_plate", 0.33, "Poisson's ratio of the plate", low=0.0, high=0.49)
EDGES = Setting.one_of("edges", ("hinged", "clamped"), "hinged", "edges of the plate, held: whether they may turn")


def _references() -> tuple[Reference, ...]:
    """Of the tyre on a rigid plane, for a stiff plate; Navier's, for one that bends by 0.004 of its thickness."""
    rigid = [each for each in Tyre.references if each.quantity in pressed_tyre.QUANTITIES]
    bent = references("exact", "Navier's plate", 1e-3, [({"E_plate_MPa": 1e7}, {"deflection_over_navier": 1.0})])
    return (*(replace(each, at={**each.at, **STIFF}) for each in rigid), *bent)


class TyreOnPlate(OnGround):
    """The mesh is that of the whole tyre; a1 of the plate along the axis, a2 in the rolling direction of the tyre."""

    name = "tyre-on-plate"
    title = "Tyre pressed on a plate that bends"
    settings = (THICK, LONG, WIDE, YOUNG, POISSON, EDGES, *pressed_tyre.SETTINGS)
    references = _references()
    quantities = {
        **pressed_tyre.QUANTITIES,
        "deflection_mm": "largest deflection of the plate",
        "deflection_over_navier": "deflection of its middle over that of Navier's plate under the same forces",
    }
    ladders = (
        Ladder(
            CONTACT,
            meshes(14, 18, 3),
            ("force_N",),
            settings={**ISOTROPIC, "delta_mm": "20"},
            coarser=("8x10",),
            causes={"force_N": JUMPS},
        ),
    )

    def build(self, request: Request) -> SceneModel:
        """The tyre is the first body."""
        request = uncut(request)
        tyre, plate = Inflated.on(request), _plate(request)
        t, sides = request.number("plate_mm"), (request.number("plate_width_mm"), request.number("plate_length_mm"))
        body, copies = plate.discretisation, 4 if request.model == "quarter" else 1
        centre = int(np.argmin(np.linalg.norm(body.grid.nodes, axis=1)))
        stiffness = request.number("E_plate_MPa") * t**3 / 12 / (1 - request.number("nu_plate") ** 2)

        def reading(meeting: Meeting) -> dict[str, float]:
            deflection = -np.mean(body.cartesian(meeting.u[len(tyre.u) :]), axis=0)[:, 2]
            y, z = meeting.position[:, 1:].T
            linear = copies * navier_deflection(sides, stiffness, z, y, meeting.force)
            over = {"deflection_over_navier": float(deflection[centre]) / linear if linear else 1.0}
            readings = {"deflection_mm": float(np.max(deflection))}
            return readings | (over if request.choice("edges") == "hinged" else {})

        near = np.abs(body.grid.centre) <= np.multiply(NEAR, reach(request, np.inf))
        side = Side(1, 1, np.flatnonzero(near.all(axis=1)))
        ends = [body.grid.on_line(axis, float(end)) for axis in (0, 1) for end in body.grid.ends[axis] if end != 0]
        nodes = np.setdiff1d(np.unique(body.grid.elements[side.patches]), np.concatenate(ends))
        return pressed_tyre.pressed(
            request, tyre, lambda shift: Placed(plate, TURN, shift), t / 2, (side, nodes), reading
        )


def _plate(request: Request) -> ShellModel:
    edge, at = request.choice("edges"), []
    for key, count, covered in zip(
        ("plate_width_mm", "plate_length_mm"), request.mesh, reach(request, np.inf), strict=True
    ):
        half = request.number(key) / 2
        if half <= covered:
            raise UsageError(
                f"{key} must be above {2 * covered:.4g}, else the tyre would reach its edges: got {2 * half:g}"
            )
        at.append(lines(request, of_second(count, request), half, covered))
    wall = Laminate.single(Ply.isotropic(*(request.number(key) for key in ("E_plate_MPa", "nu_plate", "plate_mm"))))
    first = "symmetric" if request.model == "quarter" else edge
    return loaded_shell(on_grid(request, Plate(), grid_over(request, *at), wall, (first, edge) * 2), request)


SCENES = (TyreOnPlate(),)
