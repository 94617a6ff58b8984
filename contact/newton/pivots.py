"""The constraints of a contact set, put into the tangent without the zeros of a saddle point on its diagonal."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.problem import ContactProblem


@dataclass(frozen=True, eq=False)
class Pivots:
    """The constraints of the set, each solved for the displacement it holds most firmly.

    The saddle-point system has zeros on its diagonal, which make a sparse factorisation of symmetric pattern pivot and
    fill (7 times slower on the tyre). Writing du_k = -(g + p/epsilon + sum_{j != k} G_j du_j)/G_k instead, and p/s in
    the column that du_k leaves free, keeps size and pattern of K, and loses no digit for any epsilon.
    """

    rows: sparse.csr_matrix  # G_A (a, n)
    gap: np.ndarray  # g_A
    pivot: np.ndarray  # k of each node of the set
    slope: np.ndarray  # G_k
    held: sparse.csc_matrix  # the columns K_k
    column: sparse.csc_matrix  # K_k/(epsilon G_k) + G^T W, the force of each pressure on the unknowns (n, a)
    scale: np.ndarray  # s, which gives these columns the size of the K_k; their diagonal may well be zero
    epsilon: float

    @classmethod
    def choose(
        cls,
        problem: ContactProblem,
        u: np.ndarray,
        nodes: np.ndarray,
        K: sparse.csc_matrix,
        epsilon: float,
    ) -> Pivots:
        """Largest entry of each gap row as pivot; raises ValueError when it has none or two rows share an unknown."""
        rows, acting = problem.gap_jacobian(u)[nodes], problem.push(u)
        push = sparse.csc_matrix(acting.T @ problem.weight_matrix[:, nodes])
        pivot, slope = holding(acting[nodes], nodes)
        held = sparse.csc_matrix(K[:, pivot])
        column = sparse.csc_matrix(push + held @ sparse.diags_array(1.0 / (epsilon * slope)))
        size, found = largest(held), largest(column)
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        found[found == 0] = 1.0  # the pressure acts on nothing: singular, which the factorisation will say
        return cls(rows, problem.gap(u)[nodes], pivot, slope, held, column, size / found, epsilon)

    def substitute(self, K: sparse.csc_matrix, b: np.ndarray) -> tuple[sparse.csc_matrix, np.ndarray]:
        """Matrix and right-hand side for du with p/s in place of each du_k, or with nothing there."""
        a, n = len(self.pivot), K.shape[0]
        place = sparse.csr_matrix((np.ones(a), self.pivot, np.arange(a + 1)), shape=(a, n))
        on_others = self.held @ (sparse.diags_array(-1.0 / self.slope) @ self.rows)
        column = self.column @ sparse.diags_array(self.scale)
        return sparse.csc_matrix(K + (on_others - column @ place)), b + self.held @ (self.gap / self.slope)

    def homogeneous(self) -> Pivots:
        """The same for closed gaps, as of a motion that leaves them so."""
        return replace(self, gap=np.zeros_like(self.gap))

    def resolve(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du and the pressures of the set from the solution of the substituted system."""
        pressure, du = self.scale * x[self.pivot], x.copy()
        du[self.pivot] = 0.0
        du[self.pivot] = -(self.gap + pressure / self.epsilon + self.rows @ du) / self.slope
        return du, pressure


def holding(rows: sparse.csr_matrix, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The unknown that holds each gap most firmly, and the slope of the gap in it.

    Raises ValueError when a gap has no unknown, or two share one.
    """
    if np.max(np.bincount(rows.indices[rows.data != 0]), initial=0) > 1:
        raise ValueError("two contact candidates share an unknown: node-to-obstacle contact is required")
    number = np.diff(rows.indptr)
    largest_last = np.lexsort((np.abs(rows.data), np.repeat(np.arange(len(number)), number)))
    pivot, slope = np.zeros(len(number), np.intp), np.zeros(len(number))
    some = largest_last[rows.indptr[1:][number > 0] - 1]
    pivot[number > 0], slope[number > 0] = rows.indices[some], rows.data[some]
    if not np.all(slope):
        names = ", ".join(map(str, nodes[slope == 0]))
        raise ValueError(f"contact candidate {names} has no unknown: its supports hold it before the foundation")
    return pivot, slope


def largest(A: sparse.csc_matrix) -> np.ndarray:
    """Size (a,) of each column."""
    return np.asarray(abs(A).max(axis=0).toarray()).ravel()
