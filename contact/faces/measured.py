"""Distances to a face and slips along it measured anew, for the judge: nothing of what poses the problem is used.

A bilinear patch is a family of straight segments. The closest point of one is a quotient; over the family the distance
is narrowed by golden sections, from the best of SAMPLES. The patches looked at are those whose boxes come as near as
the nearest corner of any, and of them those that come as near as any between samples, at the speed of their segments.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

SAMPLES = (3, 17)
CLOSE = 1e-9  # of a distance: as near
SECTIONS = 70  # of an interval of 2/SAMPLES, down to the last digit
ASIDE = 1e-4  # of a patch, for a slope by differences
GOLDEN = (np.sqrt(5.0) - 1) / 2
BEHIND = -0.7  # cosine with the normal from which on a point is behind the face; else it is before or beside it
AT_ONCE = 10_000_000  # entries of an array


def distances(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Signed distances (p,) of points x (p, 3) from a face of points (k, 3) and patches (q, 4), negative behind it."""
    off, normal, _ = feet(x, positions, quads)
    return _signed(off, normal)


def curved_distances(
    x: np.ndarray, positions: np.ndarray, quads: np.ndarray, both: Edges, place: np.ndarray
) -> np.ndarray:
    """Those (p,) of the curved faces, from points of the slave at ``place`` (p, 3), its patch, or -1, and xi there.

    both: of the slave and, after it, of the face itself.
    """
    off, normal, at = feet(x, positions, quads)
    at[:, 0] += len(both.patches) - len(quads)
    return _signed(off, normal) - _raised(positions, both, np.concatenate([at, place])).reshape(2, -1).sum(axis=0)


class Edges(Protocol):
    """What says how curved faces are, :class:`contact.faces.bulges.Bulges`."""

    @property
    def patches(self) -> np.ndarray:
        """(q, 4)."""

    @property
    def share(self) -> np.ndarray:
        """Of the normals at both ends of their edges (2, q, 4)."""

    @property
    def ways(self) -> np.ndarray:
        """Projections of normals (k, 3, 3)."""


def _raised(positions: np.ndarray, face: Edges, place: np.ndarray) -> np.ndarray:
    """How far (p,) a curved face lies before its patches at places (p, 3): by the points in the middle of edges.

    Their heights are those of parabolas with the normals at both ends, and between them the shape functions of eight
    nodes. Normals by unit vectors along the edges.
    """
    corners, normal = positions[face.patches], np.zeros_like(positions)
    for i in range(4):
        ahead, behind = (corners[:, (i + step) % 4] - corners[:, i] for step in (1, -1))
        by = np.sum(ahead**2, axis=1) * np.sum(behind**2, axis=1)
        np.add.at(normal, face.patches[:, i], np.cross(ahead, behind) / by[:, None])
    normal = np.squeeze(face.ways @ normal[:, :, None], axis=2)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), np.finfo(float).tiny)
    inside = place[:, 0] >= 0
    quad, (first, second) = place[inside, 0].astype(np.intp), place[inside, 1:].T
    low, high = (1 - first**2) * (1 - second), (1 - first**2) * (1 + second)
    left, right = (1 - second**2) * (1 - first), (1 - second**2) * (1 + first)
    raised = np.zeros(len(place))
    for i, function in enumerate((low, right, high, left)):
        start, end = face.patches[quad, i], face.patches[quad, (i + 1) % 4]
        before, after = (share[quad, i, None] for share in face.share)
        turned = after * normal[end] - before * normal[start]
        raised[inside] += function / 8 * np.sum((positions[end] - positions[start]) * turned, axis=1)
    return raised


def _signed(off: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Distances (p,) by where their feet lie (p, 3), negative behind normals (p, 3)."""
    least, along = np.linalg.norm(off, axis=1), np.einsum("pc,pc->p", off, normal)
    return np.where(along < BEHIND * least, -least, least)


def feet(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From the closest points of the face to x (p, 3), the unit normals there, and where: patch and xi, (p, 3) each."""
    corners = positions[quads]
    size = max(1, AT_ONCE // (3 * max(1, len(quads))))
    parts = [_some(x[i : i + size], corners) for i in range(0, len(x), size)]
    off, normal, place = zip((np.zeros((0, 3)),) * 3, *parts, strict=True)
    return np.concatenate(off), np.concatenate(normal), np.concatenate(place)


def _some(x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    point, quad = _within_boxes(x, corners)
    for count in SAMPLES:
        at, patch, tried = x.T[:, point], _apart(corners[quad]), np.linspace(-1, 1, count)
        far = np.stack([_far(at, patch, np.full(len(point), t)) for t in tried])
        speed = np.max(np.linalg.norm(patch[[1, 2]] - patch[[0, 3]], axis=1), axis=0) / 2
        kept = far.min(axis=0) - speed / (count - 1) <= _least(far.min(axis=0), point, len(x))[point] * (1 + CLOSE)
        point, quad, far = point[kept], quad[kept], far[:, kept]
    at, patch, best = x.T[:, point], _apart(corners[quad]), np.argmin(far, axis=0)
    t = _narrowed(at, patch, tried[np.maximum(best - 1, 0)], tried[np.minimum(best + 1, count - 1)])
    ts = np.stack([t, np.full(len(point), -1.0), np.ones(len(point))])
    offs = np.stack([_off(at, patch, each).T for each in ts])
    best, every = np.argmin(np.linalg.norm(offs, axis=2), axis=0), np.arange(len(point))
    off, t = offs[best, every], ts[best, every]
    distance = np.linalg.norm(off, axis=1)
    least = _least(distance, point, len(x))
    ties = distance <= least[point] * (1 + CLOSE) + 1e-12 * np.ptp(corners)
    normal = np.zeros_like(x)
    np.add.at(normal, point[ties], _normal(corners[quad[ties]]))
    first = np.flatnonzero(distance == least[point])
    off_of, place = np.zeros((2, *x.shape))
    off_of[point[first]] = off[first]
    t = _polished(at, patch, t)
    place[point[first]] = np.column_stack([quad, t, 2 * _share(at, patch, t)[0] - 1])[first]
    return off_of, normal / np.linalg.norm(normal, axis=1, keepdims=True), place


def _apart(corners: np.ndarray) -> np.ndarray:
    """Patches (p, 4, 3) as (4, 3, p)."""
    return np.ascontiguousarray(np.moveaxis(corners, 0, -1))


def _within_boxes(x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (c,) of a point and a patch that may be the closest: no corner of any is nearer than its box."""
    low, high = corners.min(axis=1).T, corners.max(axis=1).T
    outside, nearest = np.zeros((2, len(x), len(corners)))
    for own, lower, upper, first in zip(x.T, low, high, corners[:, 0].T, strict=True):
        at = own[:, None]
        outside += np.maximum(np.maximum(lower - at, at - upper), 0.0) ** 2
        nearest += (at - first) ** 2
    point, quad = np.nonzero(outside <= nearest.min(axis=1)[:, None] * (1 + CLOSE))
    return point, quad


def _least(distance: np.ndarray, point: np.ndarray, count: int) -> np.ndarray:
    """Of each point (count,)."""
    least = np.full(count, np.inf)
    np.minimum.at(least, point, distance)
    return least


def _narrowed(x: np.ndarray, corners: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The t (p,) between a and b (p,) that is closest: each section has one point in common with the last."""
    c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_c, at_d = _far(x, corners, c), _far(x, corners, d)
    for _ in range(SECTIONS):
        lower = at_c < at_d
        a, b = np.where(lower, a, c), np.where(lower, d, b)
        new = np.where(lower, b - GOLDEN * (b - a), a + GOLDEN * (b - a))
        at_new = _far(x, corners, new)
        c, d = np.where(lower, new, d), np.where(lower, c, new)
        at_c, at_d = np.where(lower, at_new, at_d), np.where(lower, at_c, at_new)
    return np.where(at_c < at_d, c, d)


def _polished(x: np.ndarray, corners: np.ndarray, t: np.ndarray) -> np.ndarray:
    """The same t (p,) to all digits: at the least distance half of them do not change it, but its slope."""

    def slope(at: np.ndarray) -> np.ndarray:
        share, off, way = _share(x, corners, at)
        side = (1 - share) * (corners[1] - corners[0]) + share * (corners[2] - corners[3])
        return np.asarray(np.sum((off - share * way) * side, axis=0))

    here, ahead = slope(t), slope(t + ASIDE) - slope(t - ASIDE)
    step = np.divide(-2 * ASIDE * here, ahead, out=np.zeros_like(t), where=(np.abs(t) < 1) & (ahead != 0))
    return np.where(np.abs(step) < ASIDE, np.clip(t + step, -1.0, 1.0), t)


def _far(x: np.ndarray, corners: np.ndarray, t: np.ndarray) -> np.ndarray:
    """How far (p,) points x (3, p) are from the segments at t (p,) of patches (4, 3, p)."""
    return np.sqrt(np.sum(_off(x, corners, t) ** 2, axis=0))


def _off(x: np.ndarray, corners: np.ndarray, t: np.ndarray) -> np.ndarray:
    """From the closest point of the segment at t (p,) of patches (4, 3, p) to x (3, p)."""
    share, off, way = _share(x, corners, t)
    return np.asarray(off - share * way)


def _share(x: np.ndarray, corners: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far along the segment that point lies (p,), x less where it starts, and the segment (3, p)."""
    low, high = (1 - t) / 2, (1 + t) / 2
    start, end = low * corners[0] + high * corners[1], low * corners[3] + high * corners[2]
    way, off = end - start, x - start
    share = np.sum(off * way, axis=0) / np.sum(way * way, axis=0)
    return np.clip(share, 0.0, 1.0), off, way


def _normal(corners: np.ndarray) -> np.ndarray:
    """Unit normals (p, 3) of patches by their diagonals."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def slips(x: np.ndarray, positions: np.ndarray, quads: np.ndarray, anchors: np.ndarray) -> np.ndarray:
    """Slips (m, 2) of points x (m, 3) from material points (patch, xi_1, xi_2) (m, 3) of a face, along a_1 and across.

    Material points by interpolation along two edges and between them, unit tangents by an orthogonal triangularisation.
    """
    corners = positions[quads[anchors[:, 0].astype(np.intp)]]
    first, second = (anchors[:, 1:] + 1).T[:, :, None] / 2
    low, high, left, right = (
        corners[:, i] + share * (corners[:, j] - corners[:, i])
        for i, j, share in ((0, 1, first), (3, 2, first), (0, 3, second), (1, 2, second))
    )
    Q, R = np.linalg.qr(np.stack([right - left, high - low], axis=2))
    off = x - low - second * (high - low)
    return np.asarray(np.einsum("pca,pc,pa->pa", Q, off, np.sign(np.einsum("paa->pa", R))))
