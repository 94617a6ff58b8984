"""Two faces as one contact problem: points of one, the slave, against the patches of the other, the master.

    gamma_s(u) = +-|x_s - X(xi_s)|,    x_s = sum_j S_sj X_j,    g_i(u) = sum_s C_is gamma_s

X(xi_s) is the closest point of the master, found anew at every u. Nodes against patches have S = 1 and C = 1; an
integrated form averages over many points of the slave, see :mod:`contact.faces.sampling`. Both faces are points of one
set, whose positions are linear in the unknowns, so that two bodies and a body that meets itself are alike.

Derivatives are those of gamma itself: with n its gradient in space, v = dx_s - sum_l N_l dX_l, p_a = a_a . v and
q_a = n . sum_l N_l,a dX_l ::

    dgamma = n . v,    d2gamma = -(p m^-1 b A^-1 p + p A^-1 q + q A^-1 p + gamma q A^-1 q),    A = m - gamma b

with m_ab = a_a . a_b and b_ab = n . X,ab over a patch. Beyond an edge, which is straight, only the coordinate along it
is left, b is none, and each direction t across n that the closest point does not follow adds (t . v)^2/gamma.
Points x_s stay where they are in the slave, so that this is all of it.
A gap does not see a rigid motion of both bodies, so neither does its derivative: the contact forces of a pair have no
resultant and no moment, whatever the form, to the last digit.
Sources: Laursen, Simo, IJNME 36 (1993) 3451-3485; Konyukhov, Schweizerhof, Computational Contact Mechanics (2013).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.faces.blocks import along, inverse, summed
from contact.faces.bulged import Bulged
from contact.faces.bulges import Bulges
from contact.faces.measured import curved_distances, distances
from contact.faces.passages import Ways
from contact.faces.patches import shape, twist
from contact.faces.sampling import Sampling
from contact.faces.search import Nearest, nearest
from contact.problem import ContactProblem, Faces, Linearise
from contact.swept import Passable

KEPT = 2  # states
KINK = 1e-5  # of the size of a patch: nearer than this, the direction from an edge turns too fast to have a derivative


@dataclass(frozen=True, eq=False)
class Pair:
    """A slave and a master in one set of points: x(u) = reference + operator u, reference (k, 3), operator (3k, n).

    master (b, 4): patches by their points, turned so that a_1 x a_2 points out of the wall.
    sampling: where the slave is looked at.  slave (a, 4): its patches, for the judge alone, who looks at what passes
    through them; none where it does not.  smooth: whether there is no friction, whatever the coefficient of others.
    bulges: of the patches of the slave and, after them, of the master, where they are curved and not facets.
    """

    reference: np.ndarray
    operator: sparse.csr_matrix
    master: np.ndarray
    sampling: Sampling
    slave: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), np.intp))
    smooth: bool = False
    bulges: Bulges | None = None

    @property
    def weights(self) -> np.ndarray:
        """Reference areas (m,) [mm^2] of the candidates."""
        return self.sampling.weights

    def positions(self, u: np.ndarray) -> np.ndarray:
        """x (k, 3)."""
        return self.reference + (self.operator @ u).reshape(-1, 3)

    def at(self, u: np.ndarray) -> Paired:
        """What is closest to what at u (n,)."""
        x = self.positions(u)
        return Paired(self, x, nearest(self.sampling.points @ x, x, self.master))

    def forces(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        """Forces (k, 3) [N] on all points of both faces by the candidates' forces (m,)."""
        return np.asarray((self.at(u).rows.T @ nodal).reshape(-1, 3))

    def resultant(self, u: np.ndarray, nodal: np.ndarray) -> np.ndarray:
        """The force (3,) [N] of the master on the slave by the candidates' forces (m,)."""
        return np.asarray(self.at(u).direction.T @ (self.sampling.average.T @ nodal))

    def measured(self, u: np.ndarray) -> np.ndarray:
        """Gaps (m,) at the same points of the slave, by distances that are measured anew."""
        x = self.positions(u)
        points = self.sampling.points @ x
        if self.bulges is None:
            distance = distances(points, x, self.master)
        else:
            distance = curved_distances(points, x, self.master, self.bulges, self.sampling.place)
        return np.asarray(self.sampling.average @ distance)

    @property
    def mirrors(self) -> np.ndarray:
        """Unit normals (r, 3) of the planes of symmetry that the normals of curved faces lie in."""
        return np.zeros((0, 3)) if self.bulges is None else self.bulges.across

    @property
    def nodes(self) -> np.ndarray:
        """The points (m,) that are the candidates."""
        return self.sampling.nodes

    @property
    def parts(self) -> tuple[tuple[Pair, slice], ...]:
        """The pair and its candidates, which are all."""
        return ((self, slice(None)),)

    @property
    def standing(self) -> Ways | None:
        """What the points of both faces may not pass through."""
        return Ways(self.positions, self.slave, self.master) if len(self.slave) else None

    @property
    def size(self) -> float:
        """Largest coordinate [mm]: a gap is a difference of two."""
        return float(np.max(np.abs(self.reference), initial=0.0))


@dataclass(frozen=True, eq=False)
class Paired:
    """The closest points at one u, and what follows from them.  x (k, 3): positions of all points."""

    pair: Pair
    x: np.ndarray
    near: Nearest

    @property
    def gap(self) -> np.ndarray:
        """g (m,), zero where it is rounding of coordinates: that must not say who touches at rest."""
        gamma = self.near.gap if self._over is None else self.near.gap - self._over.height
        averaged = np.asarray(self.pair.sampling.average @ gamma)
        return np.where(np.abs(averaged) <= np.finfo(float).eps * self.pair.size, 0.0, averaged)

    @property
    def rows(self) -> sparse.csr_matrix:
        """dg (m, 3k) by the positions of the points."""
        normal = along(self._apart, self.near.direction)
        if self._over is not None:
            normal = normal - self._over.rows
        return sparse.csr_matrix(self.pair.sampling.average @ normal)

    @property
    def direction(self) -> np.ndarray:
        """Of forces on points of the slave (p, 3): normals of facets, tilted where they are curved."""
        return self.near.direction if self._over is None else self.near.direction - self._over.tilt

    @cached_property
    def _over(self) -> Bulged | None:
        """What bulges take off the gaps of the points."""
        if self.pair.bulges is None:
            return None
        return Bulged(self.pair.bulges, self.pair.master, self.pair.sampling.place, self.x, self.near, self._apart)

    @cached_property
    def _apart(self) -> sparse.csr_matrix:
        """V (p, k): v = dx_s - dX at a fixed xi."""
        return sparse.csr_matrix(self.pair.sampling.points - self._on_master(shape(self.near.xi)[0]))

    def _on_master(self, values: np.ndarray) -> sparse.csr_matrix:
        """Values (p, 4) at the corners of the patches, (p, k)."""
        columns = self.pair.master[self.near.quad]
        ends = 4 * np.arange(len(columns) + 1)
        return sparse.csr_matrix(
            (values.ravel(), columns.ravel(), ends), shape=(len(columns), len(self.pair.reference))
        )

    def curvature(self, force: np.ndarray) -> sparse.csr_matrix:
        """sum_i f_i d2g_i (3k, 3k) by the positions, of candidates' forces (m,).

        Points of one patch before the same other one have their corners in common, and are summed before the matrix is.
        """
        near, sampling = self.near, self.pair.sampling
        on_points = sampling.average.T @ force
        kept = np.flatnonzero(on_points)
        if not len(kept):
            return sparse.csr_matrix((self.x.size, self.x.size))
        both = sampling.patches[kept] * len(self.pair.master) + near.quad[kept]
        _, first, group = np.unique(both, return_index=True, return_inverse=True)
        kept, first, group = kept[np.argsort(group, kind="stable")], kept[first], np.sort(group)
        corners = np.column_stack([sampling.corners[0][first], self.pair.master[near.quad[first]]])
        middle = on_points[kept, None, None] * self._middle(kept)
        blocks = summed(self._local(kept), middle, group, corners, len(self.x))
        if self._over is not None:
            over = self._over.curvature(on_points, kept, sampling.corners[1][kept], group, corners)
            return sparse.csr_matrix(blocks - over)
        return blocks

    def _local(self, kept: np.ndarray) -> np.ndarray:
        """p_1, p_2, q_1, q_2 and, where one is beyond an edge, t_1 . v, t_2 . v (kept, 4 or 6, 3c).

        By the positions of the c corners of both patches.
        """
        near, own = self.near, self.pair.sampling.corners[1][kept]
        N, slope = shape(near.xi[kept])
        a, n, free = near.a[kept], near.direction[kept], near.free[kept]
        apart = np.column_stack([own, -N])[:, None, :, None]
        local = np.zeros((len(kept), 4 if free.all() else 6, apart.shape[2], 3))
        local[:, :2] = apart * np.swapaxes(a, 1, 2)[:, :, None]
        local[:, 2:4, own.shape[1] :] = np.swapaxes(slope, 1, 2)[..., None] * n[:, None, None]
        if not free.all():
            local[:, 4:] = apart * np.swapaxes(_across(a, n, free), 1, 2)[:, :, None]
        return local.reshape(*local.shape[:2], -1)

    def _middle(self, kept: np.ndarray) -> np.ndarray:
        """d2gamma in what :meth:`_local` has (kept, 4 or 6, 4 or 6)."""
        near = self.near
        a, g, free = near.a[kept], near.gap[kept], near.free[kept]
        both, whole = free[:, :, None] & free[:, None, :], free.all(axis=1)
        m = np.where(both, np.swapaxes(a, 1, 2) @ a, np.eye(2))
        b = np.zeros_like(m)
        twisted = np.tensordot(twist(), self.x[self.pair.master[near.quad[kept]]], (0, 1))
        b[:, 0, 1] = b[:, 1, 0] = whole * np.einsum("pc,pc->p", near.direction[kept], twisted)
        across = inverse(m - g[:, None, None] * b)
        middle = np.zeros((len(kept), *(4 if free.all() else 6,) * 2))
        middle[:, :2, :2] = -inverse(m) @ b @ across
        middle[:, :2, 2:4] = middle[:, 2:4, :2] = -across * both
        middle[:, 2:4, 2:4] = -g[:, None, None] * across * both
        if not free.all():
            sharp = np.abs(g) > KINK * near.size[kept]
            bent = np.divide(1.0, g, out=np.zeros_like(g), where=sharp)
            middle[:, 4, 4], middle[:, 5, 5] = bent * ~whole, bent * ~free.any(axis=1)
        return middle


def _across(a: np.ndarray, n: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Unit vectors (p, 3, 2) at right angles to n that the closest point does not follow; zero where it does."""
    across = np.zeros_like(a)
    edge, corner = np.flatnonzero(free.sum(axis=1) == 1), np.flatnonzero(~free.any(axis=1))
    along = a[edge, :, np.argmax(free[edge], axis=1)]
    across[edge, :, 0] = np.cross(n[edge], along)
    first = a[corner, :, 0] - np.einsum("pc,pc->p", a[corner, :, 0], n[corner])[:, None] * n[corner]
    across[corner, :, 0], across[corner, :, 1] = first, np.cross(n[corner], first)
    size = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, size, out=across, where=size > 0)


class Met(Protocol):
    """What is closest to what at one u: :class:`Paired`, or that of several pairs."""

    @property
    def gap(self) -> np.ndarray:
        """g (m,)."""

    @property
    def rows(self) -> sparse.csr_matrix:
        """dg (m, 3k) by the positions."""

    def curvature(self, force: np.ndarray) -> sparse.csr_matrix:
        """sum_i f_i d2g_i (3k, 3k) by the positions."""


class Posed(Faces, Protocol):
    """One :class:`Pair`, or :class:`contact.faces.several.Several`."""

    @property
    def operator(self) -> sparse.csr_matrix:
        """d positions/du (3k, n)."""

    @property
    def weights(self) -> np.ndarray:
        """(m,) [mm^2]."""

    @property
    def standing(self) -> Passable | None:
        """What may not be passed through."""

    @property
    def size(self) -> float:
        """[mm]."""

    def at(self, u: np.ndarray) -> Met:
        """What is closest to what."""


def between(linearise: Linearise, pair: Posed) -> ContactProblem:
    """The contact problem of a pair, or of several; ``linearise``: the mechanics of all bodies at once."""
    A, kept = pair.operator, dict[bytes, tuple[Met, sparse.csr_matrix]]()

    def at(u: np.ndarray) -> tuple[Met, sparse.csr_matrix]:
        """The closest points and the rows there: the last ones are asked for again and again."""
        key = u.tobytes()
        if key not in kept:
            while len(kept) >= KEPT:
                del kept[next(iter(kept))]
            paired = pair.at(u)
            kept[key] = paired, sparse.csr_matrix(paired.rows @ A)
        return kept[key]

    def curvature(u: np.ndarray, force: np.ndarray) -> sparse.csc_matrix:
        return sparse.csc_matrix(A.T @ at(u)[0].curvature(force) @ A)

    return ContactProblem(
        linearise=linearise,
        gap=lambda u: at(u)[0].gap,
        gap_jacobian=lambda u: at(u)[1],
        weights=pair.weights,
        gap_curvature=curvature,
        gap_size=pair.size,
        standing=pair.standing,
        faces=pair,
    )
