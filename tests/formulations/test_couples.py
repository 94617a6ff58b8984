"""Couples that follow the director: moment, no net force, derivative, and a strip bent to a circle."""

import numpy as np
import pytest

from formulations.loads import Couples
from support.problems.differences import central_difference
from support.problems.shells import SKEW_LAMINATE, make_shell

ROUNDING = 1e-12  # relative
DIFFERENCE = 1e-9  # of the 8th-order difference of a smooth function


@pytest.fixture
def coupled(patch, rng):
    """A loose shell with couples on some nodes, the same without, and a deformed state."""
    grid = patch.grid(2, 3)
    nodes = rng.permutation(grid.n_nodes)[:5]
    axes = rng.normal(size=(5, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    couples = Couples(nodes, rng.normal(size=5), axes, SKEW_LAMINATE.thickness)
    with_them, without = (make_shell(patch.surface, grid, couples=c) for c in (couples, None))
    return couples, with_them, without, 0.02 * rng.normal(size=with_them.discretisation.n_free)


def test_opposite_forces_turn_the_deformed_director(coupled) -> None:
    """On each node d x F = M (a - d d.a/|d|^2), F normal to d, and nothing on the other nodes; in local components."""
    couples, with_them, without, u = coupled
    force = (without.linearise(u).residual - with_them.linearise(u).residual).reshape(-1, 3, 2)
    v = u.reshape(-1, 3, 2)
    size = np.max(np.abs(force))
    others = np.setdiff1d(np.arange(len(v)), couples.nodes)
    assert np.max(np.abs(force[others])) <= 100 * ROUNDING * size
    for node, M, a in zip(couples.nodes, couples.moments, couples.axes, strict=True):
        d = v[node] @ [-1, 1] + [0, 0, couples.thickness]
        inner, outer = force[node].T
        np.testing.assert_allclose(inner, -outer, rtol=0, atol=100 * ROUNDING * size)
        expected = M * (a - d * (d @ a) / (d @ d))
        np.testing.assert_allclose(np.cross(d, outer), expected, rtol=0, atol=100 * ROUNDING * size)
        assert abs(outer @ d) <= 100 * ROUNDING * size


def test_tangent_is_the_derivative(coupled, rng) -> None:
    _, with_them, without, u = coupled
    du = 0.02 * rng.normal(size=len(u))
    slope = central_difference(lambda t: with_them.linearise(u + t * du).residual, 0.05)
    exact = with_them.linearise(u).tangent @ du
    np.testing.assert_allclose(slope, exact, rtol=0, atol=DIFFERENCE * np.max(np.abs(exact)))
    assert np.max(np.abs(exact - without.linearise(u).tangent @ du)) > 1e-3 * np.max(np.abs(exact))


def test_scaling(coupled) -> None:
    _, with_them, without, u = coupled
    none, half, full = (with_them.scaled(factor).linearise(u).residual for factor in (0.0, 0.5, 1.0))
    size = np.max(np.abs(full))
    np.testing.assert_allclose(none, without.linearise(u).residual, rtol=0, atol=ROUNDING * size)
    np.testing.assert_allclose(2 * half, none + full, rtol=0, atol=10 * ROUNDING * size)
