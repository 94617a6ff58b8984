"""A contact set put into the tangent, without the zeros of a saddle point on its diagonal.

:class:`Held`: as motions that obey it, which stays symmetric; :class:`Pivots`: where pressures have to be unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from contact.problem import ContactProblem
from contact.solvers.sparse import added


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
        return sparse.csc_matrix(K + (on_others - column @ place)), self.loaded(b)

    def loaded(self, b: np.ndarray) -> np.ndarray:
        """That right-hand side (n,)."""
        return np.asarray(b + self.held @ (self.gap / self.slope))

    def opened(self, gap: np.ndarray) -> Pivots:
        """The same for other gaps (a,), 0 of a motion that leaves them closed."""
        return replace(self, gap=gap)

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


@dataclass(frozen=True, eq=False)
class Held:
    """The step K du - G_A^T f = -r, G_A du + E f = s - g of a set A with slacks s (a,), 0 unless a node is let go.

    f = w p are nodal forces and E = diag(1/(epsilon w)). Each gap is solved for the displacement k that it holds most
    firmly, du = T y + P (s - g), where P has 1/G_k at k. T leaves the others as they are and makes du_k follow them;
    its t at (k, k) is the share of a spring in du_k, 0 where epsilon is infinite. What is left is, with e = E/G_k^2::

        (T^T K T + D) y = -T^T (r + K P (s - g)),    D_kk = kappa/(1 + e kappa),    t^2 = e D_kk,    f = P^T (K du + r)

    kappa is the size of K_k: the diagonal is as large as that of K for any epsilon. A symmetric K leaves a symmetric
    matrix, a definite one a definite one, and every entry is in a place of K's. Where unknowns move the foundation, the
    T on the left is that of the rows by which forces act, without them.
    """

    K: sparse.csc_matrix
    rows: sparse.csr_matrix  # G_A (a, n)
    acting: sparse.csr_matrix  # the same for forces
    pivot: np.ndarray
    slope: np.ndarray  # G_k
    compliance: np.ndarray  # diagonal of E [mm/N]
    share: np.ndarray  # t
    spring: np.ndarray  # D_kk

    @classmethod
    def on(
        cls, problem: ContactProblem, u: np.ndarray, nodes: np.ndarray, K: sparse.csc_matrix, epsilon: float
    ) -> Held:
        """The set of these candidates; raises ValueError when one has no unknown or two share one."""
        rows = problem.gap_jacobian(u)[nodes]
        acting = problem.push(u)[nodes] if problem.driven else rows
        pivot, slope = holding(acting, nodes)
        size = largest(sparse.csc_matrix(K[:, pivot]))
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        compliance = 1.0 / (epsilon * problem.weights[nodes])
        soft = compliance / slope**2
        spring = size / (1 + soft * size)
        return cls(K, rows, acting, pivot, slope, compliance, np.sqrt(soft * spring), spring)

    @cached_property
    def following(self) -> sparse.csr_matrix:
        """R (a, n): T = 1 - (1 at k) R."""
        return self._following(self.rows)

    @cached_property
    def balancing(self) -> sparse.csr_matrix:
        """R of the T on the left."""
        return self.following if self.acting is self.rows else self._following(self.acting)

    def _following(self, rows: sparse.csr_matrix) -> sparse.csr_matrix:
        a, n = rows.shape
        own = sparse.csr_matrix((self.share, self.pivot, np.arange(a + 1)), shape=(a, n))
        return sparse.csr_matrix(sparse.diags_array(1.0 / self.slope) @ rows - own)

    @cached_property
    def columns(self) -> sparse.csc_matrix:
        """K_k (n, a)."""
        return sparse.csc_matrix(self.K[:, self.pivot])

    @cached_property
    def across(self) -> sparse.csr_matrix:
        """The rows k of K (a, n)."""
        return sparse.csr_matrix(self.K[self.pivot])

    @cached_property
    def matrix(self) -> sparse.csc_matrix:
        """T^T K T + D (n, n)."""
        if len(self.pivot) == 0:
            return self.K
        R, n = self.following, self.K.shape[0]
        change = self.balancing.T @ ((self.columns[self.pivot] @ R) - self.across) - self.columns @ R
        on = sparse.csc_matrix((self.spring, (self.pivot, self.pivot)), shape=(n, n))
        return added(self.K, sparse.csc_matrix(change + on))

    def load(self, force: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """T^T (force - K P slack) (n,), of a slack s - g (a,)."""
        left = force - self.columns @ (slack / self.slope)
        return np.asarray(left - self.balancing.T @ left[self.pivot])

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du = T y + P slack (n,)."""
        du = y.copy()
        du[self.pivot] += slack / self.slope - self.following @ y
        return du

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]: of springs softer than the shell what they are pushed in by, else all that is left along k."""
        found = np.asarray((self.across @ du + residual[self.pivot]) / self.slope)
        soft = self.share**2 > 0.5
        found[soft] = -(self.slope * self.share * y[self.pivot])[soft] / self.compliance[soft]
        return found

    @property
    def stiffness(self) -> sparse.csc_matrix:
        """P^T K P (a, a): forces of slacks, all else at rest."""
        inner = self.columns[self.pivot].tocoo()
        scaled = inner.data / self.slope[inner.row] / self.slope[inner.col]
        return sparse.csc_matrix((scaled, (inner.row, inner.col)), shape=inner.shape)

    def shared(self, rows: sparse.csr_matrix) -> sparse.csr_matrix:
        """G P (b, a): gaps of other candidates under the slacks."""
        return sparse.csr_matrix(rows[:, self.pivot] @ sparse.diags_array(1.0 / self.slope))


def holdable(problem: ContactProblem) -> bool:
    """Whether every pressure is a force on its own candidate, so that it can be left out of the unknowns."""
    return problem.coupling is None and bool(np.all(problem.weights > 0))
