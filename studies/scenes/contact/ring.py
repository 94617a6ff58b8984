"""Ring between two rigid plates: the elastica that flattens, and whose flat part carries no pressure at all.

A quarter, its plate moving inwards; the middle lines of both contacts are 2 (R - delta) apart. Over the flat part
bending alone keeps the ring straight, so it touches without pressure and strict complementarity fails there; all load
stands on the ends of the flat part. The elastica neither stretches nor shears: P of this wall is lower by 2.4 (h/R)^2
of it at delta = R/2, which is 2.4e-4 with the thickness h = R/100 (measured).
"""

from __future__ import annotations

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.request import Request
from studies.scene import EPSILON, SOLVER, Reference, SceneModel, Setting
from studies.scenes.closed_forms.beams_on_planes import flattened_ring
from studies.scenes.contact.base import ContactModel, Touch, outer_face
from studies.scenes.element import ELEMENT, discretise, even_grid
from studies.scenes.statics import loaded_shell

E, RADIUS, THIN, WIDTH = 1.2e6, 100.0, 1.0, 10.0  # MPa, mm; nu = 0
AWAY = np.array([1.0, 0.0, 0.0])

TRAVELS = Setting(
    "delta_mm", (35.0, 40.0, 50.0), "travel of each plate from first touch", "floats", 0.0, 80.0, open_low=True
)
THICKNESS = Setting("h_mm", THIN, "thickness; the elastica holds for h/R to zero", low=0.1, high=20)
SOURCE = "inextensible elastica, elliptic integrals"


def _references() -> tuple[Reference, ...]:
    found = []
    for delta in (35.0, 40.0, 50.0):
        at: dict[str, float | str] = {"delta_mm": delta, "h_mm": THIN, "measure": "exact"}
        load, flat = flattened_ring(1 - delta / RADIUS)
        found += [Reference("P_R2_over_EI", load, at, "exact", SOURCE, 3e-4)]
        found += [Reference("P_H2_over_EI", 4 * load * (1 - delta / RADIUS) ** 2, at, "exact", SOURCE, 3e-4)]
        found += [Reference("flat_half_length", flat, at, "exact", SOURCE, 3e-4)]
    return tuple(found)


class Ring:
    """a1 along the axis, a2 from the plate over a quarter of the ring."""

    name: str = "ring"
    title: str = "Ring flattened between rigid plates"
    default_mesh: tuple[int, int] = (1, 64)
    settings: tuple[Setting, ...] = (TRAVELS, THICKNESS, EPSILON, *ELEMENT, SOLVER)
    references: tuple[Reference, ...] = _references()

    def build(self, request: Request) -> SceneModel:
        """Symmetry on all four sides; P is the whole force of a plate."""
        right = np.pi / 2
        grid = even_grid(request, (0, WIDTH), (0, right))
        supports = Supports.none(grid)
        for plane in (0.0, WIDTH):
            supports = supports.symmetric(grid.on_line(0, plane), 0)
        for plane in (0.0, right):
            supports = supports.symmetric(grid.on_line(1, plane), 1)
        h = request.number("h_mm")
        laminate, EI = Laminate.single(Ply.isotropic(E, 0.0, h)), E * h**3 / 12 * WIDTH
        discretisation = discretise(request, cylinder(RADIUS), grid, laminate, *supports.masks)
        shell = loaded_shell(discretisation, request)
        nodes = np.setdiff1d(np.arange(grid.n_nodes), grid.on_line(1, right))
        candidates = outer_face(discretisation, nodes)
        deltas = request.numbers("delta_mm")

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            total = float(touch.force.sum())
            load = 2 * total * RADIUS**2 / EI
            x = np.abs(candidates.positions(touch.u)[:, 1])
            centre = float(touch.force @ x) / total / RADIUS if total > 0 else 0.0
            height = 2 * (1 - delta / RADIUS)
            return {"P_R2_over_EI": load, "P_H2_over_EI": load * height**2, "flat_half_length": centre}

        def plate(delta: float) -> RigidPlane:
            return RigidPlane(AWAY, RADIUS + h / 2 - delta)

        return ContactModel(shell, "delta_mm", deltas, lambda delta: shell, plate, nodes, candidates, measured)
