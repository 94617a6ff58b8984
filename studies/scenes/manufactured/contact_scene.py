"""A shell on a ball with a given pressure and a given edge of contact, which moves along the path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, cached_property

import numpy as np
from scipy.linalg import expm

from contact.obstacles.drum_sphere import Sphere
from contact.problem import ContactSolution
from formulations.section.laminate import SECTIONS, Laminate
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import StrainMeasure
from studies.ask.scene import EPSILON, SOLVER, Begun, Declared, Request, SceneModel, Setting, Sheet
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.element import TWO_FACES
from studies.scenes.manufactured.scene import QUANTITIES, carrying, errors, held_piece, unknowns_at
from studies.scenes.manufactured.solution import Displacement, Exact, Patch
from studies.scenes.manufactured.statements import LAYUPS, PIECES, SPIN, Piece, faces, waved

PRESSURE = 5.0  # MPa: p = PRESSURE (c^2 - r^2)
LIFT = 0.1  # mm: the face clears the ball by LIFT (r^2 - c^2)^2


@dataclass(frozen=True, eq=False)
class OntoBall:
    """x = R (o + (rho + gap) m): stretched and waved as by :class:`TurnedWaves`, then led onto a ball from outside.

    m: unit vector from the centre o of the ball of radius rho to the stretched, waved point of the outer face; the
    inner face is h further out.  lifts: whether the gap LIFT (r^2 - c^2)^2 is added, as it is outside the curve r = c.
    """

    piece: Piece
    laminate: Laminate
    angle: float
    stretch: float
    wave: float
    ball: float
    radius: float
    lifts: bool = False

    @cached_property
    def turn(self) -> np.ndarray:
        """R (3, 3)."""
        return np.asarray(expm(self.angle * SPIN))

    @cached_property
    def _centre(self) -> np.ndarray:
        """Centre o (3,) before the turn: the ball touches the middle of the piece at rest."""
        a1, a2 = (np.array([0.5 * sum(span)]) for span in (self.piece.a1, self.piece.a2))
        outer = faces(self.piece.surface, self.laminate, a1, a2)[0, 1]
        return np.asarray(outer + self.ball * self.piece.surface.frame(a1, a2)[0, 2])

    @property
    def centre(self) -> np.ndarray:
        """Where the centre of the ball is, (3,)."""
        return self.turn @ self._centre

    def direction(self, a: np.ndarray) -> np.ndarray:
        """R m (..., 3): how the ball pushes."""
        X = faces(self.piece.surface, self.laminate, a[..., 0], a[..., 1])[..., 1, :]
        arm = waved(X, self.stretch, self.wave) - self._centre
        return np.asarray(arm / np.linalg.norm(arm, axis=-1, keepdims=True) @ self.turn.T)

    def __call__(self, a: np.ndarray) -> np.ndarray:
        """u (..., 2, 3) at points a (..., 2)."""
        X = faces(self.piece.surface, self.laminate, a[..., 0], a[..., 1])
        gap = LIFT * (self.piece.distance(a) - self.radius**2) ** 2 if self.lifts else np.zeros(a.shape[:-1])
        far = self.ball + gap[..., None] + np.array([self.laminate.thickness, 0.0])
        return self.centre + far[..., None] * self.direction(a)[..., None, :] - X


@dataclass(frozen=True, eq=False)
class Touching:
    """The exact solution of a shell on a ball; see :class:`studies.scenes.manufactured.solution.Solution`.

    inside, outside: two smooth solutions, each over the whole rectangle; each is valid on one side of the curve, where
    their displacements and strains agree. The pressure, per area of the outer face at rest, is taken off the force on
    that face: the ball provides it.
    """

    field: OntoBall
    inside: Exact
    outside: Exact

    @classmethod
    def on(cls, field: OntoBall, measure: StrainMeasure, stiffness: np.ndarray) -> Touching:
        """The solution of a field without its gap, and with it."""
        patch = Patch.over(field.piece.a1, field.piece.a2)
        both = (
            Exact(field.piece.surface, field.laminate, measure, stiffness, patch, replace(field, lifts=lifts))
            for lifts in (False, True)
        )
        return cls(field, *both)

    @property
    def stiffness(self) -> np.ndarray:
        """D (11, 11)."""
        return self.inside.stiffness

    @property
    def displacement(self) -> Displacement:
        """u of both faces."""
        return lambda a: self._either(a, self.inside.displacement(a), self.outside.displacement(a))

    def pressure(self, a: np.ndarray) -> np.ndarray:
        """p (...) [MPa] per area of the outer face at rest."""
        return PRESSURE * np.maximum(self.field.radius**2 - self.field.piece.distance(a), 0.0)

    def strains(self, a: np.ndarray) -> np.ndarray:
        """E (..., 11)."""
        return self._either(a, self.inside.strains(a), self.outside.strains(a))

    def body_force(self, a: np.ndarray) -> np.ndarray:
        """All forces but the pressure, (..., 2, 3)."""
        force = self._either(a, self.inside.body_force(a), self.outside.body_force(a))
        pushed = self.pressure(a) * self.inside.outer_area(a)
        force[..., 1, :] -= pushed[..., None] * self.field.direction(a)
        return force

    def edge_force(self, axis: int, a: np.ndarray) -> np.ndarray:
        """As that of :class:`Exact`, (..., 2, 3)."""
        return self._either(a, self.inside.edge_force(axis, a), self.outside.edge_force(axis, a))

    def _either(self, a: np.ndarray, inside: np.ndarray, outside: np.ndarray) -> np.ndarray:
        within = self.field.piece.distance(a) < self.field.radius**2
        return np.where(within.reshape(*within.shape, *[1] * (inside.ndim - within.ndim)), inside, outside)


RADII = Setting.positive("radius", (0.3, 0.5, 0.7), "radius of contact over half of the piece", 0.95, kind="floats")
SETTINGS = (
    RADII,
    Setting.one_of("surface", PIECES, "cylinder", "piece of a surface"),
    Setting.one_of("layup", LAYUPS, "skew", "two plies that are symmetric nowhere, or one isotropic one"),
    Setting.positive("h_mm", 0.1, "thickness; the pieces are about 1 mm long and wide", 0.2),
    Setting("ball_mm", 2.0, "radius of the ball", low=1, high=100),
    Setting("rotation_deg", 30.0, "rotation of the whole piece about a skew axis", low=-180, high=180),
    Setting("stretch", 0.25, "uniform elongation of the piece; with less some measures fold", low=0, high=1),
    Setting("wave_mm", 0.04, "amplitude of the waves along the ball", low=0, high=0.2, unit="mm"),
    Setting.one_of("section", SECTIONS, "constant-s33", "law of the section for the thickness stretch"),
    EPSILON,
    *TWO_FACES,
    SOLVER,
)


@dataclass(frozen=True, eq=False)
class PressedOnBall(ContactModel):
    """The path of the radius of contact, from the exact solution at the nodes where the ball barely touches."""

    exact_at: Callable[[float], Touching] = field(kw_only=True)

    def _begin(self, previous: ContactSolution | None) -> Begun:
        problem_at, start = super()._begin(previous)
        return problem_at, replace(start, u=unknowns_at(self.shell.discretisation, self.exact_at(0.0)))


class ManufacturedContact(Declared):
    """A piece of a surface pressed by a ball; the pressure is c^2 - r^2 within the radius c of contact."""

    name = "manufactured-contact"
    title = "Shell on a ball with a given pressure and edge of contact (errors known exactly)"
    default_mesh = (16, 16)
    settings = SETTINGS
    quantities = {
        **QUANTITIES,
        "error_pressure": "relative L2 error of the nodal contact pressures",
        "error_edge": "root mean square distance of the edge of contact from the exact one, over its radius",
        "error_area": "error of the area that touches, over the exact one",
    }
    sheet = Sheet("x", 40.0, 28.0)

    def build(self, request: Request) -> SceneModel:
        """The first edge of each coordinate is held and the last one loaded; the exact solution is that of a wall of
        two faces.
        """
        piece, laminate, shell, supports = held_piece(request)
        angle, ball = np.deg2rad(request.number("rotation_deg")), request.number("ball_mm")
        motion = OntoBall(piece, laminate, angle, request.number("stretch"), request.number("wave_mm"), ball, 0.0)
        measure, stiffness = MEASURES[request.measure], laminate.stiffness(request.choice("section"))

        @cache
        def exact_at(radius: float) -> Touching:
            return Touching.on(replace(motion, radius=radius), measure, stiffness)

        def body_at(radius: float) -> ShellModel:
            return carrying(shell, exact_at(radius), {0: piece.a1[1], 1: piece.a2[1]})

        def measured(radius: float, touch: Touch) -> dict[str, float]:
            return errors(body_at(radius), touch.u, exact_at(radius)) | contact_errors(exact_at(radius), touch)

        obstacle = Sphere(motion.centre, ball)
        held = np.flatnonzero(supports.held.any(axis=1))
        radii = request.numbers("radius")
        return PressedOnBall(
            shell, held, radii, lambda radius: obstacle, measured, key="radius", body_at=body_at, exact_at=exact_at
        )


def contact_errors(exact: Touching, touch: Touch) -> dict[str, float]:
    """error_pressure: relative L2 norm of the nodal pressures.  error_edge, error_area: of the edge of contact.

    error_edge: root mean square of its distance on the grid lines that cross it, the pressure led on to zero from the
    last two nodes; error_area: of the area of the nodes that touch; both over the exact ones.
    """
    weight, stated = touch.candidates.weights, exact.pressure(touch.at)
    off = np.sqrt(weight @ (touch.pressure - stated) ** 2 / (weight @ stated**2))
    radius = exact.field.radius
    crossings = edge_crossings(exact.field.piece, touch)
    edge = np.sqrt(np.mean((crossings - radius) ** 2)) / radius if len(crossings) else np.nan
    area = weight @ touch.active / (weight @ (stated > 0)) - 1
    return {"error_pressure": float(off), "error_edge": float(edge), "error_area": float(abs(area))}


def edge_crossings(piece: Piece, touch: Touch) -> np.ndarray:
    """r (k,) where the pressure falls to zero on the grid lines, between a node that touches and one that does not."""
    crossings = []
    for axis in (0, 1):
        for across in np.unique(touch.at[:, 1 - axis]):
            line = np.flatnonzero(touch.at[:, 1 - axis] == across)
            line = line[np.argsort(touch.at[line, axis])]
            for nodes in (line, line[::-1]):
                for before, last, after in zip(nodes, nodes[1:], nodes[2:], strict=False):
                    if touch.active[before] and touch.active[last] and not touch.active[after]:
                        crossings.append(_zero(touch, before, last, after))
    return np.sqrt(piece.distance(np.array(crossings))) if crossings else np.zeros(0)


def _zero(touch: Touch, before: int, last: int, after: int) -> np.ndarray:
    """The point (2,) where the line through two pressures is zero, no further than the next node."""
    p, q = touch.pressure[before], touch.pressure[last]
    share = q / (p - q) * np.linalg.norm(touch.at[last] - touch.at[before]) if p > q else np.inf
    step = touch.at[after] - touch.at[last]
    return touch.at[last] + step * min(share / np.linalg.norm(step), 1.0)


SCENES = (ManufacturedContact(),)
