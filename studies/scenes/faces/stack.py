"""Three rings in a row, pressed between the middle planes of the first and the last: two pairs in one problem.

A quarter of the first and the last and a half of the middle one, whose outer face is the master of one pair and the
slave of the other. The middle planes come nearer by 4 delta. Equal rings share that: each line of contact is straight,
and each ring is the elastica of :mod:`studies.scenes.contact.ring` between plates that travel by delta. By symmetry
nothing pushes the middle ring along the row; it is held there at two points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from formulations.conditions.boundary import Supports
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
from studies.scenes.element import ELEMENT, discretise, grid_over, spaced_lines
from studies.scenes.faces.bodies import Bodies, Placed, Side
from studies.scenes.faces.model import (
    OTHER,
    PAIRING,
    SHAPE_OF_FACES,
    FacesModel,
    Facing,
    Meeting,
    of_second,
    pairing_of,
)
from studies.scenes.faces.two_rings import FACING
from studies.scenes.statics import loaded_shell

MIDDLE = Setting("other_h_mm", THIN, "thickness of the middle ring", low=1e-6, high=20)


def _references() -> tuple[Reference, ...]:
    found: list[Row] = []
    for delta in DELTAS:
        load, flat = flattened_ring(1 - delta / RADIUS)
        values = {"P_R2_over_EI": load, "second_over_first": 1.0, "flat_half_length": flat}
        found.append(({"delta_mm": delta, "h_mm": THIN, "other_h_mm": THIN, "measure": "exact"}, values))
    return references("exact", "inextensible elastica, elliptic integrals, by symmetry", 3e-4, found)


class Stack:
    """a1 along the axis, a2 from a line of contact around each ring; the mesh is that of a quarter."""

    name: str = "stack"
    title: str = "Three rings in a row, pressed together"
    default_mesh: tuple[int, int] = (1, 40)
    settings: tuple[Setting, ...] = (
        TRAVELS,
        THICKNESS,
        MIDDLE,
        OTHER,
        PAIRING,
        SHAPE_OF_FACES,
        RIM_LINES,
        EPSILON,
        *ELEMENT,
        SOLVER,
    )
    references: tuple[Reference, ...] = _references()
    quantities: Mapping[str, str] = {
        "P_R2_over_EI": "force between the first two rings times R^2/(E I) of the first",
        "second_over_first": "force between the last two rings over that between the first two",
        "flat_half_length": "centre of the nodal forces of the first pair from the middle of the contact, over R",
    }
    ladders: tuple[Ladder, ...] = (
        Ladder(
            CONTACT,
            ("2x16", "4x32", "8x64"),
            ("P_R2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x8",),
        ),
    )
    sheet: Sheet = Sheet("x", -62.0, 14.0)

    def build(self, request: Request) -> SceneModel:
        """Symmetry on all sides."""
        request = replace(request, leaves=())  # cuts of one body are none of the other's: all follow the mesh
        deltas, h, middle = request.numbers("delta_mm"), request.number("h_mm"), request.number("other_h_mm")
        quarter = _lines(request, request.mesh[1])
        half = _lines(request, of_second(request.mesh[1], request))
        outer = _ring(request, h, quarter)
        inner = _ring(request, middle, np.append(half, np.pi - half[-2::-1]))
        EI = E * h**3 / 12 * WIDTH
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
            apart = np.array([2 * RADIUS + (h + middle) / 2 - 2 * delta, 0.0, 0.0])
            last = Placed(outer, FACING, 2 * apart + np.array([0.0, 0.0, WIDTH]))
            return Bodies((Placed(outer), Placed(inner, shift=apart), last))

        def measured(delta: float, meeting: Meeting) -> dict[str, float]:
            first = meeting.pair == 0
            forces = [float(meeting.force[own].sum()) for own in (first, ~first)]
            y = np.abs(meeting.position[first, 1])
            centre, ratio = 0.0, 1.0
            if forces[0] > 0:
                centre, ratio = float(meeting.force[first] @ y) / forces[0] / RADIUS, forces[1] / forces[0]
            return {
                "P_R2_over_EI": 2 * forces[0] * RADIUS**2 / EI,
                "second_over_first": ratio,
                "flat_half_length": centre,
            }

        return FacesModel(bodies, pairs, pairing_of(request), deltas, measured, "delta_mm")


def _lines(request: Request, count: int) -> np.ndarray:
    """Of a quarter."""
    asked = replace(request, mesh=(request.mesh[0], count))
    delta = request.numbers("delta_mm")[-1]
    return contact_lines(asked, 1, (0, np.pi / 2), lambda: flattened_ring(1 - delta / RADIUS)[1])


def _ring(request: Request, h: float, around: np.ndarray) -> ShellModel:
    grid = grid_over(request, spaced_lines(0, WIDTH, request.mesh[0]), around)
    supports = Supports.of_edges(grid, *("symmetric",) * 4)
    if around[-1] > np.pi / 2:  # a half: nothing else keeps it where it is along the row, and nothing pushes there
        supports = supports.hold(grid.on_line(1, np.pi / 2), [1], ["inner"])
    laminate = Laminate.single(Ply.isotropic(E, 0.0, h))
    return loaded_shell(discretise(request, cylinder(RADIUS), grid, laminate, *supports.masks), request)


SCENES: tuple[Scene, ...] = (Stack(),)
