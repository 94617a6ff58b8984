"""Unit normals at the nodes of a mesh of quadrilaterals, from positions alone, within O(h^2) of a smooth surface.

Those of the triangles e_i x e_j of two edges at a node, weighted by 1/(|e_i|^2 |e_j|^2): on a sphere the mean is exact.
At the rim half of the triangles are missing: there n is at right angles to the tangent of the rim, and along the edge c
to a node inside it has the component of an arc, whose normals at both ends of c have opposite ones, n.c = -n_inside.c;
at a corner of a single element along both of its edges. Source: Max, Journal of Graphics Tools 4 (1999) 1-6.
"""

import numpy as np

from formulations.geometry.quad_cuts import edges_of, rim_tangents

SMOOTH = 45.0  # degrees between two edges of the rim, above which it has no tangent


def nodal_normals(x: np.ndarray, elements: np.ndarray, given: np.ndarray, known: np.ndarray) -> np.ndarray:
    """(N, 3) from positions x (N, 3) and elements (E, 4); given (N, 3) stay where they are known (N,) bool.

    A node whose triangles cancel has the normal 0.
    """
    onwards, back = (np.roll(x[elements], -k, axis=1) - x[elements] for k in (1, -1))
    weight = np.sum(onwards**2, axis=-1) * np.sum(back**2, axis=-1)
    total = np.zeros_like(x)
    np.add.at(total, elements, np.cross(onwards, back) / weight[..., None])
    normals = np.where(known[:, None], given, _unit(total))
    ends, sides = edges_of(elements)
    rim = np.zeros(len(x), bool)
    alone = np.bincount(sides.ravel(), minlength=len(ends)) == 1
    rim[ends[alone]] = True
    both = np.concatenate([ends[~alone], ends[~alone, ::-1]])  # an edge of the rim is along its tangent
    inwards = both[(rim & ~known)[both[:, 0]] & (~rim | known)[both[:, 1]]]
    single = np.bincount(elements.ravel(), minlength=len(x)) == 1
    turned = np.zeros_like(x)
    at, inside = inwards[~single[inwards[:, 0]]].T
    tangent = _unit(rim_tangents(x, elements, SMOOTH)[at])
    np.add.at(turned, at, _as_on_an_arc(normals[at], x[inside] - x[at], normals[inside], tangent))
    normals[at] = _unit(turned[at])
    element, corner = np.nonzero((single & ~known)[elements])
    at = elements[element, corner]
    for _ in range(2):  # the components along both edges, which are not at right angles
        for step in (1, -1):
            beside = elements[element, (corner + step) % 4]
            seen = ~single[beside] | known[beside]
            one, other = at[seen], beside[seen]
            normals[one] = _as_on_an_arc(normals[one], x[other] - x[one], normals[other], np.zeros((len(one), 3)))
    return normals


def _as_on_an_arc(n: np.ndarray, chord: np.ndarray, inside: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Unit n (k, 3), its component along the chord that of an arc with the normal ``inside`` at its other end.

    tangent: unit vectors, or 0, to which it is at right angles then.
    """
    n = n - np.sum(n * tangent, axis=-1, keepdims=True) * tangent
    away = chord - np.sum(chord * tangent, axis=-1, keepdims=True) * tangent
    c = _unit(away)
    across = n - np.sum(n * c, axis=-1, keepdims=True) * c
    sine = -np.sum(inside * chord, axis=-1, keepdims=True) / np.linalg.norm(away, axis=-1, keepdims=True)
    sine = np.clip(sine, -1.0, 1.0)
    return np.asarray(sine * c + np.sqrt(1 - sine**2) * _unit(across))


def _unit(x: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(x, axis=-1, keepdims=True)
    return np.asarray(x / np.where(length > 0, length, 1.0))
