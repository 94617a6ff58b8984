"""A patch test of contact: a uniform pressure through two faces whose meshes do not match.

Flat: two plates on each other, the lower one on a rigid ground; nothing moves sideways. Both meshes represent a uniform
stress exactly, and the pressure between them is that on top. Gaps averaged over the intersections of the two meshes
pass it to the last digit; nodes against patches do not.
Curved: a tube in another one, an eighth of the circumference, pressed outwards from inside. The exact pressure between
them is uniform. The chords of two polygons are not at a uniform distance; the deviation is of the order of the square
of the element size.
With friction the upper plate is dragged along the lower, longer one. Once all of it slips, the drag force is mu times
the normal force.
"""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import Plate, cylinder
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, Ladder, Sheet
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.element import ELEMENT, discretise, grid_over, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import DRAG, PAIRED, SLAVES, FacesModel, Facing, Meeting, of_second, uncut
from studies.scenes.statics import loaded_shell

E, NU, H, SIDE = 1000.0, 0.3, 2.0, 40.0  # MPa, -, mm, mm
RADIUS = 50.0  # of the face between the tubes
TURN = np.pi / 4
LIFTED = np.diag([1.0, -1.0, -1.0])  # half a turn about the first axis
SHAPE = Setting.one_of("shape", ("flat", "curved"), "flat", "plates on each other, or a tube in another one")
PRESSURE = Setting.positive("pressure_MPa", (1.0,), "pressure on the first body", 10.0, kind="floats")


def lame_between(inner: float, outer: float) -> float:
    """Pressure between two thin tubes of one material over that inside: Lame's -S_rr(R) of one wall.

    (a/R)^2 (c^2 - R^2)/(c^2 - a^2) with the radii a inside, R between, c outside.
    """
    return (inner / RADIUS) ** 2 * (outer**2 - RADIUS**2) / (outer**2 - inner**2)


class FacePatch(Declared):
    """a1 and a2 along both sides of a plate; for tubes along the axis and around."""

    name = "face-patch"
    title = "Uniform pressure through two faces whose meshes do not match"
    default_mesh = (8, 8)
    settings = (PRESSURE, SHAPE, DRAG, *PAIRED, EPSILON, *ELEMENT, SOLVER)
    references = (
        Reference("pressure_ratio", 1.0, {"shape": "flat", "pairing": "mortar"}, "exact", "equilibrium", 1e-12),
        Reference(
            "pressure_ratio",
            lame_between(RADIUS - H, RADIUS + H),
            {"shape": "curved", "measure": "linear"},
            "exact",
            "Lame, one wall of both tubes",
            2e-3,
        ),
    )
    quantities = {
        "pressure_ratio": "force between the faces over their reference area, over the pressure on the first body",
        "pressure_error": "root of the mean square of p less its mean, over the mean",
    }
    ladders = (
        Ladder(
            CONTACT,
            ("4x4", "8x8", "16x16"),
            ("pressure_ratio",),
            "linear",
            settings={"shape": "curved"},
            coarser=("2x2",),
        ),
    )
    sheet = Sheet("z", -55.0, 26.0, settings={"pairing": "mortar"})

    def build(self, request: Request) -> SceneModel:
        """The first body carries the pressure."""
        request = uncut(request)
        flat = request.choice("shape") == "flat"
        drags = request.numbers(DRAG.key) if DRAG.key in request.settings else ()
        if drags and not flat:
            raise UsageError("drag_mm needs shape=flat: tubes in each other cannot be dragged")
        if drags and request.choice("slave") != SLAVES[0]:
            raise UsageError("drag_mm needs slave=first: nodes of the longer plate would pass the rim of the other")
        far = max(map(abs, drags), default=0.0)
        meshes = request.mesh, tuple(of_second(n, request) for n in request.mesh)
        first, second = (_body(request, (n1, n2), k, far * k, flat=flat) for k, (n1, n2) in enumerate(meshes))
        slave_index = SLAVES.index(request.choice("slave"))
        faces = (1, 1 if flat else 0)
        lifted = Placed(first, LIFTED, np.array([0.0, SIDE, 1.5 * H])) if flat else Placed(first)
        area = (first, second)[slave_index].discretisation.nodal_areas(("inner", "outer")[faces[slave_index]]).sum()

        def bodies(pressure: float, drag: float = 0.0) -> Bodies:
            shift = lifted.shift + np.array([drag, 0.0, 0.0])
            on_top = replace(lifted, shell=first.scaled(pressure), shift=shift)
            return Bodies((on_top, Placed(second, shift=np.array([0.0, 0.0, 0.5 * H * flat]))))

        def measured(pressure: float, meeting: Meeting) -> dict[str, float]:
            mean = float(meeting.force.sum() / area)
            error = math.sqrt(meeting.area @ (meeting.pressure - mean) ** 2 / area) / mean if mean > 0 else 0.0
            return {"pressure_ratio": mean / pressure, "pressure_error": error}

        sides = [
            (Side(k, face), np.arange(body.discretisation.grid.n_nodes))
            for k, (face, body) in enumerate(zip(faces, (first, second), strict=True))
        ]
        pair, last = Facing.between(request, *sides), request.numbers("pressure_MPa")[-1]
        model = FacesModel.of(request, bodies, [pair], measured, "pressure_MPa", lying=True)
        return replace(model, dragged_at=partial(bodies, last), drags=drags)


def _body(request: Request, mesh: tuple[int, int], number: int, beyond: float, *, flat: bool) -> ShellModel:
    """A body; beyond [mm]: what it is longer by along a1 at either end, at least, in elements of the same length."""
    laminate = Laminate.single(Ply.isotropic(E, NU, H))
    surface = Plate() if flat else cylinder(RADIUS + (number - 0.5) * H)
    more = math.ceil(beyond * mesh[0] / SIDE)
    along = np.arange(-more, mesh[0] + more + 1) * (SIDE / mesh[0]) if more else spaced_lines(0.0, SIDE, mesh[0])
    grid = grid_over(request, along, spaced_lines(0.0, SIDE if flat else TURN, mesh[1]))
    gripped = DRAG.key in request.settings and not number
    supports = Supports.of_edges(grid, *("free" if gripped else "symmetric",) * 2, *("symmetric",) * 2)
    if gripped:
        supports = supports.hold(np.arange(grid.n_nodes), [0], ["inner"])
    if flat and number:
        supports = supports.hold(np.arange(grid.n_nodes), [2], ["inner"])
    body = discretise(request, surface, grid, laminate, *supports.masks)
    return loaded_shell(body, request) if number else loaded_shell(body, request, pressure=Pressure(1.0, area="face"))


SCENES = (FacePatch(),)
