"""Initial resultants H0: balance at rest, dead forces, a tensioned strip, buckling."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.strains.quantities import N_E
from support.problems.differences import rotation
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell, nodal_components

ROUNDING = 1e-12  # relative to the largest entry of the quantity
DEFLECTION = 5e-4  # of the tensioned strip, see its test
EULER = 0.01  # bracket around the buckling load
INITIAL = np.array([0.9, 1.4, -0.5, 0.8, 0.3, 0.6, 0.2, -0.4, 0.5, 0.1, -0.7])


def largest(array) -> float:
    return float(np.max(np.abs(array)))


def test_initial_resultants_are_in_balance_at_rest(patch) -> None:
    shell = make_shell(patch.surface, patch.grid(2, 3), initial=INITIAL)
    rest = np.zeros(shell.discretisation.n_free)
    assert largest(shell.linearise(rest).residual) <= ROUNDING


def test_dead_forces_that_balance_H0_do_not_turn_with_the_body() -> None:
    """A prestressed plate turned rigidly: the edge a1 = max carries (R - I)(N11 e1 + N12 e2) times its width."""
    N11, N12 = 2.0, -0.7
    initial = np.zeros(N_E)
    initial[0:2], initial[4:6] = N11 / 2, N12 / 2
    grid = PATCHES["plate"].grid(3, 2)
    R = rotation(np.array([0.3, -0.7, 0.5]), 1.1)
    u = nodal_components(Plate(), grid, SKEW_LAMINATE, lambda x: x @ (R - np.eye(3)).T)
    residual = make_shell(Plate(), grid, initial=initial).linearise(u).residual.reshape(-1, 3, 2).sum(axis=2)
    width = np.ptp(grid.nodes[:, 1])
    residual = residual.reshape(*grid.node_shape, 3)
    # what the edges a2 = const leave at the two corners cancels in the sum
    expected = (R - np.eye(3)) @ np.array([N11, N12, 0.0]) * width
    np.testing.assert_allclose(residual[-1].sum(axis=0), expected, rtol=0, atol=100 * ROUNDING)
    assert largest(residual[1:-1, 1:-1]) <= 100 * ROUNDING


STRIP, WIDTH, THIN, MODULUS, NU = 10.0, 1.0, 0.1, 1e4, 0.3
BENDING = MODULUS * THIN**3 / (12 * (1 - NU**2))


def strip_tangent(n: int, N0: float):
    """Tangent at rest of a simply supported strip under N11 = N0 in cylindrical bending, with its grid and freedoms."""
    grid = Grid.tensor(np.linspace(0, STRIP, n + 1), np.linspace(0, WIDTH, 2))
    fixed = np.zeros((grid.n_nodes, 6), bool)
    fixed[:, 2:4] = True  # no strain along the width
    fixed[grid.on_line(0, 0.0), 4:] = fixed[grid.on_line(0, STRIP), 4:] = True
    fixed[grid.node_at(0.0, 0.0), 0:2] = [True, False]
    initial = np.zeros(N_E)
    initial[:2] = N0 / 2
    laminate = Laminate.single(Ply.isotropic(MODULUS, NU, THIN))
    shell = make_shell(Plate(), grid, laminate, fixed=fixed, initial=initial)
    return shell.linearise(np.zeros(shell.discretisation.n_free)).tangent, grid, fixed


@pytest.mark.parametrize("stiffness", [5.0, 20.0, 200.0])
def test_tensioned_strip_deflects_as_a_string_with_bending(stiffness) -> None:
    """D w,1111 - N w,11 = q: w(L/2) = q L^2/8N - (q D/N^2)(1 - 1/cosh(kL/2)), k^2 = N/D; ``stiffness`` is k L.

    Bending takes 37, 2 and 0.02 % of the deflection of a string. What remains is 2 (h/L)^2 = 2e-4 by theory: the
    strains of the shell are linear between the faces, so H0 adds N h^2/4 to D, where a continuum would add N h^2/12.
    """
    N0, n = BENDING * (stiffness / STRIP) ** 2, 80
    exact = STRIP**2 / (8 * N0) - BENDING / N0**2 * (1 - 1 / math.cosh(stiffness / 2))
    tangent, grid, fixed = strip_tangent(n, N0)
    forces = np.zeros((grid.n_nodes, 6))
    forces[:, 4:] = WIDTH * STRIP / n / 4  # q = 1 per area: two nodes across, two faces
    u = np.zeros(fixed.size)
    u[~fixed.ravel()] = spsolve(tangent, forces[~fixed])
    w = u.reshape(-1, 6)[grid.node_at(STRIP / 2, 0.0), 4:]
    assert w == pytest.approx([exact, exact], rel=DEFLECTION)


def test_compressed_strip_buckles_at_the_euler_load() -> None:
    """The smallest eigenvalue of the tangent changes sign at N = -pi^2 D/L^2, within the shear and mesh correction."""
    euler, smallest = math.pi**2 * BENDING / STRIP**2, []
    for factor in (1 - EULER, 1 + EULER):
        tangent, _, _ = strip_tangent(32, -factor * euler)
        smallest.append(np.linalg.eigvalsh(tangent.toarray()).min())
    assert smallest[0] > 0 > smallest[1]
