"""The sparse pattern of a mesh, found once: where every entry of every element matrix goes.

Scattering through these slots costs a fifth of building a COO matrix at every Newton step.
"""

from __future__ import annotations

from collections.abc import Iterable
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
    """The pattern without C, by blocks of unknowns that elements have together: a sixth of the time of all entries."""
    plain = number.copy()
    plain[elements] = -1
    groups = plain, theirs
    first = _begins_block(max(n, 1), groups)  # held numbers, -1, are looked up where no unknown is free, too
    block, start = np.cumsum(first) - 1, np.flatnonzero(first)
    size, nobody = np.bincount(block), len(start) ** 2
    met = [_blocks(each, first, block) for each in groups]
    keys = [_keys(blocks, len(start), nobody).ravel() for blocks, _ in met]
    pairs, pair = np.unique(np.concatenate(keys), return_inverse=True)
    column, row = np.divmod(pairs[pairs < nobody], len(start))
    above = np.append(0, np.cumsum(size[row]))  # entries of a column of all blocks, before each pair
    begin = above[np.searchsorted(column, np.arange(len(start) + 1))]
    indptr = np.append(0, np.cumsum(np.diff(begin)[block])).astype(np.int32)
    indices = _ranges(start[row], size[row])[_ranges(begin[:-1][block], np.diff(indptr))].astype(np.int32)
    offset = np.append(above[:-1] - begin[column], 0)  # of a pair in its columns
    slots = []
    for each, (_, place), its in zip(groups, met, np.split(pair, [len(keys[0])]), strict=True):
        k = place.max(initial=0) + 1
        where = np.arange(len(each))[:, None, None], place[:, None, :], place[:, :, None]
        slot = offset[its.reshape(len(each), k, k)][where]
        slot += (each - start[block[each]])[:, :, None] + indptr[each][:, None, :]
        slot[(each < 0)[:, :, None] | (each < 0)[:, None, :]] = len(indices)
        slots.append(slot)
    placed = None if not len(elements) else (elements, slots[1], NOTHING)
    return Pattern(n, indptr[: n + 1], indices, slots[0].ravel(), placed)


@lru_cache(maxsize=KEPT)
def _met_before(n: int, *numbers: tuple[bytes, np.dtype, tuple[int, ...]]) -> Pattern:
    """The same by what arrays hold: those who differ in their loads or plies alone have one pattern."""
    number, elements, theirs = (np.frombuffer(each, kind).reshape(shape) for each, kind, shape in numbers)
    return _found(n, number, elements, theirs)


def _begins_block(n: int, groups: Iterable[np.ndarray]) -> np.ndarray:
    """Unknowns (n,) that begin a block: all others follow the one before in every element that has one of the two."""
    met, follows = np.zeros(n, np.intp), np.zeros(n, np.intp)
    for each in groups:
        met += np.bincount(each[each >= 0], minlength=n)
        after = (each[:, 1:] > 0) & (each[:, 1:] == each[:, :-1] + 1)
        follows += np.bincount(each[:, 1:][after], minlength=n)
    return np.append(True, (follows[1:] < met[1:]) | (met[1:] != met[:-1]))[:n]


def _blocks(number: np.ndarray, first: np.ndarray, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The blocks (E, k) of each element, -1 where it has fewer, and the place (E, d) of each of its unknowns there."""
    begins = (number >= 0) & first[number]
    place = np.maximum(np.cumsum(begins, axis=1) - 1, 0)
    blocks = np.full((len(number), place.max(initial=0) + 1), -1)
    element, at = np.nonzero(begins)
    blocks[element, place[element, at]] = block[number[element, at]]
    return blocks, place


def _keys(blocks: np.ndarray, n: int, nobody: int) -> np.ndarray:
    """Of each pair of the blocks of an element (E, k, k), by column and row."""
    held = (blocks < 0)[:, :, None] | (blocks < 0)[:, None, :]
    return np.where(held, nobody, blocks[:, :, None] * n + blocks[:, None, :])


def _ranges(begins: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Every begins[i], ..., begins[i] + lengths[i] - 1, one after the other."""
    ends = np.cumsum(lengths)
    return np.repeat(begins - ends + lengths, lengths) + np.arange(ends[-1] if len(ends) else 0)
