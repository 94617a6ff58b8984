"""The laws against energies written another way, closed forms of one-dimensional states, and each other."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import logm
from scipy.optimize import brentq

from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS, OURS, Corded, NeoHooke, StVenantKirchhoff
from formulations.section.material import VOIGT, Divided, Law, lame_constants, tensor
from formulations.solid import SolidDiscretisation
from formulations.solid_mesh import SolidMesh
from support.problems.differences import central_difference, fitted_order, rotation

E, NU = 4.07, 0.48
PLY = Ply.isotropic(E, NU, 1.0)
SKEW = Ply(30.0, 8.0, 4.0, 3.0, 0.3, 0.4, 0.6, 0.11)
CORDS = Ply(510.45, 6.91, 2.33, 1.77, 0.46, 0.95, 0.9, 1.2)  # of the tyre
LAM, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
ONCE = np.array([1.0 if i == j else 2.0 for i, j in VOIGT])
Energy = Callable[[np.ndarray], float]  # of C (3, 3)


def _svk(C: np.ndarray) -> float:
    green = 0.5 * (C - np.eye(3))
    return float(LAM / 2 * np.trace(green) ** 2 + MU * np.trace(green @ green))


def _hencky(C: np.ndarray) -> float:
    H = 0.5 * logm(C).real
    return float(LAM / 2 * np.trace(H) ** 2 + MU * np.trace(H @ H))


def _neo_hooke(C: np.ndarray) -> float:
    J = np.sqrt(np.linalg.det(C))
    return float(MU / 2 * (np.trace(C) - 3) - MU * np.log(J) + LAM / 2 * np.log(J) ** 2)


def _isochoric(C: np.ndarray, terms: tuple[tuple[float, float], ...]) -> float:
    """Of the eigenvalues of C, with the bulk modulus of the ply."""
    J = np.sqrt(np.linalg.det(C))
    stretches = np.sqrt(np.linalg.eigvalsh(C)) / J ** (1 / 3)
    share = 2 * MU / sum(m * a for m, a in terms)
    bulk = (LAM + 2 * MU / 3) / 4 * (J**2 - 1 - 2 * np.log(J))
    return float(sum(share * m / a * (np.sum(stretches**a) - 3) for m, a in terms) + bulk)


def _mooney_rivlin(C: np.ndarray) -> float:
    J = np.sqrt(np.linalg.det(C))
    first, second = np.trace(C), 0.5 * (np.trace(C) ** 2 - np.trace(C @ C))
    c1, c2 = 0.4 * MU, 0.1 * MU
    bulk = (LAM + 2 * MU / 3) / 4 * (J**2 - 1 - 2 * np.log(J))
    return float(c1 * (first / J ** (2 / 3) - 3) + c2 * (second / J ** (4 / 3) - 3) + bulk)


ENERGIES: dict[str, Energy] = {
    "svk": _svk,
    "hencky": _hencky,
    "neo-hooke": _neo_hooke,
    "mooney-rivlin": _mooney_rivlin,
    "ogden": lambda C: _isochoric(C, ((6.3, 1.3), (0.012, 5.0), (-0.1, -2.0))),
}
every_law = pytest.mark.parametrize("name", LAWS)
other_laws = pytest.mark.parametrize("name", [name for name in LAWS if name != "svk"])


def test_the_names_of_the_laws_are_known_before_they_are_loaded() -> None:
    assert list(LAWS) == list(OURS)


def green(F: np.ndarray) -> np.ndarray:
    """E (..., 6) with engineering shears."""
    full = 0.5 * (F.swapaxes(-1, -2) @ F - np.eye(3))
    return np.stack([full[..., i, j] for i, j in VOIGT], axis=-1) * ONCE


def deformed(rng: np.random.Generator, size: float = 0.25) -> np.ndarray:
    return np.eye(3) + size * rng.uniform(-1, 1, size=(3, 3))


def energy_errors(law: Law, energy: Energy, F: np.ndarray) -> np.ndarray:
    """S less dW/dE by differences of the energy (6,)."""
    strain = green(F)
    at = lambda step, unit: energy(np.eye(3) + 2 * tensor((strain + step * unit) / ONCE))  # noqa: E731
    slopes = [central_difference(lambda t, unit=unit: at(t, unit), 0.002) for unit in np.eye(6)]
    return law.response(strain)[0] - slopes


def tangent_order(law: Law, strain: np.ndarray, direction: np.ndarray) -> float:
    """Order of the central difference of S against the tangent, by steps; linear laws have no error at all."""
    exact, steps = law.response(strain)[1] @ direction, 0.005 * 2.0 ** -np.arange(8)
    ends = [[law.response(strain + sign * t * direction)[0] for sign in (1, -1)] for t in steps]
    errors = [np.linalg.norm((a - b) / (2 * t) - exact) for t, (a, b) in zip(steps, ends, strict=True)]
    return 2.0 if max(errors) <= 1e-12 * np.linalg.norm(exact) else fitted_order(steps, errors)


@every_law
def test_stress_is_the_slope_of_the_energy(rng, name) -> None:
    for _ in range(3):
        law, F = LAWS[name](PLY), deformed(rng)
        assert energy_errors(law, ENERGIES[name], F) == pytest.approx(np.zeros(6), abs=1e-9)
        assert law.energy(green(F)) == pytest.approx(ENERGIES[name](F.T @ F), rel=1e-12)


@every_law
@pytest.mark.parametrize("size", [1e-6, 1e-12])
def test_small_strains_keep_their_digits(rng, name, size) -> None:
    """Energy and stress are those of the stiffness at rest to the order of the strain, not of rounding over it."""
    law, strain, B = LAWS[name](PLY), size * rng.normal(size=(20, 6)), PLY.stiffness()
    stress, _ = law.response(strain)
    within = 30 * size + 1e-13
    assert np.abs(stress - strain @ B).max() <= within * np.abs(strain @ B).max()
    energy = 0.5 * np.sum(strain * (strain @ B), axis=1)
    assert np.abs(law.energy(strain) / energy - 1).max() <= within


@every_law
@pytest.mark.parametrize("equal", [0, 2, 3], ids=["all-differ", "two-equal", "three-equal"])
def test_tangent_is_the_slope_of_the_stress(rng, name, equal) -> None:
    """Principal stretches that coincide are where a formula of differences breaks down."""
    stretch = np.array([1.3, 0.8, 1.1])
    stretch[:equal] = 1.2
    R = rotation(rng.normal(size=3), 1.0)
    law, strain = LAWS[name](PLY), green(np.diag(stretch) @ R)
    assert abs(tangent_order(law, strain, rng.normal(size=6)) - 2) <= 0.02
    tangent = law.response(strain)[1]
    assert pytest.approx(tangent, abs=1e-12 * np.max(np.abs(tangent))) == tangent.T


@every_law
def test_a_law_is_the_sum_of_what_shape_and_volume_cost(rng, name) -> None:
    """At rest what volume costs has one and the same entry for all normal strains."""
    law, strain = LAWS[name](PLY), green(deformed(rng))
    assert isinstance(law, Divided)
    shape, volume = law.divided()
    assert shape.energy(strain) + volume.energy(strain) == pytest.approx(law.energy(strain), rel=1e-12)
    for one, other, whole in zip(*(each.response(strain) for each in (shape, volume, law)), strict=True):
        assert np.abs(one + other - whole).max() <= 1e-12 * np.abs(whole).max()
    at_rest, normal = volume.response(np.zeros(6))[1], np.array([1, 1, 0, 1, 0, 0.0])
    assert np.abs(at_rest - at_rest[0, 0] * np.outer(normal, normal)).max() <= 1e-12 * LAM
    assert at_rest[0, 0] >= LAM * (1 - 1e-12)


def test_any_ply_has_its_own_linear_law(rng) -> None:
    strain = rng.normal(size=(2, 5, 6))
    stress, tangent = StVenantKirchhoff.of(SKEW).response(strain)
    assert np.array_equal(tangent, SKEW.stiffness())
    assert stress == pytest.approx(np.einsum("pq,abq->abp", SKEW.stiffness(), strain))


@other_laws
@pytest.mark.parametrize("ply", [CORDS, SKEW], ids=["cords", "skew"])
def test_a_ply_with_cords_has_its_own_stiffness_and_the_law_of_its_rubber(rng, name, ply) -> None:
    """W less that of St. Venant and Kirchhoff's law is what it is of the rubber alone; S and dS/dE by differences."""
    law, own, strain = LAWS[name](ply), StVenantKirchhoff.of(ply), green(deformed(rng))
    _, at_rest = law.response(np.zeros(6))
    assert at_rest == pytest.approx(own.B, abs=1e-12 * np.abs(own.B).max())
    lam = ply.nu_LT * ply.E_T / (1 - ply.nu_TT - 2 * ply.nu_LT**2 * ply.E_T / ply.E_L)  # contraction along the cords
    across = ply.E_T * (ply.nu_TT + ply.nu_LT**2 * ply.E_T / ply.E_L) / (1 + ply.nu_TT)
    lam, mu = min(lam, lam / ply.nu_LT / ply.E_T * across), min(ply.G_LT, ply.G_TT)
    rubber = Ply.isotropic(mu * (3 * lam + 2 * mu) / (lam + mu), lam / (2 * (lam + mu)), 1.0)
    more = [LAWS[name](rubber).energy(strain), -StVenantKirchhoff.of(rubber).energy(strain), own.energy(strain)]
    assert law.energy(strain) == pytest.approx(sum(more), rel=1e-12)
    energy = lambda C: float(law.energy(ONCE * np.array([0.5 * (C - np.eye(3))[at] for at in VOIGT])))  # noqa: E731
    F = deformed(rng)
    assert energy_errors(law, energy, F) == pytest.approx(np.zeros(6), abs=1e-7)
    assert abs(tangent_order(law, strain, rng.normal(size=6)) - 2) <= 0.02


def test_cords_of_the_tyre_are_stiff_along_themselves_alone() -> None:
    """The constants of the docstring: E_c along the cords, and next to nothing else."""
    law = LAWS["neo-hooke"](replace(CORDS, angle=0.0))
    assert (law.rubber.mu, law.rubber.lam) == pytest.approx((1.77, 71.80), rel=1e-4)
    left = law.cords.B
    assert left[0, 0] == pytest.approx(501.17, rel=1e-4)
    assert np.abs(left[0, 1:]).max() <= 1e-9
    assert left[1, 1] == pytest.approx(4.475, rel=1e-3)
    assert left[2, 2] == left[4, 4] == pytest.approx(0.56)
    assert np.linalg.eigvalsh(left).min() >= -1e-9


def test_rubber_that_would_swell_by_itself_is_refused() -> None:
    with pytest.raises(ValueError, match=r"bulk modulus of -31.* MPa: it must be positive"):
        LAWS["hencky"](replace(CORDS, nu_TT=-0.9))


def test_constants_are_lames() -> None:
    assert lame_constants(PLY) == pytest.approx((LAM, MU), rel=1e-12)


def uniaxial(law: Law, stretch: float) -> float:
    """S_11 [MPa] of a bar at this stretch, free to contract."""

    def sideways(across: float) -> float:
        return float(law.response(green(np.diag([stretch, across, across])))[0][1])

    across = brentq(sideways, 0.5, 1.6, xtol=1e-15, rtol=1e-14)
    return float(law.response(green(np.diag([stretch, across, across])))[0][0])


@pytest.mark.parametrize(
    ("name", "k"), [("svk", 0.0), ("hencky", 3.0), ("neo-hooke", 2 + NU * (1 + 2 * NU**2) / (1 + NU))]
)
def test_laws_differ_by_the_square_of_the_strain(name, k) -> None:
    """k of S = E (E_11 - k E_11^2), as the docstring of the laws has it."""
    ends = [uniaxial(LAWS[name](PLY), np.sqrt(1 + 2 * strain)) / E for strain in (1e-3, -1e-3)]
    assert -0.5 * sum(ends) / 1e-6 == pytest.approx(k, abs=2e-4)


def test_stretches_of_a_body_are_those_of_its_deformation(rng) -> None:
    laminate = Laminate.single(Ply.isotropic(E, NU, 0.2))
    mesh = SolidMesh.build(cylinder(1.0), np.array([0.0, 0.3]), np.linspace(0, 1.0, 3), laminate)
    body = SolidDiscretisation.build(mesh, laminate, np.zeros((len(mesh.x), 3), bool))
    turn = rotation(rng.normal(size=3), 1.0)
    for factors in ([0.8, 1.1, 1.3], [-0.8, 1.1, 1.3]):
        u = mesh.x @ (turn @ np.diag(factors) - np.eye(3)).T
        assert body.stretches(u) == pytest.approx(np.broadcast_to(factors, (2, 27, 3)), rel=1e-9)


@other_laws
def test_no_volume_has_no_stress(name) -> None:
    """A strain that no deformation has gives NaN, without a warning; the rest of the batch is not touched."""
    law, sound = LAWS[name](PLY), green(np.diag([1.1, 0.9, 1.0]))
    stress, tangent = law.response(np.stack([[-0.6, 0, 0, 0, 0, 0.0], sound]))
    assert np.isnan(stress[0]).any()
    assert stress[1] == pytest.approx(law.response(sound)[0], rel=1e-13, abs=1e-15)
    assert np.all(np.isfinite(tangent[1]))


def test_a_strain_whose_digits_hide_the_volume_has_no_stress() -> None:
    """As an iterate that runs away has: C is singular to the last digit, and nothing is raised."""
    strain = np.where(np.diff(VOIGT, axis=1)[:, 0] == 0, 1e17, 2e17)
    assert np.isnan(NeoHooke.of(PLY).response(strain)[0]).all()


class Plain:
    """Neo-Hooke's law with the three methods that a law must have."""

    def __init__(self, ply: Ply) -> None:
        self._law = NeoHooke.of(ply)

    def energy(self, strain: np.ndarray) -> np.ndarray:
        return self._law.energy(strain)

    def response(self, strain: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self._law.response(strain)


def test_cords_in_rubber_of_a_law_that_is_not_divided(rng) -> None:
    strain = green(deformed(rng))
    whole, plain = Corded.of(NeoHooke.of, SKEW), Corded.of(Plain, SKEW)
    assert isinstance(whole, Divided)
    assert not isinstance(plain, Divided)
    assert plain.energy(strain) == whole.energy(strain)
    for one, other in zip(plain.response(strain), whole.response(strain), strict=True):
        assert np.array_equal(one, other)
