"""The oracle of friction: right where the answer is built in, unwilling where there is no programme."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.friction.oracle import confirm, minimise, refusal
from contact.friction.problem import State
from contact.friction.verify import judge
from contact.interchange.oracle import OracleError
from support.problems.frictional import all_answers, in_units, klarbring, manufactured

EXACT = 1e-8  # of quantities of the order one


def agrees(seed: int) -> None:
    rng = np.random.default_rng(seed)
    step, answer = manufactured(rng, int(rng.integers(1, 7)))
    found = minimise(step)
    np.testing.assert_array_equal(found.state, answer.state)
    np.testing.assert_allclose(found.normal, answer.normal, rtol=0, atol=EXACT)
    np.testing.assert_allclose(found.friction, answer.friction, rtol=0, atol=EXACT)
    np.testing.assert_allclose(found.du, answer.u, rtol=0, atol=EXACT)
    assert judge(step.problem(), found.du, found.normal, found.friction).failures() == []


@pytest.mark.parametrize("seed", range(20))
def test_it_finds_the_answer_that_is_built_in(seed) -> None:
    agrees(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20, 300))
def test_it_finds_each_of_many_answers(seed) -> None:
    agrees(seed)


def test_every_state_is_among_them() -> None:
    states = [manufactured(rng := np.random.default_rng(s), int(rng.integers(1, 7)))[1].state for s in range(20)]
    assert min(np.bincount(np.concatenate(states), minlength=3)) > 10


@pytest.mark.parametrize("load", [(1.0, -1.0), (0.1, -1.0), (-1.0, -1.0), (3.0, -1.0), (-3.0, -2.0)])
@pytest.mark.parametrize("mu", [0.0, 0.2, 0.8])
def test_klarbrings_springs_have_one_answer_at_small_mu(mu, load) -> None:
    springs = klarbring(mu, load, 1.0)
    (answer,) = all_answers(springs)
    found = minimise(springs)
    np.testing.assert_array_equal(found.state, answer.state)
    np.testing.assert_allclose(found.du, answer.u, rtol=0, atol=EXACT)
    np.testing.assert_allclose(found.friction, answer.friction, rtol=0, atol=EXACT)
    assert judge(springs.problem(), answer.u, answer.normal, answer.friction).failures() == []


def test_klarbrings_springs_have_three_answers_at_large_mu() -> None:
    """mu times the coupling above the stiffness along: open, stick and slip, each sound; the oracle has one of them."""
    springs = klarbring(3.0, (2.5, -1.0), 1.0)
    answers = all_answers(springs)
    assert {int(answer.state[0]) for answer in answers} == {State.OPEN, State.STICK, State.SLIP}
    for answer in answers:
        assert judge(springs.problem(), answer.u, answer.normal, answer.friction).failures() == []
    found = minimise(springs)
    assert min(np.max(np.abs(found.du - answer.u)) for answer in answers) <= EXACT


@pytest.mark.parametrize(("length", "force"), [(4.0**10, 1.0), (4.0**-10, 1.0), (1.0, 4.0**10), (1.0, 4.0**-10)])
def test_in_any_units(length, force) -> None:
    step, answer = manufactured(np.random.default_rng(2), 5)
    found = minimise(in_units(step, length, force))
    np.testing.assert_array_equal(found.state, answer.state)
    np.testing.assert_allclose(found.du / length, answer.u, rtol=0, atol=EXACT)
    np.testing.assert_allclose(found.friction / force, answer.friction, rtol=0, atol=EXACT)


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
    n = len(step.step.r)
    skew = sparse.csc_matrix(step.step.K.toarray() + 1e-3 * np.triu(np.ones((n, n)), 1))
    refused = {
        "not symmetric": replace(step, step=replace(step.step, K=skew)),
        "not positive definite": replace(step, step=replace(step.step, K=-step.step.K)),
        "no Tresca bound": replace(step, mu=np.full(3, math.inf)),
    }
    for reason, wrong in refused.items():
        assert reason in str(refusal(wrong))
        with pytest.raises(OracleError, match=reason):
            minimise(wrong)
