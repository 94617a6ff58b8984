"""Products of series of quantities under a quadratic measure, formed by its few monomials.

With q = sum q_k a^k and E = L q + 1/2 q Q q, the coefficients of E and of the forces (L + Q q)^T H are sums over the
pairs of orders that add up to k (Cauchy products). A measure has some 30 monomials, most of them on either face and for
three components: such blocks are formed at once, along contiguous points, and not the tables (n_e, n_q, n_q), which
hold fifty times as many zeros. No element may enter here.

The element along a path that is a power series: what the orders before k put into the equilibrium of order k.

With v = sum v_k a^k, the strains of a quadratic measure on the modes are E_k = B_0 v_k + E'_k, the resultants
H_k = D E_k, and the internal force is sum f_k a^k with f_k = K_T v_k + r_k::

    E'_k = P 1/2 sum_{i=1}^{k-1} q_i Q q_{k-i}
    r_k = B_0^T W D E'_k + Q_op^T sum_{i=1}^{k-1} (Q q_i)^T P^T W H_{k-i}

P samples and projects (Gauss points, nodes for E33, relaxation), W are the weights of the modes. The modes are strains
of the displacements and nothing is condensed that depends on the state: with all f_k balanced the path is that of the
discrete equilibrium itself. Source: Cochelin, Potier-Ferry, Int. J. Numer. Meth. Engng 37 (1994) 1187-1203. No support,
no load and no equation to solve may enter here.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import as_strided

from formulations.element.mixed import MODE_WEIGHTS, N_M, MixedElement
from formulations.element.strain_operator import N_DOF, N_GAUSS, ElementGeometry
from formulations.operations import product, spend
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.quantities import N_E, N_Q, N_V

Term = tuple[int, int, int]  # strain n, quantities i and j of an entry of Q
NO_STEP = (0, 0, 0)
FACES = (NO_STEP, (1, 1, 1), (1, 1, 0), (1, 0, 1))  # from a term on the inner face to the same on the outer
COMPONENTS = (NO_STEP, (0, 2, 2), (0, 2, 1), (0, 1, 2), (0, 1, 1))  # from l to w and t, and along beta


class Block(NamedTuple):
    """Terms first + x along + r face, x < components, r < faces."""

    first: Term
    along: Term
    components: int
    face: Term
    faces: int

    def terms(self) -> dict[Term, None]:
        """In order."""
        xr = [(x, r) for x in range(self.components) for r in range(self.faces)]
        places = ([f + x * a + r * b for f, a, b in zip(self.first, self.along, self.face, strict=True)] for x, r in xr)
        return dict.fromkeys((n, i, j) for n, i, j in places)

    def rows(self, which: int, of: np.ndarray) -> np.ndarray:
        """The rows n, i or j (``which`` 0, 1, 2) of the terms in coefficients (orders, rows, P), as a view."""
        order, row, point = of.strides
        strides = (order, self.along[which] * row, self.face[which] * row, point)
        return as_strided(of[:, self.first[which] :], (len(of), self.components, self.faces, of.shape[2]), strides)


class Products:
    """Coefficients q (order + 1, n_q, P) and H (order + 1, n_e, P), to be filled in order by order, and their sums."""

    def __init__(self, measure: QuadraticMeasure, order: int, points: int) -> None:
        n_e, n_q = measure.linear.shape
        self.q, self.H = np.zeros((order + 1, n_q, points)), np.zeros((order + 1, n_e, points))
        self._squares = 0.5 * np.einsum("nii->ni", measure.quadratic)
        strain, force = (_sums(measure, symmetric=symmetric) for symmetric in (True, False))
        self._pairs = Sums.of(*strain, (1, self.q), (2, self.q))
        self._works = Sums.of(*force, (2, self.q), (0, self.H))

    def strain(self, k: int) -> np.ndarray:
        """1/2 sum_{i=1}^{k-1} q_i Q q_{k-i}, (n_e, P)."""
        half = (k - 1) // 2
        squares = 2.0 * np.einsum("krp,krp->rp", self.q[1 : half + 1], self.q[k - 1 : k - 1 - half : -1])
        if k % 2 == 0:
            squares += self.q[k // 2] ** 2
        return np.asarray(self._squares @ squares + self._pairs.at(k))

    def force(self, k: int) -> np.ndarray:
        """sum_{i=1}^{k-1} (Q q_i)^T H_{k-i}, (n_q, P)."""
        return self._works.at(k)


class Sums(NamedTuple):
    """Factors a and b of every block as views of the coefficients, where its sums go, and what adds all terms up."""

    factors: list[tuple[np.ndarray, np.ndarray, np.ndarray]]
    formed: np.ndarray
    matrix: np.ndarray

    @classmethod
    def of(cls, blocks: list[Block], matrix: np.ndarray, a: tuple[int, np.ndarray], b: tuple[int, np.ndarray]) -> Sums:
        """a, b: which rows of which coefficients are multiplied."""
        formed, factors, end = np.empty((matrix.shape[1], a[1].shape[2])), [], 0
        for block in blocks:
            start, end = end, end + block.components * block.faces
            out = formed[start:end].reshape(block.components, block.faces, -1)
            factors.append((block.rows(*a), block.rows(*b), out))
        return cls(factors, formed, matrix)

    def at(self, k: int) -> np.ndarray:
        """sum_{i=1}^{k-1} a_i b_{k-i} of all terms, added up: (rows, P)."""
        for a, b, out in self.factors:
            np.einsum("kxrp,kxrp->xrp", a[1:k], b[k - 1 : 0 : -1], out=out)
        return np.asarray(self.matrix @ self.formed)


@cache
def _sums(measure: QuadraticMeasure, *, symmetric: bool) -> tuple[list[Block], np.ndarray]:
    """Blocks of terms and the matrix that adds them up: to strains, i < j alone (Q is symmetric), or to the forces."""
    Q = measure.quadratic
    left = {(int(n), int(i), int(j)) for n, i, j in np.argwhere(Q) if i < j or not symmetric}
    blocks = []
    while left:
        first = min(left)
        fit = [block for block in _blocks(first) if block.terms().keys() <= left]
        blocks.append(max(fit, key=lambda block: block.components * block.faces))
        left -= blocks[-1].terms().keys()
    rows = [term for block in blocks for term in block.terms()]
    matrix = np.zeros((Q.shape[0 if symmetric else 1], len(rows)))
    for place, term in enumerate(rows):
        matrix[term[0 if symmetric else 1], place] = Q[term]
    return blocks, matrix


def _blocks(first: Term) -> Iterator[Block]:
    """Those that may begin with a term."""
    for face in FACES:
        for along in COMPONENTS:
            yield Block(first, along, 3 if any(along) else 1, face, 2 if any(face) else 1)


class ElementSeries:
    """The recurrence at nodal displacements v_0 (E, 24); :meth:`add` is given v_1, v_2, ... in turn.

    order: the largest k.  Raises ValueError for a measure that is not quadratic.
    """

    def __init__(self, element: MixedElement, geometry: ElementGeometry, v: np.ndarray, order: int) -> None:
        if not isinstance(element.measure, QuadraticMeasure) or not isinstance(element.through, QuadraticMeasure):
            raise ValueError(f"measure {element.measure.name} is not quadratic")
        self._element, self._geometry = element, geometry
        points = N_GAUSS * len(v)
        self._products = Products(element.measure, order, points)
        self._through = None if element.nodal is None else Products(element.through, order, points)
        self._weight = MODE_WEIGHTS * geometry.weight[:, None]
        self._B = element.mode_gradient(geometry, v)
        self._higher = np.zeros((len(v), N_M))
        self._k = 0

    def add(self, v: np.ndarray) -> np.ndarray:
        """r_{k+1} (E, 24) once v_k (E, 24) is known."""
        element, geometry = self._element, self._geometry
        self._k += 1
        k, n = self._k, len(v)
        spend(n * (2 * product(N_M, N_DOF) + 2 * product(N_GAUSS * N_Q, N_DOF) + 8 * N_GAUSS * N_Q * k))
        q = np.matmul(geometry.Q, v[..., None])[..., 0]
        self._products.q[k] = q.reshape(-1, N_Q).T
        strains = np.matmul(self._B, v[..., None])[..., 0] + self._higher
        at_gauss, at_nodes = element.sampled_work(geometry, self._weight * element.resultants(strains))
        self._products.H[k] = at_gauss.reshape(-1, N_E).T
        samples = self._products.strain(k + 1).T.reshape(-1, N_GAUSS, N_E)
        nodal = None
        if self._through is not None and at_nodes is not None:
            self._through.q[k] = (v.reshape(-1, N_V) @ geometry.director.T).T
            self._through.H[k] = at_nodes.reshape(1, -1)
            nodal = self._through.strain(k + 1).reshape(-1, 4)
        self._higher = element.on_modes(geometry, samples, nodal)
        force = np.matmul((self._weight * element.resultants(self._higher))[:, None], self._B)[:, 0]
        along = self._products.force(k + 1).T.reshape(-1, 1, N_GAUSS * N_Q)
        force += np.matmul(along, geometry.Q)[:, 0]
        if self._through is not None:
            by_beta = self._through.force(k + 1).T @ geometry.director
            force += by_beta.reshape(-1, N_DOF)
        return force
