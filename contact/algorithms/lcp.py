"""The linearised problem condensed on the candidates: a dense linear complementarity problem, solved exactly.

With friction the problem is that on a polygon in the disc, see :mod:`contact.newton.friction_compliance`, by Lemke's
pivots; where they find no end states are settled by exact steps alone, as the history says. Candidates that slip along
a line have no polygon. ``sides``: of the polygon; friction is up to 1 - cos(pi/sides) short. ``finish``: whether exact
steps on the states of the answer put friction on the disc itself; without, a step ends with the forces of the polygon,
which the judge refuses.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.algorithms.base import NewtonAlgorithm
from contact.events import Event, EventKind
from contact.newton.condensed import Condensed, closed
from contact.newton.friction_compliance import SIDES, by_pivots, no_polygon
from contact.newton.friction_loop import finished, unfinished
from contact.newton.loop import Step, StepError, decide_set, iterate
from contact.newton.step import Iterate, NewtonRun
from contact.operations import DENSE_PIVOTS, eigenvalues_alone, spend
from contact.parameters import SHARED, SYSTEM, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.lcp_pivoting import (
    METHODS,
    LcpError,
    LcpSolution,
    NotApplicableError,
    active_set,
    principal_pivot,
    unit,
)
from contact.solvers.sparse import response

INDEFINITE = 1e-10  # of the highest eigenvalue: less than that below zero is rounding


@dataclass(frozen=True)
class Lcp(NewtonAlgorithm):
    """0 <= f, 0 <= g + G du(f), their product zero, with du(f) = K^-1 (G^T f - r) and nodal forces f = W p.

    system: ``condensed`` factorises on the expected set and pivots on the candidates whose expected state is wrong
    there. Others join them when the solution makes their state wrong (:class:`Condensed`). ``full`` factorises K and
    builds the Delassus operator G K^-1 G^T (compliance, mm/N) of all candidates that are expected to press or penetrate
    in the free step, one solution per candidate. K alone must then be regular: a body held only by the foundation has
    no compliance.
    method: ``lemke`` (exact pivoting, any P-matrix), ``active-set`` (fast, any P-matrix), ``nnls`` (symmetric positive
    definite matrices only). nnls excludes follower loads without a potential, non-symmetric sections and consistent
    coupling; where the travel of the foundation is an unknown (arc length), the active set replaces it.
    Consistent coupling is solved with the full system.
    Source: Delassus, Ann. Sci. Éc. Norm. Supér. 34 (1917) 95-179; Cottle, Pang, Stone (1992).
    """

    method: str = "lemke"
    system: str = "condensed"
    sides: int = SIDES
    finish: bool = True
    name: ClassVar[str] = "lcp"
    friction: ClassVar[bool] = True
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter(
            "method",
            "how the complementarity problem is solved",
            kind="choice",
            choices=tuple(METHODS),
            frictionless=True,
        ),
        SYSTEM,
    )

    def supports(self, problem: ContactProblem) -> str | None:
        """Applies to all problems except consistent coupling with nnls."""
        if problem.coulomb is not None:
            refused = no_polygon(self.sides, problem.coulomb.mu, "is not a row of a complementarity problem")
            return refused or super().supports(problem)
        if self.method not in METHODS:
            return f"method {self.method!r} must be one of {', '.join(METHODS)}"
        if self.method == "nnls" and problem.coupling is not None:
            return "method nnls needs a symmetric problem, and consistent coupling makes it non-symmetric"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """Newton from ``start`` on linearised problems that are each solved to the end."""
        if problem.coulomb is not None:
            run, by = self.rubbing(problem, start, lawful=self.finish), finished if self.finish else unfinished
            choose = partial(by_pivots, sides=self.sides)
            return run.finish(*by(run, run.start(), choose, [], self.max_iterations))
        step = _condensed if self.system == "condensed" else _full
        method = "active-set" if self.method == "nnls" and problem.driven else self.method
        return iterate(self.run(problem), start, partial(step, method), self.max_iterations)


def _condensed(method: str, run: NewtonRun, at: Iterate) -> Step:
    linear = run.linear(at.lin, at.u, at.pressure, at.active)
    if not isinstance(linear, Condensed):
        return _full(method, run, at)
    events: list[Event | None] = []

    def decide(M: np.ndarray, q: np.ndarray, base: np.ndarray, left: np.ndarray) -> np.ndarray:
        back = base if method == "nnls" else np.zeros_like(base)  # the forces of all: a symmetric matrix
        size = unit(M)
        with run.tally.timed("contact_s"):
            try:
                M, q = principal_pivot(size[:, None] * M * size, size * q, back)
            except LcpError as error:
                raise StepError(Outcome.UNSOLVED, f"lcp by {method}: {error}") from None
            answer = _solve(method, M, q, back)
        events.append(answer.event)
        return (answer.z > 0) ^ back

    return replace(decide_set(run, at, linear, decide)[0], event=next(filter(None, reversed(events)), None))


def _full(method: str, run: NewtonRun, at: Iterate) -> Step:
    problem, G = run.problem, run.problem.gap_jacobian(at.u)
    K = problem.stiffness(at.lin, at.u, at.pressure)
    lumped = problem.coupling is None
    # the multiplier: nodal forces, which keep the matrix symmetric, or pressures where a matrix makes forces of them
    acting = problem.push(at.u)
    push = sparse.csc_matrix(acting.T if problem.coupling is None else acting.T @ problem.coupling)
    per_pressure = problem.weights if lumped else np.ones_like(problem.weights)
    factor = run.factorise(K)
    free_du = run.solution(factor, K, -at.lin.residual)
    free = at.gap + G @ free_du
    # where the set holds a gap closed, rounding is no penetration
    rounding = run.gap_rounding(at, float(np.max(np.abs(free - at.gap), initial=0.0)))
    nodes, columns = np.zeros(0, int), np.zeros((len(free), 0))
    event: Event | None = None
    multiplier, entering = np.zeros(len(free)), np.flatnonzero(at.active | (free < -rounding))
    while len(entering):
        with run.tally.timed("contact_s"):
            sides = sparse.csc_matrix(G.T), push[:, entering]
            columns = np.hstack([columns, response(factor, *sides)])
            nodes = np.append(nodes, entering)
            M = columns[nodes] + np.diag(1.0 / (run.epsilon * per_pressure[nodes]))
            answer = _solve(method, M, free[nodes], at.active[nodes])
            multiplier[nodes], event = answer.z, answer.event
            pushed_in = free + columns @ answer.z < -rounding
            pushed_in[nodes] = False
            entering = np.flatnonzero(pushed_in)
    du = run.solution(factor, K, push @ multiplier - at.lin.residual) if len(nodes) else free_du
    pressure, active = multiplier / per_pressure, multiplier > 0
    exact = closed(du, at.gap, G, acting, pressure / run.epsilon, active) if active.any() else du
    return Step(exact, pressure, active, event)


def _solve(method: str, M: np.ndarray, q: np.ndarray, expected: np.ndarray) -> LcpSolution:
    """By the method; where M is indefinite or the method fails, by the active set from the expected one.

    The tangent of a body that only the foundation keeps from buckling is indefinite. There are then several solutions,
    and pivoting from nothing finds one far away, or none; the one wanted is near. Raises StepError.
    """
    spend(DENSE_PIVOTS, eigenvalues_alone(len(q)))
    eigenvalues = np.linalg.eigvalsh((M + M.T) / 2)
    why = f"lowest eigenvalue {eigenvalues[0] / eigenvalues[-1]:.1e} of the highest"
    if eigenvalues[0] >= -INDEFINITE * np.abs(eigenvalues[-1]) or method == "active-set":
        try:
            return METHODS[method](M, q, expected)
        except NotApplicableError as error:
            raise StepError(Outcome.REFUSED, f"lcp by {method}: {error}") from None
        except LcpError as error:
            why = str(error)
    try:
        answer = active_set(M, q, expected)
    except LcpError as error:
        raise StepError(Outcome.UNSOLVED, f"lcp by {method}: {why}; by the active set: {error}") from None
    instead = Event(EventKind.SUBSTITUTE, f"lcp by {method}: {why}; the active set was used instead")
    return LcpSolution(answer.z, answer.pivots, instead)
