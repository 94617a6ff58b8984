"""Plies and laminates: tensor rotation, plane stress, Poisson thickness locking, quadrature and a variational check."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import quad_vec

from formulations.section.laminate import SECTIONS, Laminate, Ply

ROUNDING = 1e-12  # relative to the largest entry
VOIGT = ((0, 0), (1, 1), (0, 1), (2, 2), (0, 2), (1, 2))  # 11, 22, 12, 33, 13, 23
E, H = 210.0, 0.3
# E_L, E_T, G_LT, G_TT, nu_LT, nu_TT of the plies of the 2004 paper, MPa
PAPER = (510.45, 6.91, 2.33, 1.77, 0.46, 0.95)
POISSON = (-0.2, 0.0, 0.3, 0.45)

section_of_each_kind = pytest.mark.parametrize("section", SECTIONS)


def compliance_tensor(ply: Ply) -> np.ndarray:
    """S_ijkl in the fibre axes straight from the engineering constants."""
    S = np.zeros((3, 3, 3, 3))
    for i in range(3):
        S[i, i, i, i] = 1 / ply.moduli[i]
    nu_LT, nu_LN, nu_TN = ply.poisson
    for i, j, nu, modulus in ((0, 1, nu_LT, ply.E_L), (0, 2, nu_LN, ply.E_L), (1, 2, nu_TN, ply.E_T)):
        S[i, i, j, j] = S[j, j, i, i] = -nu / modulus
    for (i, j), shear in zip(((0, 1), (0, 2), (1, 2)), ply.shears, strict=True):
        for a, b, c, d in ((i, j, i, j), (i, j, j, i), (j, i, i, j), (j, i, j, i)):
            S[a, b, c, d] = 1 / (4 * shear)
    return S


def turned_compliance(ply: Ply) -> np.ndarray:
    """S_ijkl in the shell axes by the rotation of a tensor of fourth order."""
    c, s = math.cos(ply.angle), math.sin(ply.angle)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])  # the first column is the fibre
    return np.einsum("ia,jb,kc,ld,abcd->ijkl", R, R, R, R, compliance_tensor(ply))


def engineering_voigt(S: np.ndarray) -> np.ndarray:
    """Compliance (6, 6) of engineering shears, from stresses to strains."""
    return np.array([[(1 if i == j else 2) * (1 if k == m else 2) * S[i, j, k, m] for k, m in VOIGT] for i, j in VOIGT])


def stacked(d_minus: float = -0.2) -> Laminate:
    """Three unequal plies, nowhere symmetric."""
    return Laminate(
        (
            Ply(*PAPER, math.radians(52), 0.12),
            Ply(40.0, 9.0, 4.0, 3.0, 0.3, 0.4, -0.7, 0.31),
            Ply.isotropic(15.0, 0.4, 0.2),
        ),
        d_minus,
    )


def ply_stiffness(ply: Ply) -> np.ndarray:
    return np.linalg.inv(engineering_voigt(turned_compliance(ply)))


def shape(z: float, h: float) -> np.ndarray:
    """(N-, N+) at the height z above the inner face."""
    return np.array([1 - z / h, z / h])


def through_thickness(laminate: Laminate, integrand) -> np.ndarray:
    """Sum over the plies of the integral of integrand(z, ply) by adaptive quadrature."""
    total, bottom = 0.0, 0.0
    for ply in laminate.plies:
        total = total + quad_vec(lambda z, ply=ply: integrand(z, ply), bottom, bottom + ply.thickness, epsrel=1e-13)[0]
        bottom += ply.thickness
    return total


def condensed(D: np.ndarray) -> np.ndarray:
    """The tangential stiffness (6, 6) left when the resultant of E33 vanishes."""
    return D[:6, :6] - np.outer(D[:6, 10], D[10, :6]) / D[10, 10]


def assert_close(found: np.ndarray, expected: np.ndarray, tolerance: float = ROUNDING) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * np.max(np.abs(expected)))


@pytest.mark.parametrize("angle", [0.0, math.radians(52), -math.radians(52), 1.3, math.pi / 2])
@pytest.mark.parametrize("constants", [PAPER, (40.0, 9.0, 4.0, 3.0, 0.3, 0.4), (5.0, 9.0, 2.0, 8.0, -0.2, 0.1)])
@pytest.mark.parametrize("across", [(), (14.0, 5.0, 0.15)])  # E_N, G_LN, nu_LN
def test_ply_stiffness_is_the_rotated_fourth_order_tensor(constants, across, angle) -> None:
    ply = Ply(*constants[:-1], 0.2 if across else constants[-1], angle, 1.0, *across)
    assert_close(ply.stiffness(), ply_stiffness(ply), 1e-10)  # the paper's ply has a condition number of about 1e3


@section_of_each_kind
@pytest.mark.parametrize("nu", POISSON)
def test_bending_stiffness(section, nu) -> None:
    """Plane stress, except that full-3d locks: cylindrical bending 1.225 times too stiff at nu = 0.3, 3.025 at 0.45."""
    D = condensed(Laminate.single(Ply.isotropic(E, nu, H)).stiffness(section))
    cylindrical, equibiaxial = E * H**3 / (12 * (1 - nu**2)), 2 * E * H**3 / (12 * (1 - nu))
    if section == "full-3d":
        cylindrical *= (1 - nu) ** 2 / (1 - 2 * nu)
        equibiaxial *= (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    for strains, expected in (((-1, 1, 0, 0, 0, 0), cylindrical), ((-1, 1, -1, 1, 0, 0), equibiaxial)):
        curved = H / 2 * np.array(strains)
        assert curved @ D @ curved == pytest.approx(expected, rel=ROUNDING)


@section_of_each_kind
def test_symmetry_of_the_section(section) -> None:
    D = stacked().stiffness(section)
    asymmetry = np.max(np.abs(D - D.T)) / np.max(np.abs(D))
    if section == "nonsymmetric":
        assert asymmetry > 1e-3
    else:
        assert asymmetry <= ROUNDING
        assert np.linalg.eigvalsh(D).min() > 0


def test_nonsymmetric_section_is_plane_stress_tangentially_and_full_in_the_normal_row() -> None:
    laminate = stacked()
    D = laminate.stiffness("nonsymmetric")
    assert np.all(D[:6, 10] == 0)

    def reduced(z: float, ply: Ply) -> np.ndarray:
        N = shape(z, laminate.thickness)
        plane = np.linalg.inv(engineering_voigt(turned_compliance(ply))[:3, :3])  # plane stress by its definition
        return np.kron(plane, np.outer(N, N))

    def normal(z: float, ply: Ply) -> np.ndarray:
        b = ply_stiffness(ply)
        return np.append(np.kron(b[3, :3], shape(z, laminate.thickness)), b[3, 3])

    assert_close(D[:6, :6], through_thickness(laminate, reduced), 1e-10)
    assert_close(D[10, [*range(6), 10]], through_thickness(laminate, normal), 1e-10)


def test_full_3d_section_is_the_integral_of_the_law() -> None:
    laminate = stacked()

    def integrand(z: float, ply: Ply) -> np.ndarray:
        N = shape(z, laminate.thickness)
        T = np.zeros((6, 11))  # from the 11 strains to 11, 22, 12, 33, 13, 23 at z
        for row, first in ((0, 0), (1, 2), (2, 4), (4, 6), (5, 8)):
            T[row, first : first + 2] = N
        T[3, 10] = 1.0
        return T.T @ ply_stiffness(ply) @ T

    assert_close(laminate.stiffness("full-3d"), through_thickness(laminate, integrand), 1e-10)


@section_of_each_kind
def test_transverse_shear_block_is_the_integral_of_the_law(section) -> None:
    laminate = stacked()

    def integrand(z: float, ply: Ply) -> np.ndarray:
        N = shape(z, laminate.thickness)
        return np.kron(ply_stiffness(ply)[4:, 4:], np.outer(N, N))

    D = laminate.stiffness(section)
    assert_close(D[6:10, 6:10], through_thickness(laminate, integrand), 1e-10)
    assert np.all(D[6:10, [*range(6), 10]] == 0)
    assert np.all(D[[*range(6), 10], 6:10] == 0)


def test_constant_s33_minimises_the_three_dimensional_energy(rng) -> None:
    """Its energy is the minimum of 1/2 int e.b.e over all profiles e33(z) whose mean is E33.

    That variational definition knows no plane-stress stiffness; it is solved at the Gauss points as a KKT system.
    """
    laminate = stacked()
    h, z, weight, b = laminate.thickness, [], [], []
    points, weights = np.polynomial.legendre.leggauss(3)
    bottom = 0.0
    for ply in laminate.plies:
        z += list(bottom + ply.thickness * (points + 1) / 2)
        weight += list(ply.thickness * weights / 2)
        b += [ply_stiffness(ply)] * len(points)
        bottom += ply.thickness
    D = laminate.stiffness("constant-s33")
    for _ in range(5):
        faces, mean = rng.normal(size=(3, 2)), rng.normal()
        plane = [faces @ shape(height, h) for height in z]
        kkt = np.zeros((len(z) + 1, len(z) + 1))
        right = np.zeros(len(z) + 1)
        for i, (w, stiffness, strain) in enumerate(zip(weight, b, plane, strict=True)):
            kkt[i, i] = w * stiffness[3, 3]
            kkt[i, -1] = kkt[-1, i] = w
            right[i] = -w * stiffness[3, :3] @ strain
        right[-1] = h * mean
        profile = np.linalg.solve(kkt, right)[:-1]
        energy = sum(
            w / 2 * (e := np.append(strain, normal)) @ stiffness[:4, :4] @ e
            for w, stiffness, strain, normal in zip(weight, b, plane, profile, strict=True)
        )
        strains = np.concatenate([faces.ravel(), np.zeros(4), [mean]])
        assert strains @ D @ strains / 2 == pytest.approx(energy, rel=1e-10)


def test_single_ply_lies_about_its_middle_surface() -> None:
    laminate = Laminate.single(Ply.isotropic(E, 0.3, H))
    assert (laminate.d_minus, laminate.d_plus) == pytest.approx((-H / 2, H / 2), rel=ROUNDING)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"nu_TT": 0.995}, r"not positive definite: .* must be > 0 \(nu_TT = 0.995, nu_LT = 0.46, nu_LN = 0.46\)"),
        ({"nu_LN": 9.0}, r"not positive definite: .* nu_LN = 9\)"),
        ({"E_N": 4 * 6.91}, r"nu_TT = 0.95 must lie in \(-0.5, 0.5\)"),
        ({"E_N": 0.0}, "E_N = 0 must be a positive number"),
        ({"G_LN": -2.0}, "G_LN = -2 must be a positive number"),
        ({"nu_LT": 2.0}, "not positive definite"),
        ({"nu_LT": math.nan}, "not positive definite"),
        ({"nu_TT": 1.0}, r"nu_TT = 1 must lie in \(-1, 1\)"),
        ({"nu_TT": -1.0}, r"nu_TT = -1 must lie in \(-1, 1\)"),
        ({"nu_TT": math.nan}, "nu_TT = nan"),
        ({"E_L": 0.0}, "E_L = 0 must be a positive number"),
        ({"E_T": -1.0}, "E_T = -1 must be a positive number"),
        ({"G_LT": math.nan}, "G_LT = nan must be a positive number"),
        ({"G_TT": math.inf}, "G_TT = inf must be a positive number"),
        ({"thickness": 0.0}, "thickness = 0 must be a positive number"),
    ],
)
def test_impossible_plies_are_refused_with_the_reason(changed, message) -> None:
    constants = dict(zip(("E_L", "E_T", "G_LT", "G_TT", "nu_LT", "nu_TT"), PAPER, strict=True))
    with pytest.raises(ValueError, match=message):
        Ply(**{**constants, "angle": 0.1, "thickness": 1.0, **changed})


@pytest.mark.parametrize("nu", [0.5, -1.0, 0.7, math.nan, 1e-15 - 1, 0.5 - 1e-15])
def test_impossible_isotropic_plies_are_refused(nu) -> None:
    with pytest.raises(ValueError, match=r"must (lie in|be at least 2e-13 inside) \(-1, 0.5\)"):
        Ply.isotropic(E, nu, H)


MODULI, RATIOS = st.floats(0.5, 50), st.floats(-1.5, 1.5)


@given(moduli=st.tuples(MODULI, MODULI, MODULI), ratios=st.tuples(RATIOS, RATIOS, RATIOS))
def test_a_ply_is_accepted_exactly_when_its_compliance_is_definite(moduli, ratios) -> None:
    (E_L, E_T, E_N), (nu_LT, nu_LN, nu_TN) = moduli, ratios
    normal = np.array([[1 / E_L, -nu_LT / E_L, -nu_LN / E_L], [0, 1 / E_T, -nu_TN / E_T], [0, 0, 1 / E_N]])
    smallest = np.linalg.eigvalsh(np.triu(normal, 1).T + normal).min()
    assume(abs(smallest) >= 1e-9)  # on the border rounding decides
    try:
        Ply(E_L, E_T, 1.0, 1.0, nu_LT, nu_TN, 0.0, 1.0, E_N, 1.0, nu_LN)
    except ValueError:
        assert smallest < 0
    else:
        assert smallest > 0


def test_an_isotropic_ply_comes_close_to_both_of_its_limits() -> None:
    """Twice the shear modulus, and three times the bulk modulus, as nu comes to -1 and to 1/2."""
    for nu in (1e-9 - 1, 1e-12 - 1, 0.5 - 1e-9, 0.5 - 1e-12):
        rounding = 10 * np.finfo(float).eps / min(1 + nu, 0.5 - nu)
        values = np.linalg.eigvalsh(Ply.isotropic(1.0, nu, 1.0).stiffness()[np.ix_([0, 1, 3], [0, 1, 3])])
        assert values == pytest.approx(sorted([1 / (1 - 2 * nu), *[1 / (1 + nu)] * 2]), rel=rounding)


def test_unknown_section_is_refused_with_the_choices() -> None:
    with pytest.raises(ValueError, match="'plain' is not one of " + ", ".join(SECTIONS)):
        stacked().stiffness("plain")


@section_of_each_kind
def test_stresses_have_the_resultants_of_the_section(section: str) -> None:
    """In shell axes and integrated over the wall they are D E in the plane: linear in each ply, Simpson is exact."""
    laminate = Laminate((Ply(*PAPER, 0.7, 0.3), Ply.isotropic(E, 0.3, 0.2), Ply(*PAPER, -0.4, 0.5)), -0.4)
    strains = np.random.default_rng(2).standard_normal((4, 11))
    actual = laminate.stresses(strains, section)
    resultants, bottom = np.zeros((4, 3, 2)), 0.0
    for k, ply in enumerate(laminate.plies):
        c, s = math.cos(ply.angle), math.sin(ply.angle)
        to_axes = np.array([[c * c, s * s, -2 * c * s], [s * s, c * c, 2 * c * s], [c * s, -c * s, c * c - s * s]])
        sides = actual[:, k] @ to_axes.T
        for at, weight in ((0.0, 1 / 6), (0.5, 4 / 6), (1.0, 1 / 6)):
            upper = (bottom + at * ply.thickness) / laminate.thickness
            stress = (1 - at) * sides[:, 0] + at * sides[:, 1]
            resultants += weight * ply.thickness * stress[:, :, None] * np.array([1 - upper, upper])
        bottom += ply.thickness
    np.testing.assert_allclose(resultants.reshape(4, 6), (strains @ laminate.stiffness(section).T)[:, :6], rtol=1e-11)


def test_a_stiffness_that_is_changed_is_nobody_elses() -> None:
    """It is integrated once a laminate and section."""
    laminate = Laminate.single(Ply.isotropic(100.0, 0.3, 1.0))
    before = laminate.stiffness("full-3d").copy()
    laminate.stiffness("full-3d")[:] = 0.0
    np.testing.assert_array_equal(laminate.stiffness("full-3d"), before)
    assert np.any(laminate.stiffness() != before)
