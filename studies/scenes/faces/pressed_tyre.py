"""The tyre of :mod:`studies.scenes.tyre.scene` pressed on a ground that deforms: what the scenes of one share.

The tyre is inflated without contact, one column of elements for all. The ground comes along -e_x, touches the crown at
(psi, phi) = (0, 0), and moves on by delta: to the wheel it is the same as if this moved by delta towards the ground.
Of the tyre only what looks at the ground may meet it. Two mirror planes, where the plies have them, leave a quarter;
nodes in these planes are on the rim of the ground, where a slope of the ground turns gaps' derivatives by its square.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Self

import numpy as np

from contact.algorithms.semismooth import Semismooth
from contact.continuation.load_stepping import follow
from contact.faces.sampling import PAIRINGS
from contact.problem import ContactSolution, Outcome
from formulations.shell import ShellModel
from studies.ask.request import Request, Value
from studies.ask.scene import EPSILON, SOLVER, Declared, Setting, Sheet, UsageError
from studies.scenes import foundations
from studies.scenes.contact.extent import half_extent
from studies.scenes.element import ELEMENT, MOVED_NODES
from studies.scenes.faces.bodies import Bodies, Body, Placed, Side
from studies.scenes.faces.model import SLAVES, FacesModel, Facing, Meeting, paired
from studies.scenes.faces.solids import towards_start
from studies.scenes.tyre.grid_lines import GRADING, tyre_lines
from studies.scenes.tyre.model import checked_wall, column_over, faces_of, inflated_shell
from studies.scenes.tyre.parts import Part, part_of, settle_model
from studies.scenes.tyre.press import PATH_SETTINGS, begin_inflation
from studies.scenes.tyre.press import Body as TyreBody
from studies.scenes.tyre.scene import SETTINGS as TYRE
from studies.scenes.tyre.scene import Tyre, with_wall
from studies.scenes.tyre.sector import SECTOR

DEEP, BESIDES = 2.0, 0.1  # travels and radii of the rim from the crown down to what may meet the ground
ON_LINE = 1e-9  # mm
IN_PATCH = 0.6  # share of the elements of a larger ground that lie under the patch
TRAVELS = Setting.positive(
    "delta_mm", (5.0, 10.0, 15.0, 20.0), "travel of the wheel from first touch", 100, kind="floats"
)
# its rim carries a line force, which pressures of averaged gaps answer by waves: peaks are twice what nodes have
NODES = paired(pairing=PAIRINGS[0])
_OWN = {"delta_mm", "coupling", "rim", *(each.key for each in (GRADING, SECTOR, *PATH_SETTINGS, *foundations.SETTINGS))}
_NOT = _OWN | {each.key for each in (*ELEMENT, EPSILON, SOLVER)}
SETTINGS = (
    TRAVELS,
    *(each for each in TYRE if each.key not in _NOT),
    *(*NODES, EPSILON),
    *(each for each in ELEMENT if each not in MOVED_NODES),
    SOLVER,
)
QUANTITIES: Mapping[str, str] = {
    "force_N": "force of the ground on the whole tyre, along the way of the wheel",
    **{name: text for name, text in Tyre.quantities.items() if name in ("centre_pressure_MPa", "mean_pressure_MPa")},
    "half_length_mm": "from the centre of the patch to its rim around the axis, half-way to the first point out of it",
    "half_width_mm": "from the centre of the patch to its rim along the axis, half-way to the first point out of it",
}


@dataclass(frozen=True, eq=False)
class Inflated:
    """A tyre, or a quarter of it, inflated: unknowns u (n,), and the x [mm] of its crown."""

    shell: ShellModel
    part: Part
    u: np.ndarray
    crown: float

    @classmethod
    def on(cls, request: Request) -> Self:
        """Raises UsageError on impossible geometry, plies or meshes, and where the tyre cannot be inflated."""
        clamp = checked_wall(request.settings)[3]
        part = part_of(request.model, *tyre_lines(request.mesh, clamp))
        shell = inflated_shell(request, part)
        column = column_over(request, part, shell)
        u = column.lift(_inflated(request, column.body, None))
        u = _inflated(request, shell, ContactSolution(u, np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED))
        return cls(shell, part, u, float(np.max(faces_of(shell, u)[1][:, 0])))

    def side(self, depth: float) -> Side:
        """The elements of its outer face that look at the ground, no deeper than this [mm] below the crown at rest."""
        grid = self.part.grid
        below = self.crown - self.shell.discretisation.positions()[1][grid.elements, 0].mean(axis=1)
        return Side(0, 1, np.flatnonzero((below <= depth) & np.all(np.abs(grid.centre) < math.pi / 2, axis=1)))

    def nodes(self, side: Side) -> np.ndarray:
        """Those of these elements that are not held."""
        grid = self.part.grid
        clamp = float(grid.ends[0, 1])
        held = np.union1d(grid.on_line(0, clamp), grid.on_line(0, -clamp))
        return np.setdiff1d(np.unique(grid.elements[side.patches]), held)


def _inflated(request: Request, body: TyreBody, start: ContactSolution | None) -> np.ndarray:
    algorithm = Semismooth(tolerance=request.number("tolerance"), solver=request.choice("solver"))
    problem_at, begun = begin_inflation(body, start)
    (point,) = follow(problem_at, 0.0, [1.0], algorithm, begun, request.steps)
    if not point.outcome.converged:
        p0 = request.number("p0_MPa")
        raise UsageError(f"p0_MPa = {p0:g}: the inflation of this tyre stops at {point.reached * p0:.3g}")
    return point.solution.u


class OnGround(Declared):
    """What scenes of it share; the mesh is that of the whole tyre."""

    default_mesh = (28, 28)
    coarsest_mesh = (14, 14)  # 8x8 has an unstable path, odd numbers have none
    models = ("auto", "full", "quarter")
    sheet = Sheet("-x", 42.0, 14.0, settings={"delta_mm": "20"}, model="full")

    def complete(self, settings: Mapping[str, Value]) -> dict[str, Value]:
        """The plies of the paper unless others are given; raises UsageError on a mixture."""
        return with_wall(settings)

    def settle(self, request: Request) -> Request:
        """A quarter where the plies allow it, unless the whole is asked for; raises UsageError where they do not."""
        model, reason = settle_model(request.model, request.settings)
        return replace(request, model="full" if model == "half" else model, model_reason=reason)


def reach(request: Request, radius: float) -> tuple[float, float]:
    """Half width and half length [mm] of what a tyre as stiff as its rim covers of a drum, a plane of radius inf."""
    laminate, R1, R0, _ = checked_wall(request.settings)
    outer = R0 + laminate.thickness
    return R1 + laminate.thickness, math.sqrt(2 * request.numbers("delta_mm")[-1] / (1 / outer + 1 / radius))


def lines(request: Request, n: int, length: float, near: float, *, down: bool = False) -> np.ndarray:
    """About n lines over both sides of the centre, or n/2 over one, which is ``down`` or not, see `towards_start`.

    Over both sides the centre is in the middle of an element: nodes of the tyre would rest on lines between elements.
    """
    half = max(2, n // 2)
    if request.model == "quarter":
        up = towards_start(half, length, near, IN_PATCH)
        return -up[::-1] if down else up
    up = towards_start(2 * half + 1, length, near, IN_PATCH)[1::2]
    return np.append(-up[::-1], up)


def pressed(
    request: Request,
    tyre: Inflated,
    ground: Callable[[np.ndarray], Body],
    foremost: float,
    facing: tuple[Side, np.ndarray],
    reading: Callable[[Meeting], dict[str, float]],
) -> FacesModel:
    """The path of the ground.

    ground(shift): the body with its foremost point at the x of -``foremost`` + shift.  facing: its side,
    and points of that (k,) that may touch.  reading: what else a scene reads.
    """
    deltas = request.numbers("delta_mm")
    side = tyre.side(DEEP * deltas[-1] + BESIDES * request.number("R1_mm"))
    slave_index = SLAVES.index(request.choice("slave"))
    copies = 4 if request.model == "quarter" else 1

    def bodies(delta: float) -> Bodies:
        return Bodies((Placed(tyre.shell), ground(np.array([tyre.crown + foremost - delta, 0.0, 0.0]))))

    points = tyre.nodes(side), facing[1]
    if not all(map(len, points)):
        where = "leaves no node where tyre and ground may touch: take more elements"
        raise UsageError(f"mesh {request.mesh_text} {where}")
    candidates = points[slave_index]
    rest = bodies(0.0).parts[slave_index].face(1)[0][candidates]
    along, across = (_line(rest, axis) for axis in (1, 2))
    middle = np.linalg.norm(rest[:, 1:], axis=1)
    centre = middle <= np.min(middle) + ON_LINE
    extent = partial(_half_extent, mirrored=copies > 1)

    def measured(delta: float, meeting: Meeting) -> dict[str, float]:
        force, pressure, x = meeting.force, meeting.pressure, meeting.position
        return {
            "force_N": copies * (2 * slave_index - 1) * float(meeting.resultant[0, 0]),
            "centre_pressure_MPa": float(np.mean(pressure[centre])),
            "mean_pressure_MPa": float(force @ pressure) / (float(force.sum()) or 1.0),
            "half_length_mm": extent(x[along, 1], pressure[along] > 0),
            "half_width_mm": extent(x[across, 2], pressure[across] > 0),
            **reading(meeting),
        }

    at_rest = np.zeros(int(bodies(0.0).starts[-1]))
    at_rest[: len(tyre.u)] = tyre.u
    pair = Facing.between(request, (side, tyre.nodes(side)), facing)
    return FacesModel.of(request, bodies, [pair], measured, before=at_rest)


def _line(x: np.ndarray, axis: int) -> np.ndarray:
    """The points of (m, 3) on the line nearest to the centre along y, 1, or z, 2, in order."""
    aside = x[:, 3 - axis]
    on = np.flatnonzero((aside >= -ON_LINE) & (aside <= np.min(np.abs(aside)) + ON_LINE))
    return on[np.argsort(x[on, axis])]


def _half_extent(x: np.ndarray, touching: np.ndarray, *, mirrored: bool) -> float:
    """Of a line (k,), or of one of its halves."""
    if mirrored:
        order = np.argsort(-np.abs(x))
        x, touching = np.abs(x)[order], touching[order]
        x, touching = np.append(x, -x[-2::-1]), np.append(touching, touching[-2::-1])
    return half_extent(x, touching)
