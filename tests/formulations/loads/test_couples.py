"""Couples that follow the director: moment, no net force, derivative, and a strip bent to a circle."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.loads.pressure import Couples
from formulations.section.laminate import Laminate, Ply
from support.problems.differences import central_difference, fitted_order
from support.problems.shells import SKEW_LAMINATE, make_shell

ROUNDING = 1e-12  # relative
DIFFERENCE = 1e-9  # of the 8th-order difference of a smooth function
CIRCLE = (1.8, 2.3)  # order of the tip of the bent strip in the mesh size
TIP = 6e-3  # error of the tip over the length on the finest mesh


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


@pytest.mark.parametrize("turn", [pytest.param(math.pi / 2, marks=pytest.mark.slow), 1.5 * math.pi])
def test_strip_bent_to_an_arc(turn) -> None:
    """M = D turn/L at the end gives a circle of radius L/turn: its tip is at R sin(turn), -R (1 - cos(turn)).

    The axis is +e2, which turns e3 towards e1 and the tip downwards; D is that of plane strain, nu = 0.3.
    """
    E, nu, L, h, b = 1.2e6, 0.3, 12.0, 0.06, 1.0
    moment = E * h**3 / (12 * (1 - nu**2)) * turn / L * b
    tip, counts, errors = L / turn * np.array([math.sin(turn), math.cos(turn) - 1]), np.array([8, 16, 32]), []
    for n in counts:
        grid = Grid.tensor(np.linspace(0, L, n + 1), np.array([0.0, b]))
        fixed = np.zeros((grid.n_nodes, 6), bool)
        fixed[:, 2:4] = True
        fixed[grid.on_line(0, 0.0)] = True
        end = grid.on_line(0, L)
        couples = Couples(end, np.full(2, moment / 2), np.tile([0.0, 1.0, 0.0], (2, 1)), h)
        laminate = Laminate.single(Ply.isotropic(E, nu, h))
        shell = make_shell(Plate(), grid, laminate, fixed=fixed, thickness_strain="nodal", couples=couples)
        u, memory = np.zeros(shell.discretisation.n_free), None
        for factor in np.linspace(0, 1, 5)[1:]:
            for _ in range(15):
                lin = shell.scaled(factor).linearise(u, memory)
                du = spsolve(lin.tangent, -lin.residual)
                u, memory = u + du, lin.remember(du)
        assert np.linalg.norm(du) <= 1e-6 * np.linalg.norm(u)
        v = shell.discretisation.expand(u)[end].mean(axis=0)
        at = np.array([L + v[:2].mean(), v[4:].mean()])
        errors.append(np.linalg.norm(at - tip) / L)
    assert errors[-1] <= TIP
    assert CIRCLE[0] <= fitted_order(1 / counts, errors) <= CIRCLE[1]
