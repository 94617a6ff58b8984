"""The oracle of friction: right where the answer is built in, unwilling where there is no programme."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.coulomb import State
from contact.interchange.friction_oracle import confirm, minimise, refusal
from contact.interchange.friction_states import Known, settle
from contact.interchange.linearised_step import FrozenFrictionalStep, freeze
from contact.interchange.oracle import OracleError
from contact.verify import judge
from studies.arena.frictional_steps import dense_step
from support.problems.frictional import all_answers, balanced, in_units, klarbring, manufactured, tied

EXACT = 1e-8  # of quantities of the order one


def agrees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    step, answer = manufactured(rng, int(rng.integers(1, 7)))
    actual = minimise(step)
    np.testing.assert_array_equal(actual.state, answer.state)
    np.testing.assert_allclose(actual.normal, answer.normal, rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual.friction, answer.friction, rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual.du, answer.u, rtol=0, atol=EXACT)
    assert judge(step.problem(), actual.du, actual.normal, actual.friction).failures() == []


def test_it_finds_the_answer_that_is_built_in() -> None:
    for seed in range(12):
        agrees(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(20, 300, 70))
def test_it_finds_each_of_many_answers(first: int) -> None:
    for seed in range(first, first + 70):
        agrees(seed)


def test_klarbrings_springs_have_one_answer_at_small_mu() -> None:
    loads = (1.0, -1.0), (0.1, -1.0), (-1.0, -1.0), (3.0, -1.0), (-3.0, -2.0)
    for mu, load in product((0.0, 0.2, 0.8), loads):
        springs = klarbring(mu, load, 1.0)
        (answer,) = all_answers(springs)
        actual = minimise(springs)
        np.testing.assert_array_equal(actual.state, answer.state)
        np.testing.assert_allclose(actual.du, answer.u, rtol=0, atol=EXACT)
        np.testing.assert_allclose(actual.friction, answer.friction, rtol=0, atol=EXACT)
        assert judge(springs.problem(), answer.u, answer.normal, answer.friction).failures() == []


def test_klarbrings_springs_have_three_answers_at_large_mu() -> None:
    """mu times the coupling above the stiffness along: open, stick and slip, each sound; the oracle has one of them."""
    springs = klarbring(3.0, (2.5, -1.0), 1.0)
    answers = all_answers(springs)
    assert {int(answer.state[0]) for answer in answers} == {State.OPEN, State.STICK, State.SLIP}
    for answer in answers:
        assert judge(springs.problem(), answer.u, answer.normal, answer.friction).failures() == []
    actual = minimise(springs)
    assert min(np.max(np.abs(actual.du - answer.u)) for answer in answers) <= EXACT


def test_in_any_units() -> None:
    for length, force in ((4.0**10, 1.0), (4.0**-10, 1.0), (1.0, 4.0**10), (1.0, 4.0**-10)):
        step, answer = manufactured(np.random.default_rng(2), 5)
        actual = minimise(in_units(step, length, force))
        np.testing.assert_array_equal(actual.state, answer.state)
        np.testing.assert_allclose(actual.du / length, answer.u, rtol=0, atol=EXACT)
        np.testing.assert_allclose(actual.friction / force, answer.friction, rtol=0, atol=EXACT)


def test_a_spoilt_answer_is_contradicted() -> None:
    step, answer = manufactured(np.random.default_rng(5), 5)
    assert confirm(step, answer.u, answer.normal, answer.friction).agrees
    assert not confirm(step, answer.u + 1e-5, answer.normal, answer.friction).agrees
    rubbed = int(np.argmax(np.linalg.norm(answer.friction, axis=1)))
    other = np.where(np.arange(5)[:, None] == rubbed, -answer.friction, answer.friction)
    contradicted = confirm(step, answer.u, answer.normal, other)
    np.testing.assert_array_equal(contradicted.differing, [rubbed])
    assert not contradicted.agrees


def test_no_programme_no_answer() -> None:
    step, _ = manufactured(np.random.default_rng(5), 3)
    assert refusal(step) is None
    wrong = replace(step, K=-step.K)
    assert "not positive" in str(refusal(wrong))
    with pytest.raises(OracleError, match="not positive"):
        minimise(wrong)


def test_a_matrix_that_is_not_symmetric() -> None:
    """The answer stays where the load makes up for what is added to K."""
    for seed in range(3):
        step, answer = manufactured(np.random.default_rng(seed), 4)
        n = len(step.r)
        skew = 0.1 * np.triu(np.ones((n, n)), 1)
        other = replace(step, K=sparse.csc_matrix(step.K + skew - skew.T))
        actual = minimise(balanced(other, answer))
        np.testing.assert_array_equal(actual.state, answer.state)
        np.testing.assert_allclose(actual.du, answer.u, rtol=0, atol=EXACT)
        np.testing.assert_allclose(actual.friction, answer.friction, rtol=0, atol=EXACT)


def test_an_endless_friction_ties_who_touches() -> None:
    """Against the equations of those that touch, all of their ways zero."""
    for seed in range(3):
        problem = tied(seed)
        step = freeze(problem, np.zeros(26), np.zeros(len(problem.weights)), {})
        actual = minimise(step)
        touch = np.flatnonzero(actual.state == State.STICK)
        assert len(touch)
        assert State.SLIP not in actual.state
        J = step.H.toarray()[:, (3 * touch[:, None] + np.arange(3)).ravel()]
        K, ways = step.K.toarray(), step.w.reshape(-1, 3)[touch].ravel()
        A = np.block([[K, -J], [J.T, np.zeros((J.shape[1], J.shape[1]))]])
        wanted = np.linalg.solve(A, np.concatenate([-step.r, -ways]))
        np.testing.assert_allclose(actual.du, wanted[: len(K)], rtol=0, atol=EXACT)
        assert judge(problem, actual.du, actual.normal, actual.friction).failures() == []


def pulled(force: float) -> FrozenFrictionalStep:
    """A block that nothing holds along the plane, pressed by 2 with mu = 0.5 and pulled."""
    K, G, S = np.diag([0.0, 1.0]), np.array([[0.0, 1.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
    return dense_step(K, -np.array([force, -2.0]), G, np.zeros(1), S, np.zeros((1, 2)), np.array([0.5]))


def test_friction_alone_may_hold_a_body() -> None:
    actual = minimise(pulled(0.9))
    assert actual.passes <= 2
    assert actual.state.tolist() == [State.STICK]
    np.testing.assert_allclose(actual.friction, [[-0.9, 0.0]], rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual.du, 0.0, rtol=0, atol=EXACT)
    with pytest.raises(OracleError):
        minimise(pulled(1.1))


def test_redundant_contacts_share_what_one_carries() -> None:
    """Each candidate twice: the motion is that of each once, and so is the force of every pair."""
    for seed in range(3):
        step, answer = manufactured(np.random.default_rng(seed), 4)
        order = np.repeat(np.arange(4), 2)
        rows = (2 * order[:, None] + np.arange(2)).ravel()
        twice = replace(step, G=step.G[order], gap=step.gap[order], weights=step.weights[order])
        actual = minimise(replace(twice, S=step.S[rows], slip=step.slip[order], mu=step.mu[order]))
        np.testing.assert_allclose(actual.du, answer.u, rtol=0, atol=EXACT)
        np.testing.assert_allclose(actual.normal.reshape(4, 2).sum(axis=1), answer.normal, rtol=0, atol=EXACT)
        np.testing.assert_allclose(actual.friction.reshape(4, 2, 2).sum(axis=1), answer.friction, rtol=0, atol=EXACT)


def test_a_contact_that_just_touches_carries_nothing() -> None:
    """A normal force of -1e-15 beside one of 1 is rounding, and friction of its sign would drive."""
    eye = np.eye(6)
    r = np.array([1.0, -3.0, 0.0, -1e-15, -3.0, 0.0])  # K du + r = F with K = 1: f = r_n, and a slip of 3 - mu f
    step = dense_step(eye, r, eye[[0, 3]], np.zeros(2), eye[[1, 2, 4, 5]], np.zeros((2, 2)), np.full(2, 0.5))
    slips = np.full(2, State.SLIP)
    actual = settle(step, Known(np.zeros(6), np.ones(2), np.array([[-0.5, 0.0], [-0.5, 0.0]]), slips))
    np.testing.assert_allclose(actual.friction, [[-0.5, 0.0], [0.0, 0.0]], rtol=0, atol=EXACT)
    assert actual.normal[1] == 0
    assert np.all(actual.friction[1] == 0)
