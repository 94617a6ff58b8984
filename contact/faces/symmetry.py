"""Points that supports hold along one direction, as in a plane of symmetry, and the edges in which faces end there.

Facets of a curved face are seldom at right angles to such a plane: the perpendicular to one from a point in the plane
that is off the facet by h meets it beside the plane, by h times the sine of the angle that is missing. A point in a
plane of symmetry slides in it, over the edge in which the face meets it.
"""

import numpy as np
from scipy import sparse

NO_WAY = 1e-7  # of the others: a way that supports leave nothing of; its square is above the rounding of a product
IN_PLANE = 1e-9  # of the size of a patch: a corner that is no farther from a plane lies in it
EDGES = [[0, 3], [1, 2], [0, 1], [3, 2]]  # corners of a patch at xi_1 = -1 and 1, and at xi_2 = -1 and 1
PLACES = np.array(EDGES + [[c, c] for c in range(4)])  # edges before corners


def motions(moves: sparse.csr_matrix) -> np.ndarray:
    """A A^T (p, 3, 3) of points that move by A = dx/du (3, n) each; moves (3p, n)."""
    rows = [sparse.csr_matrix(moves[i::3]) for i in range(3)]
    return np.stack([[np.asarray(a.multiply(b).sum(axis=1)).ravel() for a in rows] for b in rows]).T


def held_along(gram: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (p, 3, 3), as columns, and along how many of them (p,), the first ones, points cannot move.

    gram (p, 3, 3): of :func:`motions`.
    """
    sizes, axes = np.linalg.eigh(gram)
    return axes, np.sum(sizes <= NO_WAY**2 * sizes[:, -1:], axis=1)


def ends_in_planes(
    points: np.ndarray, x: np.ndarray, moves: sparse.csr_matrix, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Which (e,) of the points (p,) are in a plane, and the ends (e, 2) of the edge of their patch that is in it, too.

    x (k, 3): all points at rest.  moves (3k, n): dx/du.  corners (p, 4): of the patch of each; ends are among 0 to 3.
    A corner is in a plane if it is there at rest and moves in it alone. Of a point in two planes that cross, as where
    rims are held, it may be one corner, which both ends are then.
    """
    gram = motions(moves)
    axes, held = held_along(gram[points])
    P = axes * (np.arange(3) < held[:, None])[:, None]
    off = np.linalg.norm(np.einsum("pca,plc->pla", P, x[corners] - x[points][:, None]), axis=2)
    size = np.max(np.ptp(x[corners], axis=1), axis=1)[:, None]
    out, every = np.einsum("pca,plcd,pda->pl", P, gram[corners], P), np.trace(gram[corners], axis1=2, axis2=3)
    inside = (off <= IN_PLANE * size) & (out <= NO_WAY**2 * every)
    held_there = inside[:, PLACES].all(axis=2)
    held_there[held != 2, len(EDGES) :] = False
    which = np.flatnonzero(held_there.any(axis=1) & (held > 0) & (held < 3))
    return which, PLACES[np.argmax(held_there[which], axis=1)]
