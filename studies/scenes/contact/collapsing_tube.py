"""A tube that buckles under outside pressure and collapses onto itself: a quarter of it, before its plane of symmetry.

Both halves move alike, so their contact is that of a quarter with the plane y = 0. The obstacle lies half a wall below
it: the middle lines touch, as those of the references' ring without thickness do. The pressure is a suction on the
inner face. It differs from a pressure on the middle surface by a uniform tension along the wall, which causes no
bending. The ring neglects extension and shear, whose effect is of order (h/R)^2: with h = R/100 the touch pressure is
0.04 % lower, the pressure of line contact 0.11 %.

The tube stays round up to p = 3 D/R^3. Without imperfection, a start in the buckling mode leads to the other branch,
that of two lobes. There the travel of the crown is given and the pressure unknown, see :mod:`contact.control`, until
the crown touches. After that the pressures are given: they increase along this branch, so its states are also stable
under given pressure.

Contact is first a point with a force. From p_line on, a flat part of width 2 c grows. There p presses the wall from
outside, the plane presses back with p, and a force acts at each end. The rest has the same shape at every pressure,
smaller by s = 1 - 2 c/(pi R): p s^3 and the forces times s^2 stay those of the first line contact. Friction would be
that of a real plane: halves that mirror each other have none.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from contact.control import by_work
from contact.obstacles.foundation import RigidPlane
from contact.problem import ContactProblem, ContactSolution, without_contact
from formulations.geometry.surfaces import cylinder
from formulations.loads import Pressure
from formulations.section.laminate import Laminate, Ply
from studies.ask.declarations import CONTACT, CRUSHED, Ladder, Sheet, ShellLimit, meshes, thickness_over
from studies.ask.request import Request
from studies.ask.scene import EPSILON, SOLVER, Begun, Declared, Observation, Reference, SceneModel, Setting, Stage
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, even_grid, on_grid
from studies.scenes.statics import LOAD_FRACTIONS, loaded_shell

E, NU, RADIUS, THIN, WIDTH = 1.2e6, 0.3, 100.0, 1.0, 10.0  # MPa, mm
DOWN, SIDE, INNER = np.array([-1.0, 0.0, 0.0]), np.pi / 2, 0
BUCKLING = 3.0  # D/R^3
TRAVELS = (0.25, 0.5, 0.75, 1.0)  # of the crown on the way to touch, over R
PRESSURES = replace(
    LOAD_FRACTIONS, default=(2.0, 3.0, 4.0, 6.0), low=1.75, open_low=False, high=30.0, help="pressures over 3 D/R^3"
)
THICKNESS = Setting("h_mm", THIN, "thickness; the ring of the references has none", low=0.05, high=10)
# by shooting, see :mod:`studies.scenes.closed_forms.collapsed_tube`
TOUCH, LINE, LINE_FORCE = 5.246886963, 10.336032959, 7.949702985
POINT = {2.0: 1.172190098, 3.0: 5.862008673}  # load fraction: force
SOURCE = "inextensible ring, shooting (Flaherty, Keller, Rubinow, SIAM J. Appl. Math. 23 (1972) 446)"
# relative errors at h = R/100; they go by its square
WITHIN = {
    "touch_pressure_EI_R3": 5e-4,
    "contact_force_EI_R2": 3.5e-3,
    "flat_half_length": 5e-3,
    "line_contact_pressure_EI_R3": 1.3e-3,
    "line_contact_force_EI_R2": 1.5e-3,
}


def _references() -> tuple[Reference, ...]:
    """The forces of the flat part's ends, and what lies on it, by similarity."""
    collected: tuple[Reference, ...] = ()
    for h in (THIN, THIN / 10):
        at: dict[str, float | str] = {"h_mm": h, "measure": "exact"}
        rows: list[Row] = [(at, {"touch_pressure_EI_R3": TOUCH})]
        rows += [({**at, "load_fraction": load}, {"contact_force_EI_R2": force}) for load, force in POINT.items()]
        for load in (4.0, 6.0):
            p = BUCKLING * load
            s = (LINE / p) ** (1 / 3)
            flat = SIDE * (1 - s)
            values = {"contact_force_EI_R2": LINE_FORCE / s**2 + 2 * p * flat, "flat_half_length": flat}
            line = {"line_contact_pressure_EI_R3": LINE, "line_contact_force_EI_R2": LINE_FORCE}
            rows.append(({**at, "load_fraction": load}, values | line))
        collected += references("exact", SOURCE, {name: each * (h / THIN) ** 2 for name, each in WITHIN.items()}, rows)
    return collected


class CollapsingTube(Declared):
    """a1 along the axis, a2 from the crown to the side."""

    name = "collapsing-tube"
    title = "Tube that buckles under pressure and collapses onto itself"
    default_mesh = (1, 64)
    settings = (PRESSURES, THICKNESS, EPSILON, *ELEMENT, SOLVER)
    references = _references()
    quantities = {
        "touch_pressure_EI_R3": "pressure at which the crown touches, over D/R^3",
        "contact_force_EI_R2": "between both halves, a unit of length, over D/R^2",
        "flat_half_length": "from the crown to the force at the end of the flat part, over R",
        "line_contact_pressure_EI_R3": "p s^3 over D/R^3: in line contact the pressure at which that has begun",
        "line_contact_force_EI_R2": "forces at both ends of the flat part times s^2, over D/R^2: the force then",
    }
    ladders = (
        Ladder(
            CONTACT,
            meshes(2, 32, 3),
            ("contact_force_EI_R2", "touch_pressure_EI_R3", "line_contact_pressure_EI_R3", "line_contact_force_EI_R2"),
            settings={"load_fraction": "6"},
            coarser=("1x16",),
        ),
    )
    sheet = Sheet("x", -62.0, 14.0)
    shell_limit = ShellLimit(CRUSHED, thickness_over(RADIUS, "h_mm"), same=False)

    def build(self, request: Request) -> SceneModel:
        """All four sides are symmetric, so nothing moves along the axis."""
        h = request.number("h_mm")
        wall, D = Laminate.single(Ply.isotropic(E, NU, h)), E * h**3 / 12 / (1 - NU**2)
        grid = even_grid(request, (0, WIDTH), (0, SIDE))
        quarter = on_grid(request, cylinder(RADIUS), grid, wall, ("symmetric",) * 4)
        pressure = Pressure(-BUCKLING * D / RADIUS**3, follower=True)
        shell = loaded_shell(quarter, request, pressure=pressure)

        def measured(fraction: float, touch: Touch) -> dict[str, float]:
            force = touch.force * RADIUS**2 / (D * WIDTH)
            x = np.abs(touch.candidates.positions(touch.u)[:, 1]) / RADIUS
            return line_contact(BUCKLING * fraction, force, x)

        plane = RigidPlane(DOWN, h / 2)
        side, fractions = grid.on_line(1, SIDE), request.numbers("load_fraction")
        return CollapsingModel(shell, side, fractions, lambda fraction: plane, measured, face=INNER)


def line_contact(p: float, force: np.ndarray, x: np.ndarray) -> dict[str, float]:
    """What nodal forces (m,) at x (m,) on a quarter under the pressure p say; R and D are 1.

    p on 0 < x < c and F at c have the resultant p c + F and the moment p c^2/2 + F c about the crown. A point with a
    force knows nothing of the line that it becomes, whatever the mesh: NaN of that where s = 1.
    """
    total, moment = float(force.sum()), float(force @ x)
    flat = (total - math.sqrt(max(total**2 - 2 * p * moment, 0.0))) / p
    s = 1 - flat / SIDE
    begun = 1.0 if s < 1 else math.nan
    return {
        "contact_force_EI_R2": 2 * total,
        "flat_half_length": flat,
        "line_contact_pressure_EI_R3": begun * p * s**3,
        "line_contact_force_EI_R2": begun * 2 * (total - p * flat) * s**2,
    }


@dataclass(frozen=True, eq=False)
class CollapsingModel(ContactModel):
    """Two paths: of the travel of the crown up to touch, and of the pressure from there on."""

    def stages(self) -> Iterator[Stage]:
        """To touch, and on."""
        yield Stage("buckling", self._buckled, TRAVELS, self._touched, whole=lambda x: x[:-1])
        yield from super().stages()

    def problem_at(self, t: float) -> ContactProblem:
        """As anywhere, but never below touch, where the second path begins: at less the tube would be round again."""
        return super().problem_at(max(t, TOUCH / BUCKLING))

    def _begin(self, previous: ContactSolution | None) -> Begun:
        problem_at, rest = super()._begin(None)
        return problem_at, rest if previous is None else replace(rest, u=previous.u)

    def _buckled(self, previous: ContactSolution | None) -> Begun:
        """In the mode of buckling, by the first travel: w = -A cos 2 a2 of the middle, without extension."""
        body, A = self.shell.discretisation, TRAVELS[0] * RADIUS
        a2, half = body.grid.nodes[:, 1], body.laminate.thickness / 2
        along, turned = A / 2 * np.sin(2 * a2), 1.5 * A / RADIUS * np.sin(2 * a2)
        mode = np.zeros((body.grid.n_nodes, 6))
        mode[:, 2:4] = along[:, None] + np.outer(turned, [half, -half])
        mode[:, 4:] = (-A * np.cos(2 * a2))[:, None]
        rest = ContactSolution.at_rest(body.n_free + 1, 0)
        return self._buckled_at, replace(rest, u=np.append(body.map.restrict(mode), RADIUS))

    def _buckled_at(self, travel: float) -> ContactProblem:
        """With a given travel of the crown, over R; the last unknown over RADIUS is the load fraction."""
        shell, above = self.shell, self.problem_at(0.0)
        crown = self.shell.discretisation.grid.nodes[self.nodes, 1] == 0
        assert shell.pressure is not None
        force = abs(shell.pressure.value) * RADIUS * WIDTH  # only a scale: that of the other equations
        slope = -force * np.asarray(above.gap_jacobian(np.zeros(self.n_unknowns))[crown].mean(axis=0)).ravel()

        def work(u: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
            return force * (RADIUS - float(above.gap(u)[crown].mean())), shell.work_of_pressure(u)[1], slope

        linearise = by_work(lambda t: shell.scaled(t).linearise, work, force * RADIUS * travel, 1 / RADIUS)
        problem = without_contact(linearise, self.n_unknowns + 1, ordered=shell.ordered)
        return replace(problem, multipliers=1)

    def _touched(self, problem: ContactProblem, state: ContactSolution, travel: float) -> Observation:
        pressure = BUCKLING * float(state.u[-1]) / RADIUS
        return Observation(None, {"touch_pressure_EI_R3": pressure} if travel == TRAVELS[-1] else {})


SCENES = (CollapsingTube(),)
