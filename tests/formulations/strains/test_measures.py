"""Strain measures at points of every surface: homogeneous deformations, rigid motions, derivatives, bad tables.

The displacement field u(x) = (F - I) x + c is given in space. Its local components on both faces are differentiated
numerically and sent through the displacement-gradient quantities, so that geometry, quantities and measure are tested
together against F alone.
"""

import math
from fractions import Fraction

import numpy as np
import pytest

from formulations.geometry.surfaces import Plate, cylinder, sphere, torus
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import (
    EXACT_LAW,
    QuadraticMeasure,
    quadratic_measure,
    strain_and_gradient,
    through_thickness,
)
from formulations.strains.quantities import (
    FULL,
    N_E,
    N_Q,
    QUANTITIES,
    STRAINS,
    Kinematics,
    gradient_coefficients,
    shear_row_factors,
)
from support.problems.differences import central_difference, rotation
from support.problems.shells import PATCHES

STEP = 0.015  # of the 8th-order differences, see the tests of the surfaces
RIGID = 1e-12  # the acceptance of THEORY for the exact measure
ROUNDING = 1e-12  # of quantities of size 1 after numerical differentiation
THICKNESSES = {"symmetric": (-0.1, 0.1), "asymmetric": (-0.04, 0.16), "outside": (0.0, 0.2), "thin": (-5e-3, 2e-3)}
SHEARS = {"2E13": 0, "2E23": 1}

AT = dict.fromkeys([*((name, "asymmetric") for name in PATCHES), *(("wavy", d) for d in THICKNESSES)])

# all thicknesses on the patch where nothing is constant, one of them on every patch
everywhere = pytest.mark.parametrize(
    ("patch", "d"), [pytest.param(PATCHES[name], THICKNESSES[d], id=f"{name}-{d}") for name, d in AT]
)
each_measure = pytest.mark.parametrize("measure", MEASURES.values(), ids=MEASURES)


@pytest.fixture
def quantities(patch, rng):
    """q (n, 15), row factors (n, 11) and frames (n, 3, 3) of u(x) = (F - I) x + c at random points of the patch."""
    a1, a2 = patch.points(rng, 6)

    def of(F: np.ndarray, c: np.ndarray, d: tuple[float, float], kinematics: Kinematics = FULL):
        def components(b1, b2):
            x, frame = patch.surface.position(b1, b2), patch.surface.frame(b1, b2)
            v = np.empty((len(x), 6))
            for face in (0, 1):
                u = (x + d[face] * frame[:, 2]) @ (F - np.eye(3)).T + c
                v[:, face::2] = np.einsum("nij,nj->ni", frame, u)
            return v

        geometry = patch.surface.geometry(a1, a2)
        values = (
            components(a1, a2),
            central_difference(lambda t: components(a1 + t, a2), STEP),
            central_difference(lambda t: components(a1, a2 + t), STEP),
        )
        coefficients = gradient_coefficients(geometry, *d, kinematics)
        q = sum(np.einsum("nqv,nv->nq", C, v) for C, v in zip(coefficients, values, strict=True))
        return q, shear_row_factors(geometry, *d, kinematics), patch.surface.frame(a1, a2)

    of.points = (a1, a2)
    return of


def local_strains(tensor: np.ndarray, frame: np.ndarray, k: np.ndarray, d: tuple[float, float]) -> np.ndarray:
    """The 11 strains of a constant symmetric tensor: components, doubled shears, 2E_a3 times zeta_a/zbar_a."""
    T = np.einsum("nix,xy,njy->nij", frame, tensor, frame)
    strains = np.empty((len(T), N_E))
    for row, name in enumerate(STRAINS):
        doubled = 2.0 if name.startswith("2") else 1.0
        i, j = (int(digit) - 1 for digit in name.rstrip("+-")[-2:])
        strains[:, row] = doubled * T[:, i, j]
        if name[:-1] in SHEARS:
            a, face = SHEARS[name[:-1]], "-+".index(name[-1])
            strains[:, row] *= (1 + k[:, a] * d[face]) / (1 + k[:, a] * (d[0] + d[1]) / 2)
    return strains


def random_rotations(rng, n: int) -> list[np.ndarray]:
    """Rotations about random axes by angles up to pi, and one by pi itself."""
    angles = [*rng.uniform(0.1, math.pi, n - 1), math.pi]
    return [rotation(rng.normal(size=3), angle) for angle in angles]


@everywhere
def test_exact_measures_vanish_under_rigid_motions(quantities, rng, d) -> None:
    for R in random_rotations(rng, 5):
        q, factors, _ = quantities(R, rng.normal(size=3), d)
        for name in ("exact", "elongation"):
            assert np.max(np.abs(MEASURES[name].strain(q) * factors)) <= RIGID, name


@everywhere
def test_exact_measure_is_green_lagrange(patch, quantities, rng, d) -> None:
    F = np.eye(3) + 0.5 * rng.normal(size=(3, 3))
    q, factors, frame = quantities(F, rng.normal(size=3), d)
    k = patch.surface.geometry(*quantities.points).k
    expected = local_strains((F.T @ F - np.eye(3)) / 2, frame, k, d)
    np.testing.assert_allclose(MEASURES["exact"].strain(q) * factors, expected, rtol=0, atol=5 * ROUNDING)


@everywhere
def test_linear_measure_is_the_symmetric_gradient(patch, quantities, rng, d) -> None:
    F = np.eye(3) + 0.5 * rng.normal(size=(3, 3))
    q, factors, frame = quantities(F, rng.normal(size=3), d)
    k = patch.surface.geometry(*quantities.points).k
    expected = local_strains((F + F.T) / 2 - np.eye(3), frame, k, d)
    np.testing.assert_allclose(MEASURES["linear"].strain(q) * factors, expected, rtol=0, atol=5 * ROUNDING)


THETAS = [0.3, 1.7, math.pi, 5.0, 2 * math.pi]


def residual_strain(measure, surface, point, R, c, d) -> np.ndarray:
    """The 11 strains that the motion x -> R x + c of a surface leaves at one point."""
    a1, a2 = (np.array([value]) for value in point)

    def components(b1, b2):
        x, frame = surface.position(b1, b2), surface.frame(b1, b2)
        v = np.empty((1, 6))
        for face in (0, 1):
            y = x + d[face] * frame[:, 2]
            v[:, face::2] = np.einsum("nij,nj->ni", frame, y @ (R - np.eye(3)).T + c)
        return v

    values = (
        components(a1, a2),
        central_difference(lambda t: components(a1 + t, a2), STEP),
        central_difference(lambda t: components(a1, a2 + t), STEP),
    )
    geometry = surface.geometry(a1, a2)
    coefficients = gradient_coefficients(geometry, *d, measure.kinematics)
    q = sum(np.einsum("nqv,nv->nq", C, v) for C, v in zip(coefficients, values, strict=True))
    return (measure.strain(q) * shear_row_factors(geometry, *d, measure.kinematics))[0]


@each_measure
def test_law_of_a_plate_under_rotation(measure) -> None:
    law, d, point, still = measure.rigid_body_law, (-0.04, 0.16), (0.3, -0.2), np.zeros(3)
    for theta in THETAS:
        for a, axis in ((0, [0, 1, 0]), (1, [1, 0, 0])):
            E = residual_strain(measure, Plate(), point, rotation(np.array(axis), theta), still, d)
            np.testing.assert_allclose(E[2 * a : 2 * a + 2], law.out_of_plane(theta, 1.0), rtol=0, atol=ROUNDING)
        E = residual_strain(measure, Plate(), point, rotation(np.array([0, 0, 1.0]), theta), still, d)
        np.testing.assert_allclose(E[:4], law.drilling(theta, 1.0), rtol=0, atol=ROUNDING)


@each_measure
def test_law_of_a_cylinder_turned_about_its_axis(measure) -> None:
    R, d = 2.0, (-0.1, 0.3)
    for theta in THETAS:
        turn = rotation(np.array([0, 0, 1.0]), theta)
        E = residual_strain(measure, cylinder(R), (0.4, 0.7), turn, np.zeros(3), d)
        expected = [measure.rigid_body_law.axis(theta, 1 + offset / R) for offset in d]
        np.testing.assert_allclose(E[2:4], expected, rtol=0, atol=ROUNDING)


@each_measure
def test_law_of_a_translated_cylinder(measure) -> None:
    R, U, phi, d = 2.0, 0.6, 0.7, (-0.1, 0.3)
    c = U * np.array([1.0, 0, 0])
    E = residual_strain(measure, cylinder(R), (0.4, phi), np.eye(3), c, d)
    amount = -U * np.sin(phi) / R
    expected = [measure.rigid_body_law.translation(amount, 1 + offset / R) for offset in d]
    np.testing.assert_allclose(E[2:4], expected, rtol=0, atol=ROUNDING)


@each_measure
def test_only_a_shallow_measure_strains_under_translation(measure, rng) -> None:
    for surface in (cylinder(2.0), sphere(1.5), torus(3.0, 1.0)):
        E = residual_strain(measure, surface, (0.4, 0.7), np.eye(3), rng.normal(size=3), (-0.1, 0.3))
        assert (np.max(np.abs(E)) > 1e-3) if measure.kinematics.shallow else (np.max(np.abs(E)) <= RIGID)


@each_measure
def test_derivatives_agree_with_differences(measure, rng) -> None:
    q, dq, H = rng.normal(size=(4, N_Q)), rng.normal(size=(4, N_Q)), rng.normal(size=(4, N_E))
    if not isinstance(measure, QuadraticMeasure):  # stretches must stay positive, and differences are not exact
        q, dq = 0.05 * q, 0.05 * dq
    slope = central_difference(lambda t: measure.strain(q + t * dq), 0.1)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", measure.gradient(q), dq), slope, rtol=0, atol=10 * ROUNDING)
    turning = central_difference(lambda t: np.einsum("nij,ni->nj", measure.gradient(q + t * dq), H), 0.1)
    contracted = measure.contract(q, H)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", contracted, dq), turning, rtol=0, atol=10 * ROUNDING)
    np.testing.assert_allclose(contracted, contracted.swapaxes(1, 2), rtol=0, atol=ROUNDING)


@each_measure
def test_thickness_strain_of_a_node_is_that_of_a_gradient_that_is_beta_alone(measure, rng) -> None:
    beta, H = 0.1 * rng.normal(size=(3, 4, 3)), rng.normal(size=(3, 4, 1))
    q, resultants = np.zeros((3, 4, N_Q)), np.zeros((3, 4, N_E))
    q[..., [QUANTITIES.index(f"beta{i}") for i in (1, 2, 3)]] = beta
    resultants[..., STRAINS.index("E33")] = H[..., 0]
    through = through_thickness(measure)
    for own, whole in (
        (through.strain(beta), measure.strain(q)[..., -1:]),
        (through.gradient(beta), measure.gradient(q)[..., -1:, -3:]),
        (through.contract(beta, H), measure.contract(q, resultants)[..., -3:, -3:]),
    ):
        np.testing.assert_allclose(own, whole, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("size", [1.0, 1e-9])
def test_change_of_strain_from_a_start_loses_no_digits(size, rng) -> None:
    """Against L q + start Q q + 1/2 q Q q in exact fractions: an offset of size 1, and a q that may be far smaller."""
    exact, start, q = MEASURES["exact"], rng.normal(size=N_Q), size * rng.normal(size=N_Q)
    change, gradient = strain_and_gradient(exact, q, start)
    np.testing.assert_array_equal(gradient, exact.gradient(start + q))
    L, Q, at, dq = (np.vectorize(Fraction, otypes=[object])(x) for x in (exact.linear, exact.quadratic, start, q))
    expected = L @ dq + Q @ dq @ at + Q @ dq @ dq / 2
    known, _ = strain_and_gradient(exact, q, start, exact.gradient(start))
    for actual in (change, known):
        np.testing.assert_allclose(actual, expected.astype(float), rtol=0, atol=ROUNDING * size)


@each_measure
def test_catalogue_entry_is_complete(measure) -> None:
    assert MEASURES[measure.name] is measure
    assert measure.reference
    assert measure.rigid_body_law.axis(0.0, 1.1) == 0.0
    assert np.all(measure.strain(np.zeros(N_Q)) == 0.0)


@pytest.mark.parametrize(
    ("terms", "message"),
    [
        ({"E13": {"l1": 1}}, "trial: unknown strain 'E13'"),
        ({"E11-": {"l1": 1}}, "trial: unknown strain 'E11-'"),
        ({"E11": {"l3": 1}}, "trial: unknown quantity 'l3'"),
        ({"E11": {"l1 w9": 1}}, "trial: unknown quantity 'w9'"),
        ({"E11": {"l1 l1 l1": 1}}, "trial: 'l1 l1 l1' is not a monomial"),
        ({"E11": {"": 1}}, "trial: '' is not a monomial"),
    ],
)
def test_bad_tables_are_refused_by_name(terms, message) -> None:
    with pytest.raises(ValueError, match=message):
        quadratic_measure("trial", terms, reference="none", rigid_body_law=EXACT_LAW)


def test_tables_are_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        MEASURES["exact"].quadratic[0, 0, 0] = 1.0
