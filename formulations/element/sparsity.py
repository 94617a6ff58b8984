"""The sparse pattern of a mesh, found once: where every entry of every element matrix goes.

Scattering through these slots costs a fifth of building a COO matrix at every Newton step.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy import sparse

from formulations.operations import spend

KEPT, LARGE = 6, 50_000  # patterns that were found last, of no more displacements of elements: 10 MB each
NOTHING = np.zeros(0)


@dataclass(frozen=True, eq=False)
class Pattern:
    """CSC pattern of the free matrix (n, n); ``slots``: one for each element entry, the last one takes what is held.

    constrained: the few elements (f,) whose displacements are C (f, d, m) times unknowns, and the slots (f, m, m) of
    C^T K C; among ``slots`` theirs are the last one.
    """

    n: int
    indptr: np.ndarray
    indices: np.ndarray
    slots: np.ndarray
    constrained: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    @classmethod
    def build(
        cls, number: np.ndarray, n: int, constrained: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
    ) -> Pattern:
        """From the free numbers (E, d) of the element unknowns, -1 where held.

        constrained: elements (f,), the numbers (f, m) of their unknowns, and C (f, d, m).
        """
        elements, theirs, C = constrained if constrained is not None else (np.zeros(0, np.intp), number[:0], None)
        numbers = (number, elements, theirs)
        if number.size > LARGE:
            pattern = _found(n, *numbers)
        else:
            pattern = _met_before(n, *((each.tobytes(), each.dtype, each.shape) for each in numbers))
        return pattern if C is None else pattern.constraining((elements, theirs, C))

    def constraining(self, constrained: tuple[np.ndarray, np.ndarray, np.ndarray] | None) -> Pattern:
        """The same with another C, of the same unknowns."""
        if self.constrained is None or constrained is None:
            return self
        elements, slots, _ = self.constrained
        return replace(self, constrained=(elements, slots, constrained[2]))

    def assemble(self, element_matrices: np.ndarray) -> sparse.csc_matrix:
        """Sum element matrices (E, d, d)."""
        nnz = len(self.indices)
        spend(element_matrices.size)
        data = np.bincount(self.slots, weights=element_matrices.ravel(), minlength=nnz + 1)
        if self.constrained is not None:
            elements, slots, C = self.constrained
            values = np.swapaxes(C, 1, 2) @ element_matrices[elements] @ C
            data += np.bincount(slots.ravel(), weights=values.ravel(), minlength=nnz + 1)
        return sparse.csc_matrix((data[:nnz], self.indices, self.indptr), shape=(self.n, self.n))


def _found(n: int, number: np.ndarray, elements: np.ndarray, theirs: np.ndarray) -> Pattern:
    """The pattern without C."""
    plain = number.copy()
    plain[elements] = -1
    keys = np.concatenate([_keys(each, n) for each in (plain, theirs)])
    # the index is not wanted, but sorted for it stably: half the time, because keys come in runs
    unique, _, slots = np.unique(keys, return_index=True, return_inverse=True)
    entries = unique[unique < n * n]
    indptr = np.searchsorted(entries, np.arange(n + 1, dtype=np.int64) * n)
    slots = np.minimum(slots.ravel(), len(entries)).astype(np.intp)
    own, others = np.split(slots, [number.shape[0] * number.shape[1] ** 2])
    placed = None if not len(elements) else (elements, others.reshape(-1, theirs.shape[1], theirs.shape[1]), NOTHING)
    return Pattern(n, indptr.astype(np.int32), (entries % n).astype(np.int32), own, placed)


@lru_cache(maxsize=KEPT)
def _met_before(n: int, *numbers: tuple[bytes, np.dtype, tuple[int, ...]]) -> Pattern:
    """The same by what arrays hold: those who differ in their loads or plies alone have one pattern."""
    number, elements, theirs = (np.frombuffer(each, kind).reshape(shape) for each, kind, shape in numbers)
    return _found(n, number, elements, theirs)


def _keys(number: np.ndarray, n: int) -> np.ndarray:
    """Place (column, row) of each entry of the element matrices, n^2 where it is held."""
    row, column = np.broadcast_arrays(number[:, :, None], number[:, None, :])
    keys = column.ravel().astype(np.int64) * n + row.ravel()
    keys[((row < 0) | (column < 0)).ravel()] = n * n
    return keys
