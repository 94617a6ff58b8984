"""Which patch of a face is closest to a point, and where: found anew for every position of both.

The closest point of the patch with the nearest middle leaves few others: those whose boxes come as near as that. A box
lies along its patch, and is as flat as that. Nothing is missed: no point of a patch is nearer than its box.
"""

from dataclasses import dataclass
from itertools import chain

import numpy as np
from scipy.spatial import cKDTree

from contact.faces.patches import ROUNDING, closest, frames, normals, shape

OVER = 1e-9  # of the size of a patch: a point that lies no farther beyond an edge lies over it
AT = 1e-7  # of the size of a patch: nearer to an edge or a corner than this, its own direction is rounding
BESIDE = 0.7  # cosine with the normal behind a face, up to which a point beyond an edge is beside it


@dataclass(frozen=True, eq=False)
class Nearest:
    """The closest point of a face for each of p points in space.

    quad (p,), xi (p, 2): where it is.  gap (p,) [mm]: the distance, negative behind the face.  direction (p, 3): its
    gradient, unit vectors.  a (p, 3, 2): tangents.  free (p, 2): whether the point lies over the patch along each
    coordinate, or else beyond its edge.  size (p,) [mm]: of the patch.
    """

    quad: np.ndarray
    xi: np.ndarray
    gap: np.ndarray
    direction: np.ndarray
    a: np.ndarray
    free: np.ndarray
    size: np.ndarray


def nearest(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> Nearest:
    """Of the face with these points (k, 3) and patches (q, 4) to the points x (p, 3)."""
    tree, every = cKDTree(positions[quads].mean(axis=1)), np.arange(len(x))
    guess = np.asarray(tree.query(x)[1], np.intp)
    first = _closest(x, positions[quads[guess]])
    point, quad = _near(x, positions, quads, tree, first[1])
    others = guess[point] != quad
    point, quad = point[others], quad[others]
    rest = _closest(x[point], positions[quads[quad]])
    xi, distance = (np.concatenate(both) for both in zip(first, rest, strict=True))
    point, quad = np.append(every, point), np.append(guess, quad)
    least = first[1].copy()
    np.minimum.at(least, point, distance)
    farther = distance > least[point] + ROUNDING * np.max(np.ptp(positions[quads], axis=1))
    order = np.lexsort((quad, farther, point))  # on an edge rounding must not say which of its patches it is
    best = order[np.diff(point[order], prepend=-1) > 0]
    return _measured(x, positions, quads, quad[best], xi[best])


def _closest(x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """xi (p, 2) on patches (p, 4, 3), and the distance (p,)."""
    xi = closest(x, corners)
    return xi, np.linalg.norm(x - np.einsum("pl,plc->pc", shape(xi)[0], corners), axis=1)


def _near(
    x: np.ndarray, positions: np.ndarray, quads: np.ndarray, tree: cKDTree, most: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (c,) of a point and a patch whose box is no farther from it than ``most`` (p,); tree: of their middles."""
    corners = positions[quads]
    middles, axes = corners.mean(axis=1), frames(corners)
    own = np.einsum("qlc,qci->qli", corners - middles[:, None], axes)
    low, high = own.min(axis=1), own.max(axis=1)
    radius = np.max(np.linalg.norm(corners - middles[:, None], axis=2))
    rounding = ROUNDING * max(np.max(np.abs(each), initial=0.0) for each in (x, positions))  # of coordinates, turned
    within = tree.query_ball_point(x, (most + radius) * (1 + OVER) + rounding)
    point = np.repeat(np.arange(len(x)), np.array([len(each) for each in within], np.intp))
    quad = np.fromiter(chain.from_iterable(within), np.intp, len(point))
    at = np.einsum("pc,pci->pi", x[point] - middles[quad], axes[quad])
    box = np.linalg.norm(np.maximum(np.maximum(low[quad] - at, at - high[quad]) - rounding, 0.0), axis=1)
    kept = box <= most[point] * (1 + OVER)
    return point[kept], quad[kept]


def _measured(x: np.ndarray, positions: np.ndarray, quads: np.ndarray, quad: np.ndarray, xi: np.ndarray) -> Nearest:
    corners = positions[quads[quad]]
    N, slope = shape(xi)
    a = np.einsum("pla,plc->pca", slope, corners)
    off = x - np.einsum("pl,plc->pc", N, corners)
    length = np.linalg.norm(a, axis=1)
    size = length.max(axis=1)
    free = np.abs(np.einsum("pc,pca->pa", off, a)) <= OVER * length * size[:, None]
    normal = np.cross(a[..., 0], a[..., 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    over = free.all(axis=1)
    if over.all():
        return Nearest(quad, xi, np.einsum("pc,pc->p", off, normal), normal, a, free, size)
    mean = np.einsum("pl,plc->pc", N, normals(positions, quads)[quads[quad]])
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    distance, along = np.linalg.norm(off, axis=1), np.einsum("pc,pc->p", off, mean)
    signed = np.where(along < -BESIDE * distance, -distance, distance)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = off / signed[:, None]
    direction = np.where((distance > AT * size)[:, None], own, mean)
    gap = np.where(over, np.einsum("pc,pc->p", off, normal), signed)
    return Nearest(quad, xi, gap, np.where(over[:, None], normal, direction), a, free, size)
