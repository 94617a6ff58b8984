"""A rubber roller whose bore is held, pressed on a rigid plane: its wall is two thirds of the middle radius thick.

Outer radius 35, bore 17.5, width 28 mm, nu = 0.475, 380 N: the roller of a public thread (felupe#870), which expects a
contact 30 mm wide under 0.62 MPa. Its modulus, 0.275 MPa, cannot give that. Ten times as much is used here; Hertz's
line contact is then 26 mm wide under 0.66 MPa. Hertz's body is a linear half space. This wall is only 17.5 mm thick,
and rubber stiffens in compression: the contact is 22 mm wide under 0.83 MPa at 380 N, at a travel of 2.568 mm. With a
linear law, which softens, it is 28 mm under 0.59 MPa at the same force.

The force of three surfaces is within 1.1 % of the solid's up to a travel of 3 mm, that of five within 0.1 %. The model
is a slice in plane strain, as wide as its elements are long; in wider elements the compressed part has modes that
alternate between the sides of the slice.
"""

import math

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.grid import graded_lines
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting, UsageError
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.contact.extent import half_extent
from studies.scenes.data import Row, references
from studies.scenes.element import discretise, grid_over, of_wall, spaced_lines
from studies.scenes.statics import loaded_shell

OUTER, BORE, WIDTH, SLICE, E, NU = 35.0, 17.5, 28.0, 0.5, 2.75, 0.475  # mm, mm, mm, mm, MPa
AWAY = np.array([1.0, 0.0, 0.0])
PATCH = 0.6  # rad: half of the lines lie up to here
TRAVELS = Setting.positive(
    "delta_mm", (1.0, 2.0, 2.568, 3.0), "travel of the plane from first touch", 6.0, kind="floats"
)
SOLID = {1.0: (94.84, 0.3524), 2.0: (258.97, 0.6434), 3.0: (485.02, 0.9899)}  # mm: N, MPa
OF_SOLID = "plane solid of 9-node quadrilaterals with the same law, 64x8"


def _references() -> tuple[Reference, ...]:
    rows: list[Row] = [
        ({"delta_mm": delta, "E_MPa": E, "nu": NU, "law": "neo-hooke"}, {"force_N": force, "pressure_MPa": pressure})
        for delta, (force, pressure) in SOLID.items()
    ]
    return references("computed", OF_SOLID, 3e-3, rows)


def hertz(force: float, young: float, nu: float) -> tuple[float, float]:
    """Width [mm] and largest pressure [MPa] of a solid cylinder of this radius on a plane under a force [N].

    b^2 = 4 F R/(pi w E*), p = 2 F/(pi b w), E* = E/(1 - nu^2). Source: Johnson, Contact Mechanics (1985), 4.2(c).
    """
    half = math.sqrt(4 * force * OUTER * (1 - nu**2) / (math.pi * WIDTH * young))
    return 2 * half, 2 * force / (math.pi * half * WIDTH)


def contact_width(y: np.ndarray, active: np.ndarray, pressure: np.ndarray) -> float:
    """Of both halves [mm], of what nodes (n,) from the middle outwards are; the rim is taken within an element."""
    half = ((-1, np.abs(y)), (1, active), (1, pressure))
    return 2 * half_extent(*(np.append(side * x[:0:-1], x) for side, x in half))


class Roller(Declared):
    """a1 along the axis, a2 from the middle of the contact over half of the roller."""

    name = "roller"
    title = "Rubber roller with a held bore on a rigid plane"
    default_mesh = (1, 64)
    settings = (
        TRAVELS,
        Setting.positive("E_MPa", E, "Young's modulus"),
        Setting("nu", NU, "Poisson's ratio", low=0.0, high=0.499),
        EPSILON,
        *of_wall("5", "neo-hooke"),
        SOLVER,
    )
    references = _references()
    quantities = {
        "force_N": "of the whole width; friction quantities, with mu, are those of the solved half of the slice",
        "width_mm": "of the contact",
        "pressure_MPa": "in the middle of the contact",
        "width_over_hertz": "of Hertz's contact under the same force",
        "pressure_over_hertz": "of Hertz's largest one under the same force",
    }

    def build(self, request: Request) -> SceneModel:
        """All four sides are symmetric, and the whole inner face is held."""
        n = request.mesh[1]
        if n % 2:
            raise UsageError(f"mesh {request.mesh_text}: the second number must be even, half of it in the patch")
        around = graded_lines([0.0, PATCH, np.pi], [n // 2, n // 2])
        grid = grid_over(request, spaced_lines(0, SLICE, request.mesh[0]), around)
        supports = Supports.of_edges(grid, *["symmetric"] * 4).hold(np.arange(grid.n_nodes), (0, 1, 2), ("inner",))
        young, nu = request.number("E_MPa"), request.number("nu")
        wall = Laminate.single(Ply.isotropic(young, nu, OUTER - BORE))
        half = discretise(request, cylinder((OUTER + BORE) / 2), grid, wall, *supports.masks)
        shell = loaded_shell(half, request)

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            line = np.flatnonzero(touch.at[:, 0] == 0.0)
            force = 2 * WIDTH / SLICE * float(touch.force.sum())
            y, active = touch.candidates.positions(touch.u)[line, 1], touch.active[line]
            width, pressure = contact_width(y, active, touch.pressure[line]), float(touch.pressure[line[0]])
            by_hertz = hertz(force, young, nu) if force > 0 else (math.inf, math.inf)
            ratios = {"width_over_hertz": width / by_hertz[0], "pressure_over_hertz": pressure / by_hertz[1]}
            return {"force_N": force, "width_mm": width, "pressure_MPa": pressure, **ratios}

        return ContactModel(
            shell,
            grid.on_line(1, np.pi),
            request.numbers("delta_mm"),
            lambda delta: RigidPlane(AWAY, OUTER - delta),
            measured,
            key="delta_mm",
            body_at=lambda delta: shell,
        )


SCENES = (Roller(),)
