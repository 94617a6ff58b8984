"""Clamped circular plate pressed on a plane: the contact disc of a Kirchhoff plate, with a line force on its rim.

Polar coordinates are singular at the centre, so a small hole is left there. Its edge is held as by a rigid plug that
carries the pressure on the hole; the contact disc covers it. The tests measure the effect of the hole. The line force
squeezes the wall, which is 0.01 a thick, over about 0.6 h around the rim; this reduces the contact radius by up to
0.002 a (measured).
"""

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.geometry.surfaces import annulus
from formulations.loads import edge_force
from formulations.section.laminate import Ply
from studies.ask.declarations import CONTACT, PRESSED, Ladder, ShellLimit, thickness_over
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.contact import plate_contact
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.element import ELEMENT, ShearCorrected, grid_over, on_grid, spaced_lines
from studies.scenes.statics import area_load, loaded_shell

E, NU, A, H, GAP = 1200.0, 0.3, 100.0, 1.0, 1.0  # MPa, -, mm
D = E * H**3 / (12 * (1 - NU**2))  # N mm
TOUCHING = 64 * D * GAP / A**4  # MPa
KIRCHHOFF = 1000.0  # shear correction
DOWN = np.array([0.0, 0.0, -1.0])  # the outer normal of the annulus
FRACTIONS = (2.0, 5.0, 20.0)

HOLE = Setting("hole", 0.01, "radius of the hole at the centre over that of the plate", low=1e-3, high=0.2)
PRESSURES = Setting("load_fraction", FRACTIONS, "pressures to report, over 64 D g/a^4", "floats", 0.0, 100.0)
SQUEEZE = (
    "the rim carries a line force, which passes from one ring of nodes to the next as soon as the elements are as small"
    " as the strip of 0.6 thicknesses over which it squeezes the wall"
)
SOURCE = "Kirchhoff's plate, checked by axisymmetric elements"


REFERENCES = tuple(
    Reference(name, value, {"load_fraction": fraction, "measure": "linear"}, "exact", SOURCE, 1e-6)
    for fraction in FRACTIONS
    for name, value in zip(("contact_force", "contact_radius"), reversed(plate_contact(64 * fraction)), strict=True)
)


class PlateContact(Declared):
    """A quarter; a1 from the hole to the clamp. Nothing varies around the axis."""

    name = "plate-contact"
    title = "Clamped circular plate pressed on a plane"
    default_mesh = (64, 1)
    settings = (PRESSURES, HOLE, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = REFERENCES
    quantities = {
        "contact_force": "force on the plane over D g/a^2",
        "contact_radius": "radius of the disc of contact over that of the plate",
    }
    ladders = (
        Ladder(
            CONTACT,
            ("14x1", "28x1", "56x1", "112x1"),
            ("contact_force", "contact_radius"),
            "linear",
            {"load_fraction": "5", **ON_RIM},
            causes={"contact_radius": SQUEEZE},
        ),
    )
    shell_limit = ShellLimit(PRESSED, thickness_over(A, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """Half of the pressure acts on each face; results are over a and D g/a^2.

        The plane reacts with the pressure under the disc and a line force on its rim. The plate around depends only on
        the sums of f and of f r^2, so the radius is that of the same sums of the nodal forces in excess of the
        pressure.
        """
        rim = A * request.number("hole")
        laminate = ShearCorrected((Ply.isotropic(E, NU, H),), -H / 2, KIRCHHOFF)
        edges = ("symmetric", "clamped", "symmetric", "symmetric")
        last = request.numbers("load_fraction")[-1]
        radii = contact_lines(request, 0, (rim, A), lambda: A * plate_contact(64 * last)[0])
        grid = grid_over(request, radii, spaced_lines(0, np.pi / 2, request.mesh[1]))
        quarter = on_grid(request, annulus(), grid, laminate, edges)
        forces = area_load(quarter, lambda a1, a2: TOUCHING * DOWN)
        plug = TOUCHING * rim / 2 * DOWN  # p pi c^2 over the circumference 2 pi c
        forces += edge_force(quarter, 0, rim, lambda a1, a2: plug)

        def measured(fraction: float, touch: Touch) -> dict[str, float]:
            force = 4 * float(touch.force.sum()) * A**2 / (D * GAP)
            spread, r = fraction * TOUCHING * touch.candidates.weights, touch.at[:, 0]
            excess = np.where(touch.force > 0, touch.force - spread, 0.0)
            return {"contact_force": force, "contact_radius": float(np.sqrt(excess @ r**2 / excess.sum()) / A)}

        shell, foundation = loaded_shell(quarter, request, forces=forces), RigidPlane(DOWN, H / 2 + GAP)
        clamp, pressures = quarter.grid.on_line(0, A), request.numbers("load_fraction")
        return ContactModel(shell, clamp, pressures, lambda t: foundation, measured, at_rim=("contact_radius",))


SCENES = (PlateContact(),)
