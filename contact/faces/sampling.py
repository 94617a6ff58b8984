"""Where a slave is looked at: its nodes, or points between them whose gaps are averaged with its own multipliers.

nodes: S = 1, C = 1: each node against the patch that it meets.
mortar: g_i = sum_s w_s Phi_i(xi_s) gamma_s/W_i with the reference areas w_s of points in the patches of the slave, and
W_i = int Phi_i dA over them. The points lie in the pieces into which the patches of the master cut those of the slave
at rest, where the shape functions of both are smooth: between flat parallelograms that lie on each other as at rest
every integral is exact. They stay where they are in the slave, so that gaps have exact derivatives; where the master
slides, its edges pass between them. A patch that does not look at the master all over has OWN^2 points of Gauss.
Phi are the shape functions of the slave, so that a uniform pressure is one of theirs, and forces are p_i W_i on both
sides.
Sources: Puso, Laursen, CMAME 193 (2004) 601-629; Farah, Popp, Wall, Comput. Mech. 55 (2015) 209-228.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from contact.faces.patches import CORNERS, frames, shape
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
OWN = 4  # points along each side of a patch that does not look at the master all over
SIDES = np.array([[[0, 3], [1, 2]], [[0, 1], [3, 2]]])  # corners of a patch at the ends of each coordinate
_X, _W = np.polynomial.legendre.leggauss(OWN)
INSIDE, INSIDE_WEIGHTS = np.stack(np.meshgrid(_X, _X), axis=-1).reshape(-1, 2), np.outer(_W, _W).ravel()


@dataclass(frozen=True, eq=False)
class Sampling:
    """points S (p, k): those of the slave from the points of the faces.  average C (m, p): gaps from theirs.

    weights W (m,) [mm^2]: reference areas of the candidates.  nodes (m,): which of the points of the faces they are.
    place (p, 3): the patch of the slave that a point lies in, and xi there; -1 of a point that is a corner.
    """

    points: sparse.csr_matrix
    average: sparse.csr_matrix
    weights: np.ndarray
    nodes: np.ndarray
    place: np.ndarray

    @cached_property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """The points of the faces (p, c) that each point lies between, and its shares of them (p, c)."""
        number = np.diff(self.points.indptr)
        row = np.repeat(np.arange(len(number)), number)
        place = np.arange(len(row)) - self.points.indptr[row]
        nodes, values = np.zeros((len(number), place.max() + 1), np.intp), np.zeros((len(number), place.max() + 1))
        nodes[row, place], values[row, place] = self.points.indices, self.points.data
        return nodes, values

    @cached_property
    def patches(self) -> np.ndarray:
        """A number (p,) that points have in common that lie between the same."""
        return np.unique(self.corners[0], axis=0, return_inverse=True)[1].ravel()


def at_nodes(nodes: np.ndarray, k: int, weights: np.ndarray) -> Sampling:
    """The points ``nodes`` (m,) of k, with areas (m,)."""
    m = len(nodes)
    return Sampling(_chosen(nodes, k), _chosen(np.arange(m), m), weights, nodes, _corners(m))


def joined(sampling: Sampling, count: int) -> Sampling:
    """One candidate instead of each ``count`` in a row that move alike: its gap is their mean by their areas.

    Its node is the first of theirs.
    """
    weights = sampling.weights.reshape(-1, count)
    m, total = len(weights), weights.sum(axis=1)
    share, ends = weights / total[:, None], count * np.arange(m + 1)
    means = sparse.csr_matrix((share.ravel(), np.arange(weights.size), ends), shape=(m, weights.size))
    average = sparse.csr_matrix(means @ sampling.average)
    return Sampling(sampling.points, average, total, sampling.nodes[::count], sampling.place)


def mortar(x: np.ndarray, slave: np.ndarray, master: np.ndarray, nodes: np.ndarray) -> Sampling:
    """The patches ``slave`` (a, 4) before ``master`` (b, 4) of points x (k, 3) at rest.

    nodes (m,): those of the slave that have a multiplier. One that has nothing before it but what is beside the master
    is a point by itself.
    """
    patch, xi, area = _points(x, slave, master)
    N, slope = shape(xi)
    quads = slave[patch]
    a = np.einsum("pla,plc->pca", slope, x[quads])
    w = area * np.linalg.norm(np.cross(a[..., 0], a[..., 1]), axis=1)
    ends, of = 4 * np.arange(len(w) + 1), (len(w), len(x))
    points = sparse.csr_matrix((N.ravel(), quads.ravel(), ends), shape=of)
    of_node = sparse.csr_matrix(((w[:, None] * N).ravel(), quads.ravel(), ends), shape=of).T.tocsr()[nodes]
    weights, whole = np.asarray(of_node.sum(axis=1)).ravel(), areas(x, slave)[nodes]
    alone = np.flatnonzero(weights <= SLIVER * whole)
    weights[alone] = whole[alone]
    average = [sparse.diags_array(1 / weights) @ of_node, _chosen(alone, len(nodes)).T]
    points = sparse.vstack([points, _chosen(nodes[alone], len(x))], format="csr")
    place = np.vstack([np.column_stack([patch, xi]), _corners(len(alone))])
    averaged = sparse.csr_matrix(sparse.hstack(average, format="csr"))
    return Sampling(sparse.csr_matrix(points), averaged, weights, nodes, place)


def _corners(count: int) -> np.ndarray:
    """The places (count, 3) of points that are corners."""
    return np.tile([-1.0, 0.0, 0.0], (count, 1))


def _points(x: np.ndarray, slave: np.ndarray, master: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Patch (p,), xi (p, 2) and weights (p,) of an integral over xi.

    Pieces, or, of a patch that does not look at the master all over, points of a rule of its own; where that is because
    it lies beyond the rim, nothing is before the rest of it.
    """
    patch, xi, area = pieces(x, slave, master)
    whole = np.bincount(patch, area, minlength=len(slave)) >= INSIDE_WEIGHTS.sum() * (1 - ON)
    beside = np.zeros((len(slave), len(INSIDE)), bool)
    some = np.flatnonzero(~whole)
    beside[some] = _beside(x, slave[some], master)
    own, kept = np.flatnonzero(~whole & ~beside.any(axis=1)), (whole | beside.any(axis=1))[patch]
    return (
        np.concatenate([patch[kept], np.repeat(own, len(INSIDE))]),
        np.vstack([xi[kept], np.tile(INSIDE, (len(own), 1))]),
        np.append(area[kept], np.tile(INSIDE_WEIGHTS, len(own))),
    )


def _beside(x: np.ndarray, slave: np.ndarray, master: np.ndarray) -> np.ndarray:
    """Which points of the rule in patches (a, 4) are beyond the rim of the master, no farther than a patch is long."""
    corners = x[slave]
    at = np.einsum("gl,alc->agc", shape(INSIDE)[0], corners).reshape(-1, 3)
    near = nearest(at, x, master)
    edges = np.sort(master[:, SIDES], axis=-1)
    _, which, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True)
    rim = (number[which.ravel()] == 1).reshape(-1, 2, 2)
    over = near.xi > 0
    beyond = ~near.free & np.take_along_axis(rim[near.quad], over[..., None].astype(int), axis=2)[..., 0]
    long = np.repeat(np.linalg.norm(np.ptp(corners, axis=1), axis=1), len(INSIDE))
    return np.asarray((beyond.any(axis=1) & (np.abs(near.gap) <= long)).reshape(len(slave), len(INSIDE)))


def areas(x: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """W (k,) [mm^2] of the points x (k, 3) of a face, zero where no patch is."""
    N, slope = shape(GAUSS)
    a = np.einsum("gla,qlc->qgca", slope, x[quads])
    dA = np.linalg.norm(np.cross(a[..., 0], a[..., 1]), axis=-1)
    return np.bincount(quads.ravel(), (dA @ N).ravel(), minlength=len(x))


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
    middle, axes = corners.mean(axis=1), frames(corners)[..., :2]
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
    within = cKDTree(middles).query_ball_point(middle[near], (own + radius.max() + away)[near])
    a = np.repeat(near, [len(each) for each in within])
    b = np.concatenate([np.zeros(0, np.intp), *(np.asarray(each, np.intp) for each in within)])
    looks = np.einsum("pc,pc->p", frames(mine)[a, :, 2], frames(its)[b, :, 2]) < 0
    return a[looks], b[looks]


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
        kept, number = np.zeros((p, 9, 2)), np.zeros(p, np.intp)
        for i in range(8):
            exists = i < count
            j = np.where(i + 1 < count, i + 1, 0)
            every = np.arange(p)
            s, t, there = inside[:, i], inside[every, j], here[every, j]
            keeps = exists & (s >= 0)
            kept[every[keeps], number[keeps]] = here[keeps, i]
            number += keeps
            cuts = exists & (s * t < 0)
            share = np.divide(s, s - t, out=np.zeros(p), where=cuts)
            crossing = here[:, i] + share[:, None] * (there - here[:, i])
            kept[every[cuts], number[cuts]] = crossing[cuts]
            number += cuts
        here, count = kept[:, :8], np.minimum(number, 8)
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
