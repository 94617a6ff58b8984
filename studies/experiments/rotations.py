"""Finite rotations one after another: about Z, then Y, then X, and back, over many load steps; nothing may be left.

One rotation shows a strain measure; several show what a program makes of them: rotations do not add up, nor may their
order be exchanged, and what one step leaves the next carries on. A panel is turned by its edges, all else is found by
Newton's iteration. Free, it is held by one edge and may follow without strain; strained, both of its edges are held
and the second one is pulled and bent first: its energy is to stay. After code_aster's ZZZZ364A, with a shell.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import follow
from contact.problem import (
    ContactProblem,
    ContactSolution,
    Linearisation,
    Linearise,
    Linearised,
    without_contact,
)
from formulations.conditions.boundary import Supports
from formulations.element.strain_operator import ON_LINES
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import N_E
from studies.experiments import Row, tabulated
from studies.experiments.rigid_body import rotation
from studies.experiments.specimens import Element

RADIUS, LENGTH, WIDTH, THICKNESS = 1.0, 1.0, 0.8, 0.05  # width: an angle
PULL, BEND = 0.01, 0.1  # of the second edge: along the axis, and a turn about the y axis
ANGLE, STEPS, ELEMENTS = 0.5, 8, 4  # rad of each rotation, load steps in each, elements along either side
FORCE, TOLERANCE = THICKNESS * WIDTH, 1e-11  # that of strain 1 on an edge, E = 1; of the residual over it
AXES = {"X": np.eye(3)[0], "Y": np.eye(3)[1], "Z": np.eye(3)[2]}
BACK = (("Z", 1), ("Y", 1), ("X", 1), ("X", -1), ("Y", -1), ("Z", -1))
ASTRAY = (("Z", 1), ("Y", 1), ("X", 1), ("Z", -1), ("Y", -1), ("X", -1))  # the same six in an order that is not back
PATHS = {"back": BACK, "astray": ASTRAY}
RUNS = (("free", "back"), ("strained", "back"), ("strained", "astray"))
Leg = tuple[str, int]  # axis and sense


def turned(legs: Sequence[Leg], t: float, angle: float = ANGLE) -> np.ndarray:
    """Rotation (3, 3) after t legs about axes fixed in space, the last one in part."""
    R = np.eye(3)
    for done, (axis, sense) in enumerate(legs):
        R = rotation(AXES[axis], sense * angle * min(max(t - done, 0.0), 1.0)) @ R
    return R


def measured(linearise: Linearise) -> Linearise:
    """The same, its residual measured by FORCE at the least: in a body that moves rigidly no force is in balance."""

    def linearised(u: np.ndarray, memory: object) -> Linearised:
        lin = linearise(u, memory)
        return Linearisation(lin.residual, lin.tangent, max(lin.scale, FORCE), lin.remember)

    return linearised


@dataclass(frozen=True)
class Panel:
    """A piece of a cylinder of one layer, nu = 0.3, its axis Z; ``strained``: both ends are held, else the first."""

    measure: StrainMeasure
    element: Element
    strained: bool
    legs: Sequence[Leg]
    angle: float = ANGLE

    def at_rest(self) -> ShellModel:
        """The shell without any displacement."""
        grid = Grid.tensor(np.linspace(0, LENGTH, ELEMENTS + 1), np.linspace(0, WIDTH, ELEMENTS + 1))
        supports = Supports.none(grid).clamped(grid.on_line(0, 0.0))
        if self.strained:
            supports = supports.clamped(grid.on_line(0, LENGTH))
        wall = Laminate.single(Ply.isotropic(1.0, 0.3, THICKNESS))
        return self.element.shell(self.measure, cylinder(RADIUS), grid, wall, supports)

    def faces(self, shell: ShellModel) -> tuple[np.ndarray, np.ndarray]:
        """Positions (2, N, 3) of the nodes on both faces at rest, and the frames (N, 3, 3)."""
        a1, a2 = shell.discretisation.grid.nodes.T
        frame, wall = shell.discretisation.surface.frame(a1, a2), shell.discretisation.laminate
        middle = shell.discretisation.surface.position(a1, a2)
        return np.stack([middle + d * frame[:, 2] for d in (wall.d_minus, wall.d_plus)]), frame

    def held_at(self, shell: ShellModel, t: float) -> ShellModel:
        """The shell with its edges where they are after t legs; the strain comes up from t = -1 to 0."""
        x, frame = self.faces(shell)
        moved, second = x.copy(), shell.discretisation.grid.on_line(0, LENGTH)
        if self.strained:
            grown = min(t + 1.0, 1.0)
            centre = np.array([RADIUS, 0.0, LENGTH])
            pulled = (x[:, second] - centre) @ rotation(AXES["Y"], grown * BEND).T + centre
            moved[:, second] = pulled + grown * PULL * AXES["Z"]
        u = moved @ turned(self.legs, t, self.angle).T - x
        v = np.einsum("nij,fnj->nif", frame, u).reshape(-1, 6)
        return replace(shell, prescribed=np.where(shell.discretisation.map.held, v, 0.0))

    def run(self, steps: int = STEPS) -> Iterator[Row]:
        """What is left after each leg; ends early where the shell does not follow."""
        shell = self.at_rest()
        x, frame = self.faces(shell)
        n = shell.discretisation.n_free

        def problem_at(t: float) -> ContactProblem:
            held = self.held_at(shell, t)
            return without_contact(measured(held.linearise), n, ordered=held.ordered)

        rest, targets = ContactSolution.at_rest(n, 0), range(len(self.legs) + 1)
        path = follow(problem_at, -1.0, targets, ALGORITHMS["semismooth"](tolerance=TOLERANCE), rest, steps)
        first: tuple[float, np.ndarray] | None = None
        for point in path:
            if not point.outcome.converged:
                yield {"leg": int(point.requested), "outcome": point.outcome.word}
                return
            held, u = self.held_at(shell, point.reached), point.solution.u
            v = np.einsum("nij,nif->fnj", frame, held.displacements(u).reshape(-1, 3, 2))
            body, energy = (x + v) @ turned(self.legs, point.reached, self.angle), held.energy(u)  # as the edges see it
            first = (energy, body) if first is None else first
            yield {
                "leg": int(point.requested),
                "outcome": point.outcome.word,
                "strain": float(np.abs(held.mode_strains(u)[:, :N_E]).max()),
                "energy": energy,
                "energy_change": energy / first[0] - 1 if self.strained else np.nan,
                "off": float(np.abs(body - first[1]).max() / LENGTH),
                "away": float(np.abs(v).max() / LENGTH),
            }


@tabulated
def rotations_table() -> Iterator[Row]:
    """All measures, free and strained, there and back, and strained astray.

    leg: rotations done.  strain: the largest mean |E| of an element.  energy [E mm^3], energy_change: over that before
    the first rotation, less 1.  off: the largest distance of a node from where the rotation of the edges takes what was
    there before the first one, over the panel's length.  away: the largest displacement, over the same.  outcome: of
    the path up to there; beyond one that is not converged there is nothing.
    """
    for (measure, element), (body, path) in product(cases(), RUNS):
        own = {"measure": measure.name, "interpolation": element.interpolation, "body": body, "path": path}
        for leg in Panel(measure, element, body == "strained", PATHS[path]).run():
            yield own | leg


def cases() -> list[tuple[StrainMeasure, Element]]:
    """Positions interpolated, which a rotation keeps; components where a measure knows no others, and the exact one."""
    positions, components = (Element(interpolation, "balanced") for interpolation in reversed(ON_LINES))
    every = [(measure, positions if positions.suits(measure) else components) for measure in MEASURES.values()]
    return [*every, (MEASURES["exact"], components)]
