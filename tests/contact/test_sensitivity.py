"""Rates of a solution with a parameter: against closed forms on both sides, and against solutions beside it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.problem import ContactProblem, ContactSolution, Outcome, linear_mechanics
from contact.sensitivity import OFFSETS, Change, Sensitivity

K = sparse.csc_matrix(np.array([[3.0, -1.0, 0.0], [-1.0, 3.0, -1.0], [0.0, -1.0, 3.0]]))
WEIGHTS = np.array([0.5, 2.0, 1.0])
H = 1e-6


def pressed(s: float, ways: np.ndarray, force: np.ndarray, coupling: sparse.csr_matrix | None = None) -> ContactProblem:
    """Three springs in a row above stops that come up by s ``ways``, under forces (1 + s)."""
    rows = sparse.csr_matrix(np.eye(3))
    return ContactProblem(
        linear_mechanics(K, (1 + s) * force), lambda u: u - s * ways, lambda u: rows, WEIGHTS, coupling=coupling
    )


def change(
    ways: np.ndarray, force: np.ndarray, state: ContactSolution, epsilon: float = np.inf, **how: object
) -> Change:
    return Change.between([(pressed(k * H, ways, force, **how), epsilon) for k in OFFSETS], state, H)


def test_bodies_that_touch_without_pressure_have_a_rate_on_each_side() -> None:
    ways, force = np.array([1.0, 0.0, -1.0]), np.zeros(3)
    state = ContactSolution.at_rest(3, 3)
    actual = Sensitivity(pressed(0.0, ways, force), state, np.inf)
    assert actual.one_sided
    np.testing.assert_array_equal(actual.undecided, [0, 1, 2])
    above, below = actual.rates(change(ways, force, state))
    # up: the first stop lifts its end by 1, the others follow freely; down: the last stop does, and all mirrors
    free = np.linalg.solve(K.toarray()[1:, 1:], [1.0, 0.0])
    np.testing.assert_allclose(above.u, [1.0, *free], atol=1e-9)
    np.testing.assert_allclose(below.u, -np.array([*free[::-1], 1.0]), atol=1e-9)
    np.testing.assert_allclose(above.pressure, [(3.0 - free[0]) / WEIGHTS[0], 0, 0], atol=1e-8)
    np.testing.assert_allclose(below.pressure, [0, 0, -(3.0 - free[0]) / WEIGHTS[2]], atol=1e-8)


@pytest.mark.parametrize("epsilon", [np.inf, 7.0])
@pytest.mark.parametrize("consistent", [False, True])
def test_rates_are_those_of_solutions_beside(epsilon: float, consistent: bool) -> None:
    W = sparse.csr_matrix(np.diag(WEIGHTS) + 0.1 * np.ones((3, 3))) if consistent else None
    ways, force = np.array([0.3, -0.2, 0.1]), np.array([-1.0, -2.0, 4.0])
    start = ContactSolution.at_rest(3, 3)
    algorithm = Semismooth(epsilon=epsilon)
    at, low, high = (algorithm.solve(pressed(s, ways, force, coupling=W), start) for s in (0.0, -H, H))
    assert at.outcome is Outcome.CONVERGED
    np.testing.assert_array_equal(at.active, [True, True, False])
    actual = Sensitivity(pressed(0.0, ways, force, coupling=W), at, epsilon)
    assert not actual.one_sided
    rates, other = actual.rates(change(ways, force, at, epsilon, coupling=W))
    assert rates is other
    np.testing.assert_allclose(rates.u, (high.u - low.u) / (2 * H), rtol=0, atol=1e-8)
    np.testing.assert_allclose(rates.pressure, (high.pressure - low.pressure) / (2 * H), rtol=0, atol=1e-8)


def test_candidates_that_touch_without_pressure_need_forces_of_their_own() -> None:
    W = sparse.csr_matrix(np.diag(WEIGHTS) + 0.1 * np.ones((3, 3)))
    state = ContactSolution.at_rest(3, 3)
    actual = Sensitivity(pressed(0.0, np.ones(3), np.zeros(3), W), state, np.inf)
    with pytest.raises(ValueError, match="lumped coupling"):
        actual.rates(change(np.ones(3), np.zeros(3), state, coupling=W))


def test_a_moved_state_keeps_what_it_does_not_know() -> None:
    ways, force = np.array([0.3, -0.2, 0.1]), np.array([-1.0, -2.0, 4.0])
    at = Semismooth().solve(pressed(0.0, ways, force), ContactSolution.at_rest(3, 3))
    rates, _ = Sensitivity(pressed(0.0, ways, force), at, np.inf).rates(change(ways, force, at))
    beside = rates.moved(at, 0.5)
    np.testing.assert_allclose(beside.u, at.u + 0.5 * rates.u)
    assert replace(beside, u=at.u, pressure=at.pressure).active is at.active
