"""Rigid foundations: the signed distance of an obstacle from points in space, and who may touch it.

A foundation sees positions only; how they depend on the unknowns comes as a sparse matrix. This file has the plane and
the contact problem against any foundation; drum and sphere are in :mod:`contact.obstacles.drum_sphere`, cleats
and other profiles in :mod:`contact.obstacles.cleat`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, Self

import numpy as np
from scipy import sparse

from contact.problem import ContactProblem, Linearisation, Linearise
from contact.swept import Surface


class Foundation(Protocol):
    """A rigid body, by its signed distance g(x) from points x (m, 3): positive outside it, in mm.

    Where the nearest point of the surface is unique, |dg/dx| = 1 and g never differs more between two points than they
    are apart. Every foundation is a frozen record; a moving one is another record at every instant.
    """

    @property
    def origin(self) -> np.ndarray:
        """A point (3,) that moves with it."""

    @property
    def least_radius(self) -> float:
        """Of the parts of its surface that bulge [mm]; infinite where none does."""

    def gap(self, x: np.ndarray) -> np.ndarray:
        """g (m,)."""

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """dg/dx (m, 3), unit vectors: the directions in which the foundation pushes."""

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """d2g/dx2 (m, 3, 3)."""

    def moved(self, by: np.ndarray) -> Self:
        """The foundation shifted by the vector ``by`` (3,)."""

    @property
    def size(self) -> float:
        """Largest length [mm] that g is worked out from besides x: of its position and of its own measures."""


def require_unit(what: str, vector: np.ndarray) -> None:
    """Raise ValueError unless the vector has three components and the length 1."""
    if np.shape(vector) != (3,) or not abs(float(np.linalg.norm(vector)) - 1) < 1e-12:
        raise ValueError(f"{what} must be a unit vector (3,), got {vector}")


@dataclass(frozen=True, eq=False)
class RigidPlane:
    """The half space n.x > offset is the foundation; the body must stay at n.x <= offset.

    normal (3,): unit vector from the body towards the foundation.  offset [mm]: n.x of the plane.
    """

    normal: np.ndarray
    offset: float

    def __post_init__(self) -> None:
        require_unit("the normal of a plane", self.normal)
        object.__setattr__(self, "normal", np.asarray(self.normal, float))

    @property
    def origin(self) -> np.ndarray:
        """offset n (3,)."""
        return self.offset * self.normal

    @property
    def least_radius(self) -> float:
        """Infinite."""
        return np.inf

    def gap(self, x: np.ndarray) -> np.ndarray:
        """offset - n.x, (m,)."""
        return self.offset - x @ self.normal

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """-n, (m, 3)."""
        return np.broadcast_to(-self.normal, x.shape)

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """Zero (m, 3, 3)."""
        return np.zeros((len(x), 3, 3))

    def moved(self, by: np.ndarray) -> RigidPlane:
        """The plane through the shifted points."""
        return replace(self, offset=self.offset + float(self.normal @ by))

    @property
    def size(self) -> float:
        """|offset|."""
        return abs(self.offset)


@dataclass(frozen=True, eq=False)
class Candidates:
    """Points that may touch: x(u) = reference + (operator @ u), reference (m, 3), operator (3m, n) sparse.

    weights (m,) [mm^2]: areas that turn pressure into force.  coupling (m, m): consistent matrix or None (lumped).
    """

    reference: np.ndarray
    operator: sparse.csr_matrix
    weights: np.ndarray
    coupling: sparse.csr_matrix | None = None

    def positions(self, u: np.ndarray) -> np.ndarray:
        """x (m, 3)."""
        return self.reference + (self.operator @ u).reshape(-1, 3)

    def only(self, chosen: np.ndarray) -> Candidates:
        """The chosen points (m,) bool; raises ValueError with consistent coupling, which ties neighbours together."""
        if self.coupling is not None:
            raise ValueError("candidates with consistent coupling cannot be taken apart")
        return Candidates(self.reference[chosen], self.operator[np.repeat(chosen, 3)], self.weights[chosen])


def against(linearise: Linearise, candidates: Candidates, foundation: Foundation) -> ContactProblem:
    """The contact problem of the candidates against a foundation.

    dg/du = n.A with n = dg/dx and A = dx/du;  sum_i f_i d2g_i/du2 = A^T diag(f_i d2g_i/dx2) A.
    """
    problem = replace(_against(linearise, candidates, foundation), surface=surface(candidates, foundation))
    if candidates.coupling is not None:
        return problem

    def only(chosen: np.ndarray) -> ContactProblem:
        part = candidates.only(chosen)
        return replace(_against(linearise, part, foundation), surface=surface(part, foundation))

    return replace(problem, only=only)


def travelling(
    linearise: Linearise, candidates: Candidates, foundation: Foundation, velocity: np.ndarray
) -> ContactProblem:
    """The same where the travel t of the foundation along ``velocity`` (3,) is the last unknown, its row empty.

    foundation: where it is at t = 0; seen from it, the points move against its velocity: x(u) - t velocity.
    """
    column = -np.tile(velocity, len(candidates.reference))
    operator = sparse.hstack([candidates.operator, sparse.csr_matrix(column[:, None])], format="csr")

    def with_travel(x: np.ndarray, memory: object) -> Linearisation:
        lin = linearise(x[:-1], memory)
        K = sparse.csc_matrix(sparse.block_diag([lin.tangent, sparse.csc_matrix((1, 1))]))
        return Linearisation(np.append(lin.residual, 0.0), K, lin.scale, lambda dx: lin.remember(dx[:-1]))

    problem = against(with_travel, replace(candidates, operator=operator), foundation)
    return replace(problem, driven=1)


def _against(linearise: Linearise, candidates: Candidates, foundation: Foundation) -> ContactProblem:
    if isinstance(foundation, RigidPlane):
        return against_plane(linearise, candidates, foundation)
    A, m = candidates.operator, len(candidates.reference)

    def jacobian(u: np.ndarray) -> sparse.csr_matrix:
        n = foundation.gradient(candidates.positions(u))
        each = sparse.csr_matrix((n.ravel(), np.arange(3 * m), 3 * np.arange(m + 1)), shape=(m, 3 * m))
        return sparse.csr_matrix(each @ A)

    def curvature(u: np.ndarray, force: np.ndarray) -> sparse.csc_matrix:
        nodes = np.flatnonzero(force)  # the others would only fill the matrix with zeros
        blocks = force[nodes, None, None] * foundation.curvature(candidates.positions(u)[nodes])
        rows = A[(3 * nodes[:, None] + np.arange(3)).ravel()]
        shape = (3 * len(nodes), 3 * len(nodes))
        inner = sparse.bsr_matrix((blocks, np.arange(len(nodes)), np.arange(len(nodes) + 1)), shape=shape)
        return sparse.csc_matrix(rows.T @ inner.tocsr() @ rows)

    return ContactProblem(
        linearise=linearise,
        gap=lambda u: foundation.gap(candidates.positions(u)),
        gap_jacobian=jacobian,
        weights=candidates.weights,
        coupling=candidates.coupling,
        gap_curvature=curvature,
        directions=lambda u: foundation.gradient(candidates.positions(u)),
        gap_size=foundation.size + float(np.max(np.abs(candidates.reference), initial=0.0)),
        standing=surface(candidates, foundation),
    )


def surface(candidates: Candidates, foundation: Foundation) -> Surface:
    """Both in the frame that is shifted with the foundation."""
    origin, there = foundation.origin, foundation.moved(-foundation.origin)
    size = foundation.size + float(np.max(np.abs(candidates.reference), initial=0.0))
    place, radius = (lambda u: candidates.positions(u) - origin), foundation.least_radius
    return Surface(place, there.gap, there.gradient, radius, operator=candidates.operator, size=size)


def against_plane(linearise: Linearise, candidates: Candidates, plane: RigidPlane) -> ContactProblem:
    """The contact problem of the candidates against a plane; its gap is linear in u.

    Where plane and candidates are is rounded once, in the gap at u = 0, and never again: what moves is added to it. A
    travel far below the last digit of the position of a point has all of its own.
    """
    m = len(candidates.reference)
    project = sparse.kron(sparse.eye_array(m), -plane.normal[None, :], format="csr")
    jacobian, at_rest = sparse.csr_matrix(project @ candidates.operator), plane.gap(candidates.reference)
    return ContactProblem(
        linearise=linearise,
        gap=lambda u: at_rest + jacobian @ u,
        gap_jacobian=lambda u: jacobian,
        weights=candidates.weights,
        coupling=candidates.coupling,
        directions=lambda u: plane.gradient(candidates.reference),
    )
