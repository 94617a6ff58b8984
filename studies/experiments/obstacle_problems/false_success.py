"""Who says "solved" and is wrong: every algorithm and setting over a collection, before the judge of contact."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import sparse

from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Scaled
from contact.catalogue import ALGORITHMS
from contact.problem import Outcome
from contact.solvers.lcp_pivoting import METHODS
from contact.solvers.qp_backends import BACKENDS, Programme, ask, missing
from contact.verify import judge
from studies.experiments.obstacle_problems.collection import Bounded, collection
from studies.experiments.obstacle_problems.linearised_steps import Linearised, linearised_steps

FORCE, GAP = 1e-8, 1e-8  # relative to the forces and the displacements of the problem; an honest solver is far below
PENALTY = 1e4


@dataclass(frozen=True, eq=False)
class Claim:
    """What a solver answers: u, pressure, whether it claims success, and why it did not try, if it did not."""

    u: np.ndarray
    pressure: np.ndarray
    success: bool
    refused: str = ""
    epsilon: float = math.inf


Body = Bounded | Linearised  # K x - f = G^T W p before a foundation, linear, and x where it is published
Contender = Callable[[Body], Claim]


def by_algorithm(name: str, **settings: object) -> Contender:
    """The algorithm with its own defaults, but exact where it can be."""

    def claim(body: Body) -> Claim:
        problem = body.problem()
        algorithm = ALGORITHMS[name](**settings)
        reason = algorithm.supports(problem)
        if reason is not None:
            return Claim(body.start, np.zeros_like(problem.weights), False, reason)
        found = algorithm.solve(problem, body.begin())
        why = str(found.history[-1].get("event", "")) if found.outcome is Outcome.REFUSED else ""
        return Claim(found.u, found.pressure, found.outcome.converged, why, algorithm.epsilon)

    return claim


def by_word(backend: str, eps: float, *, polish: bool, scaled: bool) -> Contender:
    """One call of a solver of quadratic programmes, taken at its word: the linear problem from x = 0."""

    def claim(body: Body) -> Claim:
        problem = body.problem()
        m, n = len(problem.weights), len(body.f)
        if not body.symmetric:
            return Claim(np.zeros(n), np.zeros(m), False, "no minimum")
        G, gap = problem.gap_jacobian(body.start), problem.gap(np.zeros(n))
        whole = Scaled.of(body.K, -body.f, G, gap, problem.weights, math.inf)
        if scaled:
            answer = ask(backend, whole.programme, eps, polish)
            u, forces = whole.unscaled(answer)
            return Claim(u, forces / problem.weights, answer.claimed)
        answer = ask(backend, Programme(body.K, -body.f, sparse.csc_matrix(G), -gap), eps, polish)
        return Claim(answer.x, answer.y / problem.weights, answer.claimed)

    return claim


def contenders() -> dict[str, Contender]:
    """Our defaults and settings, then the words of the solvers that are installed."""
    ours = {name: by_algorithm(name) for name in ALGORITHMS if name != "trial-and-error"}
    ours |= {f"trial-and-error, {e:g}": by_algorithm("trial-and-error", epsilon=e) for e in (PENALTY, math.inf)}
    ours |= {f"semismooth, {PENALTY:g}": by_algorithm("semismooth", epsilon=PENALTY)}
    ours |= {"semismooth, settle 1": by_algorithm("semismooth", settle=1.0)}
    ours |= {f"lcp, {method}": by_algorithm("lcp", method=method) for method in METHODS if method != Lcp.method}
    ours |= {f"{name}, full": by_algorithm(name, system="full") for name in ("lcp", "qp")}
    ours |= {"qp, osqp defaults": by_algorithm("qp", eps=1e-3, polish=False)}
    backends = [name for name in BACKENDS if missing(name) is None]
    ours |= {f"qp, {name}": by_algorithm("qp", backend=name) for name in backends if name != "osqp"}
    words = {"osqp alone, defaults": by_word("osqp", 1e-3, polish=False, scaled=False)}
    words |= {"osqp alone, defaults, scaled": by_word("osqp", 1e-3, polish=False, scaled=True)}
    words |= {"osqp alone, 1e-8 and polish": by_word("osqp", 1e-8, polish=True, scaled=False)}
    words |= {"osqp alone, 1e-8 and polish, scaled": by_word("osqp", 1e-8, polish=True, scaled=True)}
    words |= {f"{name} alone, 1e-8": by_word(name, 1e-8, polish=False, scaled=False) for name in backends[1:]}
    return ours | words


def failures(body: Body, claim: Claim) -> list[str]:
    """The judge's, with bounds in units of the problem; what a finite epsilon penetrates by its law is no failure."""
    problem = body.problem()
    size = max(float(np.max(np.abs(body.start))), float(np.max(np.abs(claim.u))))
    force = max(float(np.linalg.norm(body.f)), float(np.linalg.norm(problem.contact_force(claim.u, claim.pressure))))
    largest = float(np.max(claim.pressure, initial=0.0))
    law = 1.001 * largest / claim.epsilon
    verdict = judge(problem, claim.u, claim.pressure)
    bounds = {"penetration": GAP * size + law}
    bounds["complementarity"] = GAP * size * force / float(np.mean(problem.weights)) + law * largest
    wrong = [name for name in verdict.failures(equilibrium=FORCE) if name not in bounds]
    return wrong + [name for name, bound in bounds.items() if not verdict.kkt[name] <= bound]


def table(problems: Iterable[Body] | None = None, who: dict[str, Contender] | None = None) -> pd.DataFrame:
    """One row a contender: problems, refused, claimed, false claims, and the largest error of a claimed x.

    The error is against the known answer or the exact pivots of lcp, over the largest |x| of both.
    """
    problems = [*collection(), *linearised_steps()] if problems is None else list(problems)
    exact = {body.name: by_algorithm("lcp")(body).u if body.answer is None else body.answer for body in problems}
    rows = []
    for name, contender in (contenders() if who is None else who).items():
        claims = [(body, contender(body)) for body in problems]
        claimed = [(body, claim) for body, claim in claims if claim.success]
        errors = [_error(claim.u, exact[body.name], body.start) for body, claim in claimed]
        refused = sum(bool(claim.refused) for _, claim in claims)
        wrong = sum(bool(failures(body, claim)) for body, claim in claimed)
        rows.append((name, len(problems), refused, len(claimed), wrong, max(errors, default=math.nan)))
    return pd.DataFrame(rows, columns=["contender", "problems", "refused", "claimed", "false", "largest_error"])


def _error(x: np.ndarray, exact: np.ndarray, start: np.ndarray) -> float:
    return float(np.max(np.abs(x - exact)) / max(np.max(np.abs(exact)), np.max(np.abs(start))))
