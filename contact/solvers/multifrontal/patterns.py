"""The analyses of the patterns that were met last: a solve meets one pattern many times. No value decides here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import sparse

from contact.solvers.multifrontal.analysis import Analysis

KEPT = 8


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where the entries of a matrix are, by columns; two are equal where their entries are in the same places."""

    indptr: np.ndarray
    indices: np.ndarray

    def __hash__(self) -> int:
        return hash(self.indices.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pattern) and all(
            np.array_equal(mine, its) for mine, its in ((self.indptr, other.indptr), (self.indices, other.indices))
        )


def analysed(A: sparse.csc_matrix) -> tuple[sparse.csc_matrix, Analysis]:
    """A, with zeros where its pattern is not symmetric or its diagonal not whole, and the analysis of that pattern."""
    A.sort_indices()
    found = _analysis(Pattern(A.indptr, A.indices))
    if found is None:
        A = _with_zeros(A)
        found = _analysis(Pattern(A.indptr, A.indices))
        assert found is not None
    return A, found


def clear() -> None:
    """Forget all analyses."""
    _analysis.cache_clear()


@lru_cache(maxsize=KEPT)
def _analysis(pattern: Pattern) -> Analysis | None:
    return Analysis.of(pattern.indptr, pattern.indices)


def _with_zeros(A: sparse.csc_matrix) -> sparse.csc_matrix:
    """A with zeros across the diagonal from its entries, and on it."""
    entries, n = A.tocoo(), A.shape[0]
    rows = np.concatenate([entries.row, entries.col, np.arange(n)])
    columns = np.concatenate([entries.col, entries.row, np.arange(n)])
    data = np.concatenate([entries.data, np.zeros(A.nnz + n)])
    return sparse.csc_matrix(sparse.coo_matrix((data, (rows, columns)), shape=A.shape))
