"""The rigid plane: unit normal, sign of the gap, gap row and force on the body."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import sparse

from contact.obstacles.foundation import Candidates, RigidPlane, against_plane
from support.problems.contact_problems import linear_mechanics

ROUNDING = 1e-13
NORMALS = [np.array([1.0, 0, 0]), np.array([0, 0.6, -0.8]), np.array([2, 3, 6]) / 7]


@pytest.mark.parametrize("normal", [(1.0, 1e-5, 0), (0.0, 0, 0), (2.0, 0, 0), (math.nan, 0, 0), (0.5, 0.5, 0.5)])
def test_the_normal_must_be_a_unit_vector(normal) -> None:
    with pytest.raises(ValueError, match="unit vector"):
        RigidPlane(np.array(normal), 0.0)


@pytest.mark.parametrize("normal", NORMALS)
def test_gap_is_the_distance_positive_when_open(normal, rng) -> None:
    """A point is reached from the plane by going the gap against the normal, whatever lies sideways."""
    plane, offset = RigidPlane(normal, 0.7), np.array([0.3, 0.0, -0.2])
    sideways = np.cross(normal, rng.normal(size=3))
    x = 0.7 * normal - offset[:, None] * normal + sideways
    np.testing.assert_allclose(plane.gap(x), offset, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("coupling", [False, True])
def test_problem_against_a_plane(rng, normal, coupling) -> None:
    """Gap of the moved points, its derivative by differences, and a force W p against the normal on every point."""
    m, n = 3, 7
    operator, x, w = rng.normal(size=(3 * m, n)), rng.normal(size=(m, 3)), rng.uniform(0.5, 2, m)
    W = np.diag(w) + (0.1 if coupling else 0.0) * np.ones((m, m))
    candidates = Candidates(x, sparse.csr_matrix(operator), w, sparse.csr_matrix(W) if coupling else None)
    problem = against_plane(linear_mechanics(np.eye(n), np.zeros(n)), candidates, RigidPlane(normal, 0.4))
    u, du, p = rng.normal(size=n), rng.normal(size=n), rng.uniform(0, 1, m)
    moved = x + (operator @ u).reshape(m, 3)
    np.testing.assert_allclose(problem.gap(u), 0.4 - moved @ normal, rtol=0, atol=10 * ROUNDING)
    change = (problem.gap(u + du) - problem.gap(u - du)) / 2  # exact for a gap that is linear in u
    np.testing.assert_allclose(problem.gap_jacobian(u) @ du, change, rtol=0, atol=10 * ROUNDING)
    work = problem.contact_force(u, p) @ du
    assert work == pytest.approx(-(W @ p) @ ((operator @ du).reshape(m, 3) @ normal), rel=1e-11)
    assert problem.gap_curvature is None
