"""Sparse direct solvers behind one small interface; every solution is checked by its residual.

SuperLU needs ``permc_spec="MMD_AT_PLUS_A"``, ``SymmetricMode`` and a small pivot threshold for matrices of symmetric
pattern: 4 times faster than its defaults at 10,000 unknowns, and the default threshold with MMD never ends.
A matrix that comes in an order of elimination (``ordered``) keeps it: by nested dissection 250,000 unknowns of a shell
take less than half the time of MMD. Dense fronts in that order (:mod:`contact.solvers.multifrontal`) take 0.3 of the
time of SuperLU at 10,000 unknowns of a tyre whose pattern is known already, and 0.23 at 60,000; half as long as SuperLU
where the values are not symmetric. PARDISO (extra ``mkl``) finds its own order, and needs its weighted matching
switched off: left on, it can return a residual of 1e37 in silence.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, Literal, Protocol

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU, spilu, splu

from contact.operations import FACTORISATIONS, SOLUTIONS, spend
from contact.solvers.analysis import analysed
from contact.solvers.bordered import Bordered
from contact.solvers.multifrontal import SYMMETRIC, Multifrontal, PivotError, Response

BACKWARD_ERROR = 1e-13  # refine once above this, refuse above REFUSED
REFUSED = 1e-8
LOST = 0.1  # of the load: a residual above this leaves not one digit of it; thin shells do come down to two
COLUMNS = 256  # right-hand sides at once
AUTO = "auto"
LARGE_FILL = 2e7
UNLIKE = 2.6  # sum c^2 over (sum c)^2/n; measured: 1.6, 2.1, 2.6 at 10, 40 and 100 thousand unknowns


class SingularMatrixError(ArithmeticError):
    """The factorisation failed or its solution does not satisfy the system."""


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x with A x = b."""


def _superlu(A: sparse.csc_matrix, ordered: bool) -> Factor:
    order: Literal["NATURAL", "MMD_AT_PLUS_A"] = "NATURAL" if ordered else "MMD_AT_PLUS_A"
    # 1e-3 serves definite, saddle-point and non-symmetric tangents alike: same speed as 0, errors of 1e-14
    return superlu(A, permc_spec=order, diag_pivot_thresh=1e-3, options={"SymmetricMode": True})


def superlu(A: sparse.csc_matrix, **options: Any) -> SuperLU:
    """The factors of scipy's splu. Raises SingularMatrixError, and MemoryError, which SuperLU has two ways to say."""
    try:
        factor = splu(A, **options)
    except RuntimeError as error:
        if "alloc" in str(error).lower():
            raise MemoryError(str(error)) from error
        raise SingularMatrixError(str(error)) from error
    spend(FACTORISATIONS, factor_flops(factor))
    return factor


def least_degrees(A: sparse.csc_matrix) -> np.ndarray:
    """The unknowns (n,) of a symmetric pattern in SuperLU's order of minimum degree; values play no part.

    Source: Liu, ACM Trans. Math. Softw. 11 (1985) 141-153.
    """
    n = A.shape[0]
    like = sparse.csc_matrix((np.full(A.nnz, -1.0 / n), A.indices, A.indptr), shape=A.shape)
    dominant = sparse.csc_matrix(like + sparse.diags_array(np.full(n, 2.0)))
    # an incomplete factorisation that keeps nothing: the order costs a tenth of the factors
    factor = spilu(dominant, drop_tol=1.0, fill_factor=1, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return np.argsort(factor.perm_c)


class _Pardiso:
    """PARDISO with its weighted matching off; the analysis is not reused between matrices."""

    def __init__(self, A: sparse.csc_matrix, ordered: bool) -> None:
        from pypardiso import PyPardisoSolver

        self._matrix = sparse.csr_matrix(A)
        self._solver = PyPardisoSolver(mtype=11)
        for index, value in ((1, 1), (2, 2), (8, 2), (10, 13), (11, 1), (13, 0)):
            self._solver.set_iparm(index, value)
        self._solver.factorize(self._matrix)

    def solve(self, b: np.ndarray) -> np.ndarray:
        return np.asarray(self._solver.solve(self._matrix, b))

    def __del__(self) -> None:
        self._solver.free_memory(everything=True)


def _multifrontal(A: sparse.csc_matrix, ordered: bool) -> Factor:
    """By fronts; by SuperLU where there is no order of elimination, or a front is singular."""
    if not ordered:
        return _superlu(A, ordered)
    try:
        return Bordered.of(A) or Multifrontal.of_matrix(*analysed(A))
    except PivotError:
        return _superlu(A, ordered)


SOLVERS: dict[str, Callable[[sparse.csc_matrix, bool], Factor]] = {
    AUTO: _multifrontal,
    "multifrontal": _multifrontal,
    "splu": _superlu,
    "pardiso": _Pardiso,
}


def factorise(A: sparse.csc_matrix, solver: str = AUTO, *, ordered: bool = False) -> Factor:
    """Factorise with the named solver; ``ordered``: elimination in the order of the unknowns fills in little.

    Raises SingularMatrixError, KeyError for an unknown name, ModuleNotFoundError for a solver that is not installed.
    """
    return SOLVERS[solver](A, ordered)


def response(factor: Factor, left: sparse.csc_matrix, right: sparse.csc_matrix) -> np.ndarray:
    """left^T A^-1 right (j, k) of sparse (n, j) and (n, k), a few columns at a time: A^-1 right may be large."""
    if isinstance(factor, Bordered):
        return np.hstack([factor.response(left, part) for part in _batches(right)])
    if isinstance(factor, Multifrontal):
        return np.hstack([Response.of(factor, left, part).matrix() for part in _batches(right)])
    solved = (np.column_stack([solution(factor, b) for b in part.toarray().T]) for part in _batches(right))
    return np.hstack([left.T @ part for part in solved])


def solution(factor: Factor, b: np.ndarray) -> np.ndarray:
    """The x with A x = b, counted: fronts do that themselves, of other factors every entry is used once."""
    if not isinstance(factor, Multifrontal | Bordered):
        spend(SOLUTIONS, 2 * getattr(factor, "nnz", 0))
    return factor.solve(b)


def response_flops(factor: Factor, left: sparse.csc_matrix, right: sparse.csc_matrix) -> float:
    """Operations of :func:`response`, 0 where the fill is not known.

    They take as long, each, as those of the factorisation: on tyres of 4918, 9840 and 39840 unknowns 85, 200 and 340
    columns last as long as it by fronts, 30, 45 and 50 by SuperLU (measured).
    """
    if isinstance(factor, Bordered):
        factor, left, right = factor.factor, sparse.csc_matrix(left[:-1]), sparse.csc_matrix(right[:-1])
    if isinstance(factor, Multifrontal):
        return Response.of(factor, left, right).operations
    return 2.0 * float(getattr(factor, "nnz", 0)) * right.shape[1]


def _batches(A: sparse.csc_matrix) -> Iterator[sparse.csc_matrix]:
    for j in range(0, A.shape[1], COLUMNS):
        yield sparse.csc_matrix(A[:, j : j + COLUMNS])


def instead(factor: Factor, solver: str, *, ordered: bool) -> bool:
    """Whether SuperLU had to do what fronts could not: they were asked for by name, or there was an order for them."""
    return isinstance(factor, SuperLU) and (solver == "multifrontal" or (solver == AUTO and ordered))


def factor_flops(factor: Factor) -> float:
    """Floating-point operations of a factorisation: of SuperLU's, 2 sum_j c_j^2 for c_j entries in column j of L.

    L is unit lower triangular and U has its pattern transposed, near enough. L is a copy, which takes a tenth of the
    time that finding it took, and as much memory: above LARGE_FILL entries of L and U it is not made, and the columns
    are taken to be as unlike as in tyres of that size. Fronts know theirs; 0 for any other factor.
    """
    if isinstance(factor, Multifrontal | Bordered):
        return factor.flops
    if not isinstance(factor, SuperLU):
        return 0.0
    if factor.nnz > LARGE_FILL:
        return UNLIKE * float(factor.nnz) ** 2 / (2 * factor.shape[0])
    return 2.0 * float(np.sum(np.square(np.diff(factor.L.indptr), dtype=float)))


def asymmetry(K: sparse.csc_matrix) -> float:
    """Largest entry of K - K^T over the largest of K."""
    largest = float(np.max(np.abs(K.data), initial=0.0)) or 1.0
    return float(np.max(np.abs((K - K.T).data), initial=0.0)) / largest


def added(K: sparse.csc_matrix, change: sparse.csc_matrix) -> sparse.csc_matrix:
    """K + change, in the places of K where it has room for all of change, zeros and all: its analysis still holds."""
    K.sort_indices()
    n, columns = K.shape[0], np.repeat(np.arange(K.shape[1]), np.diff(K.indptr))
    keys = columns * n + K.indices
    wanted = np.repeat(np.arange(n), np.diff(change.indptr)) * n + change.indices
    places = np.minimum(np.searchsorted(keys, wanted), K.nnz - 1)
    if K.nnz == 0 or not np.array_equal(keys[places], wanted):
        return sparse.csc_matrix(K + change)
    data = K.data.copy()
    np.add.at(data, places, change.data)
    return sparse.csc_matrix((data, K.indices, K.indptr), shape=K.shape)


def symmetric(K: sparse.csc_matrix) -> bool:
    """Whether K differs from its transpose by rounding alone."""
    return asymmetry(K) <= SYMMETRIC


def negative_pivots(
    A: sparse.csc_matrix, factor: Factor | None = None, *, ordered: bool = False, multipliers: int = 0
) -> int:
    """Number of negative pivots of a symmetric matrix, its negative eigenvalues (Sylvester); a zero counts, too.

    Less those of ``multipliers``, of which each has one; 1 where it is singular, or has fewer, as no tangent has.
    A ``factor`` by fronts knows it. SuperLU without row exchanges: U has the signs of D in L D L^T, and what rounding
    may hide is close to singular. Where it exchanges rows, as on the zero of a multiplier, fronts are asked.
    """
    if factor is None and ordered:
        with suppress(SingularMatrixError):
            factor = _multifrontal(A, ordered)
    if isinstance(factor, Multifrontal | Bordered):
        return _beyond(factor.negative, multipliers)
    try:
        factor = superlu(A, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except SingularMatrixError:
        return 1
    if not np.array_equal(factor.perm_r, factor.perm_c):  # a zero on the diagonal has forced an exchange
        with suppress(PivotError):
            return _beyond(max(1, Multifrontal.of_matrix(*analysed(A)).negative), multipliers)
        return 1
    return _beyond(int(np.sum(factor.U.diagonal() <= 0)), multipliers)


def _beyond(negative: int, multipliers: int) -> int:
    return negative - multipliers if negative >= multipliers else 1


def row_norm(A: sparse.csc_matrix) -> float:
    """|A|: the largest sum of a row."""
    return float(np.max(np.bincount(A.indices, weights=np.abs(A.data), minlength=A.shape[0]), initial=0.0))


def _residual(A: sparse.csc_matrix, x: np.ndarray, b: np.ndarray, norm: float) -> tuple[float, float]:
    """|b - A x| and |A| |x| + |b|."""
    return _largest(b - A @ x), norm * _largest(x) + _largest(b)


def _largest(x: np.ndarray) -> float:
    return float(np.max(np.abs(x), initial=0.0))


def checked_solve(factor: Factor, A: sparse.csc_matrix, b: np.ndarray, norm: float | None = None) -> np.ndarray:
    """The x with A x = b, refined up to twice while its backward error is above 1e-13; ``norm``: |A|, where known.

    Raises SingularMatrixError when it stays above 1e-8, when x is not finite, or when A x shares not one digit with b
    (x is then so large that a small backward error proves nothing).
    """
    x, norm, load = solution(factor, b), norm or row_norm(A), _largest(b)
    for attempt in range(3):
        if not np.all(np.isfinite(x)):
            raise SingularMatrixError("the solution of the linear system is not finite")
        spend(SOLUTIONS, 2 * A.nnz)
        left, size = _residual(A, x, b, norm)
        if (left <= BACKWARD_ERROR * size and left <= LOST * load) or attempt == 2:
            break
        x = x + solution(factor, b - A @ x)
    if left > REFUSED * size:
        raise SingularMatrixError(f"the linear solver left a backward error of {left / size:.1e}")
    if left > LOST * load:
        cancel = f"forces of {norm * _largest(x) / load:.1e} times the load cancel in it"
        raise SingularMatrixError(f"the matrix is singular to working precision: no digit is correct, {cancel}")
    return x
