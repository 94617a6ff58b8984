"""Public solvers of quadratic programmes, with their own claims, on min du.K.du/2 + r.du subject to G du >= -g.

The multipliers are nodal forces. One call each, on min x.P.x/2 + q.x, A x >= b; P (n, n), A (m, n), multipliers y (m,)
>= 0; backends of :mod:`contact.solvers.qp_backends` are called there. The tolerance is both absolute and relative where
there are both; all other settings are the defaults, except for a larger limit of iterations.
Measured: highspy 1.15 adds 1e-7 to the diagonal of P unless told not to; the wheel of scs 3.3 brings Pardiso.
Sources of the solvers: Stellato et al., Math. Program. Comput. 12 (2020) 637-672
(OSQP); Goulart, Chen, arXiv:2405.12762 (Clarabel); Bambade et al., IEEE Trans. Robot. (2025) (ProxQP); Schwan et al.,
CDC 2023 (PIQP); Arnström et al., IEEE Trans. Autom. Control 67 (2022) 4362-4369 (DAQP); Huangfu, Hall, Math. Program.
Comput. 10 (2018) 119-142 (HiGHS); O'Donoghue, SIAM J. Optim. 31 (2021) 1999-2023 (SCS); Hermans et al., Math. Program.
Comput. 14 (2022) 497-541 (QPALM); Goldfarb, Idnani, Math. Program. 27 (1983) 1-33 (quadprog).
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from scipy import sparse

from contact.algorithms.qp import Scaled
from contact.interchange.linearised_step import FrozenStep
from contact.interchange.oracle import refusal
from contact.solvers.lcp_pivoting import unit
from contact.solvers.qp_backends import Answer as QPAnswer
from contact.solvers.qp_backends import Programme, ask
from contact.solvers.sparse import checked_solve, factorise, response
from studies.arena.solvers.base import Answer, Solver
from studies.experiments.false_success import keeps

DENSE = 3000  # unknowns beyond which K is not written out with its zeros: 72 MB, and a cubic number of operations
MOST = 100_000  # iterations of first-order methods; the time limit is reached first
INTERIOR = ("clarabel", "piqp")  # for which ``ask`` counts the solutions, two per iteration


def _ask(backend: str, programme: Programme, eps: float) -> QPAnswer:
    answer = ask(backend, programme, eps, polish=False)
    return replace(answer, iterations=answer.factorisations) if backend in INTERIOR else answer


def known(backend: str) -> Callable[[Programme, float], QPAnswer]:
    """A backend of the suite, which can be sent to another process."""
    return partial(_ask, backend)


def osqp(
    programme: Programme,
    eps: float,
    guess: tuple[np.ndarray, np.ndarray] | None = None,
    algebra: str = "builtin",
    **settings: object,
) -> QPAnswer:
    """OSQP with given settings and algebra; guess: the initial point, x (n,) and y (m,)."""
    module = importlib.import_module("osqp")
    solver, above = module.OSQP(algebra=algebra), np.full(len(programme.b), np.inf)
    settings = {"eps_abs": eps, "eps_rel": eps, "max_iter": MOST, "verbose": False, **settings}
    solver.setup(sparse.triu(programme.P, format="csc"), programme.q, programme.A, programme.b, above, **settings)
    if guess is not None:
        solver.warm_start(x=guess[0], y=-guess[1])
    result = solver.solve(raise_error=False)
    claimed = result.info.status_val == module.SolverStatus.OSQP_SOLVED
    return _answer(result.x, -result.y, claimed, result.info.status, result.info.iter)


def scs(programme: Programme, eps: float) -> QPAnswer:
    """SCS: A x + s = b with s >= 0."""
    module = importlib.import_module("scs")
    P, A = sparse.triu(programme.P, format="csc"), sparse.csc_matrix(-programme.A)
    data = {"P": P, "A": A, "b": -programme.b, "c": programme.q}
    cone = {"l": len(programme.b)}
    result = module.SCS(data, cone, eps_abs=eps, eps_rel=eps, max_iters=MOST, verbose=False).solve()
    info = result["info"]
    return _answer(result["x"], result["y"], info["status_val"] == 1, info["status"], info["iter"])


def highs(programme: Programme, eps: float) -> QPAnswer:
    """The active set of HiGHS, whose tolerances are absolute and no less than 1e-10."""
    module = importlib.import_module("highspy")
    solver, n, m = module.Highs(), len(programme.q), len(programme.b)
    model, lower, A = module.HighsModel(), sparse.tril(programme.P, format="csc"), programme.A
    model.lp_.num_col_, model.lp_.num_row_, model.lp_.col_cost_ = n, m, programme.q
    model.lp_.col_lower_, model.lp_.col_upper_ = np.full(n, -np.inf), np.full(n, np.inf)
    model.lp_.row_lower_, model.lp_.row_upper_ = programme.b, np.full(m, np.inf)
    model.lp_.a_matrix_.format_ = module.MatrixFormat.kColwise
    for matrix, given in ((model.lp_.a_matrix_, A), (model.hessian_, lower)):
        matrix.start_, matrix.index_, matrix.value_ = given.indptr, given.indices, given.data
    model.hessian_.dim_, model.hessian_.format_ = n, module.HessianFormat.kTriangular
    options = {"output_flag": False, "threads": 1, "qp_regularization_value": 0.0}
    options |= dict.fromkeys(("primal_feasibility_tolerance", "dual_feasibility_tolerance"), max(eps, 1e-10))
    for key, value in options.items():
        solver.setOptionValue(key, value)
    refused = solver.passModel(model) == module.HighsStatus.kError
    solver.run()
    status = solver.getModelStatus()
    solution = solver.getSolution()
    x, y = np.array(solution.col_value, float), np.array(solution.row_dual, float)
    if refused or len(x) != n or len(y) != m:
        return _nothing(programme, "the model was refused" if refused else solver.modelStatusToString(status))
    claimed = status == module.HighsModelStatus.kOptimal
    return _answer(x, y, claimed, solver.modelStatusToString(status), solver.getInfo().qp_iteration_count)


def qpalm(programme: Programme, eps: float) -> QPAnswer:
    """QPALM."""
    module = importlib.import_module("qpalm")
    data, settings = module.Data(len(programme.q), len(programme.b)), module.Settings()
    data.Q, data.q, data.A = programme.P, programme.q, programme.A
    data.bmin, data.bmax = programme.b, np.full(len(programme.b), np.inf)
    settings.eps_abs = settings.eps_rel = eps
    settings.max_iter, settings.verbose = MOST, False
    solver = module.Solver(data, settings)
    solver.solve()
    x, y, info = solver.solution.x, solver.solution.y, solver.info
    return _answer(np.array(x), -np.array(y), info.status == "solved", info.status, info.iter)


def cvxopt(programme: Programme, eps: float) -> QPAnswer:
    """The interior points of CVXOPT."""
    module = importlib.import_module("cvxopt")
    importlib.import_module("cvxopt.solvers")

    def given(A: Any) -> Any:
        entries = sparse.coo_matrix(A)
        return module.spmatrix(entries.data, entries.row.astype(int), entries.col.astype(int), entries.shape)

    options = {"show_progress": False, "abstol": eps, "reltol": eps, "feastol": eps}
    rest = given(-programme.A), module.matrix(-programme.b)
    result = module.solvers.qp(given(programme.P), module.matrix(programme.q), *rest, options=options)
    x, y = (np.array(result[key], float).ravel() for key in ("x", "z"))
    return _answer(x, y, result["status"] == "optimal", result["status"], result["iterations"])


def quadprog(programme: Programme, eps: float) -> QPAnswer:
    """The dual active set of Goldfarb and Idnani, which has no tolerance and raises where it finds nothing."""
    module = importlib.import_module("quadprog")
    P, A = programme.P.toarray(), programme.A.toarray()
    x, _, _, iterations, y, _ = module.solve_qp(P, -programme.q, A.T.copy(), programme.b)
    return _answer(x, y, True, "solved", int(iterations[0]))


def qpsolvers(programme: Programme, eps: float) -> QPAnswer:
    """What qpsolvers makes of quadprog."""
    module = importlib.import_module("qpsolvers")
    P, A = programme.P.toarray(), programme.A.toarray()
    solution = module.solve_problem(module.Problem(P, programme.q, -A, -programme.b), solver="quadprog")
    if not solution.found:
        return _nothing(programme, "not found")
    return _answer(solution.x, solution.z, True, "found")


def cvxpy(programme: Programme, eps: float) -> QPAnswer:
    """The default solver of cvxpy for a quadratic programme, OSQP, as cvxpy calls it."""
    cp = importlib.import_module("cvxpy")
    x = cp.Variable(len(programme.q))
    rows = programme.A @ x >= programme.b
    whole = cp.Problem(cp.Minimize(cp.quad_form(x, cp.psd_wrap(programme.P)) / 2 + programme.q @ x), [rows])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": such an answer is not claimed
        whole.solve(eps_abs=eps, eps_rel=eps, max_iter=MOST)
    if x.value is None:
        return _nothing(programme, whole.status)
    stats, y = whole.solver_stats, np.atleast_1d(rows.dual_value)
    status = f"{whole.status} by {stats.solver_name}"
    return _answer(np.asarray(x.value), y, whole.status == "optimal", status, stats.num_iters or 0)


def _answer(x: np.ndarray, y: np.ndarray, claimed: bool, status: str, iterations: int = 0) -> QPAnswer:
    """Unchanged, except that multipliers made negative by rounding become zero."""
    return QPAnswer(np.asarray(x, float), np.maximum(y, 0.0), bool(claimed), str(status), int(iterations))


def _nothing(programme: Programme, status: str) -> QPAnswer:
    nothing = np.full_like(programme.q, np.nan), np.full_like(programme.b, np.nan)
    return QPAnswer(*nothing, False, status)


@dataclass(frozen=True)
class Outside(Solver):
    """One cold call of a public solver, with the tolerance for each of its criteria.

    scaled: the programme as contact/algorithms/qp.py scales it, with a unit diagonal, unit rows and displacements about
    1; otherwise as it is in the file, in N and mm.  dense: whether the solver takes full matrices only.
    """

    call: Callable[[Programme, float], QPAnswer] = osqp
    scaled: bool = False
    dense: bool = False

    def applies(self, step: FrozenStep) -> str | None:
        """Only a convex programme whose multipliers are forces on some area."""
        if len(step.gap) == 0:
            return "no candidate: a linear system"
        if self.dense and len(step.r) > DENSE:
            return f"dense: {len(step.r)} unknowns are more than {DENSE}"
        return _refusal(step)

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """Its answer, in mm and MPa."""
        whole = self._scaled(step)
        solution = self._solved(step, whole, tolerance)
        du, forces = (solution.x, solution.y) if whole is None else whole.unscaled(solution)
        return Answer(du, forces / step.weights, solution.claimed, solution.iterations, reason=solution.status)

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """By the criterion of OSQP, in the units of the programme that it got."""
        whole, forces = self._scaled(step), step.weights * answer.pressure
        x = answer.du if whole is None else answer.du / (whole.size * whole.stretch)
        y = forces if whole is None else whole.multipliers(forces)
        return keeps(programme(step, whole), QPAnswer(x, y, True, ""), tolerance)

    def _solved(self, step: FrozenStep, whole: Scaled | None, tolerance: float) -> QPAnswer:
        return self.call(programme(step, whole), tolerance)

    def _scaled(self, step: FrozenStep) -> Scaled | None:
        return Scaled.of(step.K, step.r, step.G, step.gap, step.weights, np.inf) if self.scaled else None


@dataclass(frozen=True)
class Condensed(Outside):
    """A solver of quadratic programmes on the dense dual, with a unit diagonal and gaps of 1 at most.

    min f.C.f/2 + s.f over nodal forces f >= 0, as many unknowns as there are candidates. C = G K^-1 G^T is the
    compliance of the candidates [mm/N] (Delassus), s = g - G K^-1 r their gaps without any force. The equilibrium of
    du = K^-1 (G^T f - r) is then exact, whatever f is. Source: Delassus, Ann. Sci. Éc. Norm. Supér. 34 (1917) 95-179.
    """

    scaled: bool = True

    def applies(self, step: FrozenStep) -> str | None:
        """As the others, up to DENSE candidates."""
        if len(step.gap) > DENSE:
            return f"dense: {len(step.gap)} candidates are more than {DENSE}"
        return super().applies(step)

    def answer(self, step: FrozenStep, tolerance: float) -> Answer:
        """One factorisation, a solution for each candidate, and the programme."""
        factor, G = factorise(step.K), sparse.csc_matrix(step.G.T)
        gap = step.gap + step.G @ checked_solve(factor, step.K, -step.r)
        C = response(factor, G, G)
        size = unit(C)
        C, gap = size[:, None] * (C + C.T) / 2 * size, size * gap
        far = float(np.max(np.abs(gap))) or 1.0
        none = np.zeros_like(gap)
        whole = sparse.csc_matrix(sparse.eye_array(len(gap), format="csc"))
        solution = self.call(Programme(sparse.csc_matrix(C), gap / far, whole, none), tolerance)
        forces = far * size * np.maximum(solution.x, 0.0)
        du = checked_solve(factor, step.K, step.G.T @ forces - step.r)
        return Answer(du, forces / step.weights, solution.claimed, solution.iterations, reason=solution.status)

    def keeps(self, step: FrozenStep, answer: Answer, tolerance: float) -> bool | None:
        """None: its criterion is one of the dual, which is not stored."""
        return None


def programme(step: FrozenStep, whole: Scaled | None) -> Programme:
    """The quadratic programme of a step, as it is or ``whole`` scaled."""
    if whole is not None:
        return whole.programme
    return Programme(sparse.csc_matrix((step.K + step.K.T) / 2), step.r, sparse.csc_matrix(step.G), -step.gap)


@lru_cache(maxsize=2)
def _refusal(step: FrozenStep) -> str | None:
    if not np.all(step.weights > 0):
        return "a candidate without area has no force for a multiplier"
    return refusal(step)


def _both(solver: Outside) -> tuple[Solver, Solver]:
    return solver, replace(solver, name=f"{solver.name}, scaled", scaled=True)


# licences: cvxopt and quadprog are under the GPL, qpsolvers and QPALM under the LGPL; none is an extra of ours
OUTSIDE: tuple[Solver, ...] = (
    *_both(Outside("OSQP", "osqp", call=osqp)),
    *_both(Outside("Clarabel", "clarabel", call=known("clarabel"))),
    *_both(Outside("ProxQP", "proxsuite", call=known("proxqp"))),
    *_both(Outside("PIQP", "piqp", call=known("piqp"))),
    *_both(Outside("DAQP", "daqp", call=known("daqp"), dense=True)),
    *_both(Outside("HiGHS", "highspy", call=highs)),
    *_both(Outside("SCS", "scs", call=scs)),
    *_both(Outside("QPALM", "qpalm", call=qpalm)),
    *_both(Outside("CVXOPT", "cvxopt", call=cvxopt)),
    *_both(Outside("quadprog", "quadprog", call=quadprog, dense=True)),
    *_both(Outside("cvxpy", "cvxpy", call=cvxpy)),
    Outside("qpsolvers", "qpsolvers", "'qpsolvers[quadprog]'", call=qpsolvers, dense=True),
)
CONDENSED: tuple[Solver, ...] = (
    Condensed("OSQP, condensed", "osqp"),
    Condensed("Clarabel, condensed", "clarabel", call=known("clarabel")),
    Condensed("PIQP, condensed", "piqp", call=known("piqp")),
    Condensed("DAQP, condensed", "daqp", call=known("daqp")),
)
