"""The slip of candidates on a rigid foundation that moves in space: a translation and a rotation about an axis.

A point of the body at x is, in the frame that moves with the foundation, at X = R^T (x - c - d) + c: translation
d, the rotation R about an axis through c. The anchor A of a candidate is its X at the last accepted state. Its slip is
X - A in the tangent plane of the foundation there, so that a joint motion of body and foundation is none, whatever its
size. Where the foundation is curved, slip along it is told by the chord: steps are small against its radius.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.coulomb import Motion


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

    @property
    def directions(self) -> np.ndarray:
        """The tangents (m, 2, 3) of the foundation at the anchors, in its own frame."""
        normals = self.foundation.gradient(self.anchors)
        return tangents(normals / np.linalg.norm(normals, axis=1)[:, None])

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
        return sparse.csr_matrix(each @ self.candidates.operator)
