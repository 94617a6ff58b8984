"""Clamped cylindrical panel of angle plies pressed on a plane, on quadrilaterals that need not follow its generators.

The panel is small enough for meshes of any kind beside those on lines of curvature, which have the same limit: one
number tests anisotropy, curvature, moved nodes and contact together. The plies alternate in sign without any symmetry,
so stretching bends and twists the wall, and no part of the panel mirrors another.
"""

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.scene import EPSILON, SOLVER, Request, SceneModel, Setting, Sheet
from studies.scenes.benchmarks.quads import OnQuads
from studies.scenes.contact.base import OUTER, ContactModel, Touch
from studies.scenes.element import ON_QUADS, discretise, even_grid
from studies.scenes.statics import loaded_shell

RADIUS, HALF_LENGTH, HALF_ANGLE = 100.0, 50.0, 0.5  # mm, mm, rad
E_L, E_T, G, NU, PLY = 40e3, 8e3, 4e3, 0.25, 0.5  # MPa, MPa, MPa, -, mm
TOWARDS = np.array([1.0, 0.0, 0.0])  # outer normal in the middle of the panel


class PressedPanel(OnQuads):
    """a1 along the generators, a2 around; the plane moves along -x."""

    name = "pressed-panel"
    title = "Clamped angle-ply panel of quadrilaterals pressed on a plane"
    default_mesh = (24, 24)
    settings = (
        Setting("gamma_deg", 45.0, "angle of the fibres from the generators, in turn to either side", low=-90, high=90),
        Setting("plies", 4, "number of plies of 0.5 mm", "int", 1, 20),
        Setting("delta_mm", (1.0, 2.0), "travel of the plane from first touch", "floats", 0, 10),
        EPSILON,
        *ON_QUADS,
        SOLVER,
    )
    quantities = {"force_N": "of the panel on the plane"}
    lines_of_curvature: bool = True
    sheet = Sheet("x", 40.0, 28.0, listed=False)

    def build(self, request: Request) -> SceneModel:
        """The straight edges are clamped, the curved ones free; the path leads from rest to the last travel."""
        gamma, plies = np.deg2rad(request.number("gamma_deg")), int(request.number("plies"))
        wall = Laminate(
            tuple(Ply(E_L, E_T, G, G, NU, NU, (-1) ** k * gamma, PLY) for k in range(plies)), -0.5 * plies * PLY
        )
        grid = even_grid(request, (-HALF_LENGTH, HALF_LENGTH), (-HALF_ANGLE, HALF_ANGLE))
        supports = Supports.of_edges(grid, "free", "free", "clamped", "clamped")
        body = discretise(request, cylinder(RADIUS), grid, wall, *supports.masks)
        shell, edge = loaded_shell(body, request), np.flatnonzero(supports.held.any(axis=1))
        front = float(np.max(body.positions()[OUTER] @ TOWARDS))

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            return {"force_N": float(touch.force.sum())}

        travel = request.numbers("delta_mm")
        return ContactModel(
            shell, edge, travel, lambda delta: RigidPlane(TOWARDS, front - delta), measured, key="delta_mm"
        )


SCENES = (PressedPanel(),)
