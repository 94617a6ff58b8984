"""Products of series of quantities under a quadratic measure, formed by its few monomials.

With q = sum q_k a^k and E = L q + 1/2 q Q q, the coefficients of E and of the forces (L + Q q)^T H are sums over the
pairs of orders that add up to k (Cauchy products). A measure has some 30 monomials, most of them once on either face:
the sums are formed one by one of them, both faces at once, along contiguous points, not by the tables (n_e, n_q, n_q),
which hold fifty times as many zeros. No element may enter here.
"""

from __future__ import annotations

import numpy as np

from formulations.strains.measure import QuadraticMeasure

FACES = ((1, 1, 1), (1, 1, 0), (1, 0, 1))  # from a term on the inner face to the same on the outer: strain, quantities


class Products:
    """Of the measure with the quadratic tables Q (n_e, n_q, n_q)."""

    def __init__(self, measure: QuadraticMeasure) -> None:
        terms = _both_faces(measure.quadratic)
        n_e, n_q = measure.linear.shape
        self._squares = 0.5 * np.einsum("nii->ni", measure.quadratic)
        products = [term for term in terms if term[1].start < term[2].start]  # the tables are symmetric
        self._products = [(i, j) for _, i, j, _ in products]
        self._strain = _gather([(n, c) for n, _, _, c in products], n_e)
        self._pairs = [(j, n) for n, _, j, _ in terms]
        self._force = _gather([(i, c) for _, i, _, c in terms], n_q)

    def strain(self, q: np.ndarray, k: int) -> np.ndarray:
        """1/2 sum_{i=1}^{k-1} q_i Q q_{k-i}, (n_e, P), of coefficients q (> k - 1, n_q, P)."""
        ahead, back, half = q[1:k], q[k - 1 : 0 : -1], (k - 1) // 2
        squares = 2.0 * np.einsum("krp,krp->rp", ahead[:half], back[:half])
        if k % 2 == 0:
            squares += q[k // 2] ** 2
        found = np.zeros((len(self._products), 2, q.shape[2]))
        for out, (i, j) in zip(found, self._products, strict=True):
            _sum(ahead[:, i], back[:, j], out)
        return self._squares @ squares + self._strain @ found.reshape(-1, q.shape[2])

    def force(self, q: np.ndarray, H: np.ndarray, k: int) -> np.ndarray:
        """sum_{i=1}^{k-1} (Q q_i)^T H_{k-i}, (n_q, P), of coefficients q (> k - 1, n_q, P) and H (> k - 1, n_e, P)."""
        ahead, back = q[1:k], H[k - 1 : 0 : -1]
        found = np.zeros((len(self._pairs), 2, q.shape[2]))
        for out, (j, n) in zip(found, self._pairs, strict=True):
            _sum(ahead[:, j], back[:, n], out)
        return self._force @ found.reshape(-1, q.shape[2])


def _both_faces(quadratic: np.ndarray) -> list[tuple[slice, slice, slice, float]]:
    """The terms of the tables as rows of strains and of two quantities, those of both faces as one where they can."""
    left = {tuple(map(int, place)): float(quadratic[tuple(place)]) for place in np.argwhere(quadratic)}
    found = []
    while left:
        (place, c) = next(iter(left.items()))
        steps = (step for step in FACES if left.get(tuple(np.add(place, step).tolist())) == c)
        step = next(steps, (0, 0, 0))
        del left[place]
        left.pop(tuple(np.add(place, step).tolist()), None)
        n, i, j = (slice(start, start + 1 + more) for start, more in zip(place, step, strict=True))
        found.append((n, i, j, c))
    return found


def _gather(terms: list[tuple[slice, float]], rows: int) -> np.ndarray:
    """(rows, 2 terms): adds products, two of each term, one where it stands for a single row, to their rows."""
    matrix = np.zeros((rows, len(terms), 2))
    for t, (row, c) in enumerate(terms):
        for face in (0, 1):
            matrix[min(row.start + face, row.stop - 1), t, face] += c
    return matrix.reshape(rows, -1)


def _sum(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """sum_i a_i b_i, (rows, P), into the first rows; one row of the one may meet two of the other."""
    np.einsum("krp,krp->rp", a, b, out=out[: max(a.shape[1], b.shape[1])])
