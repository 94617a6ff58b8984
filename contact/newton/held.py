"""A contact set put into the tangent, without the zeros of a saddle point on its diagonal.

:class:`Held`: as motions that obey it, which stays symmetric; :class:`Pivots`: where pressures have to be unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import min_weight_full_bipartite_matching
from scipy.sparse.linalg import SuperLU

from contact.problem import ContactProblem
from contact.solvers.sparse import SingularMatrixError, added, superlu

OWN = 0.1  # of the largest slope of a gap: an unknown of its own with less does not hold it
FAINT = 1e-3  # of it: no pivot


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
        size, found = largest(held), largest(column)
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        found[found == 0] = 1.0  # the pressure acts on nothing: singular, which the factorisation will say
        return cls(rows, problem.gap(u)[nodes], grip, held, column, size / found, epsilon)

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
    Raises ValueError when a gap has no unknown, or the gaps depend on one another.
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
    """The grip on gaps that share unknowns, of the candidates ``nodes`` (a,); raises ValueError where some depend."""
    most = np.abs(_by_largest(rows, nodes).slope)
    firm = rows.copy()
    firm.data[np.abs(firm.data) < FAINT * np.repeat(most, np.diff(rows.indptr))] = 0.0
    firm.eliminate_zeros()
    columns, numbered = np.unique(firm.indices, return_inverse=True)
    costs = 1.0 + np.log(np.max(np.abs(firm.data))) - np.log(np.abs(firm.data))  # a zero would be no entry
    graph = sparse.csr_matrix((costs, numbered, firm.indptr), shape=(len(nodes), len(columns)))
    dependent = ValueError(f"the gaps of {len(nodes)} contact candidates depend on one another")
    try:
        order, found = min_weight_full_bipartite_matching(graph)
        if len(order) < len(nodes):
            raise dependent
        pivot = columns[found[np.argsort(order)]]
        block = superlu(sparse.csc_matrix(rows[:, pivot]))
    except (ValueError, SingularMatrixError):
        raise dependent from None
    return Grip(pivot, np.asarray(rows[np.arange(len(nodes)), pivot]).ravel(), block)


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
    T on the left is that of the rows by which forces act, without them. Gaps that share the unknowns that hold them
    have B^-1 in the place of 1/G_k, see :class:`Grip`, and entries beyond those of K.
    """

    K: sparse.csc_matrix
    rows: sparse.csr_matrix  # G_A (a, n)
    acting: sparse.csr_matrix  # the same for forces
    grip: Grip
    compliance: np.ndarray  # diagonal of E [mm/N]
    share: np.ndarray  # t
    spring: np.ndarray  # D_kk

    @classmethod
    def on(
        cls,
        problem: ContactProblem,
        u: np.ndarray,
        nodes: np.ndarray,
        K: sparse.csc_matrix,
        epsilon: float,
        grip: Grip | None = None,
    ) -> Held:
        """The set of these candidates, of a known grip or not; raises ValueError when :func:`holding` does."""
        rows = problem.gap_jacobian(u)[nodes]
        acting = problem.push(u)[nodes] if problem.driven else rows
        grip = grip or holding(acting, nodes)
        size = largest(sparse.csc_matrix(K[:, grip.pivot]))
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        compliance = 1.0 / (epsilon * problem.weights[nodes])
        soft = compliance / grip.slope**2
        spring = size / (1 + soft * size)
        return cls(K, rows, acting, grip, compliance, np.sqrt(soft * spring), spring)

    @property
    def pivot(self) -> np.ndarray:
        """All k (a,)."""
        return self.grip.pivot

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
        if self.grip.inverse is not None:
            own = self.grip.inverse @ (sparse.diags_array(self.grip.slope) @ own)
        return sparse.csr_matrix(self.grip.reciprocal @ rows - own)

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
        left = force - self.columns @ self.grip.over(slack)
        return np.asarray(left - self.balancing.T @ left[self.pivot])

    def motion(self, y: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """du = T y + P slack (n,)."""
        du = y.copy()
        du[self.pivot] += self.grip.over(slack) - self.following @ y
        return du

    def forces(self, y: np.ndarray, du: np.ndarray, residual: np.ndarray) -> np.ndarray:
        """f (a,) [N]: of springs softer than the shell what they are pushed in by, else all that is left along k."""
        found = self.grip.under(self.across @ du + residual[self.pivot])
        soft = self.share**2 > 0.5
        found[soft] = -(self.grip.slope * self.share * y[self.pivot])[soft] / self.compliance[soft]
        return found

    @property
    def stiffness(self) -> sparse.csc_matrix:
        """P^T K P (a, a): forces of slacks, all else at rest."""
        if self.grip.inverse is not None:
            return sparse.csc_matrix(self.grip.inverse.T @ self.columns[self.pivot] @ self.grip.inverse)
        inner, slope = self.columns[self.pivot].tocoo(), self.grip.slope
        scaled = inner.data / slope[inner.row] / slope[inner.col]
        return sparse.csc_matrix((scaled, (inner.row, inner.col)), shape=inner.shape)

    def sides(
        self,
        rows: sparse.csr_matrix,
        acting: sparse.csr_matrix,
        forced: np.ndarray,
        to_slack: sparse.csr_matrix,
        multiplied: sparse.csr_matrix,
    ) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
        """What there is of y in outputs, and what inputs put on the right-hand side of y (n, d).

        rows, acting, forced, to_slack, multiplied: see :class:`contact.newton.exchange.Exchange`.
        """
        free, reciprocal = sparse.diags_array(forced.astype(float)), self.grip.reciprocal
        seen = sparse.csc_matrix(rows.T @ free + self.across.T @ reciprocal @ multiplied.T)
        done = sparse.csc_matrix(acting.T @ free - self.columns @ reciprocal @ to_slack)
        seen = sparse.csc_matrix(seen - self.following.T @ seen[self.pivot])
        return seen, sparse.csc_matrix(done - self.balancing.T @ done[self.pivot])

    def direct(
        self,
        rows: sparse.csr_matrix,
        forced: np.ndarray,
        to_slack: sparse.csr_matrix,
        multiplied: sparse.csr_matrix,
        places: np.ndarray,
    ) -> np.ndarray:
        """Outputs (d, p) of inputs at these places that do not go by way of y.

        G P, gaps of other candidates under the slacks: a way that is free may push where another one is held.
        """
        shared = sparse.diags_array(forced.astype(float)) @ rows[:, self.pivot] @ self.grip.reciprocal
        slack = to_slack[:, places]
        found = shared @ slack + multiplied @ (self.stiffness @ slack - shared.T[:, places])
        return np.asarray(found.toarray())

    @property
    def multipliers(self) -> int:
        """No unknown is a force."""
        return 0


def holdable(problem: ContactProblem) -> bool:
    """Whether every pressure is a force on its own candidate, so that it can be left out of the unknowns."""
    return problem.coupling is None and bool(np.all(problem.weights > 0))
