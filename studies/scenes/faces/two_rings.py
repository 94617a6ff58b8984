"""Two rings pressed on each other: between equal ones the line of contact is straight, as on a rigid plate.

The model is a quarter of each ring in an infinite column of two alternating kinds, whose middle planes approach by 2
delta. Equal rings are mirror images: each is the elastica of :mod:`studies.scenes.contact.ring` between plates. Meshes
need not match: the second ring has a separate number of elements.
"""

import numpy as np

from studies.ask.scene import CONTACT, EPSILON, SOLVER, Declared, Ladder, Request, SceneModel, Setting, Sheet
from studies.scenes.contact import ring
from studies.scenes.contact.base import ON_RIM, RIM_LINES
from studies.scenes.element import ELEMENT
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import PAIRED, FacesModel, Facing, Meeting, of_second, uncut
from studies.scenes.statics import loaded_shell

BY_SYMMETRY = "inextensible elastica, elliptic integrals, by symmetry"
FACING = np.diag([-1.0, 1.0, -1.0])  # half a turn about the second axis
OTHER_THICKNESS = Setting("other_h_mm", ring.THIN, "thickness of the second ring", low=1e-6, high=20)


class TwoRings(Declared):
    """a1 along the axis, a2 from the line of contact over a quarter of each ring; forces are over E I of the first."""

    name = "two-rings"
    title = "Two rings pressed on each other"
    default_mesh = (1, 64)
    settings = (ring.TRAVELS, ring.THICKNESS, OTHER_THICKNESS, *PAIRED, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = ring.elastica(BY_SYMMETRY, 3e-4, ring.READ, other_h_mm=ring.THIN)
    quantities = {
        "P_R2_over_EI": "force between the rings times R^2/(E I)",
        "P_H2_over_EI": "that force times the square of the distance of the middle planes, over E I",
        "flat_half_length": "centre of the nodal contact forces from the middle of the contact, over R",
    }
    ladders = (
        Ladder(
            CONTACT,
            ("2x16", "4x32", "8x64"),
            ("P_H2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x8",),
        ),
    )
    sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """All four sides of both rings are symmetric."""
        request = uncut(request)
        thick = [request.number("h_mm"), request.number("other_h_mm")]
        counts = request.mesh[1], of_second(request.mesh[1], request)
        parts = [
            ring.part_around(request, h, ring.lines_around(request, count))
            for h, count in zip(thick, counts, strict=True)
        ]
        first, second = (loaded_shell(part, request) for part in parts)

        def bodies(delta: float) -> Bodies:
            apart = 2 * ring.RADIUS + sum(thick) / 2 - 2 * delta
            return Bodies((Placed(first), Placed(second, FACING, np.array([apart, 0.0, ring.WIDTH]))))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            return ring.flattened(delta, thick[0], meeting.force, meeting.position[:, 1])

        sides = [(Side(k, 1), ring.may_touch(part.grid)) for k, part in enumerate(parts)]
        return FacesModel.of(request, bodies, [Facing.between(request, *sides)], measured)


SCENES = (TwoRings(),)
