"""A column between clamps that is shortened and bows against a rigid wall at a clearance.

It buckles at P_E = 4 pi^2 EI/L^2, touches the wall with its middle, and is then stiffer: with the force of the wall on
that point the load grows to 4 P_E. The first state is sought from the buckling mode, without imperfection.

At 4 P_E each half buckles between clamps, and the path has two branches. On one both halves bow away from the wall and
the load stays constant. On the other the middle lies flat, without pressure, and the load grows to 9 P_E, where the
flat part buckles. Only forces that are zero distinguish the branches, so an algorithm may follow either. Where a single
node carries the force at the end of the flat part, the column can turn there and its tangent has a negative eigenvalue.
The scene therefore stops before 4 P_E. Its tests solve line contact up to 9 P_E on given sets.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import RigidPlane
from contact.problem import ContactSolution
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from studies.ask.declarations import BEAM, CONTACT, Ladder, ShellLimit, thickness_over
from studies.ask.scene import EPSILON, SOLVER, Begun, Declared, Reference, Request, SceneModel, Setting
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.data import Row, references
from studies.scenes.element import ELEMENT, even_grid, on_grid
from studies.scenes.statics import loaded_shell

POINT, LINE = 4.0, 9.0  # the largest loads in point and in line contact


def bent(load: float) -> tuple[float, float]:
    """Shortening by bending, and force of the wall; with a straight flat part beyond LINE, too.

    Euler and Bernoulli's beam, small slopes. Units: length L = 1, clearance of the wall 1, Euler's load P_E = 4 pi^2
    EI/L^2 = 1: k = sqrt(P/EI) = 2 pi sqrt P. The shortening by bending, int w'^2/2, is in units of clearance^2/L,
    forces of the wall in those of P_E clearance/L. On one half the column is w = a (1 - cos k x) + b (x - sin(k x)/k),
    with w' = 0 and w = 1 where it meets the wall: in the middle up to P = 4 P_E, then at x = 1/sqrt P, where it has no
    curvature and its flat part begins, without pressure on it. That one is a column between clamps, too, and buckles at
    9 P_E. Source: Domokos, Holmes, Royce, J. Nonlinear Sci. 7 (1997) 281 (recalled; derived anew).

    Raises ValueError below 1.
    """
    if load < 1:
        raise ValueError(f"P = {load:g} P_E must be at least 1: the column touches the wall at P_E")
    if load > POINT:
        return 1.5 * math.sqrt(load), 2 * load**1.5
    k = 2 * math.pi * math.sqrt(load)
    t = k / 2
    scale = math.cos(t / 2) / 2 - 2 / k * math.sin(t / 2)
    ak, b = -math.sin(t / 2) / scale, math.cos(t / 2) / scale
    squares = ak**2 * (1 / 4 - math.sin(2 * t) / (4 * k)) + b**2 * (
        3 / 4 - 2 * math.sin(t) / k + math.sin(2 * t) / (4 * k)
    )
    return squares + 2 * ak * b / k * (1 - math.cos(t) - math.sin(t) ** 2 / 2), 2 * load * b


def load_at(shortening: float, extension: float) -> float:
    """P/P_E at a shortening of which ``extension`` P/P_E is not by bending: 1 until the column touches.

    Raises ValueError beyond 9 P_E.
    """
    low, high = 1.0, LINE
    if bent(low)[0] + extension >= shortening:
        return min(shortening / extension, 1.0)
    if bent(high)[0] + extension * high < shortening:
        raise ValueError(f"a shortening of {shortening:g} is beyond that at {LINE:g} P_E")
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if bent(middle)[0] + extension * middle < shortening else (low, middle)
    return middle


E, LENGTH, WIDTH, H, CLEARANCE = 1e5, 200.0, 10.0, 0.1, 1.0  # MPa, mm; nu = 0
EULER = np.pi**2 * E * WIDTH * H**3 / (3 * LENGTH**2)  # N
EXTENSION = EULER * LENGTH / (E * WIDTH * H)  # mm, at P_E
BENDING = CLEARANCE**2 / LENGTH  # mm, the unit of the shortening by it
UP = np.array([0.0, 0.0, 1.0])
DELTAS = (0.008, 0.013, 0.0135, 0.014, 0.015)  # mm, with references
SHORTENINGS = Setting("delta_mm", DELTAS[:-1], "shortening, up to that at 4 P_E", "floats", low=0.001, high=0.0156)


def exact(delta: float) -> tuple[float, float]:
    """P over P_E, and the force of the wall over P_E clearance/L, at a shortening [mm]."""
    load = load_at(delta / BENDING, EXTENSION / BENDING)
    touches = delta > bent(1.0)[0] * BENDING + EXTENSION
    return load, bent(load)[1] if touches else 0.0


def _references() -> tuple[Reference, ...]:
    rows: list[Row] = []
    for delta in DELTAS:
        load, force = exact(delta)
        rows.append(({"delta_mm": delta, "measure": "exact"}, {"P_over_PE": load, "wall_force": force}))
    source = "beam of small slopes (Domokos, Holmes, Royce, J. Nonlinear Sci. 7 (1997) 281)"
    return references("exact", source, {"P_over_PE": 1e-3, "wall_force": 3e-3}, rows)


class WalledColumn(Declared):
    """Half of the column: a1 from the clamp to the middle; the wall is above."""

    name = "walled-column"
    title = "Clamped column that bows against a wall"
    default_mesh = (64, 1)
    settings = (SHORTENINGS, EPSILON, *ELEMENT, SOLVER)
    references = _references()
    quantities = {
        "P_over_PE": "load over Euler's of the column between clamps, 4 pi^2 EI/L^2",
        "wall_force": "of the wall on the column over P_E times clearance over length",
    }
    ladders = (
        Ladder(
            CONTACT,
            ("16x1", "32x1", "64x1", "128x1"),
            ("P_over_PE", "wall_force"),
            settings={"delta_mm": "0.014"},
        ),
    )
    shell_limit = ShellLimit(BEAM, thickness_over(LENGTH, H), same=False)

    def build(self, request: Request) -> SceneModel:
        """The clamp moves by half of the shortening."""
        grid = even_grid(request, (0, LENGTH / 2), (0, WIDTH))
        wall, edges = Laminate.single(Ply.isotropic(E, 0.0, H)), ("clamped", "symmetric", "symmetric", "symmetric")
        clamp, shell = grid.on_line(0, 0.0), loaded_shell(on_grid(request, Plate(), grid, wall, edges), request)
        moved = np.zeros((grid.n_nodes, 6))
        moved[clamp, :2] = 0.5

        def shortened(delta: float) -> ShellModel:
            return replace(shell, prescribed=delta * moved)

        def measured(delta: float, touch: Touch) -> dict[str, float]:
            load = float(shortened(delta).reactions(touch.u)[clamp, :2].sum())
            force = 2 * float(touch.force.sum()) * LENGTH / CLEARANCE
            return {"P_over_PE": load / EULER, "wall_force": force / EULER}

        plane, deltas = RigidPlane(UP, H / 2 + CLEARANCE), request.numbers("delta_mm")
        return ColumnModel(shell, clamp, deltas, lambda delta: plane, measured, key="delta_mm", body_at=shortened)


@dataclass(frozen=True, eq=False)
class ColumnModel(ContactModel):
    """From the mode of buckling."""

    def _begin(self, previous: ContactSolution | None) -> Begun:
        problem_at, rest = super()._begin(None)
        by_bending = (self.targets[0] - EXTENSION) / BENDING
        w = CLEARANCE * min(1.0, 2 / np.pi * np.sqrt(by_bending))
        grid, k = self.shell.discretisation.grid, 2 * np.pi / LENGTH
        mode = np.zeros((grid.n_nodes, 6))
        mode[:, 4:] = (w / 2 * (1 - np.cos(k * grid.nodes[:, 0])))[:, None]
        mode[:, :2] = np.outer(w / 2 * k * np.sin(k * grid.nodes[:, 0]), [H / 2, -H / 2])
        return problem_at, replace(rest, u=self.shell.discretisation.map.restrict(mode))


SCENES = (WalledColumn(),)
