"""One call each of public solvers: min x.P.x/2 + q.x, A x >= b; P (n, n), A (m, n), multipliers y (m,) >= 0.

What :mod:`contact.solvers.qp_backends` knows already is called there. Tolerances are absolute and relative alike where
there are both; all else is as the solver has it, but for the iterations, of which there may be more. Nothing is judged.
Measured: highspy 1.15 adds 1e-7 to the diagonal of P unless told not to; the wheel of scs 3.3 brings Pardiso.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy import sparse

from contact.solvers.qp_backends import Answer, Programme, ask

MOST = 100_000  # iterations of first-order methods; the limit of time comes first
INTERIOR = ("clarabel", "piqp")  # of which ``ask`` counts the solutions, two an iteration


def _ask(backend: str, programme: Programme, eps: float) -> Answer:
    found = ask(backend, programme, eps, polish=False)
    return replace(found, iterations=found.factorisations) if backend in INTERIOR else found


def known(backend: str) -> Callable[[Programme, float], Answer]:
    """A backend of ours, which can be sent to another process."""
    return partial(_ask, backend)


def osqp(
    programme: Programme,
    eps: float,
    guess: tuple[np.ndarray, np.ndarray] | None = None,
    algebra: str = "builtin",
    **settings: object,
) -> Answer:
    """OSQP with settings of its own, and another algebra; guess: where it starts, x (n,) and y (m,)."""
    module = importlib.import_module("osqp")
    solver, above = module.OSQP(algebra=algebra), np.full(len(programme.b), np.inf)
    settings = {"eps_abs": eps, "eps_rel": eps, "max_iter": MOST, "verbose": False, **settings}
    solver.setup(sparse.triu(programme.P, format="csc"), programme.q, programme.A, programme.b, above, **settings)
    if guess is not None:
        solver.warm_start(x=guess[0], y=-guess[1])
    found = solver.solve(raise_error=False)
    claimed = found.info.status_val == module.SolverStatus.OSQP_SOLVED
    return _answer(found.x, -found.y, claimed, found.info.status, found.info.iter)


def scs(programme: Programme, eps: float) -> Answer:
    """SCS: A x + s = b with s >= 0."""
    module = importlib.import_module("scs")
    P, A = sparse.triu(programme.P, format="csc"), sparse.csc_matrix(-programme.A)
    data = {"P": P, "A": A, "b": -programme.b, "c": programme.q}
    cone = {"l": len(programme.b)}
    found = module.SCS(data, cone, eps_abs=eps, eps_rel=eps, max_iters=MOST, verbose=False).solve()
    info = found["info"]
    return _answer(found["x"], found["y"], info["status_val"] == 1, info["status"], info["iter"])


def highs(programme: Programme, eps: float) -> Answer:
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
    found = solver.getSolution()
    x, y = np.array(found.col_value, float), np.array(found.row_dual, float)
    if refused or len(x) != n or len(y) != m:
        return _nothing(programme, "the model was refused" if refused else solver.modelStatusToString(status))
    claimed = status == module.HighsModelStatus.kOptimal
    return _answer(x, y, claimed, solver.modelStatusToString(status), solver.getInfo().qp_iteration_count)


def qpalm(programme: Programme, eps: float) -> Answer:
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


def cvxopt(programme: Programme, eps: float) -> Answer:
    """The interior points of CVXOPT."""
    module = importlib.import_module("cvxopt")
    importlib.import_module("cvxopt.solvers")

    def given(A: Any) -> Any:
        entries = sparse.coo_matrix(A)
        return module.spmatrix(entries.data, entries.row.astype(int), entries.col.astype(int), entries.shape)

    options = {"show_progress": False, "abstol": eps, "reltol": eps, "feastol": eps}
    rest = given(-programme.A), module.matrix(-programme.b)
    found = module.solvers.qp(given(programme.P), module.matrix(programme.q), *rest, options=options)
    x, y = (np.array(found[key], float).ravel() for key in ("x", "z"))
    return _answer(x, y, found["status"] == "optimal", found["status"], found["iterations"])


def quadprog(programme: Programme, eps: float) -> Answer:
    """The dual active set of Goldfarb and Idnani, which has no tolerance and raises where it finds nothing."""
    module = importlib.import_module("quadprog")
    P, A = programme.P.toarray(), programme.A.toarray()
    x, _, _, iterations, y, _ = module.solve_qp(P, -programme.q, A.T.copy(), programme.b)
    return _answer(x, y, True, "solved", int(iterations[0]))


def qpsolvers(programme: Programme, eps: float) -> Answer:
    """What qpsolvers makes of quadprog."""
    module = importlib.import_module("qpsolvers")
    P, A = programme.P.toarray(), programme.A.toarray()
    found = module.solve_problem(module.Problem(P, programme.q, -A, -programme.b), solver="quadprog")
    if not found.found:
        return _nothing(programme, "not found")
    return _answer(found.x, found.z, True, "found")


def cvxpy(programme: Programme, eps: float) -> Answer:
    """The solver that cvxpy chooses by itself for a quadratic programme, OSQP, as cvxpy hands it on."""
    cp = importlib.import_module("cvxpy")
    x = cp.Variable(len(programme.q))
    rows = programme.A @ x >= programme.b
    whole = cp.Problem(cp.Minimize(cp.quad_form(x, cp.psd_wrap(programme.P)) / 2 + programme.q @ x), [rows])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": such an answer is no claim
        whole.solve(eps_abs=eps, eps_rel=eps, max_iter=MOST)
    if x.value is None:
        return _nothing(programme, whole.status)
    stats, y = whole.solver_stats, np.atleast_1d(rows.dual_value)
    words = f"{whole.status} by {stats.solver_name}"
    return _answer(np.asarray(x.value), y, whole.status == "optimal", words, stats.num_iters or 0)


def _answer(x: np.ndarray, y: np.ndarray, claimed: bool, status: str, iterations: int = 0) -> Answer:
    """As it is, but for the sign that rounding gives a multiplier."""
    return Answer(np.asarray(x, float), np.maximum(y, 0.0), bool(claimed), str(status), int(iterations))


def _nothing(programme: Programme, status: str) -> Answer:
    nothing = np.full_like(programme.q, np.nan), np.full_like(programme.b, np.nan)
    return Answer(*nothing, False, status)
