"""A flat circular membrane of rubber with a fixed edge, blown up to its largest pressure (Code_Aster SSNS115).

The wall is a thousandth of the radius; the pressure follows the inner face and has a limit point at a deflection of 1.3
radii and stretches of 2.4. Between two faces a law linear in Green's strain would have to be thinner than nothing from
a stretch of about 1.5 on, which plane stress alone does not notice. A small hole at the centre, whose edge slides along
the axis, takes the place of the singular point of the coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.problem import ContactSolution, without_contact
from formulations.geometry.surfaces import annulus
from formulations.loads.pressure import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.request import Request
from studies.ask.scene import SOLVER, Begun, Reference, Scene, SceneModel, Setting, UsageError
from studies.scenes.data import Row, references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, loaded_shell

RADIUS, THICKNESS, E, NU = 1000.0, 1.0, 2.0, 0.3  # mm, MPa
UNIT = 1e-3  # MPa, at load fraction 1
HOLE, SECTOR = 1e-3, np.pi / 90  # of the radius
DOME = 0.25  # of the radius: height of the dome from which the first state is looked for
# pressure over UNIT: deflection [mm]; the equations of the membrane (closed_forms) have the same digits, but 0.09655
# for the first entry of the table, 0.0975 at 250 mm, which is left out
READ = {0.51748: 500.0, 1.00262: 750.0, 1.28642: 1000.0}
CODE_ASTER = "Code_Aster V6.05.115 (SSNS115), read as a table"


def _references() -> tuple[Reference, ...]:
    rows: list[Row] = [({"load_fraction": at, "law": "neo-hooke"}, {"w_centre_mm": w}) for at, w in READ.items()]
    return references("read", CODE_ASTER, 2e-3, rows)


class Membrane:
    """A strip of the disc, a1 from the centre to the edge."""

    name: str = "inflated-membrane"
    title: str = "Flat circular rubber membrane blown up"
    default_mesh: tuple[int, int] = (80, 1)
    settings: tuple[Setting, ...] = (
        replace(LOAD_FRACTIONS, default=(0.1, *READ), help="pressures to report, over 0.001 MPa"),
        *of_wall("3", "neo-hooke"),
        SOLVER,
    )
    references: tuple[Reference, ...] = _references()
    quantities: Mapping[str, str] = {"w_centre_mm": "deflection at the centre"}

    def build(self, request: Request) -> SceneModel:
        """Pressure on the true inner face."""
        if request.settings["law"] == "svk":
            raise UsageError("law = svk: a wall stretched to twice its size would have to be thinner than nothing")
        wall = Laminate.single(Ply.isotropic(E, NU, THICKNESS))
        edges = ("symmetric", "hinged", "symmetric", "symmetric")
        strip = patch(request, annulus(), (HOLE * RADIUS, RADIUS), (0.0, SECTOR), wall, edges)
        centre = strip.grid.on_line(0, HOLE * RADIUS)

        def read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            return {"w_centre_mm": float(shell.displacements(u)[centre, 4:].mean())}

        shell = loaded_shell(strip, request, pressure=Pressure(UNIT, follower=True))
        return MembraneModel(shell, request.numbers("load_fraction"), read)


@dataclass(frozen=True, eq=False)
class MembraneModel(StaticModel):
    """At rest a membrane has no stiffness: the first state is looked for from a dome, by the linear law."""

    def _begin(self, previous: ContactSolution | None) -> Begun:
        problem_at, rest = super()._begin(previous)
        shell = replace(self.shell.scaled(self.fractions[0]), law="svk", newton="mixed")
        body = shell.discretisation
        r = body.grid.nodes[:, 0] / RADIUS
        dome = np.zeros((body.grid.n_nodes, 6))
        dome[:, 4:] = (DOME * RADIUS * (1 - r**2))[:, None]
        linear = without_contact(shell.linearise, body.n_free, ordered=shell.ordered)
        found = Semismooth().solve(linear, replace(rest, u=body.map.restrict(dome)))
        return problem_at, replace(rest, u=found.u)


SCENES: tuple[Scene, ...] = (Membrane(),)
