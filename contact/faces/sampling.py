"""Where a slave is looked at: its nodes, or points between them whose gaps are averaged with its own multipliers.

nodes: S = 1, C = 1: each node against the patch that it meets.
mortar: g_i = sum_s w_s Phi_i(xi_s) gamma_s/W_i with the reference areas w_s of points in the patches of the slave, and
W_i = int Phi_i dA. The points lie in the pieces into which the patches of the master cut those of the slave, where the
shape functions of both are smooth: between flat parallelograms every integral is exact. Phi are the shape functions of
the slave, so that a uniform pressure is one of theirs, and forces are p_i W_i on both sides.
Sources: Puso, Laursen, CMAME 193 (2004) 601-629; Farah, Popp, Wall, Comput. Mech. 55 (2015) 209-228.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from contact.faces.patches import CORNERS, shape
from contact.faces.search import nearest

PAIRINGS = ("nodes", "mortar")
FAR = 20.0  # of its own size: a patch no nearer to the master, or as deep behind it, is not cut
ON = 1e-9  # of the length of an edge, within which a corner lies on it
SLIVER = 1e-12  # of a patch, smaller than which a piece is none
INVERSE = 8  # Newton steps for the inverse of a bilinear map of the plane
# Dunavant, IJNME 21 (1985) 1129-1148: six points, exact to the fourth degree; barycentric coordinates
_A, _B = 0.445948490915965, 0.091576213509771
TRIANGLE = np.array([np.roll([1 - 2 * c, c, c], k) for c in (_A, _B) for k in range(3)])
TRIANGLE_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)
GAUSS = CORNERS / np.sqrt(3)


@dataclass(frozen=True, eq=False)
class Sampling:
    """points S (p, k): those of the slave from the points of the faces.  average C (m, p): gaps from theirs."""

    points: sparse.csr_matrix
    average: sparse.csr_matrix


@dataclass(frozen=True, eq=False)
class Nodes:
    """The points ``nodes`` (m,) of k."""

    nodes: np.ndarray

    def __call__(self, x: np.ndarray) -> Sampling:
        """The same at all positions x (k, 3)."""
        m = len(self.nodes)
        return Sampling(_chosen(self.nodes, len(x)), _chosen(np.arange(m), m))


@dataclass(frozen=True, eq=False)
class Mortar:
    """The patches ``slave`` (a, 4) before ``master`` (b, 4); nodes (m,): those whose multipliers there are.

    reference (k, 3): positions that areas are of.  A node that lies before nothing of the
    master, or far from it, is a point by itself.
    """

    reference: np.ndarray
    slave: np.ndarray
    master: np.ndarray
    nodes: np.ndarray

    def __call__(self, x: np.ndarray) -> Sampling:
        """At the positions x (k, 3)."""
        patch, xi, area = pieces(x, self.slave, self.master)
        N, slope = shape(xi)
        quads = self.slave[patch]
        a = np.einsum("pla,plc->pca", slope, self.reference[quads])
        w = area * np.linalg.norm(np.cross(a[..., 0], a[..., 1]), axis=1)
        p, k = len(w), len(x)
        ends = 4 * np.arange(p + 1)
        points = sparse.csr_matrix((N.ravel(), quads.ravel(), ends), shape=(p, k))
        of_node = sparse.csr_matrix(((w[:, None] * N).ravel(), quads.ravel(), ends), shape=(p, k)).T.tocsr()[self.nodes]
        alone = np.flatnonzero(np.asarray(of_node.sum(axis=1)).ravel() <= SLIVER * self.weights)
        average = [sparse.diags_array(1 / self.weights) @ of_node, _chosen(alone, len(self.nodes)).T]
        whole = sparse.vstack([points, _chosen(self.nodes[alone], k)], format="csr")
        return Sampling(sparse.csr_matrix(whole), sparse.csr_matrix(sparse.hstack(average, format="csr")))

    @property
    def weights(self) -> np.ndarray:
        """W (m,) [mm^2]."""
        N, slope = shape(GAUSS)
        a = np.einsum("gla,qlc->qgca", slope, self.reference[self.slave])
        dA = np.linalg.norm(np.cross(a[..., 0], a[..., 1]), axis=-1)
        whole = np.bincount(self.slave.ravel(), (dA @ N).ravel(), minlength=len(self.reference))
        return np.asarray(whole[self.nodes])


def _chosen(numbers: np.ndarray, k: int) -> sparse.csr_matrix:
    """Rows of the identity (k, k)."""
    return sparse.csr_matrix((np.ones(len(numbers)), numbers, np.arange(len(numbers) + 1)), shape=(len(numbers), k))


def pieces(x: np.ndarray, slave: np.ndarray, master: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points in the pieces of the slave's patches (a, 4) that patches (b, 4) of the master lie before.

    Their patch (p,), xi (p, 2) in it, and weights (p,) of an integral over xi. Both are seen along the normal in the
    middle of the slave's patch.
    """
    own, other = _facing(x, slave, master)
    corners = x[slave[own]]
    middle, axes = corners.mean(axis=1), _axes(corners)[..., :2]
    flat = np.einsum("plc,pci->pli", corners - middle[:, None], axes)
    cutter = np.einsum("plc,pci->pli", x[master[other]][:, ::-1] - middle[:, None], axes)
    polygon, count = clipped(cutter, flat)
    pair, points, area = _triangulated(polygon, count)
    xi, jacobian = _inverse(points, flat[pair])
    kept = area > SLIVER * jacobian
    return own[pair][kept], xi[kept], (area / jacobian)[kept]


def _facing(x: np.ndarray, slave: np.ndarray, master: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (c,) of patches that look at each other and are not far apart."""
    mine, its = x[slave], x[master]
    middle, middles = mine.mean(axis=1), its.mean(axis=1)
    own, radius = (np.linalg.norm(c - c.mean(axis=1, keepdims=True), axis=2).max(axis=1) for c in (mine, its))
    away = np.abs(nearest(middle, x, master).gap)
    near = np.flatnonzero(away <= FAR * own)
    found = cKDTree(middles).query_ball_point(middle[near], (own + radius.max() + away)[near])
    a = np.repeat(near, [len(each) for each in found])
    b = np.concatenate([np.zeros(0, np.intp), *(np.asarray(each, np.intp) for each in found)])
    looks = np.einsum("pc,pc->p", _axes(mine)[a, :, 2], _axes(its)[b, :, 2]) < 0
    return a[looks], b[looks]


def _axes(corners: np.ndarray) -> np.ndarray:
    """Two unit vectors in the middle of patches (p, 4, 3) and the normal there, as columns (p, 3, 3)."""
    _, slope = shape(np.zeros((1, 2)))
    a = np.einsum("la,plc->pca", slope[0], corners)
    normal = np.cross(a[..., 0], a[..., 1])
    first = a[..., 0] / np.linalg.norm(a[..., 0], axis=1, keepdims=True)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=-1)


def clipped(polygon: np.ndarray, by: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Convex polygons (p, 4, 2) cut by others (p, 4, 2), all anticlockwise: (p, 8, 2) and the number of corners (p,).

    Edges that lie on each other to ON do not cross: where they would is rounding, and the points of a rule with it.
    Source: Sutherland, Hodgman, Commun. ACM 17 (1974) 32-42.
    """
    p = len(polygon)
    here, count = np.zeros((p, 8, 2)), np.full(p, 4)
    here[:, :4] = polygon
    for side in range(4):
        start, along = by[:, side], by[:, (side + 1) % 4] - by[:, side]
        off = here - start[:, None]
        inside = along[:, None, 0] * off[..., 1] - along[:, None, 1] * off[..., 0]
        inside[np.abs(inside) <= ON * np.einsum("pc,pc->p", along, along)[:, None]] = 0.0
        found, number = np.zeros((p, 9, 2)), np.zeros(p, np.intp)
        for i in range(8):
            exists = i < count
            j = np.where(i + 1 < count, i + 1, 0)
            every = np.arange(p)
            s, t, there = inside[:, i], inside[every, j], here[every, j]
            keeps = exists & (s >= 0)
            found[every[keeps], number[keeps]] = here[keeps, i]
            number += keeps
            cuts = exists & (s * t < 0)
            share = np.divide(s, s - t, out=np.zeros(p), where=cuts)
            crossing = here[:, i] + share[:, None] * (there - here[:, i])
            found[every[cuts], number[cuts]] = crossing[cuts]
            number += cuts
        here, count = found[:, :8], np.minimum(number, 8)
    return here, count


def _triangulated(polygon: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whose (p,), where (p, 2) and of which area (p,) the points of the rule in the triangles of polygons are."""
    whose, points, areas = [], [], []
    for i in range(1, 7):
        some = np.flatnonzero(count > i + 1)
        triangle = polygon[some][:, [0, i, i + 1]]
        one, two = triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0]
        area = (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2
        whose.append(np.repeat(some, len(TRIANGLE)))
        points.append(np.einsum("gk,tkc->tgc", TRIANGLE, triangle).reshape(-1, 2))
        areas.append(np.outer(area, TRIANGLE_WEIGHTS).ravel())
    return np.concatenate(whose), np.concatenate(points), np.concatenate(areas)


def _inverse(points: np.ndarray, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The xi (p, 2) of points (p, 2) in plane patches (p, 4, 2), and the area of a patch per that of xi there (p,)."""
    xi = np.zeros_like(points)
    for _ in range(INVERSE):
        N, slope = shape(xi)
        J = np.einsum("pla,plc->pca", slope, flat)
        xi = xi + np.linalg.solve(J, (points - np.einsum("pl,plc->pc", N, flat))[..., None])[..., 0]
    J = np.einsum("pla,plc->pca", shape(xi)[1], flat)
    return np.clip(xi, -1, 1), np.linalg.det(J)
