"""Ring between two rigid plates: the elastica that flattens, and whose flat part carries no pressure at all.

A quarter, its plate moving inwards; the middle lines of both contacts are 2 (R - delta) apart. Over the flat part
bending alone keeps the ring straight, so it touches without pressure and strict complementarity fails there; all load
stands on the ends of the flat part. The elastica neither stretches nor shears: P of this wall is lower by 2.4 (h/R)^2
of it at delta = R/2, which is 2.4e-4 with the thickness h = R/100 (measured).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import CONTACT, CRUSHED, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Reference, Scene, SceneModel, Setting
from studies.scenes.closed_forms.contact import flattened_ring
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, grid_over, on_grid, spaced_lines
from studies.scenes.statics import loaded_shell

E, RADIUS, THIN, WIDTH = 1.2e6, 100.0, 1.0, 10.0  # MPa, mm; nu = 0
AWAY = np.array([1.0, 0.0, 0.0])

DELTAS = (35.0, 40.0, 50.0)
TRAVELS = Setting.positive("delta_mm", DELTAS, "travel of each plate from first touch", 80.0, kind="floats")
THICKNESS = Setting("h_mm", THIN, "thickness; the elastica holds for h/R to zero", low=1e-6, high=20)


def _references() -> tuple[Reference, ...]:
    found: list[Row] = []
    for delta in DELTAS:
        load, flat = flattened_ring(1 - delta / RADIUS)
        values = {"P_R2_over_EI": load, "P_H2_over_EI": 4 * load * (1 - delta / RADIUS) ** 2, "flat_half_length": flat}
        found.append(({"delta_mm": delta, "h_mm": THIN, "measure": "exact"}, values))
    return references("exact", "inextensible elastica, elliptic integrals", 3e-4, found)


class Ring:
    """a1 along the axis, a2 from the plate over a quarter of the ring."""

    name: str = "ring"
    title: str = "Ring flattened between rigid plates"
    default_mesh: tuple[int, int] = (1, 64)
    settings: tuple[Setting, ...] = (TRAVELS, THICKNESS, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()
    quantities: Mapping[str, str] = {
        "P_R2_over_EI": "force of a plate times R^2/(E I)",
        "P_H2_over_EI": "force of a plate times the square of the distance of the middle lines of contact, over E I",
        "flat_half_length": "centre of the nodal contact forces from the middle of the flat part, over R",
    }
    ladders: tuple[Ladder, ...] = (
        Ladder(
            CONTACT,
            meshes(2, 20, 3),
            ("P_H2_over_EI", "flat_half_length"),
            settings={"delta_mm": "50", **ON_RIM},
            coarser=("1x10",),
        ),
    )
    sheet: Sheet = Sheet("-x", -62.0, 14.0)
    shell_limit: ShellLimit = ShellLimit(CRUSHED, thickness_over(RADIUS, "h_mm"))

    def build(self, request: Request) -> SceneModel:
        """Symmetry on all four sides; P is the whole force of a plate."""
        h, right = request.number("h_mm"), np.pi / 2
        laminate, EI = Laminate.single(Ply.isotropic(E, 0.0, h)), E * h**3 / 12 * WIDTH
        deltas = request.numbers("delta_mm")
        around = contact_lines(request, 1, (0, right), lambda: flattened_ring(1 - deltas[-1] / RADIUS)[1])
        grid = grid_over(request, spaced_lines(0, WIDTH, request.mesh[0]), around)
        quarter = on_grid(request, cylinder(RADIUS), grid, laminate, ("symmetric",) * 4)
        shell, side = loaded_shell(quarter, request), quarter.grid.on_line(1, right)

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            total = float(touch.force.sum())
            load = 2 * total * RADIUS**2 / EI
            x = np.abs(touch.candidates.positions(touch.u)[:, 1])
            centre = float(touch.force @ x) / total / RADIUS if total > 0 else 0.0
            height = 2 * (1 - delta / RADIUS)
            return {"P_R2_over_EI": load, "P_H2_over_EI": load * height**2, "flat_half_length": centre}

        def plate(delta: float) -> RigidPlane:
            return RigidPlane(AWAY, RADIUS + h / 2 - delta)

        return ContactModel(shell, side, deltas, plate, measured, key="delta_mm", body_at=lambda delta: shell)


SCENES: tuple[Scene, ...] = (Ring(),)
