"""Round foundations: drum and sphere, from outside (a road wheel) or from inside (a hollow drum)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import require_unit


class Round(ABC):
    """g = d - R outside, R - d inside it, d the distance from the centre, in some of the directions of space.

    At the centre itself the direction is not unique: one is chosen and its curvature left out; a body inside may well
    have a point there, far from contact.
    """

    centre: np.ndarray
    radius: float
    hollow: bool

    def __post_init__(self) -> None:
        if not 0 < self.radius < np.inf:
            raise ValueError(f"the radius must be positive and finite, got {self.radius}")

    @property
    def origin(self) -> np.ndarray:
        """The centre (3,)."""
        return self.centre

    @property
    def least_radius(self) -> float:
        """The radius, unless it is hollow."""
        return np.inf if self.hollow else self.radius

    @property
    def size(self) -> float:
        """Radius, or coordinate of the centre."""
        return max(self.radius, float(np.max(np.abs(self.centre))))

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Distance from the surface (m,)."""
        return self._sign * (np.linalg.norm(self._arm(x), axis=1) - self.radius)

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Unit vectors (m, 3) away from the centre, or towards it where hollow."""
        return self._sign * self._outwards(x)[0]

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """+-(P - n n)/d, (m, 3, 3)."""
        n, d = self._outwards(x)
        return self._sign * (self._projector - n[:, :, None] * n[:, None, :]) / d[:, None, None]

    @property
    def _sign(self) -> int:
        return -1 if self.hollow else 1

    @property
    @abstractmethod
    def _projector(self) -> np.ndarray:
        """P (3, 3), onto the directions in which the distance is measured."""

    @property
    @abstractmethod
    def _aside(self) -> np.ndarray:
        """The direction (3,) that is chosen at the centre."""

    def _arm(self, x: np.ndarray) -> np.ndarray:
        """From the centre (m, 3), in the directions in which the distance is measured."""
        return (x - self.centre) @ self._projector

    def _outwards(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit vectors (m, 3) along the arms, and their lengths (m,), infinite for none."""
        arm = self._arm(x)
        d = np.linalg.norm(arm, axis=1)
        none = d == 0
        n = np.where(none[:, None], self._aside, arm / np.where(none, 1.0, d)[:, None])
        return n, np.where(none, np.inf, d)


@dataclass(frozen=True, eq=False)
class Drum(Round):
    """An infinite cylinder: d is the distance from its axis.

    centre (3,): any point of the axis.  axis (3,): unit vector.  radius [mm].  hollow: the body is inside the drum.
    """

    centre: np.ndarray
    axis: np.ndarray
    radius: float
    hollow: bool = False

    def __post_init__(self) -> None:
        require_unit("the axis of a drum", self.axis)
        super().__post_init__()

    def moved(self, by: np.ndarray) -> Drum:
        """The drum about the shifted axis."""
        return replace(self, centre=self.centre + by)

    @property
    def _projector(self) -> np.ndarray:
        return np.eye(3) - np.outer(self.axis, self.axis)

    @property
    def _aside(self) -> np.ndarray:
        aside = np.cross(self.axis, np.eye(3)[np.argmin(np.abs(self.axis))])
        return np.asarray(aside / np.linalg.norm(aside))


@dataclass(frozen=True, eq=False)
class Sphere(Round):
    """A ball: d is the distance from its centre (3,).  radius [mm].  hollow: the body is inside the ball."""

    centre: np.ndarray
    radius: float
    hollow: bool = False

    def moved(self, by: np.ndarray) -> Sphere:
        """The ball about the shifted centre."""
        return replace(self, centre=self.centre + by)

    @property
    def _projector(self) -> np.ndarray:
        return np.eye(3)

    @property
    def _aside(self) -> np.ndarray:
        return np.array([0.0, 1.0, 0.0])
