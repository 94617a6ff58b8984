"""A symmetric matrix with a row and a column that are not: two solutions more instead of factors twice as large.

Curves of equilibria have them, with a plane for their last row. Where the symmetric part is all but singular, as at a
limit point, the elimination of the border loses digits: that is looked at, and left to other factors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.solvers.analysis import analysed
from contact.solvers.multifrontal import SYMMETRIC, Multifrontal, PivotError, Response

ENOUGH = 1e-10  # backward error of a solution, not refined, beyond which the border is not eliminated
SEED = 0


@dataclass(frozen=True, eq=False)
class Bordered:
    """A = [[S, c], [r^T, d]], S symmetric (n - 1, n - 1): x = y - z t and t with S y = b, S z = c.

    right: z.  left: S^-1 r.  pivot: d - r.z.
    """

    factor: Multifrontal
    row: np.ndarray
    right: np.ndarray
    left: np.ndarray
    pivot: float

    @classmethod
    def of(cls, A: sparse.csc_matrix) -> Bordered | None:
        """None where the last row is not full, S not symmetric, or too little of a solution is right."""
        n = A.shape[0]
        if n < 2 or np.count_nonzero(A.indices == n - 1) < n:
            return None
        S, analysis = analysed(sparse.csc_matrix(A[:-1, :-1]))
        if np.max(np.abs(S.data - S.data[analysis.image])) > SYMMETRIC * np.max(np.abs(S.data)):
            return None
        row, column = A[-1].toarray().ravel(), A[:-1, -1].toarray().ravel()
        try:
            factor = Multifrontal.of(S.data, analysis, symmetric=True)
        except PivotError:
            return None
        left, right = factor.solve(np.column_stack([row[:-1], column])).T
        bordered = cls(factor, row[:-1], right, left, float(row[-1] - row[:-1] @ right))
        return bordered if bordered._serves(A) else None

    def _serves(self, A: sparse.csc_matrix) -> bool:
        b = np.random.default_rng(SEED).uniform(-1.0, 1.0, A.shape[0])
        x = self.solve(b)
        with np.errstate(invalid="ignore", over="ignore"):
            size = float(np.max(abs(A).sum(axis=1))) * np.max(np.abs(x)) + np.max(np.abs(b))
            return bool(np.max(np.abs(b - A @ x)) <= ENOUGH * size < np.inf)

    @property
    def negative(self) -> int:
        """Negative eigenvalues of A where it is symmetric (Haynsworth)."""
        return self.factor.negative + (self.pivot < 0)

    @property
    def nnz(self) -> int:
        """Entries of the factors."""
        return self.factor.nnz + 3 * len(self.row)

    @property
    def flops(self) -> float:
        """Floating-point operations of the factorisation and of the two solutions."""
        return self.factor.flops + 8.0 * self.factor.nnz

    def solve(self, b: np.ndarray) -> np.ndarray:
        """x (n,) with A x = b."""
        with np.errstate(all="ignore"):  # a pivot of zero is seen in the residual
            y = self.factor.solve(b[:-1])
            t = (b[-1] - self.row @ y) / self.pivot
            return np.append(y - t * self.right, t)

    def response(self, left: sparse.csc_matrix, right: sparse.csc_matrix) -> np.ndarray:
        """left^T A^-1 right (j, k) of sparse (n, j) and (n, k)."""
        inner = Response.of(self.factor, sparse.csc_matrix(left[:-1]), sparse.csc_matrix(right[:-1])).matrix()
        shown = left[[-1]].toarray().ravel() - left[:-1].T @ self.right
        border = (right[[-1]].toarray().ravel() - right[:-1].T @ self.left) / self.pivot
        return np.asarray(inner + np.outer(shown, border))
