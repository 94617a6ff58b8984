"""The sparse pattern of a mesh, found once: where every entry of every element matrix goes.

Scattering through these slots costs a fifth of building a COO matrix at every Newton step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse


@dataclass(frozen=True, eq=False)
class Pattern:
    """CSC pattern of the free matrix (n, n); ``slots``: one for each element entry, the last one takes what is held."""

    n: int
    indptr: np.ndarray
    indices: np.ndarray
    slots: np.ndarray

    @classmethod
    def build(cls, number: np.ndarray, n: int) -> Pattern:
        """From the free numbers (E, d) of the element unknowns, -1 where held."""
        row, column = np.broadcast_arrays(number[:, :, None], number[:, None, :])
        held = ((row < 0) | (column < 0)).ravel()
        keys = column.ravel().astype(np.int64) * n + row.ravel()
        keys[held] = n * n
        unique, slots = np.unique(keys, return_inverse=True)
        entries = unique[unique < n * n]
        indptr = np.searchsorted(entries, np.arange(n + 1, dtype=np.int64) * n)
        return cls(n, indptr.astype(np.int32), (entries % n).astype(np.int32), slots.ravel().astype(np.intp))

    def assemble(self, element_matrices: np.ndarray) -> sparse.csc_matrix:
        """Sum element matrices (E, d, d)."""
        nnz = len(self.indices)
        data = np.bincount(self.slots, weights=element_matrices.ravel(), minlength=nnz + 1)[:nnz]
        return sparse.csc_matrix((data, self.indices, self.indptr), shape=(self.n, self.n))
