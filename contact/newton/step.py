"""The one Newton that all algorithms share: a linear step on a given contact set, convergence tests, counters, history.

Which nodes belong to the set is the algorithm's business and must not enter here.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from contact.events import Event
from contact.problem import (
    ROUNDING_ALONE,
    ContactProblem,
    ContactSolution,
    Linearised,
    Outcome,
    excused,
    rounding_floor,
)
from contact.solvers.sparse import Factor, checked_solve, factor_flops, factorise

RESIDUAL_TOLERANCE = 1e-9  # relative to the forces in balance; what every algorithm's ``tolerance`` is by default
GAP_TOLERANCE = 1e-12  # relative to the size of the terms that make up the gap
ROUNDING_MARGIN = 10.0
BLOW_UP = 1e12  # residual, relative to the forces at the start, beyond which nothing can be rescued


@dataclass
class NewtonRun:
    """The book-keeping of one solve: a problem, a solver, an epsilon, and what has been spent on them."""

    problem: ContactProblem
    epsilon: float = np.inf
    solver: str = "splu"
    counters: dict[str, float] = field(
        default_factory=lambda: {
            "newton_iterations": 0,
            "factorisations": 0,
            "assemblies": 0,
            "flops": 0,
            "set_changes": 0,
            "assembly_s": 0.0,
            "factorisation_s": 0.0,
            "solve_s": 0.0,
            "contact_s": 0.0,
        }
    )
    history: list[dict[str, object]] = field(default_factory=list)
    tolerance: float = RESIDUAL_TOLERANCE
    clock: Callable[[], float] = time.perf_counter  # what the times of the counters are read from
    flops_by_fill: list[float] = field(default_factory=list)  # of the first factorisation: operations over fill^2
    _first_scale: float = 0.0
    _first_gap_size: float = 0.0
    _scale: float = 0.0
    _residual: float = np.inf
    _set: np.ndarray | None = None  # of the last step
    _moved: float = np.inf  # |du| of the last step, and of the one before it on the same set
    _moved_before: float = np.inf

    def linearise(self, u: np.ndarray, memory: object) -> Linearised:
        """Linearise the mechanics, counted and timed."""
        start = self.clock()
        lin = self.problem.linearise(u, memory)
        self.spend("assembly_s", start)
        self.counters["assemblies"] += 1
        return lin

    def imbalance(self, lin: Linearised, u: np.ndarray, pressure: np.ndarray) -> float:
        """|r - G^T W p| over the largest of the forces in balance; infinite once the iteration has blown up."""
        contact = self.problem.contact_force(u, pressure)
        self._scale = max(lin.scale, float(norm(contact, check_finite=False)))
        self._first_scale = self._first_scale or self._scale
        imbalance = float(norm(lin.residual - contact, check_finite=False))
        if not imbalance <= BLOW_UP * max(self._first_scale, np.finfo(float).tiny):
            self._residual = float("inf")
        else:
            self._residual = imbalance / self._scale if self._scale > 0 else imbalance
        return self._residual

    def balanced(self, lin: Linearised, u: np.ndarray, residual: float) -> bool:
        """True when the relative residual is within tolerance, or is rounding and does not matter.

        What it still asks for is taken to be what the last step has moved.
        """
        if residual <= self.tolerance:
            return True
        size = float(norm(u, check_finite=False))
        return excused(residual, self._rounding(lin, u), self._moved / size if size > 0 else np.inf)

    def stuck(self, lin: Linearised, u: np.ndarray, residual: float) -> bool:
        """True when the residual is rounding and the steps no longer shrink; without balance, that is the end."""
        return residual <= self._rounding(lin, u) and self._moved > 0.5 * self._moved_before

    def closed(self, u: np.ndarray, gap: np.ndarray, pressure: np.ndarray, active: np.ndarray) -> bool:
        """True when the nodes of the set obey g + p/epsilon = 0."""
        mismatch = np.abs(gap + pressure / self.epsilon)[active]
        return bool(np.max(mismatch, initial=0.0) <= GAP_TOLERANCE * self.gap_size(u, gap))

    def misplaced(
        self,
        lin: Linearised,
        u: np.ndarray,
        gap: np.ndarray,
        pressure: np.ndarray,
        active: np.ndarray,
        c: float = 1.0,
        *,
        solved: bool = False,
    ) -> np.ndarray:
        """Candidates (m,) on the wrong side: in the set with p - c g < 0, or out of it with p - c g > 0.

        A node that just touches without pressure has p and g of the size of rounding, and no set is the right one:
        near equilibrium, and where p and g have just been ``solved`` for, what rounding explains swaps nothing.
        """
        excess = np.where(active, 1.0, -1.0) * (pressure - c * gap)
        wrong = excess < 0
        if wrong.any() and (solved or self._residual <= ROUNDING_ALONE):
            force = ROUNDING_MARGIN * (rounding_floor(lin, u) + np.finfo(float).eps * self._scale)
            in_pressure, in_gap = force / self.problem.weights, c * GAP_TOLERANCE * self.gap_size(u, gap)
            # a solved step leaves a pressure in the set and a gap out of it; rounding of the other is none of theirs
            wrong = excess < -(np.where(active, in_pressure, in_gap) if solved else in_pressure + in_gap)
        return wrong

    def gap_size(self, u: np.ndarray, gap: np.ndarray) -> float:
        """Size of the terms that make up a gap; their rounding is the gap's, however small the gap itself.

        Not less than at the start: a body that goes back to zero brings the rounding of its way with it.
        """
        size = self.problem.size_of_gaps(u, gap)
        self._first_gap_size = self._first_gap_size or size
        return max(size, self._first_gap_size)

    def step(
        self, lin: Linearised, u: np.ndarray, pressure: np.ndarray, active: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """One linear step du (n,) on the set ``active``, with the pressures (m,) it brings.

        K du - G^T W p = -r,   G_A du + p_A/epsilon = -g_A,   p = 0 outside the set A.
        Raises SingularMatrixError.
        """
        start = self.clock()
        K = self.problem.stiffness(lin, u, pressure)
        nodes = np.flatnonzero(active)
        A, b, pivots = K, -lin.residual, None
        if len(nodes):
            pivots = Pivots.choose(self.problem, u, nodes, K, self.epsilon)
            A, b = pivots.substitute(K, b)
        self.spend("contact_s", start)
        du = self.solution(self.factorise(A), A, b)
        start = self.clock()
        found = np.zeros_like(pressure)
        if pivots is not None:
            du, found[nodes] = pivots.resolve(du)
        self.spend("contact_s", start)
        return du, found

    def factorise(self, A: sparse.csc_matrix) -> Factor:
        """Factorise, counted and timed; raises SingularMatrixError."""
        start = self.clock()
        factor = factorise(A, self.solver, ordered=self.problem.ordered)
        self.spend("factorisation_s", start)
        self.count(factor)
        return factor

    def count(self, factor: Factor) -> None:
        """Count a factorisation and its operations, about.

        Their number is known of the first one; others differ in a few columns, and count by the square of their fill.
        """
        self.counters["factorisations"] += 1
        fill = float(getattr(factor, "nnz", 0))
        if not self.flops_by_fill:
            self.flops_by_fill.append(factor_flops(factor) / max(fill, 1.0) ** 2)
        self.counters["flops"] += round(self.flops_by_fill[0] * fill**2)

    def solution(self, factor: Factor, A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
        """The checked solution, timed; raises SingularMatrixError."""
        start = self.clock()
        x = checked_solve(factor, A, b)
        self.spend("solve_s", start)
        return x

    def advance(self, lin: Linearised, u: np.ndarray, du: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, object]:
        """The next u and its memory: one Newton iteration, however many linear systems its step and its set took."""
        if self._set is None or not np.array_equal(active, self._set):
            self._set, self._moved = active, np.inf
        self.counters["newton_iterations"] += 1
        return u + du, self.remember(lin, du)

    def remember(self, lin: Linearised, du: np.ndarray) -> object:
        """The memory of the step, timed as assembly."""
        self._moved_before, self._moved = self._moved, float(norm(du, check_finite=False))
        start = self.clock()
        memory = lin.remember(du)
        self.spend("assembly_s", start)
        return memory

    def note(self, residual: float, active: np.ndarray, before: np.ndarray, event: Event | None = None) -> None:
        """One row of history; the set changes are counted."""
        added, removed = int(np.sum(active & ~before)), int(np.sum(before & ~active))
        self.counters["set_changes"] += bool(added or removed)
        row: dict[str, object] = {"residual": residual, "contact_nodes": int(active.sum())}
        row |= {"added": added, "removed": removed}
        self.history.append(row | ({} if event is None else {"event": event}))

    def tell(self, event: Event) -> None:
        """Write an event into the last row of history."""
        self.history[-1]["event"] = event

    def finish(self, u: np.ndarray, pressure: np.ndarray, active: np.ndarray, outcome: Outcome) -> ContactSolution:
        """The solution record of this run; pressures of a converged set that rounding made negative become zero."""
        if outcome.converged:
            pressure = np.maximum(pressure, 0.0)
        return ContactSolution(u, pressure, active, outcome, self.counters, tuple(self.history))

    def _rounding(self, lin: Linearised, u: np.ndarray) -> float:
        return rounding_floor(lin, u) / self._scale if self._scale > 0 else 0.0

    def spend(self, what: str, start: float) -> float:
        """Add the time since ``start`` to a counter; returns now."""
        now = self.clock()
        self.counters[what] += now - start
        return now


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
        cls, problem: ContactProblem, u: np.ndarray, nodes: np.ndarray, K: sparse.csc_matrix, epsilon: float
    ) -> Pivots:
        """Largest entry of each gap row as pivot; raises ValueError when it has none or two rows share an unknown."""
        jacobian = problem.gap_jacobian(u)
        rows = jacobian[nodes]
        if np.max(np.bincount(rows.indices), initial=0) > 1:
            raise ValueError("two contact candidates share an unknown: node-to-obstacle contact is required")
        push = sparse.csc_matrix(jacobian.T @ problem.weight_matrix[:, nodes])
        pivot = np.asarray(abs(rows).argmax(axis=1)).ravel()
        each = np.arange(len(nodes))
        slope = np.asarray(rows[each, pivot]).ravel()
        if not np.all(slope):
            names = ", ".join(map(str, nodes[slope == 0]))
            raise ValueError(f"contact candidate {names} has no unknown: its supports hold it before the foundation")
        held = sparse.csc_matrix(K[:, pivot])
        column = sparse.csc_matrix(push + held @ sparse.diags_array(1.0 / (epsilon * slope)))
        size, found = _largest(held), _largest(column)
        size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
        found[found == 0] = 1.0  # the pressure acts on nothing: singular, which the factorisation will say
        return cls(rows, problem.gap(u)[nodes], pivot, slope, held, column, size / found, epsilon)

    def substitute(self, K: sparse.csc_matrix, b: np.ndarray) -> tuple[sparse.csc_matrix, np.ndarray]:
        """Matrix and right-hand side for du with p/s in place of each du_k."""
        a, n = len(self.pivot), K.shape[0]
        place = sparse.csr_matrix((np.ones(a), self.pivot, np.arange(a + 1)), shape=(a, n))
        on_others = self.held @ (sparse.diags_array(-1.0 / self.slope) @ self.rows)
        column = self.column @ sparse.diags_array(self.scale)
        return sparse.csc_matrix(K + (on_others - column @ place)), b + self.held @ (self.gap / self.slope)

    def homogeneous(self) -> Pivots:
        """The same for closed gaps, as of a motion that leaves them so."""
        return replace(self, gap=np.zeros_like(self.gap))

    def free_motions(self) -> sparse.csc_matrix:
        """Basis Z (n, n - a) of the motions with G_A du = 0: the pivots follow the others."""
        n = self.rows.shape[1]
        others = np.setdiff1d(np.arange(n), self.pivot)
        follow = sparse.csr_matrix(sparse.diags_array(-1.0 / self.slope) @ self.rows)
        place = sparse.csr_matrix(
            (np.ones(len(self.pivot)), (self.pivot, np.arange(len(self.pivot)))), (n, len(self.pivot))
        )
        return sparse.csc_matrix(sparse.eye_array(n, format="csc") + place @ follow)[:, others]

    def resolve(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du and the pressures of the set from the solution of the substituted system."""
        pressure, du = self.scale * x[self.pivot], x.copy()
        du[self.pivot] = 0.0
        du[self.pivot] = -(self.gap + pressure / self.epsilon + self.rows @ du) / self.slope
        return du, pressure


def _largest(A: sparse.csc_matrix) -> np.ndarray:
    return np.asarray(abs(A).max(axis=0).toarray()).ravel()
