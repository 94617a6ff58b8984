"""The sparse pattern of a mesh, found once: where every entry of every element matrix goes.

Scattering through these slots costs a fifth of building a COO matrix at every Newton step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse


@dataclass(frozen=True, eq=False)
class Pattern:
    """CSC pattern of the free matrix (n, n); ``slots``: one for each element entry, the last one takes what is held.

    turned: the few elements (f,) with displacements that are the negative of an unknown, their slots and the signs of
    their entries; among ``slots`` theirs are the last one.
    """

    n: int
    indptr: np.ndarray
    indices: np.ndarray
    slots: np.ndarray
    turned: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    @classmethod
    def build(cls, number: np.ndarray, n: int, sign: np.ndarray | None = None) -> Pattern:
        """From the free numbers (E, d) of the element unknowns, -1 where held; ``sign`` (E, d): their signs."""
        row, column = np.broadcast_arrays(number[:, :, None], number[:, None, :])
        held = ((row < 0) | (column < 0)).ravel()
        keys = column.ravel().astype(np.int64) * n + row.ravel()
        keys[held] = n * n
        unique, slots = np.unique(keys, return_inverse=True)
        entries = unique[unique < n * n]
        indptr = np.searchsorted(entries, np.arange(n + 1, dtype=np.int64) * n)
        slots, turned = slots.ravel().astype(np.intp), None
        if sign is not None and np.any(sign < 0):
            elements = np.flatnonzero(np.any(sign < 0, axis=1))
            of_each = slots.reshape(len(number), -1)
            turned = (elements, of_each[elements], sign[elements, :, None] * sign[elements, None, :])
            of_each[elements] = len(entries)
        return cls(n, indptr.astype(np.int32), (entries % n).astype(np.int32), slots, turned)

    def assemble(self, element_matrices: np.ndarray) -> sparse.csc_matrix:
        """Sum element matrices (E, d, d)."""
        nnz = len(self.indices)
        data = np.bincount(self.slots, weights=element_matrices.ravel(), minlength=nnz + 1)
        if self.turned is not None:
            elements, slots, signs = self.turned
            values = element_matrices[elements] * signs
            data += np.bincount(slots.ravel(), weights=values.ravel(), minlength=nnz + 1)
        return sparse.csc_matrix((data[:nnz], self.indices, self.indptr), shape=(self.n, self.n))
