"""Prismatic foundations: a plane with a cleat across it or another profile, corners rounded, by exact signed distance.

The profile is a smooth curve of straight pieces and arcs in a plane (s, t), s along the travel and t the height above
the base. Its tangent turns continuously, so the nearest point of the curve lies inside a piece or at a joint that two
pieces share with one normal: the distance is that of the piece whose nearest point is nearest of all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contact.obstacles.foundation import require_unit


@dataclass(frozen=True)
class Line:
    """Points start + l direction for low <= l <= high; the material is on the right of the direction."""

    start: tuple[float, float]
    direction: tuple[float, float]
    low: float
    high: float

    def distance(self, y: np.ndarray) -> np.ndarray:
        """Distance (m,) of the points y (m, 2) from the piece."""
        along = np.clip((y - self.start) @ self.direction, self.low, self.high)
        return np.asarray(np.linalg.norm(y - self.start - along[:, None] * self.direction, axis=1))

    def local(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Signed distance (m,), its gradient (m, 2), and its second derivative along the tangent (m,)."""
        normal = np.array([-self.direction[1], self.direction[0]])
        return (y - self.start) @ normal, np.broadcast_to(normal, y.shape), np.zeros(len(y))


@dataclass(frozen=True)
class Arc:
    """Points centre + radius (cos, sin)(middle + b), |b| <= half; side +1: material inside the circle, -1: outside."""

    centre: tuple[float, float]
    radius: float
    middle: float
    half: float
    side: int

    def distance(self, y: np.ndarray) -> np.ndarray:
        """Distance (m,) of the points y (m, 2) from the piece."""
        arm = y - self.centre
        turned = np.arctan2(arm[:, 1], arm[:, 0]) - self.middle
        b = np.clip((turned + np.pi) % (2 * np.pi) - np.pi, -self.half, self.half) + self.middle
        return np.asarray(np.linalg.norm(arm - self.radius * np.column_stack([np.cos(b), np.sin(b)]), axis=1))

    def local(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Signed distance (m,), its gradient (m, 2), and its second derivative along the tangent (m,)."""
        arm = y - self.centre
        d = np.linalg.norm(arm, axis=1)
        none = d == 0  # at the centre the direction is not unique: the middle of the arc, without its curvature
        n = np.where(none[:, None], [np.cos(self.middle), np.sin(self.middle)], arm / np.where(none, 1, d)[:, None])
        return self.side * (d - self.radius), self.side * n, self.side / np.where(none, np.inf, d)


@dataclass(frozen=True, eq=False)
class Profile:
    """A foundation whose section is a curve, the same all along the third direction.

    normal (3,): unit vector from the body towards the base plane.  offset [mm]: n.x of the base plane.  travel (3,):
    unit vector in the base plane across the obstacle.  centre [mm]: travel.x where s = 0.  pieces: from s = -infinity
    to infinity. The gradient is continuous as far from the surface as no two parts of it are equally near: within one
    radius of the rounding; beyond, in the open or deep inside, the distance stays exact and its gradient may jump.
    """

    normal: np.ndarray
    offset: float
    travel: np.ndarray
    centre: float
    pieces: tuple[Line | Arc, ...]

    def __post_init__(self) -> None:
        require_unit("the normal of a profile", self.normal)
        require_unit("the travel of a profile", self.travel)
        if not abs(float(self.normal @ self.travel)) < 1e-12:
            raise ValueError("the travel of a profile must lie in its base plane")

    @property
    def origin(self) -> np.ndarray:
        """The point (3,) of the base plane at s = 0."""
        return self.offset * self.normal + self.centre * self.travel

    @property
    def least_radius(self) -> float:
        """Of the rounded edges."""
        return min((p.radius for p in self.pieces if isinstance(p, Arc) and p.side > 0), default=np.inf)

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Distance from the surface (m,)."""
        return self._nearest(x)[0]

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """Unit vectors (m, 3) away from the nearest point of the surface."""
        return self._nearest(x)[1] @ self._axes()

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """+-t t/d on an arc (m, 3, 3), t the tangent of the profile and d the distance from the centre; 0 on a line."""
        _, n, c = self._nearest(x)
        tangent = np.column_stack([-n[:, 1], n[:, 0]]) @ self._axes()
        return c[:, None, None] * tangent[:, :, None] * tangent[:, None, :]

    def moved(self, by: np.ndarray) -> Profile:
        """The shifted profile."""
        shift = float(self.normal @ by), float(self.travel @ by)
        return replace(self, offset=self.offset + shift[0], centre=self.centre + shift[1])

    @property
    def size(self) -> float:
        """Distance of the base plane or of the profile from the origin, or a coordinate of a piece."""
        own = [piece.start if isinstance(piece, Line) else (*piece.centre, piece.radius) for piece in self.pieces]
        return max(abs(self.offset), abs(self.centre), *(abs(value) for piece in own for value in piece))

    def _axes(self) -> np.ndarray:
        """Directions of s and t, (2, 3)."""
        return np.array([self.travel, -self.normal])

    def _nearest(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        y = x @ self._axes().T - [self.centre, -self.offset]
        piece = np.argmin([piece.distance(y) for piece in self.pieces], axis=0)
        gap, n, c = np.empty(len(y)), np.empty((len(y), 2)), np.empty(len(y))
        for i, own in enumerate(self.pieces):
            at = piece == i
            gap[at], n[at], c[at] = own.local(y[at])
        return gap, n, c


def cleat(height: float, top: float, flank_deg: float, radius: float) -> tuple[Line | Arc, ...]:
    """The pieces of a trapezoidal bar: its height, width on top, angle of the flanks (90: a box), rounding [mm].

    Raises ValueError when the rounding does not fit on top or flank, or a number is out of its range.
    """
    foot = _foot(height, flank_deg)
    if not top > 0:
        raise ValueError(f"the width on top must be positive, got {top}")
    return rounded([(-top / 2 - foot, 0), (-top / 2, height), (top / 2, height), (top / 2 + foot, 0)], radius)


def _foot(height: float, flank_deg: float) -> float:
    if not (0 < height < np.inf and 0 < flank_deg <= 90):
        raise ValueError(f"height = {height} must be positive and flank_deg = {flank_deg} in (0, 90]")
    return height / float(np.tan(np.deg2rad(flank_deg)))


def rounded(corners: Sequence[tuple[float, float]], radius: float) -> tuple[Line | Arc, ...]:
    """Level lines from -infinity to the first and from the last corner on, straight between; every corner rounded.

    A corner that turns by an angle a takes radius tan(|a|/2) of both its lines. Raises ValueError where that is not
    there, where the curve turns back, or where a corner does not turn.
    """
    if not 0 < radius < np.inf:
        raise ValueError(f"the rounding must be positive and finite, got {radius}")
    v = np.asarray(corners, float)
    edges = np.diff(v, axis=0)
    lengths = np.array([np.inf, *np.linalg.norm(edges, axis=1), np.inf])
    angles = np.array([0.0, *np.arctan2(edges[:, 1], edges[:, 0]), 0.0])
    turns = np.diff(angles)
    if np.any(np.abs(angles) > np.pi / 2 + 1e-12) or np.any(turns == 0):
        raise ValueError("the profile must advance along its travel and turn at every corner")
    taken = radius * np.tan(np.abs(turns) / 2)
    used = np.array([0.0, *taken]) + np.array([*taken, 0.0])
    if np.any(used > lengths * (1 + 1e-12)):
        short = int(np.argmax(used - lengths))
        raise ValueError(f"a rounding of {radius:g} mm needs {used[short]:g} mm of a line that has {lengths[short]:g}")
    pieces: list[Line | Arc] = [_line(v[0], 0.0, -np.inf, -taken[0])]
    for i, turn in enumerate(turns):
        side = -1 if turn > 0 else 1  # a left turn is a foot, filled up; a right turn is an edge, cut off
        ahead = np.array([np.cos(angles[i]), np.sin(angles[i])])
        centre = v[i] - taken[i] * ahead - side * radius * np.array([-ahead[1], ahead[0]])
        middle = float(angles[i] + turn / 2 + side * np.pi / 2)
        pieces.append(Arc((float(centre[0]), float(centre[1])), radius, middle, float(abs(turn)) / 2, side))
        left = lengths[i + 1] - (taken[i + 1] if i + 1 < len(taken) else 0.0)
        pieces.append(_line(v[i], angles[i + 1], taken[i], max(left, taken[i])))
    return tuple(pieces)


def _line(start: np.ndarray, angle: float, low: float, high: float) -> Line:
    direction = float(np.cos(angle)), float(np.sin(angle))
    return Line((float(start[0]), float(start[1])), direction, float(low), float(high))
