"""What the bulges of two curved faces take off the gaps between their facets, with its derivatives.

    gamma' = gamma - b_master(xi) - b_slave(eta)

at the closest point xi of the facets of the master, from the point eta of the slave. Normals of both faces differ by
the order of the size of patches, so that it is the distance of the curved faces to the third order. With v, q_a, m, b
and A of :mod:`contact.faces.pair`, and w_a = sum_l N_l,a dX_l, r = gamma n::

    dxi = A^-1 (p + gamma q)
    A d2xi_a = S[v - a_b dxi_b, w_a + X_,ac dxi_c] + S[r . w_12, dxi_c] - S[a_a . w_b, dxi_b]
               - a_a . X_,12 S[dxi_1, dxi_2]

c the other coordinate than a, and S[x, y] the sum of both orders; db = b_,a dxi_a + sum_e phi_e dk_e, and d2b alike.
The heights k_e follow the deformed faces, and no rigid motion of both changes them but where a plane of symmetry stays
where it is: forces that are derivatives of these gaps have no resultant, and no moment about what such planes leave.

Before a convex edge between two facets of the master, and behind a concave one, points within the angle of both normals
are closest to the edge: there the direction of gamma turns from one normal to the other, and nothing tilts it towards
that of the curved face. Where the slave has the larger patches its points lie on the other side of such edges; where
the master has, Newton's method may cycle.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.faces.blocks import along, inverse, summed
from contact.faces.bulges import Bulges, Heights, blend, spread
from contact.faces.patches import shape, twist
from contact.faces.search import Nearest


@dataclass(frozen=True, eq=False)
class Bulged:
    """At positions x (k, 3) of both faces; place (p, 3): patch of the slave, -1 for none, and eta, of each point.

    bulges: of the patches of the slave, and after them of those of the master (b, 4).
    apart V (p, k): v = dx_s - dX at a fixed xi.
    """

    bulges: Bulges
    master: np.ndarray
    place: np.ndarray
    x: np.ndarray
    near: Nearest
    apart: sparse.csr_matrix

    @cached_property
    def height(self) -> np.ndarray:
        """b (p,) [mm]."""
        return np.asarray(self._phi @ self._heights.k)

    @property
    def tilt(self) -> np.ndarray:
        """Between the normal of the facet and that of the curved face (p, 3), per unit length of the former."""
        c = np.einsum("pab,pb->pa", self._A, np.stack([each @ self._heights.k for each in self._over], axis=1))
        return np.asarray(np.einsum("pca,pa->pc", self.near.a, c))

    @cached_property
    def rows(self) -> sparse.csr_matrix:
        """db (p, 3k)."""
        moved = sum(
            sparse.diags_array(each @ self._heights.k) @ dxi for each, dxi in zip(self._over, self._dxi, strict=True)
        )
        return sparse.csr_matrix(moved + self._phi @ self._heights.slopes)

    def curvature(
        self, force: np.ndarray, kept: np.ndarray, shares: np.ndarray, group: np.ndarray, corners: np.ndarray
    ) -> sparse.csr_matrix:
        """sum_p f_p d2b_p (3k, 3k), f (p,); kept, group, corners: the points with one, see :func:`summed`.

        shares (kept, c): of the corners of the slave.
        """
        middle = force[kept, None, None] * self._middle(kept)
        blocks = summed(self._local(kept, shares), middle, group, corners, len(self.x))
        weight = sparse.diags_array(force)
        mixed = (
            sum(dxi.T @ weight @ each for each, dxi in zip(self._over, self._dxi, strict=True)) @ self._heights.slopes
        )
        return sparse.csr_matrix(blocks + mixed + mixed.T + self._heights.curvature(self._phi.T @ force))

    @cached_property
    def _heights(self) -> Heights:
        """Those of all edges, where the points are."""
        return self.bulges.at(self.x)

    @cached_property
    def _phi(self) -> sparse.csr_matrix:
        """phi at xi on the edges of the master and at eta on those of the slave (p, 4q)."""
        under = spread(blend(self.place[:, 1:])[0], self.place[:, 0].astype(np.intp), self._count)
        return sparse.csr_matrix(under + spread(blend(self.near.xi)[0], self._quad, self._count))

    @cached_property
    def _over(self) -> list[sparse.csr_matrix]:
        """phi_,a at xi (p, 4q)."""
        return [spread(each, self._quad, self._count) for each in np.moveaxis(blend(self.near.xi)[1], 2, 0)]

    @property
    def _count(self) -> int:
        return len(self.bulges.patches)

    @property
    def _quad(self) -> np.ndarray:
        """The patches of the master (p,) among all."""
        return self._count - len(self.master) + self.near.quad

    @cached_property
    def _A(self) -> np.ndarray:
        """A^-1 (p, 2, 2), zero for a coordinate that an edge holds."""
        near = self.near
        both, whole = near.free[:, :, None] & near.free[:, None, :], near.free.all(axis=1)
        m = np.where(both, np.swapaxes(near.a, 1, 2) @ near.a, np.eye(2))
        twisted = whole * near.gap * np.einsum("pc,pc->p", near.direction, self._twisted)
        m[:, [0, 1], [1, 0]] -= twisted[:, None]
        return inverse(m) * both

    @cached_property
    def _twisted(self) -> np.ndarray:
        """X_,12 (p, 3)."""
        return np.tensordot(twist(), self.x[self.master[self.near.quad]], (0, 1))

    @cached_property
    def _dxi(self) -> list[sparse.csr_matrix]:
        """dxi_a (p, 3k)."""
        near = self.near
        _, slope = shape(near.xi)
        columns, ends = self.master[near.quad].ravel(), 4 * np.arange(len(near.gap) + 1)
        derivatives = []
        for own in np.moveaxis(self._A, 1, 0):
            values = np.einsum("pb,plb->pl", near.gap[:, None] * own, slope)
            turned = sparse.csr_matrix((values.ravel(), columns, ends), shape=(len(near.gap), len(self.x)))
            moved = along(self.apart, np.einsum("pb,pcb->pc", own, near.a))
            derivatives.append(sparse.csr_matrix(moved + along(turned, near.direction)))
        return derivatives

    def _local(self, kept: np.ndarray, shares: np.ndarray) -> np.ndarray:
        """v, w_1, w_2, n . w_12 (kept, 10, 3c) by the positions of the c corners of both patches."""
        N, slope = shape(self.near.xi[kept])
        width = shares.shape[1]
        local = np.zeros((len(kept), 10, width + 4, 3))
        every = np.arange(3)
        local[:, every, :, every] = np.column_stack([shares, -N])
        local[:, 3 + every, width:, every] = slope[..., 0]
        local[:, 6 + every, width:, every] = slope[..., 1]
        local[:, 9, width:] = twist()[:, None] * self.near.direction[kept, None]
        return local.reshape(len(kept), 10, -1)

    def _middle(self, kept: np.ndarray) -> np.ndarray:
        """d2b at held heights, in what :meth:`_local` has (kept, 10, 10)."""
        near, A, t = self.near, self._A[kept], self._twisted[kept]
        a, n, g = near.a[kept], near.direction[kept], near.gap[kept]
        _, first, second = blend(near.xi[kept])
        k = self._heights.k.reshape(-1, 4)[self._quad[kept]]
        c = np.einsum("pab,peb,pe->pa", A, first, k)
        basis = np.eye(10)
        v, w, s = basis[:3], basis[3:9].reshape(2, 3, 10), basis[9]
        by_p = np.einsum("pcb,ci->pbi", a, v) + np.einsum("p,pc,bci->pbi", g, n, w)
        dxi = np.einsum("pab,pbi->pai", A, by_p)
        left = v - np.einsum("pcb,pbi->pci", a, dxi)
        middle = np.einsum("pe,peab,pai,pbj->pij", k, second, dxi, dxi) / 2
        for each in (0, 1):
            other, share = dxi[:, 1 - each], c[:, each, None, None]
            turned = w[each] + t[:, :, None] * other[:, None]
            term = np.einsum("pci,pcj->pij", left, turned)
            term += g[:, None, None] * s[:, None] * other[:, None]
            term -= np.einsum("pc,bci,pbj->pij", a[:, :, each], w, dxi)
            term -= np.einsum("pc,pc->p", t, a[:, :, each])[:, None, None] * dxi[:, 0, :, None] * dxi[:, 1, None]
            middle += share * term
        return np.asarray(middle + np.swapaxes(middle, 1, 2))
