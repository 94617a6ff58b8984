"""A mesh of quadrilaterals cut in n x n on the curved surface that its positions and nodal normals define.

Edges are cubics from P0 to P1, with unit directions d of the chord c = P1 - P0 laid into the tangent planes::

    C(s) = H00 P0 + H10 T0 + H01 P1 + H11 T1,    T_i = 2 |c| d_i/(1 + d_i.c/|c|)

which meets the middle of an arc of a circle, and so is within O(h^4) of a smooth surface where the normals are. Where
the rim of a mesh goes on smoothly, d is the tangent of the circle through three of its nodes. Between its edges a
quadrilateral is their bilinear blend, within O(h^4), too, beside a rim that curves within the surface within O(h^3).
Its normals are those of that blend, an order less, on an edge the mean of both sides; nodes of the mesh keep theirs.
Meshes of all n have their nodes on one surface.
Source: Coons, MIT Project MAC TR-41 (1967); Farin, Curves and Surfaces for CAGD (1990), ch. 20.

Unit normals at the nodes of a mesh of quadrilaterals, from positions alone, within O(h^2) of a smooth surface.

Those of the triangles e_i x e_j of two edges at a node, weighted by 1/(|e_i|^2 |e_j|^2): on a sphere the mean is exact.
At the rim half of the triangles are missing: there n is at right angles to the tangent of the rim, and along the edge c
to a node inside it has the component of an arc, whose normals at both ends of c have opposite ones, n.c = -n_inside.c;
at a corner, in the mean of squares, those along all of its edges.
Source: Max, Journal of Graphics Tools 4 (1999) 1-6.
"""

from dataclasses import dataclass

import numpy as np

LEAST = 1e-9  # of a chord: what is left of it in a tangent plane, below which it has no direction there
BLEND = ((0, 1), (3, 2), (0, 3), (1, 2))  # corners that the edges v = 0, v = 1, u = 0, u = 1 lead from and to
SIDES = (0, 2, 3, 1)  # of the element, that these are


@dataclass(frozen=True, eq=False)
class QuadCuts:
    """middle, normals (M, 3): those of the mesh first.  elements (E n^2, 4), those of one quadrilateral in a row.

    around (M, 4): the nodes of the mesh that a node lies between, shares (M, 4): its bilinear coordinates there.
    """

    middle: np.ndarray
    normals: np.ndarray
    elements: np.ndarray
    around: np.ndarray
    shares: np.ndarray


def cut(middle: np.ndarray, normals: np.ndarray, elements: np.ndarray, n: int, smooth_deg: float) -> QuadCuts:
    """middle, normals (N, 3), elements (E, 4) that go round about the normals; each in n x n.

    smooth_deg: largest angle between two edges of the rim that go on smoothly.
    """
    ends, sides = edges_of(elements)
    rim = np.bincount(sides.ravel(), minlength=len(ends)) == 1
    curves = _curves(middle, normals, ends, rim, rim_tangents(middle, elements, smooth_deg))
    numbers = _numbers(elements, ends, sides, len(middle), n)
    at = np.arange(n + 1) / n
    u, v = np.meshgrid(at, at, indexing="ij")
    x, across = _blends(middle, elements, ends, sides, curves, at)
    places, M = numbers.reshape(-1), numbers.max() + 1
    places_of_all = np.empty((M, 3))
    places_of_all[places] = x.reshape(-1, 3)
    places_of_all[: len(middle)] = middle
    total = np.zeros((M, 3))
    np.add.at(total, places, across.reshape(-1, 3))
    directions = unit(total)
    directions[: len(middle)] = normals
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1)
    around, shares = np.empty((M, 4), np.intp), np.empty((M, 4))
    around[places] = np.repeat(elements, (n + 1) ** 2, axis=0)
    shares[places] = np.broadcast_to(weights, (len(elements), *weights.shape)).reshape(-1, 4)
    cells = np.stack([numbers[:, :-1, :-1], numbers[:, 1:, :-1], numbers[:, 1:, 1:], numbers[:, :-1, 1:]], axis=-1)
    return QuadCuts(places_of_all, directions, cells.reshape(-1, 4), around, shares)


def edges_of(elements: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both nodes of all edges, the lower number first (K, 2), and the edge of every side of an element (E, 4)."""
    pairs = np.sort(np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    ends, sides = np.unique(pairs, axis=0, return_inverse=True)
    return ends, sides.reshape(-1, 4)


def _curves(
    middle: np.ndarray, normals: np.ndarray, ends: np.ndarray, rim: np.ndarray, tangents: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """T0 and T1 (K, 3) of all edges, from the lower number to the higher."""
    chord = middle[ends[:, 1]] - middle[ends[:, 0]]
    length = np.linalg.norm(chord, axis=-1, keepdims=True)
    along = np.repeat((chord / length)[:, None], 2, axis=1)  # (K, 2, 3)
    along[rim] = _along_rim(tangents[ends[rim]], along[rim, 0])
    n = normals[ends]
    laid = along - np.sum(along * n, axis=-1, keepdims=True) * n
    size = np.linalg.norm(laid, axis=-1, keepdims=True)
    direction = np.where(size > LEAST, laid / np.maximum(size, LEAST), along)
    cosine = np.sum(direction * (chord / length)[:, None], axis=-1, keepdims=True)
    both = 2 * length[:, None] * direction / (1 + np.maximum(cosine, 0.0))
    return both[:, 0], both[:, 1]


def rim_tangents(x: np.ndarray, elements: np.ndarray, smooth_deg: float) -> np.ndarray:
    """(N, 3) at positions x (N, 3): tangents of the rim, along it as the elements go round; 0 inside and at corners.

    Of the circle through a node and its neighbours on the rim, of inverse length.  smooth_deg: of the largest turn.
    """
    ends, sides = edges_of(elements)
    alone = np.bincount(sides.ravel(), minlength=len(ends))[sides] == 1
    first, last = elements[alone], np.roll(elements, -1, axis=1)[alone]
    chord = x[last] - x[first]
    before, behind = np.zeros_like(x), np.zeros_like(x)
    before[last] = behind[first] = chord / np.sum(chord**2, axis=-1, keepdims=True)
    size = np.linalg.norm(before, axis=-1) * np.linalg.norm(behind, axis=-1)
    smooth = np.sum(before * behind, axis=-1) >= np.cos(np.radians(smooth_deg)) * size
    smooth &= np.bincount(first, minlength=len(x)) == 1
    return np.where(smooth[:, None], before + behind, 0.0)


def _along_rim(tangents: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Unit directions (k, 2, 3) at both ends of edges of the rim, from its tangents there and those of the chords.

    At a corner of the rim the edge is an arc of the circle that its other end has, between two corners it is straight.
    """
    along = direction[:, None]
    length = np.linalg.norm(tangents, axis=-1, keepdims=True)
    known = length > 0
    unit = tangents / np.where(known, length, 1.0)
    unit = np.where(np.sum(unit * along, axis=-1, keepdims=True) < 0, -unit, unit)
    mirrored = 2 * np.sum(unit * along, axis=-1, keepdims=True) * along - unit
    return np.where(known, unit, np.where(known[:, ::-1], mirrored[:, ::-1], along))


def _hermite(
    ends: tuple[np.ndarray, np.ndarray], tangents: tuple[np.ndarray, np.ndarray], s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """C(s) and its derivative (E, k, 3) of curves with P0, P1, T0, T1 (E, 3) at s (k,)."""
    value = np.stack([(1 + 2 * s) * (1 - s) ** 2, s**2 * (3 - 2 * s), s * (1 - s) ** 2, s**2 * (s - 1)])
    slope = np.stack([6 * s * (s - 1), 6 * s * (1 - s), (1 - s) * (1 - 3 * s), s * (3 * s - 2)])
    points = np.stack([*ends, *tangents], axis=1)
    return np.einsum("ck,ecx->ekx", value, points), np.einsum("ck,ecx->ekx", slope, points)


def _blends(
    middle: np.ndarray,
    elements: np.ndarray,
    ends: np.ndarray,
    sides: np.ndarray,
    curves: tuple[np.ndarray, np.ndarray],
    s: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions and unit normals (E, k, k, 3) at all pairs of s (k,), along the first side and along the last."""
    bounds = []
    for (a, b), side in zip(BLEND, SIDES, strict=True):
        edge, first, last = sides[:, side], elements[:, a], elements[:, b]
        forwards = (ends[edge, 0] == first)[:, None]
        tangents = (
            np.where(forwards, curves[0][edge], -curves[1][edge]),
            np.where(forwards, curves[1][edge], -curves[0][edge]),
        )
        bounds.append(_hermite((middle[first], middle[last]), tangents, s))
    (low, low_u), (high, high_u), (left, left_v), (right, right_v) = bounds
    low, low_u, high, high_u = (each[:, :, None] for each in (low, low_u, high, high_u))
    left, left_v, right, right_v = (each[:, None] for each in (left, left_v, right, right_v))
    u, v = s[:, None, None], s[None, :, None]
    p00, p10, p11, p01 = (middle[elements[:, corner]][:, None, None] for corner in range(4))
    flat = (1 - u) * ((1 - v) * p00 + v * p01) + u * ((1 - v) * p10 + v * p11)
    x = (1 - v) * low + v * high + (1 - u) * left + u * right - flat
    x_u = (1 - v) * low_u + v * high_u + right - left - (1 - v) * (p10 - p00) - v * (p11 - p01)
    x_v = high - low + (1 - u) * left_v + u * right_v - (1 - u) * (p01 - p00) - u * (p11 - p10)
    return x, unit(np.cross(x_u, x_v))


def _numbers(elements: np.ndarray, ends: np.ndarray, sides: np.ndarray, n_nodes: int, n: int) -> np.ndarray:
    """Numbers (E, n + 1, n + 1) of all nodes: those of the mesh, then those on edges, then those inside."""
    numbers = np.empty((len(elements), n + 1, n + 1), np.intp)
    numbers[:, [0, n, n, 0], [0, 0, n, n]] = elements
    inner = np.arange(n - 1)
    places = numbers[:, 1:n, 0], numbers[:, 1:n, n], numbers[:, 0, 1:n], numbers[:, n, 1:n]
    for (a, _), side, place in zip(BLEND, SIDES, places, strict=True):
        edge = sides[:, side]
        forwards = (ends[edge, 0] == elements[:, a])[:, None]
        place[...] = n_nodes + edge[:, None] * (n - 1) + np.where(forwards, inner, inner[::-1])
    inside = n_nodes + len(ends) * (n - 1) + np.arange(len(elements) * (n - 1) ** 2)
    numbers[:, 1:n, 1:n] = inside.reshape(-1, n - 1, n - 1)
    return numbers


def unit(x: np.ndarray) -> np.ndarray:
    """Vectors (..., k) of length 1."""
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


SMOOTH = 45.0  # degrees between two edges of the rim, above which it has no tangent
TURNS = 4  # of Newton's method for a normal, from O(h) on
PARALLEL = 1e-6  # sine squared of the angle between edges that have one direction


def nodal_normals(x: np.ndarray, elements: np.ndarray, given: np.ndarray, known: np.ndarray) -> np.ndarray:
    """(N, 3) from positions x (N, 3) and elements (E, 4); given (N, 3) stay where they are known (N,) bool.

    A node whose triangles cancel has the normal 0.
    """
    onwards, back = (np.roll(x[elements], -k, axis=1) - x[elements] for k in (1, -1))
    weight = np.sum(onwards**2, axis=-1) * np.sum(back**2, axis=-1)
    total = np.zeros_like(x)
    np.add.at(total, elements, np.cross(onwards, back) / weight[..., None])
    normals = np.where(known[:, None], given, _unit_or_none(total))
    ends, sides = edges_of(elements)
    rim = np.zeros(len(x), bool)
    alone = np.bincount(sides.ravel(), minlength=len(ends)) == 1
    rim[ends[alone]] = True
    tangents = _unit_or_none(rim_tangents(x, elements, SMOOTH))
    single = np.bincount(elements.ravel(), minlength=len(x)) == 1
    sought = rim & ~known & normals.any(axis=1)
    corner = sought & (single | ~tangents.any(axis=1))
    both = np.concatenate([ends[~alone], ends[~alone, ::-1]])  # an edge of the rim is along its tangent
    at, inside = both[(sought & ~corner)[both[:, 0]] & (~rim | known)[both[:, 1]]].T
    turned = np.zeros_like(x)
    np.add.at(turned, at, _as_on_an_arc(normals[at], x[inside] - x[at], normals[inside], tangents[at]))
    normals[at] = unit(turned[at])
    return _at_corners(x, ends, normals, corner)


def _unit_or_none(x: np.ndarray) -> np.ndarray:
    """Vectors (..., k) of length 1, and 0 where they are."""
    length = np.linalg.norm(x, axis=-1, keepdims=True)
    return np.asarray(x / np.where(length > 0, length, 1.0))


def _at_corners(x: np.ndarray, ends: np.ndarray, normals: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """The normals (N, 3) with those of corners (N,) bool such that n.c = -n_beside.c, in the mean of squares over all
    edges c/|c| to nodes beside them that are not corners. Newton's method in the tangent plane.
    """
    both = np.concatenate([ends, ends[:, ::-1]])
    at, beside = both[corner[both[:, 0]] & ~corner[both[:, 1]]].T
    chord = unit(x[beside] - x[at])
    for _ in range(TURNS):
        n = normals[at]
        laid = chord - np.sum(chord * n, axis=-1, keepdims=True) * n
        missing = -np.sum((n + normals[beside]) * chord, axis=-1, keepdims=True)
        matrix, right = np.zeros((len(x), 3, 3)), np.zeros_like(x)
        np.add.at(matrix, at, laid[:, :, None] * laid[:, None])
        np.add.at(right, at, missing * laid)
        turn = np.linalg.pinv(matrix[corner], rcond=PARALLEL, hermitian=True) @ right[corner, :, None]
        normals[corner] = _unit_or_none(normals[corner] + turn[..., 0])
    return normals


def _as_on_an_arc(n: np.ndarray, chord: np.ndarray, inside: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Unit n (k, 3), its component along the chord that of an arc with the normal ``inside`` at its other end.

    tangent: unit vectors, or 0, to which it is at right angles then.
    """
    n = n - np.sum(n * tangent, axis=-1, keepdims=True) * tangent
    away = chord - np.sum(chord * tangent, axis=-1, keepdims=True) * tangent
    c = unit(away)
    across = n - np.sum(n * c, axis=-1, keepdims=True) * c
    sine = -np.sum(inside * chord, axis=-1, keepdims=True) / np.linalg.norm(away, axis=-1, keepdims=True)
    sine = np.clip(sine, -1.0, 1.0)
    return np.asarray(sine * c + np.sqrt(1 - sine**2) * unit(across))
