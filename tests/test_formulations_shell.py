"""The element and the shell: potential, residual and tangent, rigid motion, zero-energy modes, mixed Newton, H0."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import null_space, subspace_angles
from scipy.sparse.linalg import spsolve

from formulations.element import MEMBRANES, THICKNESS_STRAINS
from formulations.grid import Grid
from formulations.laminate import SECTIONS, Laminate, Ply
from formulations.loads import Pressure
from formulations.measure import QuadraticMeasure
from formulations.measures import MEASURES
from formulations.quantities import N_E, N_Q
from formulations.shell import NEWTONS
from formulations.surface import Plate

ROUNDING = 1e-12  # relative to the largest entry of the quantity
DIFFERENCE = 1e-10  # relative error of a difference without truncation error
LARGE_STEPS = 2.0 ** -np.arange(4)
SLOPE = 0.01  # half-width of the interval around the slope 2: the truncation error is exactly c t^2
ASYMMETRY = 1e-3  # relative: what counts as really non-symmetric
ELEMENT_ERROR = (1.8, 2.3)  # order of the element's own error under rigid motion
DEFLECTION = 5e-4  # of the tensioned strip, see its test
EULER = 0.01  # bracket around the buckling load
GAP = 1e6  # between the smallest elastic and the largest zero singular value
SYMMETRIC = [section for section in SECTIONS if section != "nonsymmetric"]
INITIAL = np.array([0.9, 1.4, -0.5, 0.8, 0.3, 0.6, 0.2, -0.4, 0.5, 0.1, -0.7])

ELEMENTS = {f"{t}-{m}": {"thickness_strain": t, "membrane": m} for t in THICKNESS_STRAINS for m in MEMBRANES}

each_section = pytest.mark.parametrize("section", SECTIONS)
each_element = pytest.mark.parametrize("element", ELEMENTS.values(), ids=ELEMENTS)

LOADS = {
    "none": {},
    "dead": {"pressure": Pressure(0.7)},
    "follower-mid": {"pressure": Pressure(0.7, follower=True)},
    "follower-face": {"pressure": Pressure(0.7, follower=True, area="face")},
    "initial": {"initial": INITIAL},
    "all": {"pressure": Pressure(-0.4, follower=True, area="face"), "initial": INITIAL},
}

# the exact measure with every section and load; the other measures and element options with all loads at once
MODELS = {
    **{f"{section}-{load}": {"section": section, **LOADS[load]} for section in SECTIONS for load in LOADS},
    **{measure: {"measure": measure, **LOADS["all"]} for measure in MEASURES if measure != "exact"},
    **{name: {**options, **LOADS["all"]} for name, options in ELEMENTS.items()},
}
POTENTIALS = {
    **{section: {"section": section} for section in SYMMETRIC},
    **{measure: {"measure": measure} for measure in MEASURES if measure != "exact"},
    **ELEMENTS,
}


def quadratic(measure: str) -> bool:
    """True unless the strains are linear in the displacements."""
    return bool(np.any(MEASURES[measure].contract(np.zeros(N_Q), np.ones(N_E))))


def amplitude(measure: str) -> float:
    """Size of the displacements [mm]: large, unless the strains need positive stretches and are no polynomials."""
    return 0.1 if isinstance(MEASURES[measure], QuadraticMeasure) else 1e-3


def assert_central_error(errors: np.ndarray, size: float, curved: bool, fitted_order) -> None:
    """Exactly c t^2 where the function is curved, rounding where it is not."""
    if curved:
        assert max(errors) > 1e3 * DIFFERENCE * size  # there is something to fit
        assert abs(fitted_order(LARGE_STEPS, errors) - 2) <= SLOPE
    else:
        assert max(errors) <= DIFFERENCE * size


def largest(array) -> float:
    return float(np.max(np.abs(array)))


@pytest.mark.parametrize("model", POTENTIALS.values(), ids=POTENTIALS)
def test_residual_is_the_gradient_of_the_energy(
    patch, rng, make_shell, central_difference, fitted_order, model
) -> None:
    """With dead pressure and forces, at a large displacement.

    A difference of 8th order has no truncation error for a quadratic measure; that of 2nd order has exactly c t^2.
    """
    grid, measure = patch.grid(2, 3), model.get("measure", "exact")
    forces = rng.normal(size=6 * grid.n_nodes)
    shell = make_shell(patch.surface, grid, pressure=Pressure(0.7, area="face"), forces=forces, **model)
    u, du = amplitude(measure) * rng.normal(size=(2, len(forces)))
    exact = shell.linearise(u).residual @ du
    assert central_difference(lambda t: shell.energy(u + t * du), 0.25) == pytest.approx(exact, rel=DIFFERENCE)
    errors = [abs((shell.energy(u + t * du) - shell.energy(u - t * du)) / (2 * t) - exact) for t in LARGE_STEPS]
    assert_central_error(errors, abs(exact) + shell.energy(u), quadratic(measure), fitted_order)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_tangent_is_the_derivative_of_the_residual(
    patch, rng, make_shell, central_difference, fitted_order, model
) -> None:
    """For every section, follower pressure and initial resultants; without memory mixed and plain tangent are one."""
    measure = model.get("measure", "exact")
    shell = make_shell(patch.surface, patch.grid(2, 3), **model)
    u, du = amplitude(measure) * rng.normal(size=(2, shell.discretisation.n_free))
    exact = shell.linearise(u).tangent @ du
    slope = central_difference(lambda t: shell.linearise(u + t * du).residual, 0.25)
    np.testing.assert_allclose(slope, exact, rtol=0, atol=DIFFERENCE * largest(exact))
    errors = [
        np.linalg.norm((shell.linearise(u + t * du).residual - shell.linearise(u - t * du).residual) / (2 * t) - exact)
        for t in LARGE_STEPS
    ]
    assert_central_error(errors, np.linalg.norm(exact), quadratic(measure), fitted_order)


@each_section
@pytest.mark.parametrize("load", LOADS)
def test_tangent_is_symmetric_where_a_potential_exists(patch, rng, make_shell, section, load) -> None:
    shell = make_shell(patch.surface, patch.grid(2, 3), section=section, **LOADS[load])
    tangent = shell.linearise(0.1 * rng.normal(size=shell.discretisation.n_free)).tangent
    asymmetry = abs(tangent - tangent.T).max() / abs(tangent).max()
    follower = "pressure" in LOADS[load] and LOADS[load]["pressure"].follower
    if section in SYMMETRIC and not follower:
        assert asymmetry <= ROUNDING
    else:
        assert asymmetry > ASYMMETRY


def test_supports_only_drop_rows_and_columns(curved_patch, rng, make_shell) -> None:
    grid = curved_patch.grid(3, 2)
    fixed = rng.random((grid.n_nodes, 6)) < 0.3
    free = ~fixed.ravel()
    loads = LOADS["all"]
    held, loose = (make_shell(curved_patch.surface, grid, fixed=f, **loads) for f in (fixed, np.zeros_like(fixed)))
    u = np.where(free, 0.1 * rng.normal(size=free.size), 0.0)
    some, everything = held.linearise(u[free]), loose.linearise(u)
    np.testing.assert_allclose(some.residual, everything.residual[free], rtol=0, atol=ROUNDING * everything.scale)
    difference = some.tangent - everything.tangent[free][:, free]
    assert abs(difference).max() <= ROUNDING * abs(everything.tangent).max()


def test_scaled_shell_scales_its_loads_only(curved_patch, rng, make_shell) -> None:
    grid = curved_patch.grid(2, 2)
    forces = rng.normal(size=6 * grid.n_nodes)
    u = 0.1 * rng.normal(size=forces.size)
    for pressure in (Pressure(0.7), Pressure(0.7, follower=True)):
        shell = make_shell(curved_patch.surface, grid, pressure=pressure, forces=forces, initial=INITIAL)
        none, half, full = (shell.scaled(factor).linearise(u).residual for factor in (0.0, 0.5, 1.0))
        np.testing.assert_allclose(2 * half, none + full, rtol=0, atol=ROUNDING * largest(full))
        assert largest(full - none) > 0.1
        np.testing.assert_allclose(full, shell.linearise(u).residual, rtol=0, atol=ROUNDING * largest(full))


# --- the strain modes of the element ------------------------------------------------------------------------------

# xi1^r1 xi2^r2: which of E11-, E11+, E22-, E22+, 2E12-, 2E12+, 2E13-, 2E13+, 2E23-, 2E23+, E33 it carries (the paper)
PAPER_MODES = {(0, 0): range(11), (0, 1): (0, 1, 6, 7, 10), (1, 0): (2, 3, 8, 9, 10), (1, 1): (10,)}


def plate_element_strains(v: np.ndarray, sides: np.ndarray, h: float, points: np.ndarray, measure: str) -> np.ndarray:
    """Strains (points, 11) of a bilinear plate element from base vectors; v (2, 2, 3, 2): corner, corner, i, face."""
    xi, one = points.T, np.ones(len(points))
    N = [np.stack([1 - x, 1 + x]) / 2 for x in xi]
    dN = [np.stack([-one, one]) / side for side in sides]  # d/dx of (1 -+ xi)/2 with x = side xi/2
    gradient = np.stack(
        [np.einsum("ap,bp,abif->pif", dN[0], N[1], v), np.einsum("ap,bp,abif->pif", N[0], dN[1], v)], axis=2
    )
    director = np.einsum("ap,bp,abif->pif", *N, v) @ [-1 / h, 1 / h]
    strains = np.empty((len(points), 11))
    for face in (0, 1):
        H = np.concatenate([gradient[..., face], director[..., None]], axis=2)  # displacement gradient (p, 3, 3)
        E = H + H.swapaxes(1, 2) + (H.swapaxes(1, 2) @ H if measure == "exact" else 0.0)
        for first, i, j in ((0, 0, 0), (2, 1, 1), (4, 0, 1), (6, 0, 2), (8, 1, 2)):
            strains[:, first + face] = E[:, i, j] / (2 if i == j else 1)
        strains[:, 10] = E[:, 2, 2] / 2
    return strains


@each_section
@pytest.mark.parametrize("measure", ["linear", "exact"])
def test_energy_of_a_plate_element_is_that_of_its_projected_strains(
    make_shell, skew_laminate, rng, measure, section
) -> None:
    """1/2 int E.D.E of the strains projected on the modes of the paper, all by a 5 x 5 quadrature of its own."""
    sides = np.array([0.7, 0.4])
    shell = make_shell(Plate(), Grid.tensor([0.0, 0.7], [0.0, 0.4]), measure=measure, section=section)
    v = 0.1 * rng.normal(size=(2, 2, 3, 2))
    t, weight = np.polynomial.legendre.leggauss(5)
    points = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    weights = np.outer(weight, weight).ravel() / 4
    strains = plate_element_strains(v, sides, skew_laminate.thickness, points, measure)
    projected = np.zeros_like(strains)
    for (r1, r2), rows in PAPER_MODES.items():
        mode = points[:, 0] ** r1 * points[:, 1] ** r2
        share = (weights * mode) @ strains[:, rows] / (weights @ mode**2)
        projected[:, rows] += mode[:, None] * share
    density = np.einsum("pi,ij,pj->p", projected, skew_laminate.stiffness(section), projected) / 2
    assert shell.energy(v.ravel()) == pytest.approx(sides.prod() * weights @ density, rel=ROUNDING)


# --- rigid motion -------------------------------------------------------------------------------------------------


def rigidly(rotation, axis, angle: float, shift):
    """Displacement field of a rigid motion."""
    R = rotation(np.asarray(axis, float), angle)
    return lambda x: x @ (R - np.eye(3)).T + shift


def test_element_error_under_rigid_rotation_is_of_second_order(
    curved_patch, make_shell, nodal_components, skew_laminate, rotation, fitted_order
) -> None:
    """The measure is exact, the interpolation of components in a turning frame is not."""
    motion = rigidly(rotation, [0.3, -0.7, 0.5], 1.0, [0.1, 0.2, 0.3])
    counts, errors = np.array([4, 8, 16]), []
    for n in counts:
        grid = curved_patch.grid(n, n, graded=False)
        u = nodal_components(curved_patch.surface, grid, skew_laminate, motion)
        errors.append(largest(make_shell(curved_patch.surface, grid).resultants(u)[:, :N_E]))
    assert ELEMENT_ERROR[0] <= fitted_order(1 / counts, errors) <= ELEMENT_ERROR[1]


@pytest.mark.parametrize("angle", [0.5, 2.0, math.pi])
def test_plate_elements_turn_without_strain(
    patches, make_shell, nodal_components, skew_laminate, rotation, angle
) -> None:
    grid = patches["plate"].grid(3, 4)
    shell = make_shell(Plate(), grid)
    u = nodal_components(Plate(), grid, skew_laminate, rigidly(rotation, [0.3, -0.7, 0.5], angle, [1.0, 2.0, 3.0]))
    size = largest(skew_laminate.stiffness())
    assert largest(shell.resultants(u)) <= ROUNDING * size


@pytest.mark.parametrize("angle", [0.5, 2.0, math.pi])
def test_linear_plate_elements_strain_as_the_linear_law_says(
    patches, make_shell, nodal_components, skew_laminate, rotation, angle
) -> None:
    """Must fail beside must pass: the mean resultants are those of the strain sym(R - I)."""
    grid = patches["plate"].grid(3, 4)
    R = rotation(np.array([0.3, -0.7, 0.5]), angle)
    u = nodal_components(Plate(), grid, skew_laminate, lambda x: x @ (R - np.eye(3)).T)
    e = R + R.T - 2 * np.eye(3)
    strain = np.array([*[e[0, 0] / 2] * 2, *[e[1, 1] / 2] * 2, *[e[0, 1]] * 2, *[e[0, 2]] * 2, *[e[1, 2]] * 2])
    expected = skew_laminate.stiffness() @ np.append(strain, e[2, 2] / 2)
    found = make_shell(Plate(), grid, measure="linear").resultants(u)[:, :N_E]
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=0, atol=ROUNDING * largest(expected))


def test_internal_forces_of_a_strained_plate_turn_with_it(patches, rng, make_shell, rotation, skew_laminate) -> None:
    """Objectivity: f(R(x + u) - x) = R f(u) and the energy stays, at strains of order one."""
    grid = patches["plate"].grid(3, 2)
    shell = make_shell(Plate(), grid)
    x = np.stack(shell.discretisation.positions(), axis=1)  # (N, face, 3)
    u = 0.2 * rng.normal(size=x.shape)
    R, c = rotation(np.array([0.2, 0.9, -0.4]), 2.3), np.array([1.0, -2.0, 0.5])

    def vector(field: np.ndarray) -> np.ndarray:
        return field.swapaxes(1, 2).ravel()  # (N, face, i) to v1-, v1+, v2-, ...

    before, after = (vector(field) for field in (u, (x + u) @ R.T + c - x))
    force = shell.linearise(before).residual.reshape(-1, 3, 2).swapaxes(1, 2)
    turned = shell.linearise(after).residual
    np.testing.assert_allclose(turned, vector(force @ R.T), rtol=0, atol=10 * ROUNDING * largest(turned))
    assert shell.energy(after) == pytest.approx(shell.energy(before), rel=10 * ROUNDING)


# --- zero-energy modes --------------------------------------------------------------------------------------------


@each_section
@each_element
def test_one_free_element_has_exactly_six_zero_modes(patch, make_shell, section, element) -> None:
    shell = make_shell(patch.surface, patch.grid(1, 1, size=0.3), section=section, **element)
    values = np.linalg.svd(shell.linearise(np.zeros(24)).tangent.toarray(), compute_uv=False)
    assert values[17] > GAP * values[18]
    assert values[17] > 1e-4 * values[0]  # and none of the 18 is almost zero


def test_zero_modes_are_the_rigid_motions(patch, make_shell, nodal_components, skew_laminate, fitted_order) -> None:
    """To rounding on the plate; on curved surfaces the angle between the two spaces falls with the square of size."""
    basis = np.eye(3)
    motions = [lambda x, c=c: np.broadcast_to(c, x.shape) for c in basis]
    motions += [lambda x, c=c: np.cross(c, x) for c in basis]
    sizes, angles = (0.4, 0.2, 0.1, 0.05), []
    for size in sizes:
        grid = patch.grid(1, 1, size)
        rigid = [nodal_components(patch.surface, grid, skew_laminate, motion) for motion in motions]
        tangent = make_shell(patch.surface, grid).linearise(np.zeros(24)).tangent.toarray()
        angles.append(np.sin(subspace_angles(null_space(tangent), np.stack(rigid, axis=1))).max())
    if isinstance(patch.surface, Plate):
        assert max(angles) <= 100 * ROUNDING
    else:
        assert ELEMENT_ERROR[0] <= fitted_order(sizes, angles) <= ELEMENT_ERROR[1]


# --- mixed and plain Newton ---------------------------------------------------------------------------------------


def equilibrium(shell, most: int = 40, tolerance: float = 1e-8) -> tuple[np.ndarray, int]:
    """Newton from rest in one load step; returns u and the number of iterations (``most`` when it fails)."""
    u, memory = np.zeros(shell.discretisation.n_free), None
    for iteration in range(most):
        lin = shell.linearise(u, memory)
        if np.linalg.norm(lin.residual) <= tolerance * lin.scale:
            return u, iteration
        du = spsolve(lin.tangent, -lin.residual)
        u, memory = u + du, lin.remember(du)
    return u, most


@pytest.fixture
def cantilever(make_shell):
    """A strip clamped at a1 = 0 under a dead shear of 2 EI/L^2 at its end, in Sze's units but with nu = 0.3."""

    def build(newton: str):
        L, h, E = 10.0, 0.1, 1.2e6
        grid = Grid.tensor(np.linspace(0, L, 13), np.linspace(0, 1, 3))
        fixed, forces = np.zeros((grid.n_nodes, 6), bool), np.zeros((grid.n_nodes, 6))
        fixed[grid.on_line(0, 0.0)] = True
        forces[grid.on_line(0, L), 4:] = 2 * E * h**3 / 12 / L**2 * np.array([[1], [2], [1]]) / 8
        laminate = Laminate.single(Ply.isotropic(E, 0.3, h))
        return make_shell(Plate(), grid, laminate, fixed=fixed, newton=newton, forces=forces[~fixed])

    return build


def test_mixed_and_plain_newton_reach_the_same_answer_mixed_sooner(cantilever) -> None:
    plain, many = equilibrium(cantilever("plain"))
    mixed, few = equilibrium(cantilever("mixed"))
    assert largest(plain - mixed) <= 1e-7 * largest(mixed)
    assert largest(mixed) > 3  # the rotations are large
    assert few <= 10 < many < 40


def test_mixed_newton_changes_only_the_tangent_and_only_with_a_memory(curved_patch, rng, make_shell) -> None:
    mixed, plain = (
        make_shell(curved_patch.surface, curved_patch.grid(2, 3), newton=newton, **LOADS["all"])
        for newton in ("mixed", "plain")
    )
    u, du = 0.1 * rng.normal(size=(2, mixed.discretisation.n_free))
    at_u = plain.linearise(u)
    size = abs(at_u.tangent).max()
    assert at_u.remember(du) is None
    assert abs(mixed.linearise(u).tangent - at_u.tangent).max() == 0
    unmoved = mixed.linearise(u).remember(np.zeros_like(u))
    assert abs(mixed.linearise(u, unmoved).tangent - at_u.tangent).max() <= ROUNDING * size
    predicted = mixed.linearise(u, mixed.linearise(u - du).remember(du))
    assert abs(predicted.tangent - at_u.tangent).max() > 1e-3 * size
    np.testing.assert_array_equal(predicted.residual, mixed.linearise(u).residual)


def test_mixed_newton_remembers_the_linear_prediction_of_the_resultants(
    curved_patch, rng, make_shell, fitted_order
) -> None:
    """H* = D (E + B du) misses D E(u + du) by exactly c |du|^2."""
    shell = make_shell(curved_patch.surface, curved_patch.grid(2, 3))
    u, du = 0.1 * rng.normal(size=(2, shell.discretisation.n_free))
    remember = shell.linearise(u).remember
    misses = [np.linalg.norm(remember(t * du) - shell.resultants(u + t * du)) for t in LARGE_STEPS]
    assert abs(fitted_order(LARGE_STEPS, misses) - 2) <= SLOPE


def test_unknown_newton_is_refused_with_the_choices(patches, make_shell) -> None:
    with pytest.raises(ValueError, match="'quasi' is not one of " + ", ".join(NEWTONS)):
        make_shell(Plate(), patches["plate"].grid(1, 1), newton="quasi")


# --- initial resultants -------------------------------------------------------------------------------------------


def test_initial_resultants_are_in_balance_at_rest(patch, make_shell) -> None:
    shell = make_shell(patch.surface, patch.grid(2, 3), initial=INITIAL)
    rest = np.zeros(shell.discretisation.n_free)
    assert largest(shell.linearise(rest).residual) <= ROUNDING


def test_dead_forces_that_balance_H0_do_not_turn_with_the_body(
    patches, make_shell, nodal_components, skew_laminate, rotation
) -> None:
    """A prestressed plate turned rigidly: the edge a1 = max carries (R - I)(N11 e1 + N12 e2) times its width."""
    N11, N12 = 2.0, -0.7
    initial = np.zeros(N_E)
    initial[0:2], initial[4:6] = N11 / 2, N12 / 2
    grid = patches["plate"].grid(3, 2)
    R = rotation(np.array([0.3, -0.7, 0.5]), 1.1)
    u = nodal_components(Plate(), grid, skew_laminate, lambda x: x @ (R - np.eye(3)).T)
    residual = make_shell(Plate(), grid, initial=initial).linearise(u).residual.reshape(-1, 3, 2).sum(axis=2)
    width = np.ptp(grid.nodes[:, 1])
    residual = residual.reshape(*grid.node_shape, 3)
    # what the edges a2 = const leave at the two corners cancels in the sum
    expected = (R - np.eye(3)) @ np.array([N11, N12, 0.0]) * width
    np.testing.assert_allclose(residual[-1].sum(axis=0), expected, rtol=0, atol=100 * ROUNDING)
    assert largest(residual[1:-1, 1:-1]) <= 100 * ROUNDING


STRIP, WIDTH, THIN, MODULUS, NU = 10.0, 1.0, 0.1, 1e4, 0.3
BENDING = MODULUS * THIN**3 / (12 * (1 - NU**2))


def strip_tangent(make_shell, n: int, N0: float):
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
def test_tensioned_strip_deflects_as_a_string_with_bending(make_shell, stiffness) -> None:
    """D w,1111 - N w,11 = q: w(L/2) = q L^2/8N - (q D/N^2)(1 - 1/cosh(kL/2)), k^2 = N/D; ``stiffness`` is k L.

    Bending takes 37, 2 and 0.02 % of the deflection of a string. What remains is 2 (h/L)^2 = 2e-4 by theory: the
    strains of the shell are linear between the faces, so H0 adds N h^2/4 to D, where a continuum would add N h^2/12.
    """
    N0, n = BENDING * (stiffness / STRIP) ** 2, 80
    exact = STRIP**2 / (8 * N0) - BENDING / N0**2 * (1 - 1 / math.cosh(stiffness / 2))
    tangent, grid, fixed = strip_tangent(make_shell, n, N0)
    forces = np.zeros((grid.n_nodes, 6))
    forces[:, 4:] = WIDTH * STRIP / n / 4  # q = 1 per area: two nodes across, two faces
    u = np.zeros(fixed.size)
    u[~fixed.ravel()] = spsolve(tangent, forces[~fixed])
    w = u.reshape(-1, 6)[grid.node_at(STRIP / 2, 0.0), 4:]
    assert w == pytest.approx([exact, exact], rel=DEFLECTION)


def test_compressed_strip_buckles_at_the_euler_load(make_shell) -> None:
    """The smallest eigenvalue of the tangent changes sign at N = -pi^2 D/L^2, within the shear and mesh correction."""
    euler, smallest = math.pi**2 * BENDING / STRIP**2, []
    for factor in (1 - EULER, 1 + EULER):
        tangent, _, _ = strip_tangent(make_shell, 32, -factor * euler)
        smallest.append(np.linalg.eigvalsh(tangent.toarray()).min())
    assert smallest[0] > 0 > smallest[1]
