"""Heavy strip on a rigid plane, lifted at one end: free length and lifting force of a Timoshenko beam.

The strip hangs under a ceiling, so to say: its weight presses the outer face on the plane, the lift pulls it off.
"""

from dataclasses import replace

import numpy as np

from contact.obstacles.foundation import RigidPlane
from formulations.conditions.boundary import Supports
from formulations.geometry.surfaces import Plate
from formulations.shell import ShellModel
from studies.ask.declarations import CONTACT, FULL, LONG, Ladder
from studies.ask.scene import EPSILON, SOLVER, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.closed_forms.contact import lifted_strip
from studies.scenes.contact.base import ON_RIM, RIM_LINES, ContactModel, Touch, contact_lines
from studies.scenes.contact.strip import UP, B, D, H, contact_edge, middle_line, strip_wall
from studies.scenes.element import ELEMENT, discretise, grid_over, spaced_lines
from studies.scenes.statics import area_load, loaded_shell

UNIT, LIFT = 100.0, 1.0  # mm: (D delta/q)^(1/4) and delta at load fraction 1
WEIGHT = D * LIFT / UNIT**4  # MPa
LENGTH = 4 * UNIT  # beyond 3 UNIT nothing happens

LAMBDA = Setting("lam_over_unit", 0.2, "sqrt(D/S) over (D delta/q)^(1/4)", low=0.01, high=1)
LIFTS = Setting("load_fraction", (1.0,), "lifts to report", "floats", 0.0, 4.0, open_low=True)
SOURCE = "closed form of beam theory, checked by beam elements"


REFERENCES = tuple(
    Reference(name, value, {"lam_over_unit": lam, "load_fraction": 1.0, "measure": "linear"}, "exact", SOURCE, 1e-6)
    for lam in (0.2, 0.5)
    for name, value in zip(("free_length", "lift_force"), lifted_strip(lam), strict=True)
)


class HeavyStrip(Declared):
    """a1 from the lifted end, which may turn, to the other one, which lies."""

    name = "heavy-strip"
    title = "Heavy strip on a plane, lifted at one end"
    default_mesh = (64, 1)
    settings = (LIFTS, LAMBDA, RIM_LINES, EPSILON, *ELEMENT, SOLVER)
    references = REFERENCES
    quantities = {
        "free_length": "from the lifted end to the begin of contact, over (D delta/q)^(1/4)",
        "lift_force": "force that lifts the end, over q (D delta/q)^(1/4) of the width",
    }
    ladders = (Ladder(CONTACT, LONG, ("lift_force", "free_length"), "linear", {**FULL, **ON_RIM}),)

    def build(self, request: Request) -> SceneModel:
        """The weight is all there from the start, the end is displaced; results over UNIT and WEIGHT UNIT."""
        lam, highest = request.number("lam_over_unit"), request.numbers("load_fraction")[-1]
        unit = highest**0.25  # the length that a lift scales with, over UNIT

        def rim() -> float:
            return UNIT * unit * lifted_strip(lam / unit)[0]

        grid = grid_over(request, contact_lines(request, 0, (0, LENGTH), rim), spaced_lines(0, B, request.mesh[1]))
        end = grid.on_line(0, 0.0)
        supports = Supports.of_edges(grid, "free", "symmetric", "symmetric", "symmetric").hold(end, (2,))
        wall = strip_wall(UNIT * lam)
        strip = discretise(request, Plate(), grid, wall, *supports.masks)
        shell = loaded_shell(strip, request, forces=area_load(strip, lambda a1, a2: WEIGHT * UP))
        total = WEIGHT * LENGTH * B

        def lifted(t: float) -> ShellModel:
            prescribed = np.zeros((grid.n_nodes, 6))
            prescribed[end, 4:] = -t * LIFT
            return replace(shell, prescribed=prescribed)

        def measured(t: float, touch: Touch) -> dict[str, float]:
            x, pressure = middle_line(touch, UNIT)
            begins, _ = contact_edge(x, pressure / WEIGHT)
            lift = (total - float(touch.force.sum())) / (WEIGHT * UNIT * B)  # what the plane does not carry
            return {"free_length": begins, "lift_force": lift}

        plane, lifts = RigidPlane(UP, H / 2), request.numbers("load_fraction")
        return ContactModel(shell, end, lifts, lambda t: plane, measured, body_at=lifted, lying=True)


SCENES = (HeavyStrip(),)
