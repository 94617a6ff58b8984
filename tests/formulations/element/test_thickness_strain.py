"""The moment of one thin element whose directors turn, to the third order of the angle: what each share of E33 costs.

Derived for a thin strip. Directors have the length L at the nodes and turn by phi on top of the angle phi0 at rest;
interpolated linearly they are shorter between the nodes, L^2 (1 - sin^2(angle/2) (1 - xi^2)), where ``angle`` is phi
for components in the rotating frame (curvilinear) and phi0 + phi for Cartesian ones (isoparametric). The mean of E33
vanishes: L^2 = 1 + (1 - s)/6 phi^2, or (1 - s)/6 ((phi0 + phi)^2 - phi0^2). The change of curvature is
2 L sin(phi/2) + phi0 (L cos(phi/2) - 1), or (2 L sin((phi0 + phi)/2) - 2 sin(phi0/2)) times the chord over the arc; the
moment is D/2l times the derivative of its square.

Initial resultants H0: balance at rest, dead forces, their work on a slope, a membrane, the plate that buckles.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from formulations.conditions.boundary import Supports
from formulations.discretisation import Discretisation
from formulations.element.mixed import THICKNESS_STRAINS, MixedElement
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate, cylinder
from formulations.loads import Couples
from formulations.section.laminate import Laminate, Ply
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from formulations.strains.quantities import N_E
from support.problems.differences import fitted_order, rotation
from support.problems.shells import PATCHES, SKEW_LAMINATE, make_shell, newton, nodal_components

E, H = 1e6, 1e-3  # MPa, mm; nu = 0, the element is 1 mm long
MOMENTS = np.array([-0.3, -0.2, -0.1, 0.1, 0.2, 0.3])  # M l/D
HIGHER = 1e-3  # of a coefficient: the next ones are of the order phi0^2


def turned(moment: float, phi0: float, interpolation: str, thickness_strain: str, bending: str = "chord") -> float:
    """The angle phi by which end couples bend one element further; phi0 = 0: a plate."""
    side = phi0 or 1.0
    grid = Grid.tensor(np.array([0.0, 1.0]), np.array([0.0, side]))
    start, end = grid.on_line(1, 0.0), grid.on_line(1, side)
    supports = Supports.none(grid).hold(np.arange(4), (0,)).symmetric(start, 1).hinged(start, (2,))
    surface, strip = cylinder(1 / phi0) if phi0 else Plate(), Laminate.single(Ply.isotropic(E, 0.0, H))
    shell = Discretisation.build(surface, grid, strip, *supports.masks, interpolation=interpolation)
    couples = Couples(end, np.full(2, moment * E * H**3 / 24), np.tile([-1.0, 0.0, 0.0], (2, 1)), H)
    model = ShellModel(
        shell,
        MEASURES["exact"],
        newton="mixed",
        couples=couples,
        thickness_strain=thickness_strain,
        membrane="relaxed",
        bending=bending,
    )
    u = np.zeros(shell.n_free)
    for part in (0.5, 1.0):
        u = newton(model.scaled(part), u, within=1e-11)
    v = shell.expand(u)[end[0]]
    return math.atan2((v[3] - v[2]) / H, 1 + (v[5] - v[4]) / H)


@pytest.mark.parametrize("thickness_strain", THICKNESS_STRAINS)
@pytest.mark.parametrize("phi0", [0.0, 0.1])
@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_moment_of_an_element_to_the_third_order(interpolation, phi0, thickness_strain) -> None:
    """Half at the nodes is what cancels phi^3, in flat and in curved elements."""
    s = THICKNESS_STRAINS[thickness_strain]
    phi = np.array([turned(moment, phi0, interpolation, thickness_strain) for moment in MOMENTS])
    sign = np.sign(phi @ MOMENTS)  # of the sense of the couples
    actual = np.linalg.lstsq(np.stack([phi**k for k in range(1, 6)], axis=1), sign * MOMENTS, rcond=None)[0][:3]
    if interpolation == "curvilinear":
        expected = [1.0, -(1 + 2 * s) / 8 * phi0, 1 / 6 - s / 3]
    else:
        expected = [1 - s / 3 * phi0**2, 3 / 8 * (1 - 2 * s) * phi0, 1 / 6 - s / 3]
    assert actual == pytest.approx(expected, abs=HIGHER)
    assert abs(actual[2]) <= HIGHER or thickness_strain != "balanced"


@pytest.mark.parametrize("phi0", [0.0, 0.1])
@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_the_moment_of_an_arc_is_linear_in_its_angle(interpolation, phi0) -> None:
    """In a flat element up to 2 rad, but for (h/l)^2; to the third order in a curved one."""
    moments = np.append(MOMENTS, [1.0, 2.0] if phi0 == 0 else [])
    phi = np.array([turned(moment, phi0, interpolation, "nodal", "arc") for moment in moments])
    sign = np.sign(phi @ moments)  # of the sense of the couples
    assert sign * phi == pytest.approx(moments, rel=1e-3 if phi0 else 1e-5)


def folded(shell: ShellModel, u: np.ndarray) -> float:
    """The largest angle of the chords of an element."""
    element, E = shell._element, MixedElement.mode_strains(shell._element, *at_elements(shell, u))
    return float(np.abs(element.slenderness * (E[:, [1, 3]] - E[:, [0, 2]])).max())


def at_elements(shell: ShellModel, u: np.ndarray) -> tuple[object, np.ndarray]:
    return shell.discretisation.geometry, shell._element_vectors(u)


@pytest.mark.parametrize(("size", "least", "most"), [(0.06, 0.5, 1.9), (0.3, 1.9, np.inf)])
@pytest.mark.parametrize("interpolation", ["curvilinear", "isoparametric"])
def test_tangent_and_energy_of_arcs(rng, interpolation, size, least, most) -> None:
    """Up to the edge and beyond it; what is remembered of a step is what the law predicts."""
    patch, options = PATCHES["wavy"], {"thickness_strain": "nodal", "membrane": "relaxed", "bending": "arc"}
    shell = make_shell(patch.surface, patch.grid(3, 2), interpolation=interpolation, newton="plain", **options)
    u, du = size * rng.normal(size=(2, shell.discretisation.n_free))
    assert least < folded(shell, u) < most
    exact, t = shell.linearise(u).tangent @ du, 1e-5
    slope = (shell.residual(u + t * du) - shell.residual(u - t * du)) / (2 * t)
    assert slope == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    rise = (shell.energy(u + t * du) - shell.energy(u - t * du)) / (2 * t)
    assert rise == pytest.approx(shell.residual(u) @ du, rel=1e-6)
    mixed, near = replace(shell, newton="mixed"), 1e-3 * du
    steps = 2.0 ** -np.arange(5)
    errors = [np.abs(mixed.linearise(u).remember(s * near) - mixed.resultants(u + s * near)).max() for s in steps]
    assert fitted_order(steps, errors) >= 1.9


def test_strains_and_resultants_that_are_read_are_those_of_arcs(rng) -> None:
    """One is D times the other, as in fields and stresses of plies."""
    shell = make_shell(Plate(), PATCHES["plate"].grid(2, 2), thickness_strain="nodal", bending="arc")
    u = 0.1 * rng.normal(size=shell.discretisation.n_free)
    D = shell.discretisation.laminate.stiffness(shell.section)
    assert shell.mean_strains(u) @ D.T == pytest.approx(shell.mean_resultants(u), rel=1e-9)
    assert shell.gauss_strains(u).mean(axis=1) == pytest.approx(shell.mean_strains(u), abs=1e-14)


def test_arcs_need_directors_at_the_nodes_two_faces_and_lines_of_curvature() -> None:
    with pytest.raises(ValueError, match="need thickness strain nodal, got balanced"):
        turned(0.1, 0.0, "curvilinear", "balanced", "arc")
    with pytest.raises(ValueError, match="need lines of curvature"):
        turned(0.1, 0.0, "quads", "nodal", "arc")
    with pytest.raises(ValueError, match="bending 'bow' is not one of chord, arc"):
        turned(0.1, 0.0, "curvilinear", "nodal", "bow")
    grid, options = Grid.tensor([0.0, 1.0], [0.0, 1.0]), {"thickness_strain": "nodal", "bending": "arc"}
    with pytest.raises(ValueError, match="which measure donnell neglects"):
        make_shell(Plate(), grid, measure="donnell", **options)
    strip, free = Laminate.single(Ply.isotropic(E, 0.0, H)), np.zeros((4, 6), bool)
    body = Discretisation.build(Plate(), grid, strip, free, surfaces="3")
    with pytest.raises(ValueError, match="surfaces between them"):
        ShellModel(body, MEASURES["exact"], **options)


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
