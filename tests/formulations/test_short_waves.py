"""The acoustic tensor of a shell against closed forms, second differences of its energy, and what grids make of it.

What the strains of recovered displacements say of the error of an element.

Couples that follow the director: moment, no net force, derivative, and a strip bent to a circle.
"""

from dataclasses import replace

import numpy as np
import pytest

from formulations.discretisation import Discretisation
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, torus
from formulations.loads import Couples
from formulations.recovery import PARTS, energy_products
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.short_waves import acoustic_tensors, short_waves
from formulations.strains.catalogue import MEASURES
from support.problems.differences import central_difference
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell

E, H = 6.0, 2.0  # MPa, mm
G = E / 2  # nu = 0


def strip(n: int, length: float = H) -> ShellModel:
    """A plate of n elements along its length, one unit wide, all of its edges held."""
    grid = Grid.tensor(np.linspace(0.0, length, n + 1), np.array([0.0, 1.0]))
    fixed = np.ones((grid.n_nodes, 6), bool)
    inside = (grid.nodes[:, 0] > 1e-9) & (grid.nodes[:, 0] < length - 1e-9)
    fixed[inside] = [False, False, True, True, False, False]  # plane strain
    laminate = Laminate.single(Ply.isotropic(E, 0.0, H))
    discretisation = Discretisation.build(Plate(), grid, laminate, fixed)
    return ShellModel(discretisation, MEASURES["exact"], thickness_strain="balanced")


def compressed(shell: ShellModel, stretch: float) -> tuple[ShellModel, np.ndarray]:
    """The plate with its ends brought together, and the displacements of a homogeneous state."""
    v = np.zeros((shell.discretisation.grid.n_nodes, 6))
    v[:, :2] = (stretch - 1) * shell.discretisation.grid.nodes[:, :1]
    held = shell.discretisation.map.held
    prescribed = np.where(held, v, 0.0)
    fields = ("discretisation", "measure", "section", "newton", "thickness_strain", "membrane")
    moved = ShellModel(**{name: getattr(shell, name) for name in fields}, prescribed=prescribed)
    return moved, moved.discretisation.map.restrict(v)


@pytest.mark.parametrize("stretch", [1.0, 1.1, 0.9, np.sqrt(2 / 3)])
def test_a_plate_under_uniform_strain(stretch: float) -> None:
    """The faces move apart and together: G h/6 of the linear part of the shear, and half of the resultant E h E11.

    At E11 = -G/(3 E) = -1/6 the plate loses its ellipticity.
    """
    shell, u = compressed(strip(3), stretch)
    actual = short_waves(shell, u)
    strain = (stretch**2 - 1) / 2
    along_1 = H * (G / 6 + E * strain / 2)
    np.testing.assert_allclose(actual.least, min(along_1, H * G / 6), rtol=1e-9, atol=1e-12)
    if strain < 0:
        np.testing.assert_allclose(actual.angle, 0.0)
        np.testing.assert_allclose(actual.amplitude[:, ::2], -actual.amplitude[:, 1::2], atol=1e-9)


def negative(n: int, strain: float) -> int:
    shell, u = compressed(strip(n), np.sqrt(1 + 2 * strain))
    return int(np.sum(np.linalg.eigvalsh(shell.linearise(u).tangent.toarray()) < 0))


def test_finer_grids_buckle_earlier_only_where_ellipticity_is_lost() -> None:
    """A block as long as it is thick: before E11 = -1/6 no grid buckles it; behind it each that is fine enough does."""
    assert [negative(n, -0.15) for n in (4, 16, 64)] == [0, 0, 0]
    assert negative(4, -0.17) == 0 < negative(64, -0.17)
    counts = [negative(n, -0.20) for n in (4, 8, 16, 32)]
    assert np.all(np.divide(counts[1:], counts[:-1]) > 2)  # the finer, the more


def patch_of_torus(measure: str, n: int, size: float) -> ShellModel:
    grid = Grid.tensor(np.linspace(0.4, 0.4 + size, n + 1), np.linspace(0.0, 0.2 * size, n + 1))
    laminate = Laminate(tuple(Ply(20.0, 7.0, 2.3, 1.8, 0.4, 0.5, angle, 1.2) for angle in (0.9, -0.9)), 0.0)
    free = np.zeros((grid.n_nodes, 6), bool)
    return ShellModel(Discretisation.build(torus(200.0, 50.0), grid, laminate, free), MEASURES[measure])


@pytest.mark.parametrize("measure", ["exact", "von-karman"])
@pytest.mark.parametrize(
    "angle", [pytest.param(0.0, marks=pytest.mark.slow), 0.6, pytest.param(2.0, marks=pytest.mark.slow)]
)
def test_the_tensor_by_second_differences_of_the_energy(measure: str, angle: float) -> None:
    """Waves of any amplitude on a small strained patch: their energy per area is k^2/4 a.A a in the mean.

    The elements interpolate them linearly: of second order.
    """
    rng = np.random.default_rng(5)
    size, waves, step = 0.006, 2, 1e-7
    strained, a = 0.05 * rng.normal(size=(2, 6)), rng.normal(size=6)
    errors = []
    for n in (24, 48):
        shell = patch_of_torus(measure, n, size)
        own = shell.discretisation
        grid, lengths = own.grid, np.array([50.0, 200.0 + 50.0 * np.cos(0.4 + size / 2)])
        s = lengths * (grid.nodes - grid.centre.mean(axis=0))
        base = own.map.restrict(s @ strained)
        (A,) = acoustic_tensors(shell, base, np.array([angle]))
        k = 2 * np.pi * waves / (50.0 * size)
        energies = []
        for shift in (0.0, np.pi / 2):  # cos^2 + sin^2: no mean of what is mixed is left
            wave = step * np.cos(k * s @ [np.cos(angle), np.sin(angle)] + shift)[:, None] * a
            values = [shell.energy(own.map.restrict(s @ strained + sign * wave)) for sign in (-1, 0, 1)]
            energies.append((values[0] - 2 * values[1] + values[2]) / step**2)
        expected = k**2 * float(own.geometry.weight @ (A @ a @ a))
        errors.append(sum(energies) / expected - 1)
    assert abs(errors[1]) < 0.05
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)


def test_stress_at_rest_counts_as_that_of_strains() -> None:
    """Resultants change the tensor by the same whether strains make them or they have been there before."""
    shell = patch_of_torus("exact", 2, 0.006)
    own, angles, rng = shell.discretisation, np.array([0.6]), np.random.default_rng(5)
    stress = rng.normal(size=11)

    def change(u: np.ndarray) -> np.ndarray:
        (without,), (with_it,) = (
            list(acoustic_tensors(replace(shell, initial=each), u, angles)) for each in (None, stress)
        )
        return with_it - without

    at_rest, strained = (change(size * rng.normal(size=own.n_free)) for size in (0.0, 1e-6))
    assert np.abs(at_rest).max() > 0.01
    np.testing.assert_allclose(strained, at_rest, rtol=0, atol=1e-9 * np.abs(at_rest).max())


def test_the_parts_of_an_element_make_its_area(rng) -> None:
    """A field that is the same in all parts has the energy of the element."""
    patch = next(iter(PATCHES.values()))
    shell = make_shell(patch.surface, patch.grid(2, 3))
    d, D = rng.normal(size=(6, 11)), SKEW_LAMINATE.stiffness(shell.section)
    actual = energy_products(shell, *[np.repeat(d[:, None], PARTS, axis=1)] * 2)
    np.testing.assert_allclose(actual, shell.discretisation.geometry.weight * np.einsum("ei,ij,ej->e", d, D, d))


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
