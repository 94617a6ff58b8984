"""General plies, and initial stress: its resultants, the pre-tensioned membrane, the plate that buckles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.section.laminate import SECTIONS, Laminate, Ply
from formulations.section.monoclinic import MonoclinicPly
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from support.problems.differences import rotation
from support.problems.shells import SKEW_LAMINATE, make_shell

ROUNDING = 1e-12  # relative
EXTRAPOLATED = 2e-4  # of a value of second order extrapolated from 8 x 8 and 16 x 16 elements, 1.9 and 0.4 % off
ORTHOTROPIC = {"E": (130.0, 9.0, 7.0), "G": (5.0, 4.0, 3.0), "nu": (0.28, 0.31, 0.4)}


def monoclinic(rng: np.random.Generator) -> np.ndarray:
    """A definite stiffness with all of its 13 constants."""
    B = np.zeros((6, 6))
    for rows in ([0, 1, 2, 3], [4, 5]):
        root = rng.normal(size=(len(rows), len(rows)))
        B[np.ix_(rows, rows)] = root @ root.T + np.eye(len(rows))
    return B


# --- plies --------------------------------------------------------------------------------------------------------


def test_orthotropic_ply_is_the_turned_tensor() -> None:
    """C_ijkl = R_ia R_jb R_kc R_ld C_abcd, and the compliances that the constants say."""
    voigt = {(0, 0): 0, (1, 1): 1, (0, 1): 2, (2, 2): 3, (0, 2): 4, (1, 2): 5}

    def tensor(B: np.ndarray) -> np.ndarray:
        index = np.array([[voigt[min(i, j), max(i, j)] for j in range(3)] for i in range(3)])
        return B[index[:, :, None, None], index[None, None]]

    still, turned = (MonoclinicPly.orthotropic(**ORTHOTROPIC, angle=a, thickness=1.0).stiffness() for a in (0, 0.7))
    R = rotation(np.array([0.0, 0.0, 1.0]), 0.7)
    expected = np.einsum("ia,jb,kc,ld,abcd->ijkl", R, R, R, R, tensor(still))
    np.testing.assert_allclose(tensor(turned), expected, rtol=0, atol=ROUNDING * 130)
    compliance = np.linalg.inv(still)
    assert compliance[1, 0] == pytest.approx(-0.28 / 130, rel=ROUNDING)
    assert compliance[3, 1] == pytest.approx(-0.4 / 9, rel=ROUNDING)
    assert 1 / np.diag(compliance)[[2, 4, 5]] == pytest.approx(ORTHOTROPIC["G"], rel=ROUNDING)


@pytest.mark.parametrize("section", SECTIONS)
def test_transversely_isotropic_ply_is_a_monoclinic_one(section) -> None:
    old = Ply(30.0, 8.0, 4.0, 8.0 / (2 * 1.4), 0.3, 0.4, 0.6, 0.5)
    nine = MonoclinicPly.orthotropic((30, 8, 8), (4, 4, 8 / 2.8), (0.3, 0.3, 0.4), 0.6, 0.5)
    D = Laminate.single(old).stiffness(section)
    np.testing.assert_allclose(
        Laminate.single(nine).stiffness(section), D, rtol=0, atol=100 * ROUNDING * np.max(np.abs(D))
    )


def test_shell_of_a_monoclinic_ply_agrees_with_the_solid(rng) -> None:
    """A block under homogeneous gradients, all 13 constants at work: equal energy, so equal forces in every direction.

    full-3d: the section that drops nothing. u = (F - I) x is in both spaces, the law is that of St. Venant-Kirchhoff.
    """
    ply = MonoclinicPly(monoclinic(rng), 0.4)
    laminate = Laminate((ply, MonoclinicPly(monoclinic(rng), 0.3)), d_minus=-0.2)
    lines = np.linspace(0, 1.2, 3), np.linspace(0, 0.9, 2)
    shell = make_shell(Plate(), Grid.tensor(*lines), laminate, section="full-3d")
    mesh = SolidMesh.build(Plate(), *lines, laminate)
    solid = SolidModel(SolidDiscretisation.build(mesh, laminate, np.zeros((len(mesh.x), 3), bool)))
    for _ in range(3):
        A = 0.2 * rng.normal(size=(3, 3))
        v = np.stack([x @ A.T for x in shell.discretisation.positions()], axis=-1).reshape(-1, 6)
        u = mesh.x @ A.T
        work = shell.linearise(v.ravel()).residual @ v.ravel()
        assert solid.linearise(u.ravel()).residual @ u.ravel() == pytest.approx(work, rel=1e-10)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"nu": (4.0, 0.3, 0.4)}, r"1 - nu_12 nu_21 = -0.1077 must be > 0"),
        ({"nu": (0.28, 4.5, 0.4)}, r"1 - nu_13 nu_31 = -0.0\d+ must be > 0"),
        ({"nu": (0.28, 0.31, 1.3)}, r"1 - nu_23 nu_32 = -0.3144 must be > 0"),
        ({"nu": (2.6, 3.0, 0.9)}, r"2 nu_21 nu_32 nu_13 = -\d"),
        ({"nu": (math.nan, 0.3, 0.4)}, r"1 - nu_12 nu_21 = nan must be > 0"),
        ({"E": (130.0, -9.0, 7.0)}, "ply E2 = -9 must be a positive number"),
        ({"G": (5.0, 4.0, math.inf)}, "ply G23 = inf must be a positive number"),
    ],
)
def test_impossible_orthotropic_plies_are_refused_by_the_inequality(changed, message) -> None:
    with pytest.raises(ValueError, match=message):
        MonoclinicPly.orthotropic(**{**ORTHOTROPIC, **changed}, angle=0.0, thickness=1.0)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({(0, 0): -1.0}, "B_11,11 = -1 must be > 0"),
        ({(0, 1): 2.0, (1, 0): 2.0}, "scaled minor of 11, 22 = -3 must be > 0"),
        ({(2, 0): 0.9, (0, 2): 0.9, (2, 1): 0.9, (1, 2): 0.9}, "scaled minor of 11, 22, 12 = -0.62 must be > 0"),
        ({(4, 5): -1.5, (5, 4): -1.5}, "scaled minor of 13, 23 = -1.25 must be > 0"),
        ({(0, 1): 0.5}, "not symmetric: B_11,22 - B_22,11 = 0.5 must be 0"),
        ({(2, 4): 0.1, (4, 2): 0.1}, "not monoclinic: B_12,13 = 0.1 must be 0"),
        ({(0, 0): math.nan}, "6 x 6 finite numbers"),
    ],
)
def test_impossible_stiffnesses_are_refused_with_the_reason(entries, message) -> None:
    B = np.eye(6)
    for place, value in entries.items():
        B[place] = value
    with pytest.raises(ValueError, match=message):
        MonoclinicPly(B, 1.0)


def test_a_stiffness_is_accepted_exactly_when_it_is_definite(rng) -> None:
    accepted = 0
    for _ in range(200):
        B = monoclinic(rng)
        B[:4, :4] -= rng.uniform(0, 2) * np.eye(4)
        smallest = np.linalg.eigvalsh(B).min()
        try:
            MonoclinicPly(B, 1.0)
        except ValueError:
            assert smallest < 0
        else:
            assert smallest > 0
            accepted += 1
    assert 50 < accepted < 150


def test_thickness_and_immutability() -> None:
    with pytest.raises(ValueError, match="thickness = 0 must be a positive number"):
        MonoclinicPly(np.eye(6), 0.0)
    with pytest.raises(ValueError, match="read-only"):
        MonoclinicPly(np.eye(6), 1.0).stiffness()[0, 0] = 2.0


# --- initial stress -----------------------------------------------------------------------------------------------


def test_initial_resultants_have_the_force_and_the_moment_of_the_stresses() -> None:
    """H- + H+ = int S da3, (H+ - H-) h/2 = int S z da3 about mid-height, for plies of 0.11 and 0.07."""
    S = np.array([[3.0, -1.0, 0.5], [-2.0, 4.0, 1.5]])
    H0 = SKEW_LAMINATE.initial_resultants(S)
    faces = H0[:6].reshape(3, 2)
    assert faces.sum(axis=1) == pytest.approx(0.11 * S[0] + 0.07 * S[1], rel=ROUNDING)
    moment = 0.11 * S[0] * (0.055 - 0.09) + 0.07 * S[1] * (0.145 - 0.09)
    assert (faces[:, 1] - faces[:, 0]) * 0.09 == pytest.approx(moment, rel=ROUNDING)
    assert np.all(H0[6:] == 0)


@pytest.mark.parametrize("stresses", [[(1, 2, 3)], [(1, 2), (3, 4)], [(1, 2, 3), (1, math.nan, 3)]])
def test_wrong_initial_stresses_are_refused(stresses) -> None:
    with pytest.raises(ValueError, match="of 2 plies"):
        SKEW_LAMINATE.initial_resultants(stresses)


SIDE, MODULUS, NU = 10.0, 1e4, 0.3


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
        initial = laminate.initial_resultants([factor * np.array(stress)])
        shell = make_shell(Plate(), grid, laminate, fixed=fixed, initial=initial)
        tangents.append(shell.linearise(np.zeros(shell.discretisation.n_free)).tangent)
    return *tangents, grid, fixed


def test_work_of_initial_stress_on_a_slope() -> None:
    """A plate that tilts by (a, b): u.(K - K0).u = N11 a^2 + 2 N12 a b + N22 b^2 per area, whatever the elasticity."""
    S = np.array([[3.0, -1.0, 0.5], [-2.0, 4.0, 1.5]])
    grid = Grid.tensor(np.array([0.0, 0.7, 2.0]), np.array([-0.5, 0.1, 0.9]))
    shells = [make_shell(Plate(), grid, initial=initial) for initial in (None, SKEW_LAMINATE.initial_resultants(S))]
    none, full = (shell.linearise(np.zeros(6 * grid.n_nodes)).tangent for shell in shells)
    N = 0.11 * S[0] + 0.07 * S[1]
    a, b = 0.3, -0.8
    v = np.zeros((grid.n_nodes, 6))
    v[:, 4:] = (grid.nodes @ [a, b])[:, None]
    work = v.ravel() @ (full - none) @ v.ravel()
    assert work == pytest.approx(2.0 * 1.4 * (N[0] * a**2 + 2 * N[2] * a * b + N[1] * b**2), rel=1e-10)


def extrapolated(value) -> float:
    coarse, fine = value(8), value(16)
    return fine + (fine - coarse) / 3


def test_square_membrane_under_tension_and_pressure() -> None:
    """N (w,11 + w,22) = -q on a square: w(centre) = (16 q L^2/pi^4 N) sum of (-1)^... /(m n (m^2 + n^2)), m, n odd.

    h = 1e-3 L and N = 2e5 D/L^2: bending takes 4e-5 of the deflection.
    """
    h, S = 0.01, 200.0

    def deflection(n: int) -> float:
        _, tangent, grid, fixed = prestressed_square(n, h, (S, S, 0.0))
        forces = np.zeros((grid.n_nodes, 6))
        forces[:, 4:] = (SIDE / n) ** 2 / 2  # q = 1; held nodes drop out
        u = np.zeros(fixed.size)
        u[~fixed.ravel()] = spsolve(tangent, forces[~fixed])
        return u.reshape(-1, 6)[grid.node_at(SIDE / 2, SIDE / 2), 4:].mean()

    m, k = np.meshgrid(*[np.arange(1, 400, 2)] * 2)
    signs = np.where((m + k) // 2 % 2 == 1, 1.0, -1.0)
    exact = 16 * SIDE**2 / (math.pi**4 * S * h) * np.sum(signs / (m * k * (m**2 + k**2)))
    assert extrapolated(deflection) == pytest.approx(exact, rel=EXTRAPOLATED)


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
