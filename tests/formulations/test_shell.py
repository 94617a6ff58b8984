"""The shell: potential, residual and tangent for every option, supports, scaling, mixed and plain Newton."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from formulations.element.mixed import MEMBRANES, THICKNESS_STRAINS
from formulations.element.strain_operator import INTERPOLATIONS
from formulations.geometry.grid import Grid
from formulations.geometry.surfaces import Plate
from formulations.loads import Pressure
from formulations.section.laminate import SECTIONS, Laminate, Ply
from formulations.shell import NEWTONS
from formulations.strains.catalogue import MEASURES
from formulations.strains.measure import QuadraticMeasure
from formulations.strains.quantities import N_E, N_Q
from support.problems.differences import central_difference, fitted_order
from support.problems.shells import PATCHES, make_shell

ROUNDING = 1e-12  # relative to the largest entry of the quantity
DIFFERENCE = 1e-10  # relative error of a difference without truncation error
LARGE_STEPS = 2.0 ** -np.arange(4)
SLOPE = 0.01  # half-width of the interval around the slope 2: the truncation error is exactly c t^2
ASYMMETRY = 1e-3  # relative: what counts as really non-symmetric
SYMMETRIC = [section for section in SECTIONS if section != "nonsymmetric"]
INITIAL = np.array([0.9, 1.4, -0.5, 0.8, 0.3, 0.6, 0.2, -0.4, 0.5, 0.1, -0.7])

ELEMENTS = {
    f"{t}-{m}-{i}": {"thickness_strain": t, "membrane": m, "interpolation": i}
    for t in THICKNESS_STRAINS
    for m in MEMBRANES
    for i in INTERPOLATIONS
}

LOADS = {
    "none": {},
    "dead": {"pressure": Pressure(0.7)},
    "follower-mid": {"pressure": Pressure(0.7, follower=True, area="mid")},
    "follower-face": {"pressure": Pressure(0.7, follower=True, area="face")},
    "initial": {"initial": INITIAL},
    "all": {"pressure": Pressure(-0.4, follower=True, area="face"), "initial": INITIAL},
}

# the exact measure with every section and load; the other measures and element options with all loads at once
MODELS = {
    **{f"{section}-{load}": {"section": section, **LOADS[load]} for section in SECTIONS for load in reversed(LOADS)},
    **{measure: {"measure": measure, **LOADS["all"]} for measure in MEASURES if measure != "exact"},
    **{name: {**options, **LOADS["all"]} for name, options in ELEMENTS.items()},
}
POTENTIALS = {
    **{section: {"section": section} for section in SYMMETRIC},
    **{measure: {"measure": measure} for measure in MEASURES if measure != "exact"},
    **ELEMENTS,
}


def everywhere(models: dict[str, dict]) -> pytest.MarkDecorator:
    """All models on the patch where nothing is constant, and the first of them on every patch."""
    pairs = dict.fromkeys([*(("wavy", name) for name in models), *((patch, next(iter(models))) for patch in PATCHES)])
    cases = [pytest.param(PATCHES[patch], models[name], id=f"{patch}-{name}") for patch, name in pairs]
    return pytest.mark.parametrize(("patch", "model"), cases)


def quadratic(measure: str) -> bool:
    """True unless the strains are linear in the displacements."""
    return bool(np.any(MEASURES[measure].contract(np.zeros(N_Q), np.ones(N_E))))


def amplitude(measure: str) -> float:
    """Size of the displacements [mm]: large, unless the strains need positive stretches and are no polynomials."""
    return 0.1 if isinstance(MEASURES[measure], QuadraticMeasure) else 1e-3


def assert_central_error(errors: np.ndarray, size: float, curved: bool) -> None:
    """Exactly c t^2 where the function is curved, rounding where it is not."""
    if curved:
        assert max(errors) > 1e3 * DIFFERENCE * size  # there is something to fit
        assert abs(fitted_order(LARGE_STEPS, errors) - 2) <= SLOPE
    else:
        assert max(errors) <= DIFFERENCE * size


def largest(array) -> float:
    return float(np.max(np.abs(array)))


@everywhere(POTENTIALS)
def test_residual_is_the_gradient_of_the_energy(patch, rng, model) -> None:
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
    assert_central_error(errors, abs(exact) + shell.energy(u), quadratic(measure))


@everywhere(MODELS)
def test_tangent_is_the_derivative_of_the_residual(patch, rng, model) -> None:
    """For every section, follower pressure and initial resultants; without memory mixed and plain tangent are one.

    The residual by itself is that of the linearisation, with a memory, too.
    """
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
    assert_central_error(errors, np.linalg.norm(exact), quadratic(measure))
    lin = shell.linearise(u, shell.linearise(u - du).remember(du))
    np.testing.assert_allclose(shell.residual(u), lin.residual, rtol=0, atol=ROUNDING * largest(lin.residual))


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize("load", LOADS)
def test_tangent_is_symmetric_where_a_potential_exists(rng, section, load) -> None:
    patch = PATCHES["wavy"]
    shell = make_shell(patch.surface, patch.grid(2, 3), section=section, **LOADS[load])
    tangent = shell.linearise(0.1 * rng.normal(size=shell.discretisation.n_free)).tangent
    asymmetry = abs(tangent - tangent.T).max() / abs(tangent).max()
    follower = "pressure" in LOADS[load] and LOADS[load]["pressure"].follower
    if section in SYMMETRIC and not follower:
        assert asymmetry <= ROUNDING
    else:
        assert asymmetry > ASYMMETRY


def test_scaled_shell_scales_its_loads_only(curved_patch, rng) -> None:
    grid = curved_patch.grid(2, 2)
    forces = rng.normal(size=6 * grid.n_nodes)
    u = 0.1 * rng.normal(size=forces.size)
    for pressure in (Pressure(0.7), Pressure(0.7, follower=True)):
        shell = make_shell(curved_patch.surface, grid, pressure=pressure, forces=forces, initial=INITIAL)
        none, half, full = (shell.scaled(factor).linearise(u).residual for factor in (0.0, 0.5, 1.0))
        np.testing.assert_allclose(2 * half, none + full, rtol=0, atol=ROUNDING * largest(full))
        assert largest(full - none) > 0.1
        np.testing.assert_allclose(full, shell.linearise(u).residual, rtol=0, atol=ROUNDING * largest(full))


def test_volume_is_kept_by_a_rigid_turn_and_lost_where_the_faces_change_places(curved_patch) -> None:
    shell = make_shell(curved_patch.surface, curved_patch.grid(4, 6))
    body = shell.discretisation
    inner, outer = body.positions()
    frame = body.surface.frame(*body.grid.nodes.T)

    def ratios(inner_to: np.ndarray, outer_to: np.ndarray) -> np.ndarray:
        local = np.einsum("nik,nfk->nif", frame, np.stack([inner_to - inner, outer_to - outer], axis=1))
        return shell.volume_ratios(body.map.restrict(local.reshape(-1, 6)))

    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert ratios(inner @ turn.T + 7.0, outer @ turn.T + 7.0) == pytest.approx(1.0, abs=1e-12)
    assert ratios(2.0 * inner, 2.0 * outer) == pytest.approx(8.0, rel=1e-12)
    assert ratios(outer, inner) == pytest.approx(-1.0, rel=1e-12)


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
def cantilever():
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


def test_mixed_newton_changes_only_the_tangent_and_only_with_a_memory(curved_patch, rng) -> None:
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


def test_mixed_newton_remembers_the_linear_prediction_of_the_resultants(curved_patch, rng) -> None:
    """H* = D (E + B du) misses D E(u + du) by exactly c |du|^2."""
    shell = make_shell(curved_patch.surface, curved_patch.grid(2, 3))
    u, du = 0.1 * rng.normal(size=(2, shell.discretisation.n_free))
    remember = shell.linearise(u).remember
    misses = [np.linalg.norm(remember(t * du) - shell.resultants(u + t * du)) for t in LARGE_STEPS]
    assert abs(fitted_order(LARGE_STEPS, misses) - 2) <= SLOPE


def test_what_is_remembered_outlives_the_scratch(curved_patch, rng) -> None:
    """The same grid under another load is linearised elsewhere between a linearisation and its step."""
    shell = make_shell(curved_patch.surface, curved_patch.grid(2, 3), **LOADS["all"])
    u, du, elsewhere = 0.1 * rng.normal(size=(3, shell.discretisation.n_free))
    expected = shell.linearise(u).remember(du)
    lin = shell.linearise(u)
    shell.scaled(2.0).linearise(elsewhere)
    np.testing.assert_array_equal(lin.remember(du), expected)


def test_unknown_newton_is_refused_with_the_choices() -> None:
    with pytest.raises(ValueError, match="'quasi' is not one of " + ", ".join(NEWTONS)):
        make_shell(Plate(), PATCHES["plate"].grid(1, 1), newton="quasi")
