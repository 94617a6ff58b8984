"""Round foundations: drum and sphere, from outside (a road wheel) or from inside (a hollow drum)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import require_unit


@dataclass(frozen=True, eq=False)
class Drum:
    """An infinite cylinder: g = d - R outside, R - d inside it, d the distance from its axis.

    centre (3,): any point of the axis.  axis (3,): unit vector.  radius [mm].  hollow: the body is inside the drum.
    On the axis itself the direction is not unique: one is chosen and its curvature left out; a body inside a drum may
    well have a point there, far from contact.
    """

    centre: np.ndarray
    axis: np.ndarray
    radius: float
    hollow: bool = False

    def __post_init__(self) -> None:
        require_unit("the axis of a drum", self.axis)
        _require_radius(self.radius)

    @property
    def origin(self) -> np.ndarray:
        """The centre (3,)."""
        return self.centre

    @property
    def least_radius(self) -> float:
        """The radius, unless it is hollow."""
        return np.inf if self.hollow else self.radius

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Distance from the surface (m,)."""
        return _gap(self._arm(x), self.radius, self.hollow)

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Unit vectors (m, 3) away from the axis, or towards it in a hollow drum."""
        return _gradient(self._arm(x), self.axis, self.hollow)

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """+-(1 - a a - n n)/d, (m, 3, 3)."""
        return _curvature(self._arm(x), self.axis, np.eye(3) - np.outer(self.axis, self.axis), self.hollow)

    def moved(self, by: np.ndarray) -> Drum:
        """The drum about the shifted axis."""
        return replace(self, centre=self.centre + by)

    @property
    def size(self) -> float:
        """Radius, or coordinate of the axis."""
        return _size(self.centre, self.radius)

    def _arm(self, x: np.ndarray) -> np.ndarray:
        r = x - self.centre
        return r - (r @ self.axis)[:, None] * self.axis


@dataclass(frozen=True, eq=False)
class Sphere:
    """A ball: g = d - R outside, R - d inside it, d the distance from its centre (3,); otherwise as :class:`Drum`."""

    centre: np.ndarray
    radius: float
    hollow: bool = False

    def __post_init__(self) -> None:
        _require_radius(self.radius)

    @property
    def origin(self) -> np.ndarray:
        """The centre (3,)."""
        return self.centre

    @property
    def least_radius(self) -> float:
        """The radius, unless it is hollow."""
        return np.inf if self.hollow else self.radius

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Distance from the surface (m,)."""
        return _gap(x - self.centre, self.radius, self.hollow)

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Unit vectors (m, 3) away from the centre, or towards it in a hollow sphere."""
        return _gradient(x - self.centre, POLE, self.hollow)

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """+-(1 - n n)/d, (m, 3, 3)."""
        return _curvature(x - self.centre, POLE, np.eye(3), self.hollow)

    def moved(self, by: np.ndarray) -> Sphere:
        """The sphere about the shifted centre."""
        return replace(self, centre=self.centre + by)

    @property
    def size(self) -> float:
        """Radius, or coordinate of the centre."""
        return _size(self.centre, self.radius)


POLE = np.array([0.0, 0.0, 1.0])


def _require_radius(radius: float) -> None:
    if not 0 < radius < np.inf:
        raise ValueError(f"the radius must be positive and finite, got {radius}")


def _size(centre: np.ndarray, radius: float) -> float:
    return max(radius, float(np.max(np.abs(centre))))


def _gap(arm: np.ndarray, radius: float, hollow: bool) -> np.ndarray:
    return (-1 if hollow else 1) * (np.linalg.norm(arm, axis=1) - radius)


def _gradient(arm: np.ndarray, axis: np.ndarray, hollow: bool) -> np.ndarray:
    return (-1 if hollow else 1) * _outwards(arm, axis)[0]


def _curvature(arm: np.ndarray, axis: np.ndarray, projector: np.ndarray, hollow: bool) -> np.ndarray:
    n, d = _outwards(arm, axis)
    return (-1 if hollow else 1) * (projector - n[:, :, None] * n[:, None, :]) / d[:, None, None]


def _outwards(arm: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (m, 3) along the arms and their lengths; some vector normal to the axis, and infinity, for none."""
    d = np.linalg.norm(arm, axis=1)
    aside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    none = d == 0
    n = np.where(none[:, None], aside / np.linalg.norm(aside), arm / np.where(none, 1.0, d)[:, None])
    return n, np.where(none, np.inf, d)
