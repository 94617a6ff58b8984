"""Bilinear patches: their points, and the closest one to a point in space. No contact condition enters here.

X(xi) = sum_l N_l(xi) X_l with corners (4, 3) in the order (-1, -1), (1, -1), (1, 1), (-1, 1), and a_1 x a_2 out of the
body whose face they make.
"""

from __future__ import annotations

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
    return one.prod(axis=-1) / 4, slope


def twist() -> np.ndarray:
    """d2N/dxi1 dxi2 (4,), the only second derivative."""
    return CORNERS.prod(axis=1) / 4


def closest(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """The xi (p, 2) in [-1, 1]^2 that minimise |x - X(xi)|^2/2 for points x (p, 3) and patches (p, 4, 3).

    Newton on the coordinates that no bound holds, Gauss-Newton where the Hessian is not definite, steps halved until
    the distance falls. A patch may be so twisted that it has more than one minimum: it is sought from the middle.
    """
    xi, todo = np.zeros((len(x), 2)), np.arange(len(x))
    for _ in range(STEPS):
        if not len(todo):
            break
        here, at, patch = xi[todo], x[todo], corners[todo]
        off, a = _offset(here, at, patch)
        slope = -np.einsum("pc,pca->pa", off, a)
        metric = np.einsum("pca,pcb->pab", a, a)
        hessian = metric.copy()
        hessian[:, [0, 1], [1, 0]] -= np.einsum("pc,pc->p", off, np.einsum("l,plc->pc", twist(), patch))[:, None]
        bad = np.linalg.det(hessian) <= 0.1 * np.linalg.det(metric)
        hessian[bad] = metric[bad]
        held = (np.abs(here) >= 1) & (slope * here < 0)
        slope = np.where(held, 0.0, slope)
        hessian = np.where(held[:, :, None] | held[:, None, :], np.eye(2) * metric, hessian)
        step = -np.linalg.solve(hessian, slope[..., None])[..., 0]
        there = np.clip(here + step, -1, 1)
        far, size = np.einsum("pc,pc->p", off, off), np.trace(metric, axis1=1, axis2=2)
        before = far * (1 + CLOSE) + size * ROUNDING**2
        for _ in range(HALVINGS):
            after = _offset(there, at, patch)[0]
            longer = np.einsum("pc,pc->p", after, after) > before
            if not longer.any():
                break
            there[longer] = (there[longer] + here[longer]) / 2
        xi[todo] = there
        todo = todo[np.max(np.abs(there - here), axis=1) > CLOSE * (1 + np.sqrt(far / size))]
    return xi


def _offset(xi: np.ndarray, x: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x - X (p, 3) and the tangents (p, 3, 2)."""
    N, slope = shape(xi)
    return x - np.einsum("pl,plc->pc", N, corners), np.einsum("pla,plc->pca", slope, corners)


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
    found = np.zeros_like(positions)
    np.add.at(found, quads, np.cross(a[..., 0], a[..., 1]))
    size = np.linalg.norm(found, axis=1, keepdims=True)
    return np.divide(found, size, out=found, where=size > 0)
