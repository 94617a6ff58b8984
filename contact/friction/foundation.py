"""The slip of candidates on a rigid foundation that moves in space: a translation and a rotation about an axis.

A point of the body at x is, in the frame that moves with the foundation, at X = R^T (x - c - d) + c: translation
d, the rotation R about an axis through c. The anchor A of a candidate is its X at the last accepted state. Its slip is
X - A in the tangent plane of the foundation there, so that a joint motion of body and foundation is none, whatever its
size. Where the foundation is curved, slip along it is told by the chord: steps are small against its radius.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.coulomb import Motion

SPACE = 3
NO_WAY = 1e-9  # of the other: a way that supports leave nothing of


class Points(Protocol):
    """Candidates: where they are and how they move."""

    @property
    def operator(self) -> sparse.csr_matrix:
        """dx/du (3m, n)."""

    def positions(self, u: np.ndarray) -> np.ndarray:
        """x (m, 3) [mm]."""


class Normals(Protocol):
    """A foundation: its unit normals."""

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """dg/dx (m, 3)."""


def tangents(normals: np.ndarray) -> np.ndarray:
    """Two unit vectors (m, 2, 3) across each unit normal (m, 3): e1 from the axis that is least along it."""
    axis = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first = axis - np.einsum("mi,mi->m", axis, normals)[:, None] * normals
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(normals, first)], axis=1)


@dataclass(frozen=True, eq=False)
class Slip:
    """The slip of candidates since their anchors (m, 3) in the frame of the foundation, ``motion`` its motion now.

    foundation: as it stands in its own frame.
    """

    candidates: Points
    foundation: Normals
    motion: Motion
    anchors: np.ndarray

    def places(self, u: np.ndarray) -> np.ndarray:
        """X (m, 3) of the candidates: the anchors of the next step, once u (n,) is accepted."""
        return self.motion.into(self.candidates.positions(u))

    @cached_property
    def directions(self) -> np.ndarray:
        """Tangents (m, 2, 3) of the foundation at the anchors, in its own frame; with one way left, it is the first."""
        found = self._tangents.copy()
        for i, ways in self._with_one_way.items():
            found[i] = ways.T @ found[i]
        return found

    @cached_property
    def _tangents(self) -> np.ndarray:
        normals = self.foundation.gradient(self.anchors)
        return tangents(normals / np.linalg.norm(normals, axis=1)[:, None])

    @cached_property
    def _with_one_way(self) -> dict[int, np.ndarray]:
        """Candidates that supports leave at most one way in the tangent plane, with their ways (2, 2) as columns."""
        A, R, found = self.candidates.operator, self.motion.rotation, {}
        for i in range(len(self.anchors)):
            entries = slice(A.indptr[3 * i], A.indptr[3 * i + 3])
            used, place = np.unique(A.indices[entries], return_inverse=True)
            if len(used) < SPACE:
                block = np.zeros((SPACE, len(used)))
                block[np.repeat(np.arange(SPACE), np.diff(A.indptr[3 * i : 3 * i + 4])), place] = A.data[entries]
                ways, sizes, _ = np.linalg.svd(self._tangents[i] @ R.T @ block)
                if len(sizes) < 2 or sizes[1] <= NO_WAY * sizes[0]:
                    found[i] = ways
        return found

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm]."""
        return np.einsum("mki,mi->mk", self.directions, self.places(u) - self.anchors)

    def jacobian(self, u: np.ndarray) -> sparse.csr_matrix:
        """ds/du (2m, n)."""
        m = len(self.anchors)
        turned = np.einsum("mki,ji->mkj", self.directions, self.motion.rotation)  # in space
        rows = np.repeat(np.arange(2 * m), 3)
        columns = (3 * np.arange(m)[:, None, None] + np.arange(3)[None, None, :] + np.zeros((1, 2, 1), int)).ravel()
        each = sparse.csr_matrix((turned.ravel(), (rows, columns)), shape=(2 * m, 3 * m))
        ways = sparse.csr_matrix(each @ self.candidates.operator)
        for row in (2 * i + 1 for i in self._with_one_way):  # rounding alone
            ways.data[ways.indptr[row] : ways.indptr[row + 1]] = 0.0
        ways.eliminate_zeros()
        return ways
