"""Coulomb friction between two faces that both deform: the slip of the slave's points over the master.

The anchor A of a candidate is a material point of the master, patch and xi. With y = x - X_A and the unit tangents
e_1 along a_1, e_2 across it in the plane of a_1 and a_2, all of them those of the patch as it is now::

    s_a(u) = e_a . y,    ds_1 = e_1 . dy + (s_2 e_2 + h n) . da_1/r
                         ds_2 = e_2 . dy - (s_1 e_2/r + k h n/q) . da_1 + (h n/q) . da_2

r = |a_1|, q = e_2 . a_2, k = (a_2 . e_1)/r, h = n . y. It is the slip on a rigid foundation, :mod:`contact.slip`, in a
frame that the master carries along: the same digits on a flat face that does not move. No rigid motion of both bodies
changes it, so S^T t, S = ds/du, has no resultant and no moment, to the last digit. It acts at x and at X_A, and on the
tangents of the patch by a couple t x y, which is none where t opposes s and the chord leaves the face by h = 0. As a
force may be moved along its line, both bodies as wholes feel it where the candidate is; what the master deforms by is
right to the first order in the slip of one step, as the step itself is.
Where supports of both bodies leave a candidate no way along d, as in a plane of symmetry, its first slip is that across
d, and the second one is none: facets are not at right angles to such a plane, and three ways would hold two unknowns.
Its anchor is in the plane, too (:mod:`contact.faces.symmetry`): beside it a little of y moves along d, and who sticks
there is held along two ways by a lever of 1e-4 of a patch, with forces that belong to neither stick nor slip.
Sources: Laursen, Simo, IJNME 36 (1993) 3451-3485; Wriggers, Computational Contact Mechanics (2006), sec. 9.4; complex
steps: Squire, Trapp, SIAM Rev. 40 (1998) 110-112.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.faces.measured import slips
from contact.faces.pair import Pair
from contact.faces.patches import CORNERS, shape, twist
from contact.faces.search import nearest
from contact.faces.symmetry import NO_WAY, ends_in_planes, held_along, motions

IMAGINARY = 1e-30  # a complex step
ROUNDED = 1e-14  # of the largest entry of a candidate: one that is rounding alone
STEPS = 20
FOOT = 1e-14  # change of xi at which the foot of a perpendicular is found
BEYOND = 3.0  # |xi| up to which a patch is continued over its edges


@dataclass(frozen=True, eq=False)
class Rubbing:
    """The slip since anchors (m, 3) = (patch, xi_1, xi_2) of the candidates, the points ``nodes`` (m,) of the pair."""

    pair: Pair
    nodes: np.ndarray
    anchors: np.ndarray

    @classmethod
    def at_rest(cls, pair: Pair) -> Rubbing:
        """From where the pair is undeformed."""
        begun = cls(pair, pair.nodes, np.zeros((len(pair.nodes), 3)))
        return begun.since(begun.places(np.zeros(pair.operator.shape[1])))

    @property
    def each(self) -> tuple[Rubbing, ...]:
        """That of the one pair."""
        return (self,)

    def since(self, anchors: np.ndarray) -> Rubbing:
        """The slip from other anchors (m, 3)."""
        return replace(self, anchors=anchors)

    def places(self, u: np.ndarray) -> np.ndarray:
        """Where the candidates (m, 3) are on the master: the anchors of the next step, once u (n,) is accepted."""
        return self._anchored(u, 0.0)

    def left(self, u: np.ndarray, stretched: np.ndarray) -> np.ndarray:
        """The anchors (m, 3) that a step leaves: places, less what springs are still ``stretched`` (m, 2) by [mm]."""
        if not stretched.any():
            return self.places(u)
        return self._anchored(u, self.in_space(u, stretched))

    def _anchored(self, u: np.ndarray, less: np.ndarray | float) -> np.ndarray:
        """Anchors (m, 3) below the candidates less (m, 3) [mm]; of those in a plane of symmetry in that plane."""
        pair, x = self.pair, self.pair.positions(u)
        at = x[self.nodes] - less
        anchors = _on_face(at, x, pair.master)
        corners = pair.master[anchors[:, 0].astype(np.intp)]
        which, ends = ends_in_planes(self.nodes, pair.reference, pair.operator, corners)
        start, end = np.moveaxis(x[np.take_along_axis(corners[which], ends, axis=1)], 1, 0)
        off, way = at[which] - start, end - start
        size = _dot(way, way)
        along = np.divide(2 * _dot(off, way), size, out=np.zeros_like(size), where=size > 0) - 1
        along = np.where(np.abs(along) <= BEYOND, along, np.clip(along, -1, 1))
        low, high = np.moveaxis(CORNERS[ends], 1, 0)
        anchors[which, 1:] = (1 - along) / 2 * low + (1 + along) / 2 * high
        return anchors

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm]."""
        return np.asarray(np.einsum("mab,mb->ma", self.ways, _slip(self._local(u)[0])))

    @cached_property
    def ways(self) -> np.ndarray:
        """The slips (m, 2, 2) of a candidate in those along e_1 and e_2: both, or one across what its supports hold."""
        rest = np.zeros(self.pair.operator.shape[1])
        z, of_points, columns = self._local(rest)
        m, every = len(z), np.arange(3)
        unknowns = np.repeat(3 * columns, 3, axis=0) + np.tile(every, m)[:, None]
        values = np.repeat(of_points[:, 0], 3, axis=0).ravel()
        ends = columns.shape[1] * np.arange(3 * m + 1)
        shape_ = (3 * m, self.pair.operator.shape[0])
        D = sparse.csr_matrix((values, unknowns.ravel(), ends), shape=shape_) @ self.pair.operator
        axes, held = held_along(motions(sparse.csr_matrix(D)))
        axis, (e1, e2, *_) = axes[:, :, 0], _frame(z)
        along = np.concatenate([_dot(e1, axis), _dot(e2, axis)], axis=1)
        size = np.linalg.norm(along, axis=1)
        free = np.tile(np.eye(2), (m, 1, 1))
        free[held > 1] = 0.0
        one = (held == 1) & (size > NO_WAY)
        free[one] = 0.0
        free[one, 0] = np.stack([along[one, 1], -along[one, 0]], axis=1) / size[one, None]
        return free

    def measured(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm] by another way, for the judge."""
        x = self.pair.positions(u)
        return np.asarray(np.einsum("mab,mb->ma", self.ways, slips(x[self.nodes], x, self.pair.master, self.anchors)))

    def on_faces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the candidates are, and the normals of the master at their anchors, (m, 3) each."""
        return self.pair.positions(u)[self.nodes], _frame(self._local(u)[0])[2]

    def in_space(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """Vectors (m, 3) of t (m, 2)."""
        e1, e2, *_ = _frame(self._local(u)[0])
        t = self._along(friction)
        return np.asarray(t[:, :1] * e1 + t[:, 1:] * e2)

    def _along(self, friction: np.ndarray) -> np.ndarray:
        """t (m, 2) along e_1 and e_2."""
        return np.asarray(np.einsum("mab,ma->mb", self.ways, friction))

    def jacobian(self, u: np.ndarray) -> sparse.csr_matrix:
        """ds/du (2m, n)."""
        m = len(self.nodes)
        S = sparse.csr_matrix(self._rows(u) @ self.pair.operator)
        size = np.zeros(m)
        row = np.repeat(np.arange(2 * m), np.diff(S.indptr))
        np.maximum.at(size, row // 2, np.abs(S.data))
        S.data[np.abs(S.data) <= ROUNDED * size[row // 2]] = 0.0
        S.eliminate_zeros()
        return S

    def forces(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """S^T t (k, 3) [N] on all points of both faces."""
        return np.asarray((self._rows(u).T @ friction.ravel()).reshape(-1, 3))

    def curvature(self, u: np.ndarray, friction: np.ndarray) -> sparse.csc_matrix:
        """sum_ia t_ia d2s_ia/du2 (n, n)."""
        z, of_points, columns = self._local(u)
        kept = np.flatnonzero(friction.any(axis=1))
        H = _bent(z[kept], self._along(friction)[kept])
        of_points, columns = of_points[kept], columns[kept]
        blocks = np.einsum("mbp,mbcBC,mBP->mpcPC", of_points, H.reshape(-1, 3, 3, 3, 3), of_points)
        size = 3 * columns.shape[1]
        unknowns = (3 * columns[:, :, None] + np.arange(3)).reshape(len(kept), size)
        places = np.repeat(unknowns, size, axis=1).ravel(), np.tile(unknowns, size).ravel()
        k = self.pair.operator.shape[0]
        local = sparse.coo_matrix((blocks.ravel(), places), shape=(k, k)).tocsr()
        return sparse.csc_matrix(self.pair.operator.T @ local @ self.pair.operator)

    def _rows(self, u: np.ndarray) -> sparse.csr_matrix:
        """ds (2m, 3k) by the positions of all points."""
        z, of_points, columns = self._local(u)
        rows = np.einsum("mda,mbp,mabc->mdpc", self.ways, of_points, _slopes(z), optimize=True)
        m, each = len(z), 3 * columns.shape[1]
        unknowns = np.repeat((3 * columns[:, :, None] + np.arange(3)).reshape(m, 1, each), 2, axis=1)
        shape_ = (2 * m, self.pair.operator.shape[0])
        S = sparse.csr_matrix((rows.ravel(), unknowns.ravel(), each * np.arange(2 * m + 1)), shape=shape_)
        S.sum_duplicates()
        return S

    def _local(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """z = (y, a_1, a_2) (m, 3, 3) of each candidate, and what (m, 3, 5) its five points (m, 5) make of it."""
        x = self.pair.positions(u)
        N, slope = shape(self.anchors[:, 1:])
        of_points = np.zeros((len(self.nodes), 3, 5))
        of_points[:, 0, 0] = 1.0
        of_points[:, 0, 1:] = -N
        of_points[:, 1:, 1:] = np.swapaxes(slope, 1, 2)
        columns = np.column_stack([self.nodes, self.pair.master[self.anchors[:, 0].astype(np.intp)]])
        return np.einsum("mbp,mpc->mbc", of_points, x[columns]), of_points, columns


def _frame(z: np.ndarray) -> tuple[np.ndarray, ...]:
    """e_1, e_2, n (m, 3) and r, q, k (m, 1) of z (m, 3, 3), which may be complex."""
    a1, a2 = z[:, 1], z[:, 2]
    r = np.sqrt(_dot(a1, a1))
    e1 = a1 / r
    across = a2 - _dot(a2, e1) * e1
    q = np.sqrt(_dot(across, across))
    e2 = across / q
    return e1, e2, np.cross(e1, e2), r, q, _dot(a2, e1) / r


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(np.einsum("mc,mc->m", a, b)[:, None])


def _slip(z: np.ndarray) -> np.ndarray:
    """s (m, 2)."""
    e1, e2, *_ = _frame(z)
    return np.concatenate([_dot(e1, z[:, 0]), _dot(e2, z[:, 0])], axis=1)


def _slopes(z: np.ndarray) -> np.ndarray:
    """ds/dz (m, 2, 3, 3)."""
    e1, e2, n, r, q, k = _frame(z)
    s1, s2, h = (_dot(e, z[:, 0]) for e in (e1, e2, n))
    first = np.stack([e1, (s2 * e2 + h * n) / r, np.zeros_like(e1)], axis=1)
    return np.stack([first, np.stack([e2, -s1 * e2 / r - k * h * n / q, h * n / q], axis=1)], axis=1)


def _bent(z: np.ndarray, friction: np.ndarray) -> np.ndarray:
    """t . d2s/dz2 (m, 9, 9), exact to the last digit."""
    curvature = np.zeros((len(z), 9, 9))
    for j in range(9):
        aside = z.astype(complex)
        aside.reshape(-1, 9)[:, j] += IMAGINARY * 1j
        curvature[:, j] = np.einsum("ma,mabc->mbc", friction, _slopes(aside)).imag.reshape(-1, 9) / IMAGINARY
    return curvature


def _on_face(x: np.ndarray, positions: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """(patch, xi_1, xi_2) (m, 3) from where a face of points (k, 3) and patches (q, 4) is left at right angles to x.

    On the nearest patch, which is continued over its edges: from there a point that lies beside them does not slip.
    """
    near = nearest(x, positions, quads)
    xi, beside = near.xi.copy(), np.flatnonzero(~near.free.all(axis=1))
    at, corners, foot = x[beside], positions[quads[near.quad[beside]]], xi[beside]
    change = np.full(len(beside), np.inf)
    for _ in range(STEPS):
        N, slope = shape(foot)
        off, a = at - np.einsum("pl,plc->pc", N, corners), np.einsum("pla,plc->pca", slope, corners)
        hessian = np.einsum("pca,pcb->pab", a, a)
        hessian[:, [0, 1], [1, 0]] -= np.einsum("pc,l,plc->p", off, twist(), corners)[:, None]
        step = np.linalg.solve(hessian, np.einsum("pca,pc->pa", a, off)[..., None])[..., 0]
        foot = np.clip(foot + step, -2 * BEYOND, 2 * BEYOND)
        change = np.max(np.abs(step), axis=1)
        if np.max(change, initial=0.0) <= FOOT:
            break
    good = (change <= FOOT * 100) & (np.max(np.abs(foot), axis=1) <= BEYOND)
    xi[beside[good]] = foot[good]
    return np.column_stack([near.quad, xi])
