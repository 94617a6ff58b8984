"""The slip of candidates on a rigid foundation that moves in space, and the anchors that a path remembers of it.

A point of the body at x is, in the frame that moves with the foundation, at X = R^T (x - c - d) + c: translation
d, the rotation R about an axis through c. The anchor A of a candidate is its X at the last accepted state. Its slip is
X - A in the tangent plane of the foundation there, so that a joint motion of body and foundation is none, whatever its
size. Where the foundation is curved, slip along it is told by the chord: steps are small against its radius.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy import sparse

from contact.coulomb import Coulomb, Motion, Sliding
from contact.problem import ContactProblem, ContactSolution

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

    @property
    def each(self) -> tuple[Slip, ...]:
        """That before the one foundation."""
        return (self,)

    def since(self, anchors: np.ndarray) -> Slip:
        """The slip from other anchors (m, 3)."""
        return replace(self, anchors=anchors)

    def places(self, u: np.ndarray) -> np.ndarray:
        """X (m, 3) of the candidates: the anchors of the next step, once u (n,) is accepted."""
        return self.motion.into(self.candidates.positions(u))

    def left(self, u: np.ndarray, stretched: np.ndarray) -> np.ndarray:
        """The anchors (m, 3) that a step leaves: places, less what springs are still ``stretched`` (m, 2) by."""
        return np.asarray(self.places(u) - np.einsum("mk,mki->mi", stretched, self.directions))

    @cached_property
    def directions(self) -> np.ndarray:
        """Tangents (m, 2, 3) of the foundation at the anchors, in its own frame; with one way left, it is the first."""
        tangents = self._tangents.copy()
        for i, ways in self._with_one_way.items():
            tangents[i] = ways.T @ tangents[i]
        return tangents

    @cached_property
    def _tangents(self) -> np.ndarray:
        normals = self.foundation.gradient(self.anchors)
        return tangents(normals / np.linalg.norm(normals, axis=1)[:, None])

    @cached_property
    def _with_one_way(self) -> dict[int, np.ndarray]:
        """Candidates that supports leave at most one way in the tangent plane, with their ways (2, 2) as columns."""
        A, R, single = self.candidates.operator, self.motion.rotation, {}
        for i in range(len(self.anchors)):
            entries = slice(A.indptr[3 * i], A.indptr[3 * i + 3])
            used, place = np.unique(A.indices[entries], return_inverse=True)
            if len(used) < SPACE:
                block = np.zeros((SPACE, len(used)))
                block[np.repeat(np.arange(SPACE), np.diff(A.indptr[3 * i : 3 * i + 4])), place] = A.data[entries]
                ways, sizes, _ = np.linalg.svd(self._tangents[i] @ R.T @ block)
                if len(sizes) < 2 or sizes[1] <= NO_WAY * sizes[0]:
                    single[i] = ways
        return single

    def __call__(self, u: np.ndarray) -> np.ndarray:
        """s (m, 2) [mm]."""
        return np.einsum("mki,mi->mk", self.directions, self.places(u) - self.anchors)

    def measured(self, u: np.ndarray) -> np.ndarray:
        """The same: a product."""
        return self(u)

    def curvature(self, u: np.ndarray, friction: np.ndarray) -> None:
        """None: the slip is linear in u."""

    def in_space(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """Friction (m, 3) [N] of the foundation on the candidates."""
        return np.asarray(np.einsum("mk,mki->mi", friction, self.directions @ self.motion.rotation.T))

    def forces(self, u: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """The same: of candidates alone."""
        return self.in_space(u, friction)

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


def with_friction(problem: ContactProblem, mu: float, motion: Motion) -> ContactProblem:
    """The same problem with friction, slips counted from where the candidates are undeformed until anchors are given.

    Its path is not followed by arc length, which friction leaves no curve to.
    Raises ValueError where the problem does not know the surface of its foundation.
    """
    surface, only = problem.surface, problem.only
    if surface is None:
        raise ValueError("friction needs a foundation that is known as a surface")

    def chosen(which: np.ndarray) -> ContactProblem:
        assert only is not None
        return with_friction(only(which), mu, motion)

    slip = Slip(surface, surface, motion, surface.positions(np.zeros(surface.operator.shape[1])))
    law = Coulomb(np.full(len(problem.weights), mu), slip, slip.jacobian, surface.size, slip)
    return replace(problem, coulomb=law, only=None if only is None else chosen, travel=None)


def sliding_of(problem: ContactProblem) -> Sliding:
    """The slip of a problem; raises ValueError where it has no friction."""
    if problem.coulomb is None or problem.coulomb.sliding is None:
        raise ValueError("the contact problem has no friction")
    return problem.coulomb.sliding


def slip_of(problem: ContactProblem, anchors: np.ndarray) -> Sliding:
    """The slip of the candidates since their anchors (m, 3); raises ValueError where the problem has no friction."""
    return sliding_of(problem).since(anchors)


def anchors_left(
    problem: ContactProblem, before: ContactProblem, state: ContactSolution, epsilon: float = np.inf
) -> np.ndarray:
    """Anchors (m, 3) from which ``problem`` counts its slip, worked out anew from the ``state`` accepted before it.

    Where the candidates were on the foundation; with a finite epsilon, where the ends of their springs were.
    """
    if state.friction is None:
        return sliding_of(problem).places(state.u)
    return slip_of(before, state.friction.since).left(state.u, stretched(before, state.friction.force, epsilon))


def stretched(problem: ContactProblem, friction: np.ndarray, epsilon: float) -> np.ndarray:
    """-t/(epsilon w) (m, 2) [mm]: what a spring gives way before it slips; 0 with an infinite epsilon."""
    if np.isinf(epsilon):
        return np.zeros_like(friction)
    stiffness = epsilon * problem.weights[:, None]
    return np.divide(-friction, stiffness, out=np.zeros_like(friction), where=stiffness > 0)
