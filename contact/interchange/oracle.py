"""An oracle of linearised contact: the quadratic programme by an interior-point solver, none of our algorithms.

    min 1/2 du.K.du + r.du    subject to    g + G du >= 0

Its multipliers are the nodal forces W p. A finite epsilon gives every constraint a slack s of the energy s^2/2 in units
of 1/sqrt(epsilon w). Clarabel, through cvxpy, finds the set, from no set at all: to 1e-6 of the forces and no closer
(thin shells, measured). The exact answer on that set then has to obey every condition; as the programme is strictly
convex, it is the only one that does. Its linear systems are solved by SciPy's SuperLU, without our fronts and checks.
"""

import contextlib
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import SuperLU, splu

from contact.interchange.linearised_step import FrozenStep
from contact.solvers.sparse import asymmetry, negative_pivots, symmetric

TOLERANCES = (1e-12, 1e-10, 1e-8)  # of the interior-point solver, on the scaled problem: the first that it reaches
EXACT = 1e-9  # relative size of a force or gap on the wrong side that is rounding
SETTLINGS = 50  # of the set: from none at all, heavy-strip's takes between 20 and 40
REFINED = 3  # times that forces are found: after one, 1.5e-3 of plate-contact's are wrong, after three 1e-12
LEFT, LOST = 1e-8, 0.1  # residual over the terms in it, and over the load, of a solution that is one
AGREEMENT = 1e-7  # of forces and displacements, relative to the largest
UNKNOWN = 1e-3  # of forces that rounding changes by more nothing is confirmed


class OracleError(ArithmeticError):
    """The oracle does not apply or found no solution; the message says why."""


@dataclass(frozen=True, eq=False)
class Confirmation:
    """How far an answer is from the oracle's.

    displacement_error: size of the difference over that to be expected [-].  force_error: largest difference of a nodal
    force, normal or friction, over the largest of them [-].  differing: candidates that only one of the two presses by
    more than the agreement, touching without pressure is in both; with friction all that differ by more.  allowed: the
    agreement, or what rounding leaves unknown of the forces where that is more: for them alone.
    """

    displacement_error: float
    force_error: float
    differing: np.ndarray
    allowed: float = AGREEMENT

    @property
    def agrees(self) -> bool:
        """True when set, forces and displacement are those of the oracle."""
        if self.displacement_error > AGREEMENT:
            return False
        return not len(self.differing) and self.force_error <= self.allowed


def refusal(step: FrozenStep) -> str | None:
    """Why the step is not a convex programme with the pressures as multipliers, or None."""
    if step.coupling is not None:
        return "with consistent coupling the pressures are not multipliers of the gaps"
    if not symmetric(step.K):
        return f"K is not symmetric (to {asymmetry(step.K):.1e}): there is no function to minimise"
    if not positive_definite(step.K):
        return "K is not positive definite: the programme is not convex"
    return None


def positive_definite(K: sparse.csc_matrix) -> bool:
    """Whether a symmetric K is, by its pivots in a scale in which its diagonal is one."""
    if not np.all(K.diagonal() > 0):
        return False
    size = sparse.diags_array(1 / np.sqrt(K.diagonal()))
    return not negative_pivots(sparse.csc_matrix(size @ K @ size))


def minimise(step: FrozenStep, epsilon: float = np.inf) -> tuple[np.ndarray, np.ndarray]:
    """The oracle's du (n,) and pressure (m,); raises OracleError."""
    reason = refusal(step)
    if reason is not None:
        raise OracleError(reason)
    try:
        factor = _superlu(step.K)
        return _settle(step, epsilon, factor, _interior(step, epsilon, factor.solve(-step.r)))
    except (RuntimeError, np.linalg.LinAlgError) as error:
        raise OracleError(f"the oracle failed: {error}") from None


def _superlu(K: sparse.csc_matrix) -> SuperLU:
    """Of a definite matrix; raises RuntimeError where it is singular."""
    return splu(K, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def solved(A: sparse.csc_matrix, b: np.ndarray) -> np.ndarray:
    """x with A x = b by SciPy's SuperLU alone, refined once; raises RuntimeError where A is singular, all but."""
    factor = splu(A)
    x = factor.solve(b)
    x = x + factor.solve(b - A @ x)
    left, load = np.max(np.abs(b - A @ x), initial=0.0), np.max(np.abs(b), initial=0.0)
    size = np.max(abs(A) @ np.abs(x), initial=0.0) + load
    if not (np.isfinite(size) and left <= LEFT * size and left <= LOST * load):
        raise RuntimeError(f"the matrix is singular to working precision: {left:.1e} is left of {load:.1e}")
    return np.asarray(x)


def _interior(step: FrozenStep, epsilon: float, free: np.ndarray) -> np.ndarray:
    """Which candidates (m,) the interior-point solver presses; ``free`` (n,): displacement without any foundation.

    In unknowns y with a unit diagonal of K, measured by the displacement to be expected, and of energy about 1.
    """
    import cvxpy as cp

    unit = 1 / np.sqrt(step.K.diagonal())
    G = sparse.csr_matrix(step.G @ sparse.diags_array(unit))
    row = np.sqrt(np.asarray(G.multiply(G).sum(axis=1)).ravel())
    row[row == 0] = 1.0
    size = float(max(np.max(np.abs(free / unit), initial=0.0), np.max(-step.gap / row, initial=0.0))) or 1.0
    K = sparse.diags_array(unit) @ step.K @ sparse.diags_array(unit)
    y = cp.Variable(len(step.r))  # du = size * unit * y
    room = (sparse.diags_array(1 / row) @ G) @ y + step.gap / (row * size)
    cost = cp.quad_form(y, cp.psd_wrap(sparse.csc_matrix((K + K.T) / 2))) / 2 + (unit * step.r / size) @ y
    if np.isfinite(epsilon):
        s = cp.Variable(len(step.gap))
        room = room + cp.multiply(1 / (row * np.sqrt(epsilon * step.weights)), s)
        cost = cost + cp.sum_squares(s) / 2
    programme = cp.Problem(cp.Minimize(cost), [room >= 0])
    solve_tightly(programme)
    multipliers = np.atleast_1d(programme.constraints[0].dual_value)
    return np.asarray(multipliers > np.atleast_1d(room.value))


def solve_tightly(programme: Any, tolerances: Sequence[float] = TOLERANCES) -> None:
    """Solve a programme of cvxpy by Clarabel to the first tolerance that it reaches; raises OracleError for none."""
    import cvxpy as cp

    for tolerance in tolerances:
        tight = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_ktratio"), tolerance)
        with contextlib.suppress(cp.error.SolverError), warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": such an answer is not taken
            programme.solve(solver=cp.CLARABEL, **tight)
            if programme.status == "optimal":
                return
    raise OracleError(f"the oracle found no solution: {programme.status}")


def _settle(step: FrozenStep, epsilon: float, factor: SuperLU, pressed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The exact answer on a set that is nearly right, condensed on the set; it has to obey every condition."""

    def response(force: np.ndarray) -> np.ndarray:
        x = factor.solve(force)
        return np.asarray(x + factor.solve(force - step.K @ x))

    for _ in range(SETTLINGS):
        nodes, f, du = np.flatnonzero(pressed), np.zeros(len(pressed)), response(-step.r)
        if len(nodes):
            rows, soft = step.G[nodes].toarray(), 1 / (epsilon * step.weights[nodes])
            flexible = response(rows.T)
            S = rows @ flexible + np.diag(soft)
            held = cho_factor((S + S.T) / 2)
            for _ in range(REFINED):
                du = du + response(rows.T @ f[nodes] - step.r - step.K @ du)
                more = cho_solve(held, -(step.gap[nodes] + rows @ du + soft * f[nodes]))
                f[nodes] += more
                du = du + flexible @ more
        slack = step.gap + step.G @ du + f / (epsilon * step.weights)
        size = float(np.max(np.abs(step.gap) + np.abs(step.G @ du), initial=0.0))
        wrong = np.where(pressed, f < -EXACT * np.max(np.abs(f), initial=0.0), slack < -EXACT * size)
        if not wrong.any():
            return du, np.maximum(f, 0.0) / step.weights
        pressed = pressed ^ wrong
    raise OracleError("the set of the oracle does not settle")


def confirm(step: FrozenStep, du: np.ndarray, pressure: np.ndarray, epsilon: float = np.inf) -> Confirmation:
    """Compare an answer of the step with the oracle's; raises OracleError where that has none.

    Displacements over the larger of du and the free response |K^-1 r|.
    """
    own, multipliers = minimise(step, epsilon)
    factor = _superlu(step.K)
    free = factor.solve(-step.r)
    size = float(max(np.linalg.norm(free), np.linalg.norm(own))) or 1.0
    f, own_force = step.weights * pressure, step.weights * multipliers
    largest = float(max(np.max(np.abs(f), initial=0.0), np.max(np.abs(own_force), initial=0.0))) or 1.0
    error = np.abs(f - own_force) / largest
    allowed = AGREEMENT
    if np.max(error, initial=0.0) > AGREEMENT:
        allowed = max(allowed, _rounding(step, epsilon, factor, free, multipliers) / largest)
        if allowed > UNKNOWN:
            raise OracleError(f"rounding alone changes the forces by {allowed:.1e} of the largest")
    pressed, other = f > allowed * largest, own_force > allowed * largest
    return Confirmation(
        float(np.linalg.norm(du - own)) / size,
        float(np.max(error, initial=0.0)),
        np.flatnonzero((pressed != other) & (error > allowed)),
        allowed,
    )


def _rounding(step: FrozenStep, epsilon: float, factor: SuperLU, free: np.ndarray, multipliers: np.ndarray) -> float:
    """Change of the largest nodal force by the rounding of the forces K free, one draw of its signs.

    An answer is the sum of motions of that size, which cancel on thin walls: no algorithm knows its forces better.
    Zero where the changed step has no answer: that says nothing of the forces.
    """
    lost = np.finfo(float).eps * (abs(step.K) @ np.abs(free)) * np.random.default_rng(0).choice([-1.0, 1.0], len(free))
    try:
        moved = _settle(replace(step, r=step.r + lost), epsilon, factor, multipliers > 0)[1]
    except (OracleError, np.linalg.LinAlgError):
        return 0.0
    return float(np.max(step.weights * np.abs(moved - multipliers), initial=0.0))
