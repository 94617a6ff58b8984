"""Initial resultants H0: balance at rest, dead forces, their work on a slope, a membrane, the plate that buckles."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import Laminate, Ply
from formulations.strains.quantities import N_E
from support.problems.differences import rotation
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell, nodal_components

ROUNDING = 1e-12  # relative to the largest entry of the quantity
INITIAL = np.array([0.9, 1.4, -0.5, 0.8, 0.3, 0.6, 0.2, -0.4, 0.5, 0.1, -0.7])
EXTRAPOLATED = 2e-4  # of a value of second order extrapolated from 8 x 8 and 16 x 16 elements, 1.9 and 0.4 % off
SIDE, MODULUS, NU = 10.0, 1e4, 0.3


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


def initial_resultants(N: np.ndarray) -> np.ndarray:
    """H0 (11,) of the membrane forces N (N11, N22, N12) [N/mm], half on either face; shears and E33 carry none."""
    return np.append(np.kron(N, [0.5, 0.5]), np.zeros(5))


def prestressed_square(n: int, h: float, stress: tuple[float, float, float]):
    """Tangents at rest with and without the stress of a simply supported square, its grid and what is held."""
    lines = np.linspace(0, SIDE, n + 1)
    grid = Grid.tensor(lines, lines)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    for axis in (0, 1):
        for line in (0.0, SIDE):
            fixed[grid.on_line(axis, line), 4:] = True
            across = 2 * (1 - axis)
            fixed[grid.on_line(axis, line), across : across + 2] = True  # hard support: no turning about the normal
    laminate = Laminate.single(Ply.isotropic(MODULUS, NU, h))
    tangents = []
    for factor in (0.0, 1.0):
        initial = initial_resultants(factor * h * np.array(stress))
        shell = make_shell(Plate(), grid, laminate, fixed=fixed, initial=initial)
        tangents.append(shell.linearise(np.zeros(shell.discretisation.n_free)).tangent)
    return *tangents, grid, fixed


def test_work_of_initial_stress_on_a_slope() -> None:
    """A plate that tilts by (a, b): u.(K - K0).u = N11 a^2 + 2 N12 a b + N22 b^2 per area, whatever the elasticity."""
    N = np.array([0.19, 0.17, 0.16])
    grid = Grid.tensor(np.array([0.0, 0.7, 2.0]), np.array([-0.5, 0.1, 0.9]))
    shells = [make_shell(Plate(), grid, initial=initial) for initial in (None, initial_resultants(N))]
    none, full = (shell.linearise(np.zeros(6 * grid.n_nodes)).tangent for shell in shells)
    a, b = 0.3, -0.8
    v = np.zeros((grid.n_nodes, 6))
    v[:, 4:] = (grid.nodes @ [a, b])[:, None]
    work = v.ravel() @ (full - none) @ v.ravel()
    assert work == pytest.approx(2.0 * 1.4 * (N[0] * a**2 + 2 * N[2] * a * b + N[1] * b**2), rel=1e-10)


def extrapolated(value) -> float:
    coarse, fine = value(8), value(16)
    return fine + (fine - coarse) / 3


@pytest.mark.parametrize(("stress", "factor"), [((-1.0, 0.0, 0.0), 4.0), ((-1.0, -1.0, 0.0), 2.0)])
def test_square_plate_buckles_at_its_classical_load(stress, factor) -> None:
    """Smallest eigenvalue of K + s K_S: s h = 4 pi^2 D/L^2 under one-sided, 2 under two-sided compression.

    With k^2 = 2 pi^2/L^2 of the mode, shear divides it by 1 + D k^2/Gh, the h^2/4 of H0 by 1 + k^2 h^2/4: 0.05 % each.
    """
    h = 0.1
    D, k2, S = MODULUS * h**3 / (12 * (1 - NU**2)), 2 * (math.pi / SIDE) ** 2, MODULUS * h / (2 * (1 + NU))

    def load(n: int) -> float:
        elastic, stressed, _, _ = prestressed_square(n, h, stress)
        K, K_S = elastic.toarray(), (stressed - elastic).toarray()
        last = len(K) - 1
        return h / eigh(-K_S, K, eigvals_only=True, subset_by_index=[last, last])[0]

    exact = factor * math.pi**2 * D / SIDE**2 / (1 + D * k2 / S + k2 * h**2 / 4)
    assert extrapolated(load) == pytest.approx(exact, rel=EXTRAPOLATED)
