"""Every contact algorithm against independent solutions: nnls, cvxpy, built-in answers, the law of epsilon."""

import math
from functools import cache
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from contact.events import EventKind, events
from contact.problem import Outcome
from contact.verify import judge
from support.problems.contact_problems import applicable, dual_by_nnls, manufactured, random_quadratic, solve_from_rest
from support.problems.differences import fitted_order

ORACLE = 1e-7  # agreement with the independent solutions, all quantities are of the order one
FINE = 1e-8  # a tenth of the smallest pressure that has to be seen; the residual is known to 1e-9
TOUCH = 1e-9  # a pressure or penetration above this is one
ROUNDING = 1e-10
GAP_ROUNDING = 1e-14  # of gaps of the order one
SLOPE = 0.02  # half-width of the interval around the exponent -1 of penetration over epsilon
EPSILONS = (math.inf, 1e4)
KINDS = ("obstacle", "definite", "inclined")

each_pair = pytest.mark.parametrize(("name", "epsilon"), applicable(*EPSILONS))


@cache
def by_cvxpy(seed: int, kind: str, epsilon: float) -> tuple[np.ndarray, np.ndarray]:
    """u and p of the primal; a finite epsilon gives every constraint a slack with the energy epsilon w s^2/2."""
    import cvxpy as cp  # slow to load

    data = random_quadratic(np.random.default_rng(seed), kind)
    u, s = cp.Variable(len(data.f)), cp.Variable(len(data.w))
    energy = cp.quad_form(u, cp.psd_wrap(data.K)) / 2 - data.f @ u
    if math.isinf(epsilon):
        constraint = data.g0 + data.G @ u >= 0
    else:  # s in units of 1/sqrt(epsilon w), so that the problem stays scaled
        constraint = data.g0 + data.G @ u + cp.multiply(1 / np.sqrt(epsilon * data.w), s) >= 0
        energy = energy + cp.sum_squares(s) / 2
    problem = cp.Problem(cp.Minimize(energy), [constraint])
    tight = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_ktratio"), 1e-12)
    problem.solve(solver=cp.CLARABEL, **tight)
    assert problem.status == "optimal"
    return u.value, constraint.dual_value / data.w


@each_pair
def test_solution_is_that_of_nnls_and_cvxpy(name, epsilon) -> None:
    for seed, kind in product(range(2), KINDS):
        data = random_quadratic(np.random.default_rng(seed), kind)
        solution = solve_from_rest(name, data.problem(), len(data.f), epsilon)
        assert solution.outcome is Outcome.CONVERGED
        for u, pressure in (dual_by_nnls(data, epsilon), by_cvxpy(seed, kind, epsilon)):
            np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE)
            np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=ORACLE)
            np.testing.assert_array_equal(solution.active, pressure > 10 * ORACLE)


@each_pair
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(KINDS))
@settings(deadline=None, derandomize=True, max_examples=8)
def test_an_answer_called_converged_is_right(name, epsilon, seed, kind) -> None:
    """Plain active sets may fail on an arbitrary definite matrix, but then they say so and the judge agrees."""
    data = random_quadratic(np.random.default_rng(seed), kind)
    solution = solve_from_rest(name, data.problem(), len(data.f), epsilon)
    if solution.outcome.converged:
        u, pressure = dual_by_nnls(data, epsilon)
        np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE)
        np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=ORACLE)
    else:
        assert kind != "obstacle"
        assert name != "trial-and-error"  # its least-index fallback ends on every P-matrix
        verdict = judge(data.problem(), solution.u, solution.pressure)
        assert max(verdict.tension, verdict.penetration - np.max(solution.pressure) / epsilon) > TOUCH


STATES = {
    "all open": [0, 0, 0, 0, 0],
    "all pressed": [1, 1, 1, 1, 1],
    "some just touch": [0, 2, 1, 2, 1],
    "all but one just touch": [2, 2, 1, 2, 2],
    "all just touch": [2, 2, 2, 2, 2],
}


@pytest.mark.parametrize(("name", "epsilon"), applicable(*EPSILONS, 1e14))
@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 10), marks=pytest.mark.slow)], ids=["few", "many"])
def test_touching_without_pressure_and_full_contact(name, epsilon, seeds) -> None:
    """Exact touch leaves the set to rounding, full contact leaves no open gap to measure by; neither may matter."""
    for seed, states, kind in product(seeds, STATES, KINDS):
        rng, case = np.random.default_rng(seed), f"{kind}, {states}, seed {seed}"
        data, u, pressure = manufactured(rng, kind, np.array(STATES[states]), epsilon)
        solution = solve_from_rest(name, data.problem(), len(u), epsilon)
        assert solution.outcome is Outcome.CONVERGED, case
        np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE, err_msg=case)
        np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=ORACLE, err_msg=case)
        assert np.all(solution.pressure >= 0), case


@each_pair
def test_almost_touching_is_still_decided(name, epsilon) -> None:
    """Must fail beside must pass: gaps and pressures of 1e-7 are far above rounding, and the set has to see them."""
    states, size = np.array([0, 1, 0, 1, 0, 1]), np.array([1e-7, 1e-7, 1e-7, 1e-7, 1.0, 1.0])
    for seed, kind in product(range(2), KINDS):
        data, _, pressure = manufactured(np.random.default_rng(seed), kind, states, epsilon, size)
        solution = solve_from_rest(name, data.problem(), len(data.f), epsilon)
        assert solution.outcome is Outcome.CONVERGED, f"{kind}, seed {seed}"
        np.testing.assert_array_equal(solution.active, states == 1)
        np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=FINE)


# --- the law of the regularisation --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name, _ in applicable(1e4)])
def test_finite_epsilon_obeys_its_law_and_converges_to_the_constraint(name) -> None:
    """p = -epsilon g on the set, 0 elsewhere; penetration falls with 1/epsilon; 1e14 costs no digit."""
    for kind in KINDS:
        data = random_quadratic(np.random.default_rng(1), kind)
        problem = data.problem()
        exact = solve_from_rest("semismooth", problem, len(data.f))
        assert 0 < exact.active.sum() < len(exact.active)
        measured, penetrations = 10.0 ** np.arange(3, 9), []
        for epsilon in (*measured, 1e10, 1e12, 1e14):
            solution = solve_from_rest(name, problem, len(data.f), epsilon)
            assert solution.outcome is Outcome.CONVERGED
            assert np.max(np.abs(solution.pressure - exact.pressure)) <= 100 / epsilon + ROUNDING
            if epsilon in measured:  # later the penetration drowns in the rounding of the gap
                gap = problem.gap(solution.u)
                law = epsilon * np.maximum(-gap, 0)
                np.testing.assert_allclose(solution.pressure, law, rtol=0, atol=ROUNDING + GAP_ROUNDING * epsilon)
                penetrations.append(np.max(-gap))
        assert abs(fitted_order(measured, penetrations) + 1) <= SLOPE


@pytest.mark.parametrize("name", ["lcp", "qp"])
def test_the_full_system_has_springs_by_area_and_the_set_of_its_own_answer(name) -> None:
    """The answer of a finite epsilon on unequal areas is that of all others, and no step has to correct its set."""
    for seed, epsilon in product(range(3), (1.0, 1e3, np.inf)):
        data = random_quadratic(np.random.default_rng(seed), "definite")
        known, actual = (
            solve_from_rest(each, data.problem(), len(data.f), epsilon, **options)
            for each, options in (("semismooth", {}), (name, {"system": "full"}))
        )
        np.testing.assert_allclose(actual.pressure, known.pressure, rtol=0, atol=ORACLE)
        assert not events(actual.history, EventKind.SUBSTITUTE)
