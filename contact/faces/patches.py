"""Bilinear patches: their points, and the closest one to a point in space. No contact condition enters here.

X(xi) = sum_l N_l(xi) X_l with corners (4, 3) in the order (-1, -1), (1, -1), (1, 1), (-1, 1), and a_1 x a_2 out of the
body whose face they make.
"""

import numpy as np

CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
STEPS = 60  # of Newton's method, most points need four
HALVINGS = 8
CLOSE = 1e-12  # change of xi at which it ends, times the distance over the size of the patch where that is larger
ROUNDING = 1e-13  # of the size of a patch: distances no longer than that are alike


def shape(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """N (p, 4) and dN/dxi (p, 4, 2) at xi (p, 2)."""
    one = 1 + xi[:, None, :] * CORNERS
    slope = CORNERS * one[..., ::-1] / 4
    return one[..., 0] * one[..., 1] / 4, slope


def twist() -> np.ndarray:
    """d2N/dxi1 dxi2 (4,), the only second derivative."""
    return CORNERS.prod(axis=1) / 4


def closest(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The xi (p, 2) in [-1, 1]^2 that minimise |x - X(xi)|^2/2 for points x (p, 3) and patches (p, 4, 3).

    Newton on the coordinates that no bound holds, Gauss-Newton where the Hessian is not definite, steps halved until
    the distance falls. A patch may be so twisted that it has more than one minimum: it is sought from the middle.
    """
    xi, todo = np.zeros((2, len(x))), np.arange(len(x))
    from_middle, sides = _polynomial(x, corners)
    for _ in range(STEPS):
        here = xi[:, todo]
        off, a = _offset(here, from_middle, sides)
        slope = -np.einsum("cp,acp->ap", off, a)
        m1, m2 = np.einsum("acp,acp->ap", a, a)
        mixed = np.einsum("cp,cp->p", a[0], a[1])
        b = mixed - np.einsum("cp,cp->p", off, sides[2])
        b = np.where(m1 * m2 - b**2 <= 0.1 * (m1 * m2 - mixed**2), mixed, b)
        held = (np.abs(here) >= 1) & (slope * here < 0)
        slope, b = np.where(held, 0.0, slope), np.where(held.any(axis=0), 0.0, b)
        step = np.stack([b * slope[1] - m2 * slope[0], b * slope[0] - m1 * slope[1]]) / (m1 * m2 - b**2)
        there = np.clip(here + step, -1, 1)
        far, size = np.einsum("cp,cp->p", off, off), m1 + m2
        before = far * (1 + CLOSE) + size * ROUNDING**2
        for _ in range(HALVINGS):
            after = _offset(there, from_middle, sides)[0]
            longer = np.einsum("cp,cp->p", after, after) > before
            if not longer.any():
                break
            there[:, longer] = (there[:, longer] + here[:, longer]) / 2
        xi[:, todo] = there
        left = np.flatnonzero(np.max(np.abs(there - here), axis=0) > CLOSE * (1 + np.sqrt(far / size)))
        if not len(left):
            break
        todo, from_middle, sides = todo[left], from_middle[:, left], sides[..., left]
    return xi.T.copy()


def _polynomial(x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x - X(0) (3, p) and the c (3, 3, p) of X = X(0) + c_1 xi_1 + c_2 xi_2 + c_3 xi_1 xi_2."""
    signs = np.column_stack([np.ones(4), CORNERS, CORNERS.prod(axis=1)]) / 4
    coefficients = np.einsum("lk,plc->kcp", signs, corners)
    return x.T - coefficients[0], coefficients[1:]


def _offset(xi: np.ndarray, from_middle: np.ndarray, sides: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x - X (3, p) and the tangents (2, 3, p) at xi (2, p)."""
    a = sides[:2] + sides[2] * xi[::-1, None]
    return from_middle - sides[0] * xi[0] - a[1] * xi[1], a


def frames(corners: np.ndarray) -> np.ndarray:
    """Two unit vectors in the middle of patches (p, 4, 3) and the normal there, as columns (p, 3, 3)."""
    _, slope = shape(np.zeros((1, 2)))
    a = np.einsum("la,plc->pca", slope[0], corners)
    normal = np.cross(a[..., 0], a[..., 1])
    first = a[..., 0] / np.linalg.norm(a[..., 0], axis=1, keepdims=True)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=-1)


def normals(positions: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Unit normals (k, 3) of a face at its points (k, 3), means over the patches (q, 4) around; 0 where none is."""
    corners = positions[quads]
    _, slope = shape(CORNERS)
    a = np.einsum("mla,qlc->qmca", slope, corners)
    own, nodes = np.cross(a[..., 0], a[..., 1]).reshape(-1, 3), quads.ravel()
    normal = np.stack([np.bincount(nodes, each, minlength=len(positions)) for each in own.T], axis=1)
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.divide(normal, size, out=normal, where=size > 0)
