"""A manufactured motion onto a ball: the outer face lies on it inside a curve that is given, and clears it outside.

The pressure is given, too. It vanishes on the curve, from where the face lifts off: the edge of contact is known for
every radius and moves as the radius grows. No mesh enters here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import expm

from formulations.section.laminate import Laminate
from formulations.strains.measure import StrainMeasure
from studies.scenes.manufactured.patches import SPIN, Piece, faces, waved
from studies.scenes.manufactured.solution import Displacement, Exact
from studies.scenes.manufactured.spectral import Patch

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

    inside, outside: two smooth solutions, each over the whole rectangle; one holds on either side of the curve, where
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
