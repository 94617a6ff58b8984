"""Finite rotations one after another: a panel turned about Z, then Y, then X, over many load steps, is not to strain.

One rotation shows a strain measure; several show what an element makes of them: rotations do not add up, and what one
step leaves the next carries on. The panel is turned by one edge and follows freely, by Newton's iteration. After
code_aster's ZZZZ364A, with a shell.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import follow
from contact.problem import ContactProblem, ContactSolution, Linearisation, Linearised, without_contact
from formulations.conditions.boundary import Supports
from formulations.element.strain_operator import ON_LINES
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import EXACT
from formulations.strains.quantities import N_E
from studies.experiments import Row, tabulated
from studies.experiments.rigid_body import rotation
from studies.experiments.specimens import Element

RADIUS, LENGTH, WIDTH, THICKNESS = 1.0, 1.0, 0.8, 0.05  # width: an angle
ANGLE, STEPS, ELEMENTS = 0.5, 8, 4  # rad of each rotation, load steps in each, elements along either side
FORCE, TOLERANCE = THICKNESS * WIDTH, 1e-11  # that of strain 1 on an edge, E = 1; of the residual over it
AXES = np.eye(3)[::-1]  # Z, Y, X, fixed in space


def turned(t: float) -> np.ndarray:
    """Rotation (3, 3) after t of the rotations, the last one in part."""
    R = np.eye(3)
    for done, axis in enumerate(AXES):
        R = rotation(axis, ANGLE * min(max(t - done, 0.0), 1.0)) @ R
    return R


def turned_panel(element: Element, n: int = ELEMENTS) -> tuple[ShellModel, np.ndarray]:
    """The exact measure's panel of n x n elements, one layer with nu = 0.3, after all rotations, and its unknowns.

    Raises RuntimeError where the panel does not follow.
    """
    grid = Grid.tensor(np.linspace(0, LENGTH, n + 1), np.linspace(0, WIDTH, n + 1))
    supports = Supports.none(grid).clamped(grid.on_line(0, 0.0))
    wall = Laminate.single(Ply.isotropic(1.0, 0.3, THICKNESS))
    shell = element.shell(EXACT, cylinder(RADIUS), grid, wall, supports)
    body = shell.discretisation
    x, frame = np.stack(body.positions()), body.surface.frame(*grid.nodes.T)

    def held_at(t: float) -> ShellModel:
        v = np.einsum("nij,fnj->nif", frame, x @ turned(t).T - x).reshape(-1, 6)
        return replace(shell, prescribed=np.where(body.map.held, v, 0.0))

    def problem_at(t: float) -> ContactProblem:
        held = held_at(t)

        def linearise(u: np.ndarray, memory: object) -> Linearised:
            """Measured by FORCE at the least: in a body that moves rigidly no force is in balance."""
            lin = held.linearise(u, memory)
            return Linearisation(lin.residual, lin.tangent, max(lin.scale, FORCE), lin.remember)

        return without_contact(linearise, body.n_free, ordered=held.ordered)

    rest, algorithm = ContactSolution.at_rest(body.n_free, 0), ALGORITHMS["semismooth"](tolerance=TOLERANCE)
    *_, last = follow(problem_at, 0.0, range(1, len(AXES) + 1), algorithm, rest, STEPS)
    if not last.outcome.converged:
        raise RuntimeError(f"turned by {last.reached:g} of {len(AXES)} rotations: {last.outcome.value}")
    return held_at(last.reached), last.solution.u


@tabulated
def rotations_table() -> Iterator[Row]:
    """What is left by interpolation, of positions, which a rotation keeps, and of components.

    strain: the largest mean |E| of an element.
    """
    for interpolation in reversed(ON_LINES):
        panel, u = turned_panel(Element(interpolation, "balanced"))
        yield {"interpolation": interpolation, "strain": float(np.abs(panel.mode_strains(u)[:, :N_E]).max())}
