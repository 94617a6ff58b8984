"""Two rings pressed on each other: between equal ones the line of contact is straight, as on a rigid plate.

A quarter of each, of an infinite column of rings of two kinds in turn, whose middle planes approach by 2 delta. Equal
rings are mirror images: each is the elastica of :mod:`studies.scenes.contact.ring` between plates. Meshes need not
match: the second ring has its own number of elements.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, Ladder, Sheet
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Reference, Scene, SceneModel, Setting
from studies.scenes.closed_forms.contact import flattened_ring
from studies.scenes.contact.base import ON_RIM, RIM_LINES, contact_lines
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
from studies.scenes.statics import loaded_shell

FACING = np.diag([-1.0, 1.0, -1.0])  # half a turn about the second axis
OTHER_THICKNESS = Setting("other_h_mm", THIN, "thickness of the second ring", low=1e-6, high=20)


def _references() -> tuple[Reference, ...]:
    found: list[Row] = []
    for delta in DELTAS:
        load, flat = flattened_ring(1 - delta / RADIUS)
        values = {"P_R2_over_EI": load, "P_H2_over_EI": 4 * load * (1 - delta / RADIUS) ** 2, "flat_half_length": flat}
        found.append(({"delta_mm": delta, "h_mm": THIN, "other_h_mm": THIN, "measure": "exact"}, values))
    return references("exact", "inextensible elastica, elliptic integrals, by symmetry", 3e-4, found)


class TwoRings:
    """a1 along the axis, a2 from the line of contact over a quarter of each ring; its force, over E I of the first."""

    name: str = "two-rings"
    title: str = "Two rings pressed on each other"
    default_mesh: tuple[int, int] = (1, 64)
    settings: tuple[Setting, ...] = (
        TRAVELS,
        THICKNESS,
        OTHER_THICKNESS,
        OTHER,
        PAIRING,
        SHAPE_OF_FACES,
        SLAVE,
        RIM_LINES,
        EPSILON,
        *ELEMENT,
        SOLVER,
    )
    references: tuple[Reference, ...] = _references()
    quantities: Mapping[str, str] = {
        "P_R2_over_EI": "force between the rings times R^2/(E I)",
        "P_H2_over_EI": "that force times the square of the distance of the middle planes, over E I",
        "flat_half_length": "centre of the nodal contact forces from the middle of the contact, over R",
    }
    ladders: tuple[Ladder, ...] = (
        Ladder(
            CONTACT,
            ("2x16", "4x32", "8x64"),
            ("P_H2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x8",),
        ),
    )
    sheet: Sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """Symmetry on all four sides of both."""
        request = replace(request, leaves=())  # cuts of one body are none of the other's: both follow the mesh
        deltas, thick = request.numbers("delta_mm"), [request.number("h_mm"), request.number("other_h_mm")]
        counts = request.mesh[1], of_second(request.mesh[1], request)
        rings = [_ring(request, h, count) for h, count in zip(thick, counts, strict=True)]
        own = SLAVES.index(request.choice("slave"))
        right = rings[own].discretisation.grid.on_line(1, np.pi / 2)
        nodes = np.setdiff1d(rings[own].discretisation.grid.free_nodes, right)
        EI = E * thick[0] ** 3 / 12 * WIDTH

        def bodies(delta: float) -> Bodies:
            apart = 2 * RADIUS + sum(thick) / 2 - 2 * delta
            return Bodies((Placed(rings[0]), Placed(rings[1], FACING, np.array([apart, 0.0, WIDTH]))))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            total = float(meeting.force.sum())
            load = 2 * total * RADIUS**2 / EI
            centre = float(meeting.force @ np.abs(meeting.position[:, 1])) / total / RADIUS if total > 0 else 0.0
            height = 2 * (1 - delta / RADIUS)
            return {"P_R2_over_EI": load, "P_H2_over_EI": load * height**2, "flat_half_length": centre}

        pairing = pairing_of(request)
        pair = Facing(Side(own, 1), Side(1 - own, 1), nodes)
        return FacesModel(bodies, (pair,), pairing, deltas, measured, "delta_mm")


def _ring(request: Request, h: float, count: int) -> ShellModel:
    laminate, right = Laminate.single(Ply.isotropic(E, 0.0, h)), np.pi / 2
    asked = replace(request, mesh=(request.mesh[0], count))
    around = contact_lines(
        asked, 1, (0, right), lambda: flattened_ring(1 - request.numbers("delta_mm")[-1] / RADIUS)[1]
    )
    grid = grid_over(request, spaced_lines(0, WIDTH, request.mesh[0]), around)
    return loaded_shell(on_grid(request, cylinder(RADIUS), grid, laminate, ("symmetric",) * 4), request)


SCENES: tuple[Scene, ...] = (TwoRings(),)
