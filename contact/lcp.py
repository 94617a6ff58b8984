"""The linearised problem condensed on the candidates: a dense linear complementarity problem, solved exactly."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy import sparse

from contact.complementarity import METHODS, LcpError, NotApplicableError
from contact.linear import Factor
from contact.linearised import Iterate, Step, StepError, iterate
from contact.newton import GAP_TOLERANCE, NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome

COLUMNS = 64  # right-hand sides at once


@dataclass(frozen=True)
class Lcp:
    """0 <= f, 0 <= g + G du(f), their product zero, with du(f) = K^-1 (G^T f - r) and nodal forces f = W p.

    The Delassus operator G K^-1 G^T (compliance of the candidates, mm/N) costs one solution a candidate. It is built
    for those expected to press or pushed in by the free step, and grows when the solution pushes in others.
    method: ``lemke`` (exact pivoting, any P-matrix), ``active-set`` (fast, any P-matrix), ``nnls`` (symmetric positive
    definite, which excludes follower loads without a potential, non-symmetric sections and consistent coupling).
    K alone must be regular: a body that only the foundation holds has no compliance.
    Source: Delassus, Ann. Sci. Éc. Norm. Supér. 34 (1917) 95-179; Cottle, Pang, Stone (1992).
    """

    epsilon: float = np.inf
    method: str = "lemke"
    max_iterations: int = 40
    solver: str = "splu"
    name: str = "lcp"

    def supports(self, problem: ContactProblem) -> str | None:
        """All problems but consistent coupling with nnls."""
        if self.method not in METHODS:
            return f"method {self.method!r} must be one of {', '.join(METHODS)}"
        if self.method == "nnls" and problem.coupling is not None:
            return "method nnls needs a symmetric problem, and consistent coupling makes it non-symmetric"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Newton from ``start`` on linearised problems that are each solved to the end."""
        run = NewtonRun(problem, self.epsilon, self.solver)
        return iterate(run, start, partial(_step, self.method), self.max_iterations)


def _step(method: str, run: NewtonRun, at: Iterate) -> Step:
    problem, K, G = run.problem, run.stiffness(at.lin, at.u, at.pressure), run.problem.gap_jacobian(at.u)
    lumped = problem.coupling is None
    # the multiplier: nodal forces, which keep the matrix symmetric, or pressures where a matrix makes forces of them
    push = sparse.csc_matrix(G.T if problem.coupling is None else G.T @ problem.coupling)
    per_pressure = problem.weights if lumped else np.ones_like(problem.weights)
    factor = run.factorise(K)
    free_du = run.solution(factor, K, -at.lin.residual)
    free = at.gap + G @ free_du
    # where the set holds a gap closed, rounding is no penetration
    rounding = GAP_TOLERANCE * run.gap_size(at.u, at.gap)
    nodes, columns = np.zeros(0, int), np.zeros((len(free), 0))
    multiplier, event, entering = np.zeros(len(free)), "", np.flatnonzero(at.expected | (free < -rounding))
    while len(entering):
        start = time.perf_counter()
        columns = np.hstack([columns, _compliance(factor, G, push[:, entering])])
        nodes = np.append(nodes, entering)
        M = columns[nodes] + np.diag(1.0 / (run.epsilon * per_pressure[nodes]))
        try:
            found = METHODS[method](M, free[nodes], at.expected[nodes])
        except LcpError as error:
            refused = isinstance(error, NotApplicableError)
            raise StepError(Outcome.REFUSED if refused else Outcome.UNSOLVED, f"lcp by {method}: {error}") from None
        multiplier[nodes], event = found.z, found.event
        pushed_in = free + columns @ found.z < -rounding
        pushed_in[nodes] = False
        entering = np.flatnonzero(pushed_in)
        run.spend("contact_s", start)
    du = run.solution(factor, K, push @ multiplier - at.lin.residual) if len(nodes) else free_du
    return Step(du, multiplier / per_pressure, multiplier > 0, event)


def _compliance(factor: Factor, G: sparse.csr_matrix, push: sparse.csc_matrix) -> np.ndarray:
    """G K^-1 push (m, a), a few columns at a time: K^-1 push itself would be large."""
    parts = [push[:, j : j + COLUMNS].toarray() for j in range(0, push.shape[1], COLUMNS)]
    return np.hstack([G @ np.column_stack([factor.solve(b) for b in part.T]) for part in parts])
