"""The factors of a matrix on the fronts of its pattern, by dense LAPACK, and solutions with them.

F11 = L L^T where a symmetric front is positive definite, L D L^T (Bunch and Kaufman) where it is not, P L U for a
matrix that is not symmetric; S = F22 - F21 F11^-1 F12 goes to the parent. Nothing is pivoted between fronts: the
residual of a solution is for its user to check.
Sources: Duff, Reid, ACM Trans. Math. Softw. 9 (1983) 302-325; Liu, SIAM Rev. 34 (1992) 82-109.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.linalg import blas, lapack

from contact.operations import COLUMNS, FACTORISATIONS, SOLUTIONS, spend
from contact.solvers.analysis import Analysis, Front, Places

BLOCK = 64  # columns at once of an indefinite front: LAPACK's own workspace allows one
SYMMETRIC = 1e-10  # relative asymmetry of a matrix that is rounding


class PivotError(ArithmeticError):
    """The own unknowns of a front are singular, or not finite."""


@dataclass(frozen=True, eq=False)
class Definite:
    """A front whose own unknowns are eliminated, F11 = L L^T; below: F21 L^-T.

    forward(b): what stays of a right-hand side, and what it takes off that of the boundary; backward: the own unknowns,
    from what has stayed and the solution on the boundary. negative: eigenvalues of F11 below zero.
    """

    L: np.ndarray
    below: np.ndarray
    negative: int = 0

    @property
    def nnz(self) -> int:
        """Entries of the factors: m (m + 1)/2 + m b."""
        b, m = self.below.shape
        return m * (m + 1) // 2 + m * b

    @property
    def flops(self) -> float:
        """Operations of the elimination, an addition and a multiplication each one: m^3/3 + m^2 b + m b^2."""
        b, m = map(float, self.below.shape)
        return m**3 / 3 + m * m * b + m * b * b

    @property
    def solving(self) -> int:
        """Operations of forward and backward with one right-hand side: each entry twice."""
        return 4 * self.nnz

    def forward(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """L^-1 b."""
        y, _ = lapack.dtrtrs(self.L, own, lower=1)
        return y, self.below @ y

    def backward(self, own: np.ndarray, boundary: np.ndarray) -> np.ndarray:
        """L^-T y."""
        x, _ = lapack.dtrtrs(self.L, own - self.below.T @ boundary, lower=1, trans=1)
        return np.asarray(x)


@dataclass(frozen=True, eq=False)
class General:
    """Any regular F11; inverse: b -> F11^-1 b.  below: F21; beside: F11^-1 F12."""

    inverse: Callable[[np.ndarray], np.ndarray]
    below: np.ndarray
    beside: np.ndarray
    negative: int

    @property
    def nnz(self) -> int:
        """m^2 + 2 m b."""
        b, m = self.below.shape
        return m * m + 2 * m * b

    @property
    def flops(self) -> float:
        """Twice as many: 2 (m^3/3 + m^2 b + m b^2)."""
        b, m = map(float, self.below.shape)
        return 2 * (m**3 / 3 + m * m * b + m * b * b)

    @property
    def solving(self) -> int:
        """Each entry once."""
        return 2 * self.nnz

    def forward(self, own: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """F11^-1 b."""
        z = self.inverse(own)
        return z, self.below @ z

    def backward(self, own: np.ndarray, boundary: np.ndarray) -> np.ndarray:
        """What is left."""
        return np.asarray(own - self.beside @ boundary)


Eliminated = Definite | General


@dataclass(frozen=True, eq=False)
class Multifrontal:
    """A factorised matrix."""

    analysis: Analysis
    fronts: Sequence[Eliminated]

    @classmethod
    def of(cls, data: np.ndarray, analysis: Analysis, *, symmetric: bool) -> Multifrontal:
        """Of the matrix with these entries; raises PivotError."""
        eliminate = _symmetric if symmetric else _any
        left: dict[int, np.ndarray] = {}
        fronts = []
        for number, front in enumerate(analysis.fronts):
            one, rest = eliminate(front, data, left)
            fronts.append(one)
            left[number] = rest
        factor = cls(analysis, fronts)
        spend(FACTORISATIONS, factor.flops)
        return factor

    @classmethod
    def of_matrix(cls, A: sparse.csc_matrix, analysis: Analysis) -> Multifrontal:
        """Symmetric to SYMMETRIC of its largest entry, or not; raises PivotError."""
        data = A.data
        skew = float(np.max(np.abs(data - data[analysis.image]), initial=0.0))
        return cls.of(data, analysis, symmetric=skew <= SYMMETRIC * float(np.max(np.abs(data), initial=0.0)))

    @property
    def negative(self) -> int:
        """Negative eigenvalues of a symmetric matrix (Sylvester)."""
        return sum(each.negative for each in self.fronts)

    @property
    def nnz(self) -> int:
        """Entries of L, or of L and U, those of blocks that are zero included."""
        return sum(each.nnz for each in self.fronts)

    @cached_property
    def flops(self) -> float:
        """Floating-point operations of the factorisation."""
        return sum(each.flops for each in self.fronts)

    @cached_property
    def solving(self) -> int:
        """Floating-point operations of a solution."""
        return sum(each.solving for each in self.fronts)

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x (n,) or (n, k) with A x = b."""
        spend(SOLUTIONS, self.solving * b.size // max(len(b), 1))
        x = b[self.analysis.order]
        pairs = list(zip(self.analysis.fronts, self.fronts, strict=True))
        for front, one in pairs:
            own = slice(front.start, front.stop)
            x[own], off = one.forward(x[own])
            x[front.boundary] -= off
        for front, one in reversed(pairs):
            own = slice(front.start, front.stop)
            x[own] = one.backward(x[own], x[front.boundary])
        reordered = np.empty_like(x)
        reordered[self.analysis.order] = x
        return reordered


@dataclass(frozen=True, eq=False)
class Response:
    """left^T A^-1 right (j, k) by those fronts alone that their unknowns go through on the way to the root.

    up: fronts that the unknowns of right go through.  down: those of left, too.
    """

    factor: Multifrontal
    left: sparse.csc_matrix
    right: sparse.csc_matrix
    up: np.ndarray
    down: np.ndarray

    @classmethod
    def of(cls, factor: Multifrontal, left: sparse.csc_matrix, right: sparse.csc_matrix) -> Response:
        """Find the fronts."""
        order = factor.analysis.order
        rank = np.empty(len(order), np.intp)
        rank[order] = np.arange(len(order))
        up, also = (factor.analysis.above(rank[np.unique(side.indices)]) for side in (right, left))
        return cls(factor, left, right, up, up | also)

    @property
    def operations(self) -> float:
        """Floating-point operations."""
        each = zip(self.factor.fronts, self.up, self.down, strict=True)
        return 2.0 * self.right.shape[1] * sum(one.nnz * (int(up) + int(down)) for one, up, down in each)

    def matrix(self) -> np.ndarray:
        """(j, k)."""
        spend(COLUMNS, self.operations)
        analysis, path = self.factor.analysis, []
        # the unknowns of these fronts, numbered without the others
        kept = np.repeat(self.down, [front.stop - front.start for front in analysis.fronts])
        place, chosen = np.cumsum(kept) - 1, analysis.order[kept]
        x = self.right.tocsr()[chosen].toarray(order="F")
        for front, one, up, down in zip(analysis.fronts, self.factor.fronts, self.up, self.down, strict=True):
            if down:
                begin = int(place[front.start])
                own, boundary = slice(begin, begin + front.stop - front.start), place[front.boundary]
                path.append((own, boundary, one))
                if up:
                    x[own], off = one.forward(x[own])
                    x[boundary] -= off
        for own, boundary, one in reversed(path):
            x[own] = one.backward(x[own], x[boundary])
        return np.asarray(self.left.tocsr()[chosen].T @ x)


def _symmetric(front: Front, data: np.ndarray, left: dict[int, np.ndarray]) -> tuple[Eliminated, np.ndarray]:
    """The lower half of the front is assembled and eliminated."""
    m, b = front.stop - front.start, len(front.boundary)
    blocks = F11, F21, F22 = _filled((m, m), data, front.own), _filled((b, m), data, front.below), _zeros(b, b)
    for child, shares in front.children:
        S = left.pop(child)
        for share in shares:
            blocks[share.block][share.to] += S[share.of]
    L, failed = lapack.dpotrf(F11, lower=1, clean=0)
    if not failed:
        if b:
            F21 = blas.dtrsm(1.0, L, F21, side=1, lower=1, trans_a=1, overwrite_b=1)
            F22 = blas.dsyrk(-1.0, F21, beta=1.0, c=F22, lower=1, overwrite_c=1)
        return Definite(L, F21), F22
    ldl, pivots, info = lapack.dsytrf(F11, lower=1, lwork=BLOCK * max(m, 1))
    if info:
        raise PivotError(f"a pivot among unknowns {front.start} to {front.stop} is zero")

    def inverse(rhs: np.ndarray) -> np.ndarray:
        return np.asarray(lapack.dsytrs(ldl, pivots, rhs, lower=1)[0])

    W = inverse(F21.T)
    if b:
        F22 = blas.dgemm(-1.0, F21, W, beta=1.0, c=F22, overwrite_c=1)
    return General(inverse, F21, W, _negative(ldl, pivots)), F22


def _any(front: Front, data: np.ndarray, left: dict[int, np.ndarray]) -> tuple[Eliminated, np.ndarray]:
    """The whole front is assembled and eliminated."""
    m, b = front.stop - front.start, len(front.boundary)
    F11, F21, F22 = _filled((m, m), data, front.own), _filled((b, m), data, front.below), _zeros(b, b)
    F12 = _filled((m, b), data, front.beside)
    blocks, images = (F11, F21, F22), (F11.T, F12.T, F22.T)
    for child, shares in front.children:
        S = left.pop(child)
        for share in shares:
            blocks[share.block][share.to] += S[share.of]
            if share.twice:
                images[share.block][share.to] += S.T[share.of]
    lu, pivots, info = lapack.dgetrf(F11)
    if info:
        raise PivotError(f"a pivot among unknowns {front.start} to {front.stop} is zero")

    def inverse(rhs: np.ndarray) -> np.ndarray:
        return np.asarray(lapack.dgetrs(lu, pivots, rhs)[0])

    W = inverse(F12)
    if b:
        F22 = blas.dgemm(-1.0, F21, W, beta=1.0, c=F22, overwrite_c=1)
    return General(inverse, F21, W, 0), F22


def _filled(shape: tuple[int, int], data: np.ndarray, places: Places) -> np.ndarray:
    block = np.zeros(shape[0] * shape[1])
    block[places[1]] = data[places[0]]
    return block.reshape(shape, order="F")


def _zeros(rows: int, columns: int) -> np.ndarray:
    return np.zeros((rows, columns), order="F")


def _negative(ldl: np.ndarray, pivots: np.ndarray) -> int:
    """Negative eigenvalues of D: one of each block of two, which Bunch and Kaufman take for indefinite ones alone."""
    single = pivots > 0
    return int(np.sum(np.diagonal(ldl)[single] < 0)) + int(np.sum(~single)) // 2
