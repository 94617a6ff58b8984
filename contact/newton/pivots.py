"""The unknowns that hold the gaps of a contact set most firmly, and pressures in their place in the tangent.

No state and no friction enters here, and no condensed matrix: that is :mod:`contact.newton.held`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import min_weight_full_bipartite_matching
from scipy.sparse.linalg import SuperLU

from contact.problem import ContactProblem
from contact.solvers.sparse import SingularMatrixError, superlu

OWN = 0.1  # of the largest slope of a gap: an unknown of its own with less does not hold it
FAINT = 1e-3  # of it: no pivot


class DependentGapsError(SingularMatrixError, ValueError):
    """Gaps of a set that no unknowns can hold one by one: the saddle-point problem is singular on it."""


@dataclass(frozen=True, eq=False)
class Pivots:
    """The constraints of the set, each solved for the displacement it holds most firmly.

    The saddle-point system has zeros on its diagonal, which make a sparse factorisation of symmetric pattern pivot and
    fill (7 times slower on the tyre). Writing du_k = -(g + p/epsilon + sum_{j != k} G_j du_j)/G_k instead, and p/s in
    the column that du_k leaves free, keeps size and pattern of K, and loses no digit for any epsilon.
    """

    rows: sparse.csr_matrix  # G_A (a, n)
    gap: np.ndarray  # g_A
    grip: Grip
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
        """Pivots of the gap rows as :func:`holding` has them, raises ValueError when it does."""
        rows, acting = problem.gap_jacobian(u)[nodes], problem.push(u)
        push = sparse.csc_matrix(acting.T @ problem.weight_matrix[:, nodes])
        grip = holding(acting[nodes], nodes)
        held = sparse.csc_matrix(K[:, grip.pivot])
        column = sparse.csc_matrix(push + held @ (grip.reciprocal / epsilon))
        size, most = largest(held), largest(column)
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        most[most == 0] = 1.0  # the pressure acts on nothing: singular, which the factorisation will say
        return cls(rows, problem.gap(u)[nodes], grip, held, column, size / most, epsilon)

    def substitute(self, K: sparse.csc_matrix, b: np.ndarray) -> tuple[sparse.csc_matrix, np.ndarray]:
        """Matrix and right-hand side for du with p/s in place of each du_k, or with nothing there."""
        a, n = len(self.grip.pivot), K.shape[0]
        place = sparse.csr_matrix((np.ones(a), self.grip.pivot, np.arange(a + 1)), shape=(a, n))
        on_others = self.held @ (-self.grip.reciprocal @ self.rows)
        column = self.column @ sparse.diags_array(self.scale)
        return sparse.csc_matrix(K + (on_others - column @ place)), self.loaded(b)

    def loaded(self, b: np.ndarray) -> np.ndarray:
        """That right-hand side (n,)."""
        return np.asarray(b + self.held @ self.grip.over(self.gap))

    def opened(self, gap: np.ndarray) -> Pivots:
        """The same for other gaps (a,), 0 of a motion that leaves them closed."""
        return replace(self, gap=gap)

    def resolve(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du and the pressures of the set from the solution of the substituted system."""
        pivot, du = self.grip.pivot, x.copy()
        pressure = self.scale * x[pivot]
        du[pivot] = 0.0
        du[pivot] = -self.grip.over(self.gap + pressure / self.epsilon + self.rows @ du)
        return du, pressure


@dataclass(frozen=True, eq=False)
class Grip:
    """The unknown k that holds each gap, pivot (a,), and the slope G_k (a,) of the gap in it.

    block: factors of B (a, a), the gaps in the unknowns that hold all of them; None where B is diagonal.
    """

    pivot: np.ndarray
    slope: np.ndarray
    block: SuperLU | None = None

    @cached_property
    def inverse(self) -> sparse.csr_matrix | None:
        """B^-1 (a, a), None where B is diagonal."""
        return None if self.block is None else sparse.csr_matrix(self.block.solve(np.eye(len(self.pivot))))

    @property
    def reciprocal(self) -> sparse.csr_matrix | sparse.dia_array:
        """B^-1 (a, a)."""
        return sparse.diags_array(1.0 / self.slope) if self.inverse is None else self.inverse

    def over(self, gaps: np.ndarray) -> np.ndarray:
        """B^-1 g (a,): changes of those unknowns."""
        return np.asarray(gaps / self.slope if self.block is None else self.block.solve(gaps))

    def under(self, forces: np.ndarray) -> np.ndarray:
        """B^-T f (a,): forces along the gaps from those on the unknowns."""
        if self.block is None:
            return np.asarray(forces / self.slope)
        return np.asarray(self.block.solve(forces, "T"))  # type: ignore[call-overload]  # its stubs know no vectors


def holding(rows: sparse.csr_matrix, nodes: np.ndarray) -> Grip:
    """The unknown that holds each gap most firmly.

    Candidates against a foundation share no unknown. Where others do, as between faces that both deform, each takes one
    that is its own; where some have none, all are matched, so that the product of the slopes is as large as it can be.
    Raises ValueError when a gap has no unknown, DependentGapsError when the gaps depend on one another.
    Source: Duff, Koster, SIAM J. Matrix Anal. Appl. 20 (1999) 889-901.
    """
    used = np.bincount(rows.indices[rows.data != 0], minlength=rows.shape[1])
    if np.max(used, initial=0) <= 1:
        return _by_largest(rows, nodes)
    own = rows.copy()
    own.data = np.where(used[rows.indices] == 1, rows.data, 0.0)
    size, most = (largest(sparse.csc_matrix(each.T)) for each in (own, rows))
    return _by_largest(own, nodes) if np.all((size >= OWN * most) & (most > 0)) else matched(rows, nodes)


def _by_largest(rows: sparse.csr_matrix, nodes: np.ndarray) -> Grip:
    number = np.diff(rows.indptr)
    largest_last = np.lexsort((np.abs(rows.data), np.repeat(np.arange(len(number)), number)))
    pivot, slope = np.zeros(len(number), np.intp), np.zeros(len(number))
    some = largest_last[rows.indptr[1:][number > 0] - 1]
    pivot[number > 0], slope[number > 0] = rows.indices[some], rows.data[some]
    if not np.all(slope):
        names = ", ".join(map(str, nodes[slope == 0]))
        raise ValueError(f"contact candidate {names} has no unknown: its supports hold it before the foundation")
    return Grip(pivot, slope)


def matched(rows: sparse.csr_matrix, nodes: np.ndarray) -> Grip:
    """The grip on gaps that share unknowns, of the candidates ``nodes`` (a,); raises DependentGapsError."""
    most = np.abs(_by_largest(rows, nodes).slope)
    firm = rows.copy()
    firm.data[np.abs(firm.data) < FAINT * np.repeat(most, np.diff(rows.indptr))] = 0.0
    firm.eliminate_zeros()
    columns, numbered = np.unique(firm.indices, return_inverse=True)
    costs = 1.0 + np.log(np.max(np.abs(firm.data))) - np.log(np.abs(firm.data))  # a zero would be no entry
    graph = sparse.csr_matrix((costs, numbered, firm.indptr), shape=(len(nodes), len(columns)))
    dependent = DependentGapsError(f"the gaps of {len(nodes)} contact candidates depend on one another")
    try:
        order, matches = min_weight_full_bipartite_matching(graph)
        if len(order) < len(nodes):
            raise dependent
        pivot = columns[matches[np.argsort(order)]]
        block = superlu(sparse.csc_matrix(rows[:, pivot]))
    except (ValueError, SingularMatrixError):
        raise dependent from None
    return Grip(pivot, np.asarray(rows[np.arange(len(nodes)), pivot]).ravel(), block)


def largest(A: sparse.csc_matrix) -> np.ndarray:
    """Size (a,) of each column."""
    return np.asarray(abs(A).max(axis=0).toarray()).ravel()
