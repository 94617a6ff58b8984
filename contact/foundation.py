"""Rigid frictionless foundations: gap and normal of an obstacle seen from points in space.

A foundation sees positions only; how they depend on the unknowns comes as a sparse matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.problem import ContactProblem, Linearisation


@dataclass(frozen=True, eq=False)
class RigidPlane:
    """The half space n.x > offset is the foundation; the body must stay at n.x <= offset.

    normal (3,): unit vector from the body towards the foundation.  offset [mm]: n.x of the plane.
    """

    normal: np.ndarray
    offset: float

    def __post_init__(self) -> None:
        if not abs(float(np.linalg.norm(self.normal)) - 1) < 1e-12:
            raise ValueError(f"the normal of a plane must be a unit vector, got {self.normal}")

    def gap(self, x: np.ndarray) -> np.ndarray:
        """Offset - n.x, (m,)."""
        return self.offset - x @ self.normal


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
        """X (m, 3)."""
        return self.reference + (self.operator @ u).reshape(-1, 3)


def against_plane(
    linearise: Callable[[np.ndarray, object], Linearisation], candidates: Candidates, plane: RigidPlane
) -> ContactProblem:
    """The contact problem of the candidates against a plane; its gap is linear in u."""
    m = len(candidates.reference)
    project = sparse.kron(sparse.eye_array(m), -plane.normal[None, :], format="csr")
    jacobian = sparse.csr_matrix(project @ candidates.operator)
    return ContactProblem(
        linearise=linearise,
        gap=lambda u: plane.gap(candidates.positions(u)),
        gap_jacobian=lambda u: jacobian,
        weights=candidates.weights,
        coupling=candidates.coupling,
    )
