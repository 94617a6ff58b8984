"""Three rings in a row, pressed between the middle planes of the first and the last: two pairs in one problem.

The model is a quarter of the first and the last ring and half of the middle one, whose outer face is the master of one
pair and the slave of the other. The middle planes approach by 4 delta. Equal rings share that: each line of contact is
straight, and each ring is the elastica of :mod:`studies.scenes.contact.ring` between plates that travel by delta. By
symmetry nothing pushes the middle ring along the row; it is held there at two points.
"""

from collections.abc import Mapping

import numpy as np

from studies.ask.scene import CONTACT, EPSILON, SOLVER, Declared, Ladder, Request, SceneModel, Setting, Sheet
from studies.scenes.contact import ring
from studies.scenes.contact.base import ON_RIM, RIM_LINES
from studies.scenes.element import ELEMENT
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import PAIRED, FacesModel, Facing, Meeting, of_second, uncut
from studies.scenes.faces.two_rings import BY_SYMMETRY, FACING
from studies.scenes.statics import loaded_shell

MIDDLE = Setting("other_h_mm", ring.THIN, "thickness of the middle ring", low=1e-6, high=20)


QUANTITIES: Mapping[str, str] = {
    "P_R2_over_EI": "force between the first two rings times R^2/(E I) of the first",
    "second_over_first": "force between the last two rings over that between the first two",
    "flat_half_length": "centre of the nodal forces of the first pair from the middle of the contact, over R",
}


class Stack(Declared):
    """a1 along the axis, a2 from a line of contact around each ring; the mesh is that of a quarter."""

    name = "stack"
    title = "Three rings in a row, pressed together"
    default_mesh = (1, 40)
    settings = (ring.TRAVELS, ring.THICKNESS, MIDDLE, *PAIRED[:-1], RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = ring.elastica(BY_SYMMETRY, 3e-4, QUANTITIES, other_h_mm=ring.THIN)
    quantities = QUANTITIES
    ladders = (
        Ladder(
            CONTACT,
            ("2x16", "4x32", "8x64"),
            ("P_R2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x8",),
        ),
    )
    sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """All sides are symmetric."""
        request = uncut(request)
        h, middle = request.number("h_mm"), request.number("other_h_mm")
        half = ring.lines_around(request, of_second(request.mesh[1], request))
        lines = ring.lines_around(request, request.mesh[1]), np.append(half, np.pi - half[-2::-1])
        outer, inner = (
            loaded_shell(ring.part_around(request, thick, around), request)
            for thick, around in zip((h, middle), lines, strict=True)
        )
        grid, other = outer.discretisation.grid, inner.discretisation.grid
        nodes = np.flatnonzero(grid.nodes[:, 1] < np.pi / 2 - 1e-9)
        to_first = np.flatnonzero(other.centre[:, 1] > np.pi / 2)
        to_last = np.flatnonzero(other.centre[:, 1] < np.pi / 2)
        above = np.flatnonzero(other.nodes[:, 1] < np.pi / 2 - 1e-9)
        pairs = (
            Facing(Side(0, 1), Side(1, 1, to_first), nodes),
            Facing(Side(1, 1, to_last), Side(2, 1), above),
        )

        def bodies(delta: float) -> Bodies:
            apart = np.array([2 * ring.RADIUS + (h + middle) / 2 - 2 * delta, 0.0, 0.0])
            last = Placed(outer, FACING, 2 * apart + np.array([0.0, 0.0, ring.WIDTH]))
            return Bodies((Placed(outer), Placed(inner, shift=apart), last))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            first = meeting.pair == 0
            read = ring.flattened(delta, h, meeting.force[first], meeting.position[first, 1])
            forces = [float(meeting.force[of_pair].sum()) for of_pair in (first, ~first)]
            read["second_over_first"] = forces[1] / forces[0] if forces[0] > 0 else 1.0
            return {name: read[name] for name in QUANTITIES}

        return FacesModel.of(request, bodies, pairs, measured)


SCENES = (Stack(),)
