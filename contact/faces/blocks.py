"""Matrices of many small blocks at the points of faces. No geometry enters here."""

import numpy as np
from scipy import sparse


def along(values: sparse.csr_matrix, directions: np.ndarray) -> sparse.csr_matrix:
    """The rows d_i . (values @ x)_i (p, 3k) of directions d (p, 3)."""
    row = np.repeat(np.arange(len(directions)), np.diff(values.indptr))
    data = values.data[:, None] * directions[row]
    columns = 3 * values.indices[:, None] + np.arange(3)
    shape_ = (values.shape[0], 3 * values.shape[1])
    return sparse.csr_matrix((data.ravel(), columns.ravel(), 3 * values.indptr), shape=shape_)


def assembled(rows: np.ndarray, columns: np.ndarray, blocks: np.ndarray, k: int) -> sparse.csr_matrix:
    """Blocks (p, 3r, 3c) at points (p, r) and (p, c) of k, summed (3k, 3k)."""
    at, to = ((3 * each[:, :, None] + np.arange(3)).reshape(len(each), -1) for each in (rows, columns))
    places = np.repeat(at, to.shape[1], axis=1).ravel(), np.tile(to, at.shape[1]).ravel()
    return sparse.coo_matrix((blocks.ravel(), places), shape=(3 * k, 3 * k)).tocsr()


def summed(J: np.ndarray, M: np.ndarray, group: np.ndarray, corners: np.ndarray, k: int) -> sparse.csr_matrix:
    """sum_p J^T M J (3k, 3k) of points in the order of their groups (p,), each with corners (groups, c) of k in common.

    J (p, r, 3c), M (p, r, r). They are summed before the matrix is.
    """
    bent = M @ J
    J, bent = (_padded(each, group) for each in (J, bent))
    return assembled(corners, corners, np.swapaxes(J, 1, 2) @ bent, k)


def _padded(rows: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Rows (p, i, j) of points in the order of their groups (p,) as (groups, i times points of the largest, j)."""
    start = np.flatnonzero(np.diff(group, prepend=-1))
    place = np.arange(len(group)) - start[group]
    blocks = np.zeros((len(start), place.max() + 1, *rows.shape[1:]))
    blocks[group, place] = rows
    return blocks.reshape(len(start), -1, rows.shape[2])


def inverse(m: np.ndarray) -> np.ndarray:
    """Of symmetric matrices (p, 2, 2)."""
    adjugate = np.array([[1.0, -1.0], [-1.0, 1.0]]) * m
    adjugate[:, [0, 1], [0, 1]] = m[:, [1, 0], [1, 0]]
    return np.asarray(adjugate / (m[:, 0, 0] * m[:, 1, 1] - m[:, 0, 1] ** 2)[:, None, None])
