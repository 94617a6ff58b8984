"""Who says "solved" and is wrong: every algorithm and setting over a collection, before the judge of contact.

The collection is of published problems, and of last steps of shells in contact, linearised where they set out from.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np
import pandas as pd
from scipy import sparse

from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Scaled
from contact.catalogue import ALGORITHMS
from contact.interchange.linearised_step import FrozenStep, freeze
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.lcp_pivoting import METHODS
from contact.solvers.qp_backends import BACKENDS, MODULES, Answer, Programme, ask, missing
from contact.solvers.sparse import symmetric
from contact.verify import judge
from studies.experiments.obstacles import Bounded, collection
from studies.scenes.complete import complete
from studies.scenes.walk import walk

BOUND = 1e-8  # relative to the forces and the displacements of the problem; an honest solver is far below
PENALTY = 1e4
COLUMNS = (
    *("contender", "version", "tolerance", "bound", "problems", "claimed"),
    *("false_own", "false", "largest_error", "worst", "worst_fails"),
)
PAPER = {"element": "paper", "delta_mm": "15,20"}  # the tyre's element whose tangent is definite without the foundation


@dataclass(frozen=True, eq=False)
class Linearised:
    """K du - f = G^T W p with g + G du >= 0, in the unknowns du (n,) of one Newton step; no published answer.

    K (n, n): the tangent, curvature of the gap included; f (n,): what is out of balance without the foundation.
    before: the converged state that the step sets out from.
    """

    name: str
    step: FrozenStep
    before: ContactSolution
    K: sparse.csc_matrix
    f: np.ndarray
    start: np.ndarray
    symmetric: bool
    answer: None = None

    def problem(self) -> ContactProblem:
        """The contact problem in du."""
        return self.step.problem()

    def begin(self) -> ContactSolution:
        """The pressures and the set of the state before."""
        return ContactSolution(self.start, self.before.pressure, self.before.active, Outcome.CONVERGED)


def last_step(scene_name: str, mesh: str, **settings: str) -> Linearised:
    """The step to the last target of the last stage of a scene, linearised at the state before."""
    scene, request = complete(scene_name, settings, mesh)
    *_, last = walk(scene.build(request).stages(), ALGORITHMS[request.contact](epsilon=math.inf))
    name = ", ".join([f"{scene_name} {mesh}", *(f"{key} {value}" for key, value in settings.items())])
    step = freeze(last.problem, last.before.u, last.before.pressure, {})
    return Linearised(name, step, last.before, step.K, -step.r, np.zeros_like(step.r), symmetric(step.K))


def linearised_steps() -> list[Linearised]:
    """The tyre pressed to 20 mm, from 15 mm, at once, and with the section without symmetry; strips and a plate."""
    tyres = [PAPER, {**PAPER, "delta_mm": "20"}, {**PAPER, "section": "nonsymmetric"}]
    thin = ("strip-contact", "plate-contact", "heavy-strip")
    return [
        *(last_step("tyre", "12x12", **settings) for settings in tyres),
        *(last_step(name, "16x1") for name in thin),
    ]


@dataclass(frozen=True, eq=False)
class Claim:
    """What a solver answers: u, pressure, and whether it claims success.

    tolerance: what it was asked for.  kept: whether its answer keeps that by its own criterion, None for the judge's.
    """

    u: np.ndarray
    pressure: np.ndarray
    success: bool
    epsilon: float = math.inf
    tolerance: float = math.nan
    kept: bool | None = None


Body = Bounded | Linearised  # K x - f = G^T W p before a foundation, linear, and x where it is published
Contender = Callable[[Body], Claim]


def by_algorithm(name: str, **settings: object) -> Contender:
    """The algorithm with its own defaults, but exact where it can be."""

    def claim(body: Body) -> Claim:
        problem = body.problem()
        algorithm = ALGORITHMS[name](**settings)
        if algorithm.supports(problem) is not None:
            return Claim(body.start, np.zeros_like(problem.weights), False)
        solution = algorithm.solve(problem, body.begin())
        tolerance = getattr(algorithm, "tolerance", BOUND)
        return Claim(solution.u, solution.pressure, solution.outcome.converged, algorithm.epsilon, tolerance)

    return claim


def by_word(backend: str, eps: float, *, polish: bool, scaled: bool) -> Contender:
    """One call of a solver of quadratic programmes, taken at its word: the linear problem from x = 0."""

    def claim(body: Body) -> Claim:
        problem = body.problem()
        m, n = len(problem.weights), len(body.f)
        if not body.symmetric:
            return Claim(np.zeros(n), np.zeros(m), False, tolerance=eps)  # no minimum
        G, gap = problem.gap_jacobian(body.start), problem.gap(np.zeros(n))
        whole = Scaled.of(body.K, -body.f, G, gap, problem.weights, math.inf)
        programme = whole.programme if scaled else Programme(body.K, -body.f, sparse.csc_matrix(G), -gap)
        answer = ask(backend, programme, eps, polish)
        u, forces = whole.unscaled(answer) if scaled else (answer.x, answer.y)
        kept = keeps(programme, answer, eps)
        return Claim(u, forces / problem.weights, answer.claimed, tolerance=eps, kept=kept)

    return claim


def keeps(programme: Programme, answer: Answer, eps: float) -> bool:
    """Is the answer one by OSQP's criterion, in the units of the programme: both residuals below eps (1 + their terms)?

    Stellato et al., Math. Program. Comput. 12 (2020), sect. 3.4; clarabel asks the same of them, and of the gap.
    """
    x, y, rows = answer.x, answer.y, programme.A @ answer.x
    curved, pushed = programme.P @ x, programme.A.T @ y
    primal = np.max(np.maximum(programme.b - rows, 0.0), initial=0.0)
    dual = np.max(np.abs(curved + programme.q - pushed), initial=0.0)
    terms = [
        max(float(np.max(np.abs(v), initial=0.0)) for v in of)
        for of in ((rows, programme.b), (curved, pushed, programme.q))
    ]
    return bool(primal <= eps * (1 + terms[0]) and dual <= eps * (1 + terms[1]))


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


def failures(body: Body, claim: Claim, bound: float = BOUND) -> list[str]:
    """The judge's, with bounds in units of the problem; penetration by the law of a finite epsilon is not a failure."""
    problem = body.problem()
    size = max(float(np.max(np.abs(body.start))), float(np.max(np.abs(claim.u))))
    force = max(float(np.linalg.norm(body.f)), float(np.linalg.norm(problem.contact_force(claim.u, claim.pressure))))
    largest = float(np.max(claim.pressure, initial=0.0))
    law = 1.001 * largest / claim.epsilon
    verdict = judge(problem, claim.u, claim.pressure)
    bounds = {"penetration": bound * size + law}
    bounds["complementarity"] = bound * size * force / float(np.mean(problem.weights)) + law * largest
    wrong = [name for name in verdict.failures(equilibrium=bound) if name not in bounds]
    return wrong + [name for name, most in bounds.items() if not verdict.kkt[name] <= most]


def kept(body: Body, claim: Claim) -> bool:
    """Does a claim keep what it was asked for: by its own criterion, or by the judge's with its own tolerance?"""
    return not failures(body, claim, claim.tolerance) if claim.kept is None else claim.kept


def table(problems: Iterable[Body] | None = None, who: dict[str, Contender] | None = None) -> pd.DataFrame:
    """One row a contender, with COLUMNS.

    version: name and version of a solver that is not ours.  tolerance: what it was asked for.  claimed: problems that
    it calls solved.
    false_own: claims that do not keep that tolerance; false: claims that the judge refuses with ``bound``.
    largest_error: of a claimed x, against the known answer or the exact pivots of lcp, over the largest |x| of both; on
    the problem ``worst``, where the judge refuses the residuals ``worst_fails``.
    """
    problems = [*collection(), *linearised_steps()] if problems is None else list(problems)
    exact = {body.name: by_algorithm("lcp")(body).u if body.answer is None else body.answer for body in problems}
    rows = []
    for name, contender in (contenders() if who is None else who).items():
        claims = [(body, contender(body)) for body in problems]
        claimed = [(body, claim) for body, claim in claims if claim.success]
        wrong = {body.name: failures(body, claim) for body, claim in claimed}
        own = sum(not kept(body, claim) for body, claim in claimed)
        errors = {body.name: _error(claim.u, exact[body.name], body.start) for body, claim in claimed}
        worst = max(errors, key=lambda each: errors[each], default="")
        counts = (len(problems), len(claimed), own, sum(map(bool, wrong.values())))
        asked = (_version(name), max((claim.tolerance for _, claim in claims), default=math.nan), BOUND)
        rows.append((name, *asked, *counts, errors.get(worst, math.nan), worst, ", ".join(wrong.get(worst, ()))))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _version(contender: str) -> str:
    """Of the solver that a contender asks; empty for what is all ours."""
    backend = next((name for name in BACKENDS if name in contender), "osqp" if contender.startswith("qp") else "")
    return f"{backend} {version(MODULES[backend])}" if backend else ""


def _error(x: np.ndarray, exact: np.ndarray, start: np.ndarray) -> float:
    return float(np.max(np.abs(x - exact)) / max(np.max(np.abs(exact)), np.max(np.abs(start))))
