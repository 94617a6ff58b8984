"""A ring pinched by two opposite forces until it touches itself inside: a shell in contact with itself.

The model is half of the ring, on one side of the plane of symmetry through both forces. The part around a2 = 0 is the
slave, that around a2 = pi the master, and their meshes need not match. By symmetry each meets a rigid plane in the
middle: `against=plane` solves a quarter of the ring. Once the loaded points meet, the contact carries any additional
force.
"""

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.geometry.grid import Grid
from studies.ask.scene import CONTACT, EPSILON, SOLVER, Declared, Ladder, Request, SceneModel, Setting, Sheet
from studies.scenes.contact.base import ContactModel
from studies.scenes.contact.ring import RADIUS, WIDTH, E, part_on
from studies.scenes.element import ELEMENT, moved_nodes, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import PAIRED, FacesModel, Facing, of_second, uncut
from studies.scenes.statics import edge_forces, loaded_shell

SIDE = np.pi / 2
TOUCHING = 0.75  # of a quarter from the force: neighbours at its other end would meet
LOADS = Setting.positive("F_R2_over_EI", (4.0, 6.0, 8.0), "force times R^2/(E I)", 100, kind="floats")
THICKNESS = Setting("h_mm", 5.0, "thickness", low=1e-2, high=20)
AGAINST = Setting.one_of("against", ("itself", "plane"), "itself", "half of the ring, or a quarter on a rigid plane")


class PinchedRing(Declared):
    """a1 along the axis, a2 from one force towards the other; the mesh is that of a quarter."""

    name = "pinched-ring"
    title = "Ring pinched by two forces until it touches itself"
    default_mesh = (1, 48)
    settings = (LOADS, THICKNESS, AGAINST, *PAIRED[:-1], EPSILON, *ELEMENT, SOLVER)
    quantities = {
        "contact_R2_over_EI": "force of the whole ring on itself times R^2/(E I)",
        "spread_over_R": "outward displacement half-way between the forces over R",
    }
    ladders = (
        Ladder(
            CONTACT,
            ("2x24", "4x48", "8x96"),
            ("spread_over_R", "contact_R2_over_EI"),
            settings={"F_R2_over_EI": "8"},
            coarser=("1x12",),
        ),
    )
    sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """The ends of the part and both sides are symmetric; half of each force acts on this half."""
        request = uncut(request)
        half = request.choice("against") == "itself"
        strand = spaced_lines(0, SIDE, request.mesh[1])
        other = spaced_lines(SIDE, 2 * SIDE, of_second(request.mesh[1], request))
        lines = np.append(strand, other[1:]) if half else strand
        even = Grid.tensor(spaced_lines(0, WIDTH, request.mesh[0]), lines)
        grid = moved_nodes(request, even, even.on_line(1, SIDE))
        h = request.number("h_mm")
        body, tip, EI = part_on(request, h, grid), grid.on_line(1, SIDE), E * h**3 / 12 * WIDTH
        unit = EI / RADIUS**2
        forces = edge_forces(body, 1, 0.0, -unit / 2)
        if half:
            forces += edge_forces(body, 1, 2 * SIDE, -unit / 2)
        shell, loads = loaded_shell(body, request, forces=forces), request.numbers("F_R2_over_EI")
        nodes = np.flatnonzero(grid.nodes[:, 1] <= TOUCHING * SIDE + 1e-9)

        def read(force: np.ndarray, u: np.ndarray) -> dict[str, float]:
            spread = float(body.expand(u)[tip, 4:].mean()) / RADIUS
            return {"contact_R2_over_EI": 2 * float(force.sum()) / unit, "spread_over_R": spread}

        if not half:
            plane, free = RigidPlane(np.array([-1.0, 0.0, 0.0]), 0.0), np.setdiff1d(np.arange(grid.n_nodes), nodes)
            return ContactModel(
                shell,
                free,
                loads,
                lambda t: plane,
                lambda t, touch: read(touch.force, touch.u),
                key="F_R2_over_EI",
                face=0,
            )
        first = np.flatnonzero(grid.centre[:, 1] + grid.half[:, 1] <= TOUCHING * SIDE + 1e-9)
        second = np.flatnonzero(grid.centre[:, 1] > SIDE)
        pair = Facing(Side(0, 0, first), Side(0, 0, second), np.unique(grid.elements[first]))
        return FacesModel.of(
            request,
            lambda t: Bodies((Placed(shell.scaled(t)),)),
            [pair],
            lambda t, meeting: read(meeting.force, meeting.u),
            "F_R2_over_EI",
        )


SCENES = (PinchedRing(),)
