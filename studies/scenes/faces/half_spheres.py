"""Two hollow half-spheres pressed on each other, their rims clamped: a wedge of both about the axis.

Equal ones are mirror images, and each meets a rigid plane half-way, `against=plane`. The stiffer the other one, the
more the first meets a rigid ball, `against=ball`. The walls by default are 0.18 and 0.15 of the radius, as in a
benchmark of mortar methods (Puso, Laursen) whose radius, modulus and law are not known to us: its curves are none of
ours. From a travel of about 1 mm on a mode of short waves of the inner face at the pole has a negative eigenvalue, and
the answer is unstable, also on the rigid plane. A hole about the axis, HOLE from the pole to its rim, keeps elements
from meeting in a point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from contact.obstacles.drum_sphere import Sphere
from contact.obstacles.foundation import RigidPlane
from formulations.geometry.surfaces import sphere
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, Ladder, Sheet
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Reference, Scene, SceneModel, Setting, UsageError
from studies.scenes.contact.base import ContactModel
from studies.scenes.element import ELEMENT, grid_over, on_grid, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import OTHER, PAIRING, SLAVE, SLAVES, FacesModel, Facing, of_second
from studies.scenes.statics import loaded_shell

E, NU, RADIUS = 1.0, 0.3, 10.0  # MPa, -, mm of the middle surface
WEDGE, HOLE = math.radians(10.0), math.radians(1.0)
REACH = 0.35  # least latitude [rad] of what may touch: the rims are at 0
AWAY = np.array([0.0, 0.0, 1.0])

TRAVELS = Setting.positive("delta_mm", (0.2, 0.6), "approach of the rims from first touch", 10.0, kind="floats")
THICKNESS = Setting.positive("h_mm", 1.8, "thickness", RADIUS)
OTHER_THICKNESS = Setting.positive("other_h_mm", 1.5, "thickness of the second half-sphere", RADIUS)
OTHER_MODULUS = Setting.positive("other_E_MPa", E, "Young's modulus of the second half-sphere", 1e6)
AGAINST = Setting.one_of("against", ("other", "plane", "ball"), "other", "another half-sphere, or what is rigid")


class HalfSpheres:
    """a1 the latitude from the rim, a2 around the axis."""

    name: str = "half-spheres"
    title: str = "Two hollow half-spheres pressed on each other"
    default_mesh: tuple[int, int] = (40, 1)
    settings: tuple[Setting, ...] = (
        TRAVELS,
        THICKNESS,
        OTHER_THICKNESS,
        OTHER_MODULUS,
        AGAINST,
        OTHER,
        PAIRING,
        SLAVE,
        EPSILON,
        *ELEMENT,
        SOLVER,
    )
    references: tuple[Reference, ...] = ()
    quantities: Mapping[str, str] = {
        "force_N": "between the half-spheres, of the whole circle",
        "radius_mm": "mean distance of the contact pressure from the axis",
    }
    ladders: tuple[Ladder, ...] = (
        Ladder(
            CONTACT,
            ("20x1", "40x1", "80x1"),
            ("force_N",),
            coarser=("10x1",),
            causes={"force_N": "the rim of contact lies elsewhere between the lines of every mesh"},
        ),
    )
    sheet: Sheet = Sheet("z", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """Symmetry on both sides of the wedge."""
        request = replace(request, leaves=())  # cuts of one body are none of the other's: both follow the mesh
        deltas, against = request.numbers("delta_mm"), request.choice("against")
        thick = request.number("h_mm"), request.number("other_h_mm")
        count = request.mesh[0]
        first = _half(request, thick[0], E, count)

        def read(force: np.ndarray, at: np.ndarray) -> dict[str, float]:
            total = float(force.sum())
            away = float(force @ np.linalg.norm(at[:, :2], axis=1)) / total if total > 0 else 0.0
            return {"force_N": total * 2 * math.pi / WEDGE, "radius_mm": away}

        if against != "other":
            top = RADIUS + thick[0] / 2
            ball = RADIUS + thick[1] / 2

            def rigid(delta: float) -> RigidPlane | Sphere:
                low = top - delta
                return RigidPlane(AWAY, low) if against == "plane" else Sphere((low + ball) * AWAY, ball)

            grid = first.discretisation.grid
            held = np.flatnonzero(grid.nodes[:, 0] < REACH)
            return ContactModel(
                first,
                held,
                deltas,
                rigid,
                lambda delta, touch: read(touch.force, touch.candidates.positions(touch.u)),
                key="delta_mm",
                body_at=lambda delta: first,
            )
        second = _half(request, thick[1], request.number("other_E_MPa"), of_second(count, request))
        own, cosine, sine = SLAVES.index(request.choice("slave")), math.cos(WEDGE), math.sin(WEDGE)
        facing = np.array([[cosine, sine, 0.0], [sine, -cosine, 0.0], [0.0, 0.0, -1.0]])

        def bodies(delta: float) -> Bodies:
            apart = 2 * RADIUS + sum(thick) / 2 - delta
            return Bodies((Placed(first), Placed(second, facing, apart * AWAY)))

        grid = (first, second)[own].discretisation.grid
        touching = np.flatnonzero(grid.nodes[:, 0] >= REACH)
        pair = Facing(Side(own, 1), Side(1 - own, 1), touching)
        pairing = request.choice("pairing")
        return FacesModel(
            bodies, (pair,), pairing, deltas, lambda t, meeting: read(meeting.force, meeting.position), "delta_mm"
        )


def _half(request: Request, h: float, young: float, count: int) -> ShellModel:
    if request.mesh[1] > 4:
        raise UsageError(f"mesh {request.mesh_text}: the second number is of a wedge of 10 degrees, at most 4")
    grid = grid_over(request, spaced_lines(0.0, math.pi / 2 - HOLE, count), spaced_lines(0.0, WEDGE, request.mesh[1]))
    laminate = Laminate.single(Ply.isotropic(young, NU, h))
    edges = ("clamped", "free", "symmetric", "symmetric")
    return loaded_shell(on_grid(request, sphere(RADIUS), grid, laminate, edges), request)


SCENES: tuple[Scene, ...] = (HalfSpheres(),)
