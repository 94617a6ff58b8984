"""The bodies that laws are tried on: small shells of every element option, and panels before a foundation.

A panel is clamped all around, under a dead load. It may be posed with its axes exchanged, in other units, or moved as a
whole together with its supports, its load and its foundation, which must not matter; any problem may have its unknowns
and candidates renumbered. Whatever the way, an answer is read off in the places, numbers and units of the first one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from scipy import sparse

from contact.continuation.load_stepping import follow
from contact.obstacles.drum_sphere import Sphere
from contact.obstacles.foundation import Foundation, RigidPlane, against
from contact.parameters import STIFFNESS
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearisation, Outcome
from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import ON_LINES
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Geometry, Plate, Surface, cylinder, torus
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.measure import StrainMeasure
from formulations.strains.quantities import FULL
from studies.scenes.contact.base import outer_face


@dataclass(frozen=True)
class Element:
    """The options of the element."""

    interpolation: str = "curvilinear"
    thickness_strain: str = "projected"
    membrane: str = "compatible"

    def suits(self, measure: StrainMeasure) -> bool:
        """Interpolated positions know no gradients that leave something out."""
        return self.interpolation != "isoparametric" or measure.kinematics == FULL

    def shell(
        self,
        measure: StrainMeasure,
        surface: Surface,
        grid: Grid,
        layup: Laminate,
        supports: Supports | None = None,
        **loads: Any,
    ) -> ShellModel:
        """A shell of these options, free where no supports are given."""
        held = (supports or Supports.none(grid)).masks
        discretisation = Discretisation.build(
            surface, grid, layup, *held, kinematics=measure.kinematics, interpolation=self.interpolation
        )
        return ShellModel(
            discretisation, measure, thickness_strain=self.thickness_strain, membrane=self.membrane, **loads
        )


ELEMENTS = tuple(Element(*options) for options in product(ON_LINES, THICKNESS_STRAINS, MEMBRANES))


def layup(*, swapped: bool = False, length: float = 1.0, stress: float = 1.0) -> Laminate:
    """Two unequal plies that are nowhere symmetric; with the axes exchanged, in other units of length and stress."""
    plies = []
    for angle, h in ((0.6, 0.11), (-0.9, 0.07)):
        E_L, E_T, G_LT, G_TT = (stress * modulus for modulus in (30.0, 8.0, 4.0, 3.0))
        turned = math.pi / 2 - angle if swapped else angle
        plies.append(Ply(E_L, E_T, G_LT, G_TT, 0.3, 0.4, turned, length * h))
    return Laminate(tuple(plies), -0.05 * length)


@dataclass(frozen=True)
class Swapped:
    """A surface with its two coordinates exchanged."""

    surface: Surface

    def geometry(self, a1: np.ndarray, a2: np.ndarray) -> Geometry:
        """A, k and B with their last axis turned round."""
        g = self.surface.geometry(a2, a1)
        return Geometry(A=g.A[..., ::-1], k=g.k[..., ::-1], B=g.B[..., ::-1])

    def position(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """The same points."""
        return self.surface.position(a2, a1)

    def frame(self, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
        """e2, e1, e3."""
        return self.surface.frame(a2, a1)[..., [1, 0, 2], :]


TRAVEL, BALL = 0.1, 0.6  # lengths: how far the foundation comes, radius of a sphere
LOAD = 0.02  # stress along the normal, spread over the inner face


@dataclass(frozen=True, eq=False)
class Motion:
    """x -> R x + c; c in lengths of the panel as it is first posed."""

    R: np.ndarray
    c: np.ndarray

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Positions (..., 3), moved."""
        return x @ self.R.T + self.c

    def undone(self, y: np.ndarray) -> np.ndarray:
        """Positions (..., 3), moved back."""
        return (y - self.c) @ self.R


STILL = Motion(np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Way:
    """How a panel is posed; length, stress: what the units of the first way are in those of this one."""

    swapped: bool = False
    length: float = 1.0
    stress: float = 1.0
    motion: Motion = STILL


FIRST = Way()


@dataclass(frozen=True, eq=False)
class Seen:
    """Displacements (2, N, 3) of both faces and contact pressures (N,) at all nodes, as of the first way."""

    moved: np.ndarray
    pressure: np.ndarray


@dataclass(frozen=True, eq=False)
class Posed:
    """A problem to be solved: problem_at(t), t from 0 to 1; seen(state): what it shows; stiffness: stress/length."""

    problem_at: Callable[[float], ContactProblem]
    start: ContactSolution
    seen: Callable[[ContactSolution], Seen]
    stiffness: float = 1.0

    def algorithm(self, algorithm: ContactAlgorithm) -> ContactAlgorithm:
        """The algorithm with its parameters in the units of the problem."""
        own = {p.key: self.stiffness * getattr(algorithm, p.key) for p in algorithm.parameters if p.unit == STIFFNESS}
        frozen: Any = algorithm  # a record, which its protocol cannot say
        return algorithm if self.stiffness == 1.0 else replace(frozen, **own)

    def solved(self, algorithm: ContactAlgorithm, steps: int = 1) -> tuple[ContactSolution, Outcome]:
        """The last state of the path, and how it ended."""
        point = list(follow(self.problem_at, 0.0, (1.0,), self.algorithm(algorithm), self.start, steps))[-1]
        return point.solution, point.outcome


@dataclass(frozen=True)
class Panel:
    """A surface that looks along ``normal`` at its middle, and what it is pressed with: a ball or a plane.

    surface(length): in units of which a length is ``length``.  lines: of the grid.  lengths: whether a1, a2 are
    lengths, and not angles.  radius, travel: of the ball, and how far the foundation comes, in lengths.
    """

    surface: Callable[[float], Surface]
    lines: tuple[np.ndarray, np.ndarray]
    lengths: tuple[bool, bool]
    normal: tuple[float, float, float]
    ball: bool = False
    element: Element = ELEMENTS[0]
    radius: float = BALL
    travel: float = TRAVEL

    def posed(self, measure: StrainMeasure, way: Way = FIRST) -> Posed:
        """The contact problem by a measure."""
        lines = [line * way.length if own else line for line, own in zip(self.lines, self.lengths, strict=True)]
        surface = self.surface(way.length)
        if way.swapped:
            surface, lines = Swapped(surface), lines[::-1]
        grid = Grid.tensor(*lines)
        edge = np.unique([node for axis in (0, 1) for end in lines[axis][[0, -1]] for node in grid.on_line(axis, end)])
        nodes = np.setdiff1d(np.arange(grid.n_nodes), edge)
        laminate = layup(swapped=way.swapped, length=way.length, stress=way.stress)
        shell = self.element.shell(measure, surface, grid, laminate, Supports.none(grid).clamped(edge))
        own, frame = shell.discretisation, surface.frame(*grid.nodes.T)
        places = np.stack(own.positions())
        motion = replace(way.motion, c=way.motion.c * way.length)

        def components(vectors: np.ndarray) -> np.ndarray:
            """Of (2, N, 3) in the local frames, (N, 6)."""
            return np.stack([np.einsum("nij,nj->ni", frame, v) for v in vectors], axis=-1).reshape(-1, 6)

        carried = components(motion(places) - places)
        load = np.zeros_like(places)
        load[0] = LOAD * way.stress * own.nodal_areas("mid")[:, None] * frame[:, 2] @ motion.R.T
        shell = replace(shell, forces=own.reduce(components(load)), prescribed=np.where(own.map.held, carried, 0.0))
        candidates = outer_face(own, nodes)
        front = float(np.max(places[1] @ np.array(self.normal)))

        def problem_at(t: float) -> ContactProblem:
            foundation = self._foundation(front - t * self.travel * way.length, way.length, motion)
            return against(shell.linearise, candidates, foundation)

        def seen(state: ContactSolution) -> Seen:
            v = shell.displacements(state.u).reshape(-1, 3, 2)
            moved = places + np.einsum("nif,nij->fnj", v, frame)
            pressure = np.zeros(grid.n_nodes)
            pressure[nodes] = state.pressure
            shown = Seen((motion.undone(moved) - places) / way.length, pressure / way.stress)
            if not way.swapped:
                return shown
            order = np.arange(grid.n_nodes).reshape(grid.node_shape).T.ravel()
            return Seen(shown.moved[:, order], shown.pressure[order])

        m = len(nodes)
        start = ContactSolution(own.map.restrict(carried), np.zeros(m), np.zeros(m, bool), Outcome.CONVERGED)
        return Posed(problem_at, start, seen, way.stress / way.length)

    @property
    def outer_curvature(self) -> float:
        """k2 times the distance of the outer face from the surface, in the middle."""
        k = self.surface(1.0).geometry(np.zeros(1), np.zeros(1)).k
        return float(k[0, 1] * layup().d_plus)

    def _foundation(self, front: float, length: float, motion: Motion) -> Foundation:
        """With its foremost point ``front`` along the normal, moved."""
        n = np.array(self.normal)
        if self.ball:
            return Sphere(motion((front + self.radius * length) * n), self.radius * length)
        turned = motion.R @ n
        return RigidPlane(turned / np.linalg.norm(turned), front + float(turned @ motion.c))


_IRREGULAR = np.array([-0.5, -0.28, -0.1, 0.07, 0.24, 0.55]), np.array([-0.45, -0.2, 0.03, 0.15, 0.32, 0.5])
X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
PLATE = Panel(lambda length: Plate(), _IRREGULAR, (True, True), Z, ball=True)
CYLINDER = Panel(lambda length: cylinder(2 * length), _IRREGULAR, (True, False), X)
TORUS = Panel(lambda length: torus(3 * length, length), _IRREGULAR, (False, False), X)


def renumbered(posed: Posed, rng: np.random.Generator) -> Posed:
    """The same problem with its unknowns and its candidates in another, random order."""
    n, m = len(posed.start.u), len(posed.start.pressure)
    unknown, candidate = rng.permutation(n), rng.permutation(m)  # new number i stands for the old one unknown[i]
    back, back_candidate = np.argsort(unknown), np.argsort(candidate)

    def problem_at(t: float) -> ContactProblem:
        old = posed.problem_at(t)
        assert old.coupling is None

        def linearise(u: np.ndarray, memory: object) -> Linearisation:
            lin = old.linearise(u[back], memory)
            tangent = sparse.csc_matrix(lin.tangent[unknown][:, unknown])
            return Linearisation(lin.residual[unknown], tangent, lin.scale, lambda du: lin.remember(du[back]))

        bend = old.gap_curvature
        return ContactProblem(
            linearise,
            lambda u: old.gap(u[back])[candidate],
            lambda u: sparse.csr_matrix(old.gap_jacobian(u[back])[candidate][:, unknown]),
            old.weights[candidate],
            gap_curvature=None
            if bend is None
            else lambda u, f: sparse.csc_matrix(bend(u[back], f[back_candidate])[unknown][:, unknown]),
        )

    def restored(state: ContactSolution) -> ContactSolution:
        own = {key: getattr(state, key)[back_candidate] for key in ("pressure", "active")}
        return replace(state, u=state.u[back], **own)

    start = replace(posed.start, u=posed.start.u[unknown])  # at rest no candidate differs from another
    return Posed(problem_at, start, lambda state: posed.seen(restored(state)), posed.stiffness)
