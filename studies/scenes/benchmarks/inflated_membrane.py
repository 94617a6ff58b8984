"""A flat circular rubber membrane with a fixed edge, inflated by a pressure or a volume (Code_Aster SSNS115).

The thickness is a thousandth of the radius. The pressure follows the middle surface and has a limit point at a
deflection of 1.3 radii and stretches of 2.4. From a stretch of about 1.5 on, a law linear in Green's strain would
require a negative thickness between two faces; plane stress alone does not show this. A small hole at the centre, whose
edge slides along the axis, replaces the singular point of the coordinates.

Beyond the limit point the pressure falls while the volume grows. The states there are stable when the volume is given,
as for a liquid: with control=volume the pressure is unknown, see :mod:`contact.control`. Up to a deflection of 2.5
radii the wall thins to a fortieth. From 1.5 radii on, elements at the hole have local modes, and the stability is
reported as not counted.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.control import by_work
from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.geometry.surfaces import annulus
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.scene import SOLVER, Begun, Declared, Reference, Request, SceneModel, Setting, Stage, UsageError
from studies.scenes.data import Row, references
from studies.scenes.element import of_wall, patch
from studies.scenes.statics import LOAD_FRACTIONS, StaticModel, loaded_shell

RADIUS, THICKNESS, E, NU = 1000.0, 1.0, 2.0, 0.3  # mm, MPa
UNIT = 1e-3  # MPa, at load fraction 1
VOLUME = 2 / 3 * np.pi * RADIUS**3  # mm^3, half a sphere on the edge, the same for a volume
HOLE, SECTOR = 1e-3, np.pi / 90  # of the radius
DOME = 0.25  # of the radius: height of the dome from which the first state is looked for
FIRST = 0.2  # load fraction of that state
# pressure over UNIT: deflection [mm]; the equations of the membrane (in the tests) have the same digits, but 0.09655
# for the first entry of the table, 0.0975 at 250 mm, which is left out
READ = {0.51748: 500.0, 1.00262: 750.0, 1.28642: 1000.0}
CODE_ASTER = "Code_Aster V6.05.115 (SSNS115), read as a table"


def _references() -> tuple[Reference, ...]:
    where = {"law": "neo-hooke", "control": "pressure"}
    rows: list[Row] = [({**where, "load_fraction": at}, {"w_centre_mm": w}) for at, w in READ.items()]
    return references("read", CODE_ASTER, 2e-3, rows)


class Membrane(Declared):
    """A strip of the disc, a1 from the centre to the edge."""

    name = "inflated-membrane"
    title = "Flat circular rubber membrane blown up"
    default_mesh = (80, 1)
    settings = (
        replace(LOAD_FRACTIONS, default=(0.1, *READ), help="pressures over 0.001 MPa, or volumes over half a sphere's"),
        Setting.one_of("control", ("pressure", "volume"), "pressure", "whether pressures or volumes are given"),
        *of_wall("3", "neo-hooke"),
        SOLVER,
    )
    references = _references()
    quantities = {"w_centre_mm": "deflection at the centre", "pressure_MPa": "pressure inside"}

    def build(self, request: Request) -> SceneModel:
        """Pressure acts on the middle surface, as on a membrane."""
        if request.settings["law"] == "svk":
            raise UsageError("law = svk: a wall stretched to twice its size would have a negative thickness")
        wall = Laminate.single(Ply.isotropic(E, NU, THICKNESS))
        edges = ("symmetric", "hinged", "symmetric", "symmetric")
        strip = patch(request, annulus(), (HOLE * RADIUS, RADIUS), (0.0, SECTOR), wall, edges)
        centre = strip.grid.on_line(0, HOLE * RADIUS)

        def read(shell: ShellModel, u: np.ndarray) -> dict[str, float]:
            return {"w_centre_mm": float(shell.displacements(u)[centre, 4:].mean())}

        shell = loaded_shell(strip, request, pressure=Pressure(UNIT, follower=True, middle=True))
        model = FilledMembrane if request.choice("control") == "volume" else MembraneModel
        return model(shell, request.numbers("load_fraction"), read)


@dataclass(frozen=True, eq=False)
class MembraneModel(StaticModel):
    """At rest a membrane has no stiffness: the first state is looked for from a dome, by the linear law."""

    multipliers: ClassVar[int] = 0

    def _begin(self, previous: ContactSolution | None) -> Begun:
        body = self.shell.discretisation
        r = body.grid.nodes[:, 0] / RADIUS
        dome = np.zeros((body.grid.n_nodes, 6))
        dome[:, 4:] = (DOME * RADIUS * (1 - r**2))[:, None]
        rest = ContactSolution.at_rest(body.n_free + self.multipliers, 0)
        start = replace(rest, u=np.append(body.map.restrict(dome), np.zeros(self.multipliers)))
        linear = replace(self, shell=replace(self.shell, law="svk", newton="mixed"))
        inflated = Semismooth().solve(linear.problem_at(FIRST), start)
        return self.problem_at, replace(rest, u=inflated.u)

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        return {**super()._displacements(u, fraction), "pressure_MPa": fraction * UNIT}


class FilledMembrane(MembraneModel):
    """With a given volume inside: the last unknown over RADIUS is the pressure over UNIT."""

    multipliers: ClassVar[int] = 1

    def stages(self) -> Iterator[Stage]:
        """The path of the volume."""
        return (replace(stage, whole=lambda x: x[:-1]) for stage in super().stages())

    def problem_at(self, fraction: float) -> ContactProblem:
        """The shell with a fraction of its volume inside."""
        shell, given = self.shell, fraction * UNIT * VOLUME * SECTOR / (2 * np.pi)
        linearise = by_work(lambda t: shell.scaled(t).linearise, shell.work_of_pressure, given, 1 / RADIUS)
        problem = without_contact(linearise, shell.discretisation.n_free + 1, ordered=shell.ordered)

        def others(x: np.ndarray) -> np.ndarray:
            return shell.scaled(x[-1] / RADIUS).left_to_foundation(x[:-1])

        return replace(problem, others=others, multipliers=self.multipliers)

    def _displacements(self, u: np.ndarray, fraction: float) -> dict[str, float]:
        return super()._displacements(u[:-1], float(u[-1]) / RADIUS)


SCENES = (Membrane(),)
