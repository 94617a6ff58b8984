"""The linear systems of one solve, counted and timed: what a solve spends and writes down.

No set is chosen and no convergence is tested here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np
from scipy import sparse
from scipy.linalg import norm

from contact.events import Event
from contact.problem import ContactProblem, ContactSolution, Linearised
from contact.solvers.sparse import AUTO, Factor, checked_solve, factorise, instead

if TYPE_CHECKING:
    from contact.newton.held import Bound
    from contact.newton.pivots import Pivots

RESIDUAL_TOLERANCE = 1e-9  # relative to the forces in balance; what every algorithm's ``tolerance`` is by default
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
TIMES = ("assembly_s", "factorisation_s", "solve_s", "contact_s")


@dataclass
class Tally:
    """Counters, clock and history: the only things that a solve adds to; nothing is decided by them.

    clock: what the times of the counters are read from.
    """

    counters: dict[str, float] = field(default_factory=lambda: dict.fromkeys(COUNTERS, 0) | dict.fromkeys(TIMES, 0.0))
    history: list[dict[str, object]] = field(default_factory=list)
    clock: Callable[[], float] = time.perf_counter

    @contextmanager
    def timed(self, what: str) -> Iterator[None]:
        """Add the time of what is done inside to a counter, unless it fails."""
        start = self.clock()
        yield
        self.counters[what] += self.clock() - start

    def add(self, solution: ContactSolution) -> None:
        """What another solve has spent, and its history."""
        for key, value in solution.counters.items():
            self.counters[key] = self.counters.get(key, 0) + value
        self.history += [dict(row) for row in solution.history]

    def note(self, residual: float, active: np.ndarray, before: np.ndarray, event: Event | None = None) -> None:
        """One row of history; the set changes are counted."""
        added, removed = int(np.sum(active & ~before)), int(np.sum(before & ~active))
        self.counters["set_changes"] += bool(added or removed)
        row: dict[str, object] = {"residual": residual, "contact_nodes": int(active.sum())}
        row |= {"added": added, "removed": removed}
        self.history.append(row | ({} if event is None else {"event": event}))

    def tell(self, event: Event, row: int = -1) -> None:
        """Write an event into a row of history, by default the last."""
        self.history[row]["event"] = event


class LinearStep(Protocol):
    """A linearised problem that knows its step on any set."""

    def near(self, active: np.ndarray) -> LinearStep:
        """The one to ask for the step on a set (m,): this one, or one that is factorised anew."""

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set (m,); raises SingularMatrixError."""

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) after that step, less exact where that is cheaper."""


@dataclass(frozen=True, eq=False)
class LinearSolves:
    """A problem, an epsilon, a solver, a tolerance, and the tally of what is spent on them."""

    problem: ContactProblem
    epsilon: float = np.inf
    solver: str = AUTO
    tolerance: float = RESIDUAL_TOLERANCE
    tally: Tally = field(default_factory=Tally)

    def linearise(self, u: np.ndarray, memory: object) -> Linearised:
        """Linearise the mechanics, counted and timed."""
        self.tally.counters["assemblies"] += 1
        with self.tally.timed("assembly_s"):
            return self.problem.linearise(u, memory)

    def factorise(self, A: sparse.csc_matrix, of: Bound | None = None) -> Factor:
        """Factorise, counted and timed; ``of``: what the matrix is of.  Raises SingularMatrixError.

        A saddle point has an order of its own, and as many patterns as sets: to analyse them for fronts takes longer
        than SuperLU on all of it.
        """
        saddle = of is not None and of.multipliers > 0
        with self.tally.timed("factorisation_s"):
            solver = "splu" if saddle and self.solver == AUTO else self.solver
            factor = factorise(A, solver, ordered=self.problem.ordered or saddle)
        self.tally.counters["factorisations"] += 1
        if not saddle and instead(factor, self.solver, ordered=self.problem.ordered):
            self.tally.counters["superlu_instead"] = self.tally.counters.get("superlu_instead", 0) + 1
        return factor

    def solution(self, factor: Factor, A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
        """The checked solution, timed; raises SingularMatrixError."""
        with self.tally.timed("solve_s"):
            return checked_solve(factor, A, b)

    def remember(self, lin: Linearised, du: np.ndarray) -> tuple[object, float]:
        """The memory of the step, timed as assembly, and its size |du|."""
        with self.tally.timed("assembly_s"):
            memory = lin.remember(du)
        return memory, float(norm(du, check_finite=False))

    def response(
        self, u: np.ndarray, K: sparse.csc_matrix, nodes: np.ndarray, force: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) under forces (n,) while the gaps of these candidates stay, and the pressures (m,) that hold them.

        As :class:`Response` says; raises SingularMatrixError, ValueError.
        """
        if not len(nodes):
            return self.solution(self.factorise(K), K, force), np.zeros(len(self.problem.weights))
        return Response(self, u, K, nodes)(force, np.zeros(len(nodes)))


def holdable(problem: ContactProblem) -> bool:
    """Whether every pressure is a force on its own candidate, so that it can be left out of the unknowns."""
    return problem.coupling is None and bool(np.all(problem.weights > 0))


def bound(problem: ContactProblem, u: np.ndarray, nodes: np.ndarray, K: sparse.csc_matrix, epsilon: float) -> Bound:
    """The set of these candidates: condensed where each gap has an unknown of its own, with forces where not.

    Raises ValueError when :func:`contact.newton.pivots.holding` does.
    """
    from contact.newton.held import Held  # loaded with a contact set alone
    from contact.newton.pivots import holding
    from contact.newton.saddle import Saddle

    acting = problem.push(u)[nodes]
    grip = holding(acting, nodes)
    if grip.block is None:
        return Held.on(problem, u, nodes, K, epsilon, grip)
    rows = problem.gap_jacobian(u)[nodes] if problem.driven else acting
    return Saddle.of(K, rows, acting, 1.0 / (epsilon * problem.weights[nodes]))


def released(
    problem: ContactProblem, u: np.ndarray, nodes: np.ndarray, K: sparse.csc_matrix, epsilon: float
) -> tuple[sparse.csc_matrix, int]:
    """K (n, n) on the motions that the set of these candidates leaves free, and how many of its unknowns are forces.

    Raises ValueError as :func:`bound` does.
    """
    if not len(nodes):
        return K, 0
    held = bound(problem, u, nodes, K, epsilon)
    return held.matrix, held.multipliers


class Response:
    """du (n,) under forces (n,), and the pressures (m,) that hold the gaps of a set A, which the load opens by g (a,).

    K du - G^T W dp = force,   G_A du + dp_A/epsilon = -g,   dp = 0 outside A.
    One factorisation serves all loads.
    """

    def __init__(self, run: LinearSolves, u: np.ndarray, K: sparse.csc_matrix, nodes: np.ndarray) -> None:
        """At u (n,) with the tangent K (n, n) on the candidates ``nodes`` (a,).

        Raises SingularMatrixError, ValueError.
        """
        self._run, self.nodes = run, nodes
        self._held: Bound | None = None
        self._pivots: Pivots | None = None
        if holdable(run.problem):
            self._held = bound(run.problem, u, nodes, K, run.epsilon)
            self._matrix = self._held.matrix
        else:
            from contact.newton.pivots import Pivots  # loaded with a contact set alone

            self._pivots = Pivots.choose(run.problem, u, nodes, K, run.epsilon).opened(np.zeros(len(nodes)))
            self._matrix, _ = self._pivots.substitute(K, np.zeros(K.shape[0]))
        self._factor = run.factorise(self._matrix, self._held)

    def compliance(self, nodes: np.ndarray) -> np.ndarray:
        """1/(epsilon w) (k,) [mm/N] of candidates."""
        return np.asarray(1.0 / (self._run.epsilon * self._run.problem.weights[nodes]))

    def __call__(self, force: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and dp (m,); raises SingularMatrixError."""
        problem, held, pressures = self._run.problem, self._held, np.zeros(len(self._run.problem.weights))
        if held is not None:
            y = self._run.solution(self._factor, self._matrix, held.load(force, -gap))
            du = held.motion(y, -gap)
            pressures[self.nodes] = held.forces(y, du, -force) / problem.weights[self.nodes]
        else:
            assert self._pivots is not None
            opened = self._pivots.opened(gap)
            load = opened.loaded(force)
            du, pressures[self.nodes] = opened.resolve(self._run.solution(self._factor, self._matrix, load))
        return du, pressures


@dataclass(frozen=True, eq=False)
class Substituted:
    """The linearised problem, factorised anew on each set: the only way where pressures have to be unknowns."""

    run: LinearSolves
    lin: Linearised
    u: np.ndarray
    pressure: np.ndarray
    known: dict[bytes, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)

    def near(self, active: np.ndarray) -> Substituted:
        """The same for every set."""
        return self

    def step(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and pressures (m,) on the set; raises SingularMatrixError."""
        if active.tobytes() not in self.known:
            self.known[active.tobytes()] = self._solved(active)
        return self.known[active.tobytes()]

    def foreseen(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps and pressures (m,) after the step."""
        du, pressure = self.step(active)
        return self.run.problem.gap(self.u) + self.run.problem.gap_jacobian(self.u) @ du, pressure

    def _solved(self, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        run, nodes, pressure = self.run, np.flatnonzero(active), np.zeros_like(self.pressure)
        pivots: Pivots | None = None
        with run.tally.timed("contact_s"):
            A, b = run.problem.stiffness(self.lin, self.u, self.pressure), -self.lin.residual
            if len(nodes):
                from contact.newton.pivots import Pivots  # loaded with a contact set alone

                pivots = Pivots.choose(run.problem, self.u, nodes, A, run.epsilon)
                A, b = pivots.substitute(A, b)
        du = run.solution(run.factorise(A), A, b)
        if pivots is not None:
            with run.tally.timed("contact_s"):
                du, pressure[nodes] = pivots.resolve(du)
        return du, pressure
