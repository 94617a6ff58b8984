"""What a curved face bulges over its flat patches by, from the normals at their corners.

A curved face lies off its facets by the square of their size; a gap between facets that do not match is wrong by as
much, whatever is averaged, and what is pressed by it is stiff. Over an edge from corner i to j a quadratic that meets
the face at both, and between the edges of a patch a blend of theirs::

    b(xi) = sum_e k_e phi_e(xi),    k_e = (X_j - X_i) . (n_j - n_i)/2,    phi_1 = (1 - xi_1^2)/4 (1 - xi_2)/2, ...

outwards, right to the third order of the size where patches are nearly alike and nearly parallelograms. Others have a
share of their height left: that of the middle is too high by n,w . w/2, where w = X_,12 and n,w is what the normal
turns by along it, and normals have errors. They are means over the patches around with the weights of Max, exact on
spheres, whatever the patches; on a cylinder askew, with points moved by 0.15 of a side, heights have errors to 0.2::

    N_i = sum (X_a - X_i) x (X_b - X_i)/(|X_a - X_i|^2 |X_b - X_i|^2),    n_i = N_i/|N_i|

a and b the neighbours of i in a patch. At a rim there are patches on one side only, and at a crease two normals: of
edges that end there the other end says everything, k_e = -+ (X_j - X_i) . 2 n/2, and where both do there is no bulge.
In a plane of symmetry the normal has no part across it.
Sources: Nagata, Comput. Aided Geom. Des. 22 (2005) 327-347; Max, J. Graphics Tools 4 (1999) 1-6; Neto, Oliveira,
Menezes, Alves, IJNME 106 (2016) 633-660.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.faces.blocks import assembled
from contact.faces.patches import frames
from contact.faces.symmetry import held_along

ENDS = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])  # corners of the edges of a patch
ALONG = np.array([0, 1, 0, 1])  # the coordinate along an edge
SIDE = np.array([-1.0, 1.0, 1.0, -1.0])  # and what the other one is there
CREASE = np.pi / 6 * (1 + 1e-9)  # between two patches: a face that turns by more is not smooth, or not resolved
IMAGINARY = 1e-30  # a complex step


def blend(xi: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """phi (p, 4), their first (p, 4, 2) and second derivatives (p, 4, 2, 2) at xi (p, 2)."""
    along, share = xi[:, ALONG], (1 + SIDE * xi[:, 1 - ALONG]) / 2
    first, second, edges = np.zeros((len(xi), 4, 2)), np.zeros((len(xi), 4, 2, 2)), np.arange(4)
    first[:, edges, ALONG] = -along / 2 * share
    first[:, edges, 1 - ALONG] = (1 - along**2) / 8 * SIDE
    second[:, edges, ALONG, ALONG] = -share / 2
    second[:, edges, ALONG, 1 - ALONG] = second[:, edges, 1 - ALONG, ALONG] = -along / 4 * SIDE
    return (1 - along**2) / 4 * share, first, second


def spread(values: np.ndarray, patch: np.ndarray, count: int) -> sparse.csr_matrix:
    """Values (p, 4) on the edges of patches (p,) of ``count``, (p, 4 count); none where the patch is -1."""
    inside = patch >= 0
    columns = 4 * np.where(inside, patch, 0)[:, None] + np.arange(4)
    ends = 4 * np.arange(len(patch) + 1)
    data = np.where(inside[:, None], values, 0.0)
    return sparse.csr_matrix((data.ravel(), columns.ravel(), ends), shape=(len(patch), 4 * count))


@dataclass(frozen=True, eq=False)
class Bulges:
    """Of patches (q, 4) of k points.

    share (2, q, 4): of the normals at both ends in the k of an edge, a half each, none and one, or none of both.
    ways (k, 3, 3): projections of normals at points in planes of symmetry, 1 at others.  across (r, 3): the unit
    normals of those planes.
    """

    patches: np.ndarray
    share: np.ndarray
    ways: np.ndarray
    across: np.ndarray

    @classmethod
    def of(cls, x: np.ndarray, patches: np.ndarray, moves: np.ndarray) -> Bulges:
        """Of points x (k, 3) at rest; moves (k, 3, 3): sums of dx dx^T over the unknowns, by what supports leave."""
        i, j = patches[:, ENDS[:, 0]], patches[:, ENDS[:, 1]]
        border, crease = _borders(x, patches, i, j)
        corner, (rim, bent) = np.bincount(patches.ravel(), minlength=len(x)) == 1, np.zeros((2, len(x)), bool)
        for marked, edges in ((rim, border), (bent, crease)):
            marked[i[edges]] = marked[j[edges]] = True
        d = x[j] - x[i]
        d /= np.linalg.norm(d, axis=2, keepdims=True)
        ways, across = _mirrors(x, patches, moves, np.stack([i[border], j[border]]), d[border])
        one_sided = [
            (np.where(border, corner[end], rim[end]) | (bent[end] & ~crease))
            & (np.linalg.norm(np.einsum("qeab,qeb->qea", ways[end], d), axis=2) > np.cos(CREASE))
            for end in (i, j)
        ]
        alike = one_sided[0] == one_sided[1]
        return cls(patches, np.stack([~each / (1.0 + alike) for each in one_sided]), ways, across)

    def at(self, x: np.ndarray) -> Heights:
        """Where the points x (k, 3) are."""
        return Heights(self, x)


@dataclass(frozen=True, eq=False)
class Heights:
    """Those of bulges at points x (k, 3), and their derivatives; normals are met once for all of them."""

    of: Bulges
    x: np.ndarray

    @cached_property
    def k(self) -> np.ndarray:
        """k (4q,) [mm] of the edges."""
        _, _, d = self._edges
        return np.asarray(np.einsum("qec,qec->qe", d, self._apart)).ravel()

    @cached_property
    def slopes(self) -> sparse.csr_matrix:
        """dk (4q, 3k) by the points."""
        i, j, d = self._edges
        low, high = self.of.share[..., None]
        apart, k, (_, dn) = self._apart.reshape(-1, 3), len(self.x), self._turns
        i, j = i.ravel(), j.ravel()
        ends = _rows(j, (high * d).reshape(-1, 3), k) - _rows(i, (low * d).reshape(-1, 3), k)
        return sparse.csr_matrix(_rows(j, apart, k) - _rows(i, apart, k) + ends @ dn)

    def curvature(self, weights: np.ndarray) -> sparse.csr_matrix:
        """sum_e w_e d2k_e (3k, 3k), weights w (4q,).

        With c_i = sum over the edges at i of -+ w (X_j - X_i) times its share it is that of sum_i c_i . n_i.
        """
        (i, j, _), (n, size), (dN, dn) = self._edges, self._normals, self._turns
        k, w = len(self.x), weights.reshape(i.shape)
        at_i, at_j = (w * self.of.share).reshape(2, -1)
        values, ends = np.concatenate([at_j, -at_j, -at_i, at_i]), [each.ravel() for each in (j, i)]
        rows, columns = np.concatenate(ends[:1] * 2 + ends[1:] * 2), np.concatenate(ends * 2)
        tied = sparse.csr_matrix((values, (rows, columns)), shape=(k, k))
        dc = sparse.csr_matrix(sparse.kron(tied, np.eye(3), format="csr"))
        c = tied @ self.x
        along, W = np.einsum("kc,kc->k", c, n)[:, None, None], self.of.ways
        both = c[:, :, None] * n[:, None, :]
        turned = both + np.swapaxes(both, 1, 2) + along * (np.eye(3) - 3 * n[:, :, None] * n[:, None, :])
        H = _blocks(-W @ turned @ W / size[:, None, None] ** 2)
        g = np.einsum("kab,kb->ka", W, c - along[:, 0] * n) / size[:, None]
        crossed = sparse.csr_matrix(dc.T @ dn)
        return sparse.csr_matrix(crossed + crossed.T + dN.T @ H @ dN + self._corners_bent(g))

    @cached_property
    def _edges(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points (q, 4) at both ends, and from the first to the second (q, 4, 3)."""
        i, j = self.of.patches[:, ENDS[:, 0]], self.of.patches[:, ENDS[:, 1]]
        return i, j, self.x[j] - self.x[i]

    @property
    def _apart(self) -> np.ndarray:
        """By what the normals at the ends differ (q, 4, 3), by their shares."""
        (i, j, _), (n, _), (low, high) = self._edges, self._normals, self.of.share[..., None]
        return np.asarray(high * n[j] - low * n[i])

    @cached_property
    def _around(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A corner of a patch, the next and the last one (4q, 3), and the edges to those (4q, 3) each."""
        x = self.x
        own = np.stack([np.roll(self.of.patches, -shift, axis=1).ravel() for shift in (0, 1, -1)], axis=1)
        return own, x[own[:, 1]] - x[own[:, 0]], x[own[:, 2]] - x[own[:, 0]]

    @cached_property
    def _normals(self) -> tuple[np.ndarray, np.ndarray]:
        """n (k, 3), zero where no patch is, and |N| (k,), 1 there."""
        nodes, a, b = self._around
        one = np.cross(a, b) / (_square(a) * _square(b))[:, None]
        whole = np.stack([np.bincount(nodes[:, 0], each, minlength=len(self.x)) for each in one.T], axis=1)
        whole = np.einsum("kab,kb->ka", self.of.ways, whole)
        size = np.linalg.norm(whole, axis=1)
        size[size == 0] = 1.0
        return whole / size[:, None], size

    @cached_property
    def _turns(self) -> tuple[sparse.csr_matrix, sparse.csr_matrix]:
        """dN (3k, 3k) without the ways, and dn (3k, 3k)."""
        n, size = self._normals
        nodes, a, b = self._around
        by_edges = np.stack([_slope(np.broadcast_to(row, a.shape), a, b) for row in np.eye(3)], axis=1)
        dN = assembled(nodes[:, :1], nodes, by_edges @ APART, len(self.x))
        flat = (np.eye(3) - n[:, :, None] * n[:, None, :]) @ self.of.ways / size[:, None, None]
        return dN, sparse.csr_matrix(_blocks(flat) @ dN)

    def _corners_bent(self, g: np.ndarray) -> sparse.csr_matrix:
        """sum_i g_i . d2N_i (3k, 3k), g (k, 3) held, exact to the last digit."""
        nodes, a, b = self._around
        edges, own = np.concatenate([a, b], axis=1), g[nodes[:, 0]]
        bent = np.zeros((len(nodes), 6, 6))
        for m in range(6):
            aside = edges.astype(complex)
            aside[:, m] += IMAGINARY * 1j
            bent[:, m] = _slope(own, aside[:, :3], aside[:, 3:]).imag / IMAGINARY
        return assembled(nodes, nodes, APART.T @ bent @ APART, len(self.x))


APART = np.kron(np.array([[-1.0, 1.0, 0.0], [-1.0, 0.0, 1.0]]), np.eye(3))  # both edges by the three corners


def _slope(g: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The derivative (p, 6) of g . (a x b)/(|a|^2 |b|^2) by the edges a and b (p, 3), which may be complex."""
    scale = (_square(a) * _square(b))[:, None]
    value = 2 * np.einsum("pc,pc->p", g, np.cross(a, b))[:, None] / scale
    by_a = np.cross(b, g) / scale - value * a / _square(a)[:, None]
    return np.concatenate([by_a, np.cross(g, a) / scale - value * b / _square(b)[:, None]], axis=1)


def _square(a: np.ndarray) -> np.ndarray:
    return np.asarray(np.einsum("...c,...c->...", a, a))


def _rows(point: np.ndarray, values: np.ndarray, k: int) -> sparse.csr_matrix:
    """Rows values (e, 3) at points (e,) of k."""
    columns, ends = 3 * point[:, None] + np.arange(3), 3 * np.arange(len(point) + 1)
    return sparse.csr_matrix((values.ravel(), columns.ravel(), ends), shape=(len(point), 3 * k))


def _blocks(blocks: np.ndarray) -> sparse.csr_matrix:
    """Of (k, 3, 3) on the diagonal."""
    k = len(blocks)
    return sparse.csr_matrix(sparse.bsr_matrix((blocks, np.arange(k), np.arange(k + 1)), shape=(3 * k, 3 * k)))


def _borders(x: np.ndarray, patches: np.ndarray, i: np.ndarray, j: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which edges (q, 4) have no other patch beyond them, and which one that is turned by more than CREASE."""
    edges = np.sort(np.stack([i, j], axis=-1).reshape(-1, 2), axis=1)
    _, which, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    which = which.ravel()
    normal = np.repeat(frames(x[patches])[..., 2], 4, axis=0)
    both = np.stack([np.bincount(which, each) for each in normal.T], axis=1)
    turned = (count == 2) & (np.linalg.norm(both, axis=1) < 2 * np.cos(CREASE / 2))
    return (count != 2)[which].reshape(i.shape), turned[which].reshape(i.shape)


def _mirrors(
    x: np.ndarray, patches: np.ndarray, moves: np.ndarray, ends: np.ndarray, way: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The ways (k, 3, 3) that planes of symmetry leave normals, and the unit normals (r, 3) of those.

    ends (2, e), way (e, 3): of the edges of rims. A plane of symmetry is where supports hold both ends of one across
    it, along what normals at rest have next to nothing of; where two planes cross, along what is left. What is stiff
    in the plane of a rim holds it along itself.
    """
    axes, held = held_along(moves)
    free = np.arange(3) >= held[:, None]
    ways = np.einsum("kai,ki,kbi->kab", axes, free, axes)
    every = np.broadcast_to(np.eye(3), ways.shape)
    n, _ = Bulges(patches, np.zeros((2, 0)), every, np.zeros((0, 3))).at(x)._normals
    kept = np.linalg.norm(np.einsum("kab,kb->ka", ways, n), axis=1) > np.cos(CREASE)
    in_plane = np.linalg.norm(np.einsum("seab,eb->sea", ways[ends], way), axis=2) > np.cos(CREASE)
    mirror = ((held[ends] == 2) | (held[ends] == 1) & in_plane).all(axis=0)
    mirrored = kept & np.isin(np.arange(len(x)), ends[:, mirror])
    return np.where(mirrored[:, None, None], ways, every), np.swapaxes(axes, 1, 2)[mirrored[:, None] & ~free]
