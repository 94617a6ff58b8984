"""What passes through what between two states: the ways of the points of two faces through the patches of the other.

No search and no projection of those that pose the problem. Every point moves straight from where it was to where it is,
and so do the corners of the triangles into which patches are cut by a diagonal::

    f(s) = (x - A) . (B - A) x (C - A),    x, A, B, C linear in s in [0, 1]

is a cubic. Where it changes its sign with x in the triangle, x goes into the wall, f < 0 after, or comes out of it.
Points of faces that touch lie a little behind each other, and they slide: that is not a passage. One is

- a way out on a side that faces away from the one where it went in, n(a) . n(b) < 0, or from that at which it was, and
- an end behind the face by more than its patches explain, DEEP of their size, once it has gone in: a wall has been left
  by a side that is not a face.

Points are those of both faces; edges that pass each other without a point going through a patch are not seen.
Source: Provot, Graphics Interface (1997) 177-189, the cubic of a point and a moving triangle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from contact.faces.measured import feet
from contact.swept import SLID, Crossing

DEEP = 0.5  # of the side of a square of the area of the patch
AT_START = 1e-9  # of a patch: what is no farther behind it has not gone in yet
EDGE = 1e-9  # of a triangle: as far beyond its edge a point goes through it, too
LEVELS = 50  # bisections of a root
AT_ONCE = 500  # points
HALVES = ([0, 1, 2], [0, 2, 3])  # of a patch


@dataclass(frozen=True, eq=False)
class Ways:
    """Those of two faces: positions(u) -> (k, 3) of all points; patches slave (a, 4) and master (b, 4)."""

    positions: Callable[[np.ndarray], np.ndarray]
    slave: np.ndarray
    master: np.ndarray

    def passed(self, u0: np.ndarray, after: Ways, u1: np.ndarray) -> list[Crossing]:
        """Points of either face that pass through the other from u0 (n,) here to u1 there."""
        ends = np.stack([self.positions(u0), after.positions(u1)])
        sides = (self.slave, self.master, "slave point"), (self.master, self.slave, "master point")
        return [each for own, other, kind in sides for each in _passed(ends, np.unique(own), other, kind)]


@dataclass(frozen=True, eq=False)
class _Hits:
    """Where points go through patches, in order: whose (h,), at which s, into the wall or out of it, normals there."""

    whose: np.ndarray
    share: np.ndarray
    inwards: np.ndarray
    normal: np.ndarray
    quad: np.ndarray


def _passed(ends: np.ndarray, points: np.ndarray, quads: np.ndarray, kind: str) -> Iterator[Crossing]:
    hits, along = _hits(ends, points, quads), "the other face"
    sides, still = _sides(ends, points, quads, hits)
    for i, (goes, comes, cosine) in sides.items():
        if cosine < SLID:
            yield Crossing(int(points[i]), goes, comes, kind, along)
    whose = np.array(list(still), np.intp)
    off, normal, _ = feet(ends[1][points[whose]], ends[1], quads)
    depth = -np.einsum("pc,pc->p", off, normal)
    for i, deep in zip(whose, depth, strict=True):
        goes, quad = still[i]
        if deep > DEEP * _size(ends[1][quads[quad]]):
            yield Crossing(int(points[i]), goes, 1.0, kind, along)


def _sides(
    ends: np.ndarray, points: np.ndarray, quads: np.ndarray, hits: _Hits
) -> tuple[dict[int, tuple[float, float, float]], dict[int, tuple[float, int]]]:
    """By point: from which s to which s it is in the wall, with the cosine of the normals; and who still is, since s.

    Of several stays the one whose normals differ most.
    """
    first = np.flatnonzero(np.diff(hits.whose, prepend=-1) != 0)
    out = first[~hits.inwards[first]]  # they were behind the face from the start
    begun = dict(zip(hits.whose[out], feet(ends[0][points[hits.whose[out]]], ends[0], quads)[1], strict=True))
    sides, inside = dict[int, tuple[float, float, float]](), dict[int, tuple[float, int, np.ndarray]]()
    inside |= {int(i): (0.0, -1, n) for i, n in begun.items()}
    for i, share, inwards, normal, quad in zip(
        hits.whose.tolist(), hits.share.tolist(), hits.inwards, hits.normal, hits.quad.tolist(), strict=True
    ):
        if inwards:
            inside.setdefault(i, (share, quad, normal))
        elif i in inside:
            since, _, n = inside.pop(i)
            stay = (since, share, float(n @ normal))
            sides[i] = min(stay, sides.get(i, stay), key=lambda each: each[2])
    return sides, {i: (since, quad) for i, (since, quad, _) in inside.items()}


def _hits(ends: np.ndarray, points: np.ndarray, quads: np.ndarray) -> _Hits:
    corners = ends[:, quads]
    parts = [
        _through(ends, points, corners, point, quad, half)
        for point, quad in _near(ends[:, points], corners)
        for half in HALVES
    ]
    empty = (np.zeros(0, np.intp), np.zeros(0), np.zeros(0, bool), np.zeros((0, 3)), np.zeros(0, np.intp))
    whose, share, inwards, normal, quad = (np.concatenate(each) for each in zip(empty, *parts, strict=True))
    order = np.lexsort((share, whose))
    return _Hits(whose[order], share[order], inwards[order], normal[order], quad[order])


def _near(x: np.ndarray, corners: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Points (c,) of x (2, p, 3) and patches (c,) of corners (2, q, 4, 3) whose ways come near each other, in parts."""
    middle = corners.mean(axis=2)
    radius = np.linalg.norm(corners - middle[:, :, None], axis=3).max(axis=(0, 2))
    common = (x[1] - x[0]).mean(axis=0)
    half, halves = (np.linalg.norm(each[1] - each[0] - common, axis=1) / 2 for each in (x, middle))
    tree, far = cKDTree(middle.mean(axis=0)), half + np.max(radius + halves)
    for start in range(0, x.shape[1], AT_ONCE):
        part = slice(start, start + AT_ONCE)
        within = tree.query_ball_point(x[:, part].mean(axis=0), far[part])
        point = start + np.repeat(np.arange(len(within)), [len(each) for each in within])
        quad = np.concatenate([np.zeros(0, np.intp), *(np.asarray(each, np.intp) for each in within)])
        begin = x[0, point] - middle[0, quad]
        way = x[1, point] - middle[1, quad] - begin
        size = np.einsum("pc,pc->p", way, way)
        share = np.divide(-np.einsum("pc,pc->p", begin, way), size, out=np.zeros(len(size)), where=size > 0)
        closest = np.linalg.norm(begin + np.clip(share, 0, 1)[:, None] * way, axis=1)
        kept = closest <= radius[quad] * (1 + EDGE)
        yield point[kept], quad[kept]


def _through(
    ends: np.ndarray, points: np.ndarray, corners: np.ndarray, point: np.ndarray, quad: np.ndarray, half: list[int]
) -> tuple[np.ndarray, ...]:
    """The hits of pairs (c,) of a point and a patch, through one half of it, as arrays of :class:`_Hits`."""
    A, B, C = np.moveaxis(corners[:, quad][:, :, half], 2, 0)
    edges = np.stack([ends[:, points[point]] - A, B - A, C - A])  # (3, 2, c, 3)
    cubic = _cubic(edges[:, 0], edges[:, 1] - edges[:, 0])
    size = np.linalg.norm(edges[1:], axis=3).max(axis=(0, 1))
    which, share, inwards = _roots(cubic, AT_START * size**3)
    x, b, c = edges[:, 0, which] + share[:, None] * (edges[:, 1, which] - edges[:, 0, which])
    normal = np.cross(b, c)
    area = np.einsum("hc,hc->h", normal, normal)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.einsum("hc,hc->h", np.cross(x, c), normal) / area
        t = np.einsum("hc,hc->h", np.cross(b, x), normal) / area
        normal /= np.sqrt(area)[:, None]
    kept = (area > 0) & (s >= -EDGE) & (t >= -EDGE) & (s + t <= 1 + EDGE)
    which = which[kept]
    return point[which], share[kept], inwards[kept], normal[kept], quad[which]


def _cubic(start: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Coefficients (4, c) of x . b x c from that of s^0 on, of x, b, c = start + s way, (3, c, 3)."""

    def product(*which: int) -> np.ndarray:
        x, b, c = (way[i] if which[i] else start[i] for i in range(3))
        return np.asarray(np.einsum("pc,pc->p", x, np.cross(b, c)))

    one = product(1, 0, 0) + product(0, 1, 0) + product(0, 0, 1)
    two = product(1, 1, 0) + product(1, 0, 1) + product(0, 1, 1)
    return np.stack([product(0, 0, 0), one, two, product(1, 1, 1)])


def _roots(cubic: np.ndarray, noise: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whose (h,) cubics (4, c) change their sign, at which s in [0, 1], and whether to negative values.

    Between 0, its stationary points and 1 a cubic is monotonous. Values at 0 within the noise (c,) count as positive.
    """
    c0, c1, c2, c3 = cubic
    bernstein = np.stack([c0, c0 + c1 / 3, c0 + (2 * c1 + c2) / 3, cubic.sum(axis=0)])  # its values lie between these
    some = np.flatnonzero((bernstein.min(axis=0) < 0) & (bernstein.max(axis=0) > -noise))
    c0, c1, c2, c3 = cubic[:, some]
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(c2 + np.copysign(np.sqrt(np.maximum(c2**2 - 3 * c1 * c3, 0.0)), c2))
        turns = np.nan_to_num(np.stack([q / (3 * c3), c1 / q]), nan=0.0, posinf=0.0, neginf=0.0)
    knots = np.sort(np.concatenate([np.zeros((1, len(some))), np.clip(turns, 0, 1), np.ones((1, len(some)))]), axis=0)

    def value(s: np.ndarray, of: np.ndarray) -> np.ndarray:
        return np.asarray(((c3[of] * s + c2[of]) * s + c1[of]) * s + c0[of])

    every = np.arange(len(some))
    negative = np.stack([value(knot, every) < 0 for knot in knots])
    negative[0] = c0 < -noise[some]
    change, of = np.nonzero(negative[1:] != negative[:-1])
    low, high, inwards = knots[change, of], knots[change + 1, of], negative[change + 1, of]
    for _ in range(LEVELS):
        middle = (low + high) / 2
        beyond = (value(middle, of) < 0) == inwards
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return some[of], high, inwards


def _size(corners: np.ndarray) -> float:
    """The side [mm] of a square of the area of a patch (4, 3)."""
    return float(np.sqrt(np.linalg.norm(np.cross(corners[2] - corners[0], corners[3] - corners[1])) / 2))
