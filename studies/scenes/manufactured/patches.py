"""Pieces of surfaces and the fields that move them: what a manufactured solution is made of.

Every coordinate system of the catalogue of surfaces is here, with curvatures of either sign. No mesh enters.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from formulations.geometry import surfaces
from formulations.section.laminate import Laminate, Ply
from studies.scenes.element import Span

_AXIS = np.array([0.6, -0.5, 0.8]) / np.sqrt(1.25)
SPIN = np.cross(np.eye(3), -_AXIS)  # SPIN @ x = axis x x
_WAVES = np.array([[1.1, 0.4, -0.6], [-0.5, 1.3, 0.7], [0.8, -0.9, 1.0]])  # no two alike, none along an axis
_PHASES = np.array([0.3, 1.1, 2.0])


@dataclass(frozen=True)
class Piece:
    """A rectangle in the coordinates of a surface; lengths are about 1 [mm]."""

    surface: surfaces.Surface
    a1: Span
    a2: Span

    def distance(self, a: np.ndarray) -> np.ndarray:
        """r^2 (...) of points (..., 2): the sum of both squared distances from the middle, each 1 at the edges."""
        ends = np.array([self.a1, self.a2])
        return np.asarray(np.sum(((a - ends.mean(axis=1)) / (0.5 * np.ptp(ends, axis=1))) ** 2, axis=-1))


PIECES: Mapping[str, Piece] = {
    "plate": Piece(surfaces.Plate(), (-0.4, 0.6), (-0.3, 0.5)),
    "annulus": Piece(surfaces.annulus(), (0.6, 1.4), (0.0, 0.8)),
    "cylinder": Piece(surfaces.cylinder(1.0), (0.0, 0.8), (0.2, 1.0)),
    "cone": Piece(surfaces.cone(0.5), (1.0, 1.8), (0.0, 1.0)),
    "sphere": Piece(surfaces.sphere(1.0), (-0.3, 0.5), (0.2, 1.0)),
    "torus": Piece(surfaces.elliptic_torus(2.0, 1.0, 0.7), (0.1, 0.9), (0.0, 0.4)),
    "inner-torus": Piece(surfaces.torus(2.0, 1.0), (2.6, 3.5), (0.0, 0.6)),  # saddle-shaped
    "hyperboloid": Piece(surfaces.hyperboloid(1.0, 1.0), (-0.3, 0.6), (0.0, 0.8)),
}
LAYUPS = ("skew", "isotropic")


def wall(layup: str, h: float) -> Laminate:
    """A wall of thickness h [mm]: two unequal plies that are symmetric nowhere, or one isotropic one, nu = 0.3."""
    if layup == "isotropic":
        return Laminate((Ply.isotropic(10.0, 0.3, h),), -0.4 * h)
    plies = (Ply(30.0, 8.0, 4.0, 3.0, 0.3, 0.4, angle, share * h) for angle, share in ((0.6, 0.6), (-0.9, 0.4)))
    return Laminate(tuple(plies), -0.4 * h)


@dataclass(frozen=True, eq=False)
class TurnedWaves:
    """x = R ((1 + s) X + w sin(K X + c)): a stretch s and waves of amplitude w [mm], turned by R about a skew axis.

    Both faces X = x + d e3 of a shell move so. The stretch keeps what measures see of a rotation, cos(theta) - 1, from
    pressing the shell into waves of its own.
    """

    surface: surfaces.Surface
    laminate: Laminate
    angle: float
    stretch: float
    wave: float

    def __call__(self, a: np.ndarray) -> np.ndarray:
        """u (..., 2, 3) at points a (..., 2)."""
        a1, a2 = np.moveaxis(a, -1, 0)
        X = faces(self.surface, self.laminate, a1, a2)
        return np.asarray(waved(X, self.stretch, self.wave) @ expm(self.angle * SPIN).T - X)


def waved(X: np.ndarray, stretch: float, wave: float) -> np.ndarray:
    """(1 + s) X + w sin(K X + c), (..., 3)."""
    return np.asarray((1 + stretch) * X + wave * np.sin(X @ _WAVES.T + _PHASES))


def faces(surface: surfaces.Surface, laminate: Laminate, a1: np.ndarray, a2: np.ndarray) -> np.ndarray:
    """Positions (..., 2, 3) on the inner and on the outer face."""
    x, normal = surface.position(a1, a2), surface.frame(a1, a2)[..., 2, :]
    return np.stack([x + d * normal for d in (laminate.d_minus, laminate.d_plus)], axis=-2)
