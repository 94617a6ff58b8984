"""Distances to a face and slips along it measured anew, for the judge: nothing of what poses the problem is used.

A bilinear patch is a family of straight segments. The closest point of one is a quotient; over the family the distance
is narrowed by golden sections, from the best of SAMPLES. The patches looked at are those whose boxes come as near as
the nearest corner of any.
"""

from __future__ import annotations

import numpy as np

SAMPLES = 17
SECTIONS = 70  # of an interval of 2/SAMPLES, down to the last digit
GOLDEN = (np.sqrt(5.0) - 1) / 2
BEHIND = -0.7  # cosine with the normal from which on a point is behind the face; else it is before or beside it
AT_ONCE = 10_000_000  # entries of an array


def distances(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Signed distances (p,) of points x (p, 3) from a face of points (k, 3) and patches (q, 4), negative behind it."""
    off, normal = feet(x, positions, quads)
    least, along = np.linalg.norm(off, axis=1), np.einsum("pc,pc->p", off, normal)
    return np.where(along < BEHIND * least, -least, least)


def feet(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From the closest points of the face to x (p, 3), and the unit normals there, both (p, 3)."""
    corners = positions[quads]
    size = max(1, AT_ONCE // (3 * max(1, len(quads))))
    parts = [_some(x[i : i + size], corners) for i in range(0, len(x), size)]
    off, normal = zip((np.zeros((0, 3)),) * 2, *parts, strict=True)
    return np.concatenate(off), np.concatenate(normal)


def _some(x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    low, high = corners.min(axis=1), corners.max(axis=1)
    outside = np.maximum(np.maximum(low - x[:, None], x[:, None] - high), 0.0)
    nearest = np.min(np.linalg.norm(x[:, None] - corners[:, 0], axis=2), axis=1)
    point, quad = np.nonzero(np.linalg.norm(outside, axis=2) <= nearest[:, None] * (1 + 1e-9))
    at, patch = x[point], corners[quad]
    tried = np.linspace(-1, 1, SAMPLES)
    far = np.stack([np.linalg.norm(_off(at, patch, np.full(len(at), t)), axis=1) for t in tried], axis=1)
    best = np.argmin(far, axis=1)
    a, b = tried[np.maximum(best - 1, 0)], tried[np.minimum(best + 1, SAMPLES - 1)]
    for _ in range(SECTIONS):
        c, d = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
        lower = np.linalg.norm(_off(at, patch, c), axis=1) < np.linalg.norm(_off(at, patch, d), axis=1)
        a, b = np.where(lower, a, c), np.where(lower, d, b)
    ends = np.stack([a, b, np.full(len(a), -1.0), np.ones(len(a))])
    offs = np.stack([_off(at, patch, t) for t in ends])
    off = offs[np.argmin(np.linalg.norm(offs, axis=2), axis=0), np.arange(len(at))]
    distance = np.linalg.norm(off, axis=1)
    least = np.full(len(x), np.inf)
    np.minimum.at(least, point, distance)
    ties = distance <= least[point] * (1 + 1e-9) + 1e-12 * np.ptp(corners)
    normal = np.zeros_like(x)
    np.add.at(normal, point[ties], _normal(patch[ties]))
    first = np.flatnonzero(distance == least[point])
    off_of = np.zeros_like(x)
    off_of[point[first]] = off[first]
    return off_of, normal / np.linalg.norm(normal, axis=1, keepdims=True)


def _off(x: np.ndarray, corners: np.ndarray, t: np.ndarray) -> np.ndarray:
    """From the closest point of the segment at t (p,) of patches (p, 4, 3) to x (p, 3)."""
    low, high = (1 - t)[:, None] / 2, (1 + t)[:, None] / 2
    start, end = low * corners[:, 0] + high * corners[:, 1], low * corners[:, 3] + high * corners[:, 2]
    way = end - start
    share = np.einsum("pc,pc->p", x - start, way) / np.einsum("pc,pc->p", way, way)
    return np.asarray(x - start - np.clip(share, 0.0, 1.0)[:, None] * way)


def _normal(corners: np.ndarray) -> np.ndarray:
    """Unit normals (p, 3) of patches by their diagonals."""
    found = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


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
