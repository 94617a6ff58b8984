"""Quadratic programmes min x.P.x/2 + q.x, A x >= b, by one call of a public solver each; no solver is trusted.

The last rows of A x - b may be discs instead, three rows each: (a, c, d) with c^2 + d^2 <= a^2, a >= 0.

Every backend answers with what it has found and what it claims; judging that is the business of the caller.
Traps (osqp 1.1.3, clarabel 0.11, proxsuite 0.8.0, piqp 0.6.4, daqp 0.11.0; measured): where there is no answer OSQP
fills x with 2.1e9, and daqp claims success with NaN; proxqp never returns from NaN; of a P that is not convex clarabel,
proxqp and piqp "solve" a saddle point; the multipliers of OSQP and daqp have the other sign.
"""

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.operations import PROGRAMMES, spend


@dataclass(frozen=True, eq=False)
class Programme:
    """P (n, n) symmetric CSC, q (n,), A (m, n) CSC, b (m,); guess: x (n,) and y (m,) for those who can start there.

    discs: how many there are; only the backends in DISCS have them.
    """

    P: sparse.csc_matrix
    q: np.ndarray
    A: sparse.csc_matrix
    b: np.ndarray
    guess: tuple[np.ndarray, np.ndarray] | None = None
    discs: int = 0

    @property
    def rows(self) -> int:
        """Rows that are no disc's."""
        return len(self.b) - 3 * self.discs


@dataclass(frozen=True, eq=False)
class Answer:
    """x (n,) and multipliers y (m,) with P x + q = A^T y, whether the solver claims success, and its words.

    Multipliers are >= 0 but for those of discs.

    iterations, factorisations: that it has taken, of the matrix of P and A.
    """

    x: np.ndarray
    y: np.ndarray
    claimed: bool
    status: str
    iterations: int = 0
    factorisations: int = 1


FILLING = 1e9  # unclaimed numbers above are what solvers leave behind where they have no answer


def ask(backend: str, programme: Programme, eps: float, polish: bool) -> Answer:
    """What the backend says, and no more than that: numbers that are none and exceptions are no claim of success.

    eps: tolerance, absolute and relative.  polish: of OSQP.
    """
    nothing = Answer(np.zeros_like(programme.q), np.zeros_like(programme.b), False, "")
    if not all(np.all(np.isfinite(v)) for v in (programme.P.data, programme.q, programme.A.data, programme.b)):
        return replace(nothing, status="refused: the programme is not finite")
    if programme.discs and backend not in DISCS:
        return replace(nothing, status=f"refused: {backend} has no discs")
    call = BACKENDS[backend]
    try:
        answer = call(programme, eps, polish)
        spend(PROGRAMMES, operations(programme, answer.iterations, answer.factorisations))
        largest = np.max(np.abs(np.append(answer.x, answer.y)), initial=0.0)
    except (KeyboardInterrupt, SystemExit, MemoryError):
        raise
    except BaseException as error:  # whatever compiled code raises; a panic of Rust is not even an Exception
        return replace(nothing, status=f"refused: {error!r}")
    if not largest < (np.inf if answer.claimed else FILLING):  # NaN is not
        return replace(nothing, status=answer.status)
    return replace(answer, y=np.where(np.arange(len(answer.y)) < programme.rows, np.maximum(answer.y, 0.0), answer.y))


def operations(programme: Programme, iterations: int, factorisations: int) -> float:
    """About what a solver takes, none of which says it: of factorisations, of solutions, and of products with P and A.

    The entries of L, of the matrix of n + m rows, are those that nested dissection leaves of a grid in the plane, of
    what is given times a logarithm, and no more than a full triangle has; the factorisation takes their square over
    the rows, each solution four times their number.
    """
    rows = len(programme.q) + len(programme.b)
    given = sparse.triu(programme.P).nnz + programme.A.nnz + len(programme.b)
    fill = min(given * max(np.log2(rows), 1.0), rows * (rows + 1) / 2)
    products = 2.0 * (programme.P.nnz + 2 * programme.A.nnz)
    return float(factorisations * fill**2 / rows + iterations * (4 * fill + products))


def _osqp(programme: Programme, eps: float, polish: bool) -> Answer:
    import osqp

    solver = osqp.OSQP()
    above = np.full(len(programme.b), np.inf)
    upper = sparse.triu(programme.P, format="csc")
    limits = {"eps_abs": eps, "eps_rel": eps, "max_iter": 4000 if eps >= 1e-3 else 20_000}
    try:
        solver.setup(upper, programme.q, programme.A, programme.b, above, verbose=False, polishing=False, **limits)
    except osqp.OSQPException as error:
        codes = osqp.SolverError  # nothing else keeps its own LDL from being set up
        if error.args[0] in (codes.OSQP_MEM_ALLOC_ERROR, codes.OSQP_LINSYS_SOLVER_INIT_ERROR):
            raise MemoryError(f"OSQP: {codes(error.args[0]).name}") from error
        raise
    if programme.guess is not None:
        x, y = programme.guess
        solver.warm_start(x=x, y=-y)
    result = solver.solve(raise_error=False)
    spent, updates = result.info.iter, result.info.rho_updates
    success = int(osqp.SolverStatus.OSQP_SOLVED)
    # it polishes on the rows whose multiplier is above their slack; where there are none it prints so, quiet or not
    pressed = np.any(-result.y > np.maximum(programme.A @ result.x - programme.b, eps))
    if polish and np.any(result.y) and (pressed or result.info.status_val != success):  # a second attempt may succeed
        solver.update_settings(polishing=True)
        result = solver.solve(raise_error=False)
        spent, updates = spent + result.info.iter, updates + 1 + result.info.rho_updates  # one more to polish
    return Answer(result.x, -result.y, result.info.status_val == success, result.info.status, spent, 1 + updates)


def _clarabel(programme: Programme, eps: float, polish: bool) -> Answer:
    import clarabel

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = eps
    upper = sparse.triu(programme.P, format="csc")
    cones = [clarabel.NonnegativeConeT(programme.rows), *[clarabel.SecondOrderConeT(3)] * programme.discs]
    solver = clarabel.DefaultSolver(upper, programme.q, sparse.csc_matrix(-programme.A), -programme.b, cones, settings)
    result = solver.solve()
    solved = result.status == clarabel.SolverStatus.Solved
    each = result.iterations  # a factorisation and two solutions, a step ahead and one that corrects it
    return Answer(np.array(result.x), np.array(result.z), solved, str(result.status), 2 * each, each)


def _proxqp(programme: Programme, eps: float, polish: bool) -> Answer:
    proxqp = importlib.import_module("proxsuite").proxqp
    P, q, A, b = programme.P, programme.q, programme.A, programme.b
    result = proxqp.sparse.solve(P, q, None, None, A, b, np.full(len(b), np.inf), eps_abs=eps, eps_rel=0.0)
    solved = result.info.status == proxqp.QPSolverOutput.PROXQP_SOLVED
    spent, updates = result.info.iter, result.info.mu_updates
    return Answer(result.x, -result.z, solved, str(result.info.status), spent, 1 + updates)


def _piqp(programme: Programme, eps: float, polish: bool) -> Answer:
    piqp = importlib.import_module("piqp")
    solver = piqp.SparseSolver()
    solver.settings.eps_abs, solver.settings.eps_rel = eps, eps
    P, q, A, b = programme.P, programme.q, programme.A, programme.b
    n, above = len(q), np.full(len(b), np.inf)
    solver.setup(P, q, sparse.csc_matrix((0, n)), np.zeros(0), A, b, above)
    status = solver.solve()
    each = solver.result.info.iter  # as clarabel
    return Answer(solver.result.x, solver.result.z_l, status == piqp.PIQP_SOLVED, str(status), 2 * each, each)


def _daqp(programme: Programme, eps: float, polish: bool) -> Answer:
    daqp = importlib.import_module("daqp")
    P, A, b = programme.P.toarray(), programme.A.toarray(), programme.b
    above = np.full(len(b), 1e30)
    x, _, flag, info = daqp.solve(P, programme.q, A, above, b, primal_tol=eps, dual_tol=eps)
    return Answer(x, -info["lam"], flag == 1, f"exit flag {flag}", info["iterations"])


BACKENDS: dict[str, Callable[[Programme, float, bool], Answer]] = {
    "osqp": _osqp,
    "clarabel": _clarabel,
    "proxqp": _proxqp,
    "piqp": _piqp,
    "daqp": _daqp,
}
DISCS = ("clarabel",)
MODULES = {"osqp": "osqp", "clarabel": "clarabel", "proxqp": "proxsuite", "piqp": "piqp", "daqp": "daqp"}


def missing(backend: str) -> str | None:
    """None, or the line that says why the backend cannot be used."""
    if backend not in BACKENDS:
        return f"backend {backend!r} must be one of {', '.join(BACKENDS)}"
    if importlib.util.find_spec(MODULES[backend]) is None:
        return f"backend {backend!r} needs the extra qp: pip install -e '.[qp]' in the checkout of Footprint"
    return None
