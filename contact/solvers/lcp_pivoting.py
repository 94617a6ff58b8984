"""Dense linear complementarity problems: w = M z + q, w >= 0, z >= 0, w.z = 0, solved exactly.

No mechanics here: M (n, n) may be any matrix, q (n,). Whatever pivots a method takes, z comes from one dense solve on
the set it ends with, so that rounding does not build up.
Source of all three: Cottle, Pang, Stone, The Linear Complementarity Problem (1992), chapter 4.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contact.events import Event, EventKind
from contact.operations import DENSE_PIVOTS, dense_solution, spend

ROUNDING = 1e-13  # of the terms that make up w_i; less than that below zero is no violation
SYMMETRIC = 1e-9  # largest |M - M^T| over the largest |M| that still counts as rounding
MOST_PIVOTS = 100_000  # Lemke does need 2^n on published problems
PATIENCE = 10
SINGLY = Event(EventKind.CYCLE, "cycle detected or no progress: single indices were swapped")


class LcpError(ArithmeticError):
    """The method has found no solution; the message says why."""


class NotApplicableError(LcpError):
    """The method is not made for such a matrix; the message says why."""


@dataclass(frozen=True, eq=False)
class LcpSolution:
    """z (n,) and the number of pivots, of set updates for block methods; ``event``: what had to be done instead."""

    z: np.ndarray
    pivots: int
    event: Event | None = None


def lemke(M: np.ndarray, q: np.ndarray, start: np.ndarray | None = None, most: int = MOST_PIVOTS) -> LcpSolution:
    """Lemke's complementary pivots with the covering vector e; ``start`` is ignored.

    Ties of the ratio test are broken lexicographically: finite for every M. Raises LcpError on a secondary ray, which
    no P-matrix and no solvable positive semidefinite problem ends on, and after ``most`` pivots.
    """
    n = len(q)
    if n == 0 or np.min(q) >= 0:
        return LcpSolution(np.zeros(n), 0)
    size = 1 / np.sqrt(np.where(np.diag(M) > 0, np.diag(M), 1.0))
    # columns: w (n), z (n), the artificial z0, the right-hand side
    scaled = size * q / np.max(np.abs(size * q))
    table = np.hstack([np.eye(n), -size[:, None] * M * size, -np.ones((n, 1)), scaled[:, None]])
    basis, entering = np.arange(n), 2 * n
    row = n - 1 - int(np.argmin(table[::-1, -1]))  # which z0 = max(-q) makes zero; the last is the lexicographic one
    for pivots in range(1, most + 1):
        table[row] /= table[row, entering]
        others = np.flatnonzero(table[:, entering])
        others = others[others != row]
        spend(DENSE_PIVOTS, 2 * (len(others) + 1) * table.shape[1])
        table[others] -= np.outer(table[others, entering], table[row])
        leaving, basis[row] = basis[row], entering
        if leaving == 2 * n:
            return LcpSolution(_on_set(M, q, np.isin(np.arange(n), basis - n)), pivots)
        entering = (leaving + n) % (2 * n)
        column = table[:, entering]
        rows = np.flatnonzero(column > 1e-11 * max(np.max(np.abs(column)), 1e-300))
        if len(rows) == 0:
            raise LcpError(f"Lemke's method ended on a secondary ray after {pivots} pivots: M is no P-matrix")
        row = _lexicographic_minimum(table, rows, column, basis)
    raise LcpError(f"Lemke's method took {most} pivots without an end")


def _lexicographic_minimum(table: np.ndarray, rows: np.ndarray, column: np.ndarray, basis: np.ndarray) -> int:
    n = len(table)
    ratio = table[rows, -1] / column[rows]
    rows = rows[ratio <= np.min(ratio) + 1e-12 * (1 + abs(np.min(ratio)))]
    artificial = rows[basis[rows] == 2 * n]
    if len(artificial):  # z0 may leave: done
        return int(artificial[0])
    for j in range(n):
        if len(rows) == 1:
            break
        ratio = table[rows, j] / column[rows]
        rows = rows[ratio <= np.min(ratio) + 1e-12 * (1 + abs(np.min(ratio)))]
    return int(rows[0])


def by_nnls(M: np.ndarray, q: np.ndarray, start: np.ndarray | None = None) -> LcpSolution:
    """The least |L^T z + L^-1 q|, z >= 0, M = L L^T, by Lawson and Hanson; ``start`` is ignored.

    scipy's nnls (1.17.1) returns wrong sets without a word where the gradient is rounding, as for candidates that just
    touch: its answer is checked, and where wrong the active set goes on from it; the event says so.
    Raises NotApplicableError unless M is symmetric, LcpError unless it is positive definite.
    """
    from scipy.optimize import nnls  # loads all of scipy.optimize: only where it is asked for

    asymmetry = np.max(np.abs(M - M.T), initial=0.0)
    if asymmetry > SYMMETRIC * np.max(np.abs(M), initial=0.0):
        raise NotApplicableError(
            f"nnls needs a symmetric matrix; this one differs from its transpose by {asymmetry:.1e}"
        )
    try:
        L = np.linalg.cholesky((M + M.T) / 2)
    except np.linalg.LinAlgError:
        raise LcpError("nnls needs a positive definite matrix; this one has no Cholesky factor") from None
    spend(DENSE_PIVOTS, len(q) ** 3 / 3 + 2.0 * len(q) ** 2)
    claimed = nnls(L.T, -np.linalg.solve(L, q))[0] > 0
    # each index that enters takes its place in a triangular factor and asks for the gradient anew: about 6 n^2
    spend(DENSE_PIVOTS, 6.0 * int(claimed.sum()) * len(q) ** 2)
    exact = active_set(M, q, claimed)
    event = Event(EventKind.SUBSTITUTE, f"set of nnls corrected in {exact.pivots} updates")
    return LcpSolution(exact.z, int(claimed.sum()) + exact.pivots, event if exact.pivots else None)


def active_set(M: np.ndarray, q: np.ndarray, start: np.ndarray | None = None) -> LcpSolution:
    """Primal-dual active set from ``start`` (n,) bool, default none: all violating indices are swapped at once.

    When a set comes back, or the violations have not become fewer in 10 updates, only the last violating index is
    swapped until they have: finite for every P-matrix. Single swaps that come back to a set prove that M is none.
    Source of the safeguard: Júdice and Pires, Comput. Oper. Res. 21 (1994) 587-596.
    """
    active = np.zeros(len(q), bool) if start is None else start
    seen, singly = set[bytes](), set[bytes]()
    fewest, patience = len(q) + 1, PATIENCE
    event: Event | None = None
    most = 10 * len(q) + 100
    for pivots in range(most):
        z, wrong = _violations(M, q, active)
        if not wrong.any():
            return LcpSolution(z, pivots, event)
        if wrong.sum() < fewest:
            fewest, patience = int(wrong.sum()), PATIENCE
        elif patience > 0:
            patience = 0 if active.tobytes() in seen else patience - 1
        if patience > 0:
            singly.clear()
        else:
            event = SINGLY
            if active.tobytes() in singly:
                raise LcpError(f"single swaps have come back to a set after {pivots} updates: M is no P-matrix")
            singly.add(active.tobytes())
            wrong[: np.flatnonzero(wrong)[-1]] = False
        seen.add(active.tobytes())
        active = active ^ wrong
    raise LcpError(f"the active set has not settled in {most} updates")


def unit(M: np.ndarray) -> np.ndarray:
    """Sizes s (n,) with which s M s has a diagonal of 1 or -1: forces and gaps in one matrix are far apart."""
    diagonal = np.abs(np.diag(M))
    return np.asarray(1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)))


def principal_pivot(M: np.ndarray, q: np.ndarray, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The problem with w and z of the ``chosen`` indices (n,) bool exchanged: M' (n, n), q' (n,).

    Undoes the block signs that an exchange has given a symmetric matrix. Raises LcpError where M on them is singular.
    Source: Tsatsomeros, Linear Algebra Appl. 307 (2000) 151-165.
    """
    if not chosen.any():
        return M, q
    inside, outside = np.ix_(chosen, chosen), np.ix_(~chosen, ~chosen)
    across, down = np.ix_(chosen, ~chosen), np.ix_(~chosen, chosen)
    a, b = int(chosen.sum()), int(np.sum(~chosen))
    spend(
        DENSE_PIVOTS, 2.0 * a**3 + 4.0 * a * a * b + 2.0 * a * b * b
    )  # the inverse, both sides of it, and what they leave
    try:
        inverse = np.linalg.inv(M[inside])
    except np.linalg.LinAlgError:
        raise LcpError(f"the matrix on the {chosen.sum()} indices to be exchanged is singular") from None
    pivoted, constant = np.empty_like(M), q.copy()
    pivoted[inside], pivoted[across] = inverse, -inverse @ M[across]
    pivoted[down] = M[down] @ inverse
    pivoted[outside] = M[outside] - pivoted[down] @ M[across]
    constant[chosen] = -inverse @ q[chosen]
    constant[~chosen] -= pivoted[down] @ q[chosen]
    return pivoted, constant


def _violations(M: np.ndarray, q: np.ndarray, active: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The z on the set, and the indices with z < 0 in it or w < 0 out of it; raises LcpError."""
    z = _on_set(M, q, active, clip=False)
    spend(DENSE_PIVOTS, 4.0 * M.size)
    w = M @ z + q
    rounding = ROUNDING * (np.abs(M) @ np.abs(z) + np.abs(q))
    slope = np.abs(np.diag(M))
    in_z = np.divide(rounding, slope, out=np.zeros_like(rounding), where=slope > 0)
    return np.where(z < 0, np.where(z < -in_z, z, 0.0), z), np.where(active, z < -in_z, w < -rounding)


def _on_set(M: np.ndarray, q: np.ndarray, active: np.ndarray, clip: bool = True) -> np.ndarray:
    z = np.zeros_like(q, dtype=float)
    spend(DENSE_PIVOTS, dense_solution(int(active.sum())))
    try:
        z[active] = np.linalg.solve(M[np.ix_(active, active)], -q[active])
    except np.linalg.LinAlgError:
        raise LcpError(f"the matrix on a set of {active.sum()} is singular") from None
    return np.maximum(z, 0.0) if clip else z


METHODS: dict[str, Callable[[np.ndarray, np.ndarray, np.ndarray | None], LcpSolution]] = {
    "lemke": lemke,
    "active-set": active_set,
    "nnls": by_nnls,
}
