"""The oracle: right where nnls and closed forms are, unwilling where there is no programme, and able to contradict."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from contact.interchange import oracle
from contact.interchange.linearised_step import FrozenStep, freeze
from contact.interchange.oracle import OracleError, confirm, minimise, positive_definite, refusal
from support.problems.contact_problems import Quadratic, dual_by_nnls, random_quadratic

EXACT = 1e-9  # of quantities of the order one
KINDS = ("obstacle", "definite", "inclined")


def frozen(data) -> FrozenStep:
    return freeze(data.problem(), np.zeros(len(data.f)), np.zeros(len(data.w)), {})


@pytest.mark.parametrize("epsilon", [math.inf, 1e4])
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(KINDS))
@settings(deadline=None, derandomize=True, max_examples=12)
def test_it_is_right_where_nnls_is(epsilon, seed, kind) -> None:
    data = random_quadratic(np.random.default_rng(seed), kind)
    u, pressure = dual_by_nnls(data, epsilon)
    du, actual = minimise(frozen(data), epsilon)
    np.testing.assert_allclose(du, u, rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual, pressure, rtol=0, atol=EXACT)
    assert confirm(frozen(data), u, pressure, epsilon).agrees


def test_touching_without_pressure_is_no_difference(rng) -> None:
    """Strict complementarity fails at three of five candidates; whichever set, the pressures are the same."""
    data = random_quadratic(rng, "definite", 5)
    u, p = rng.normal(size=len(data.f)), np.array([0, 0, 0, 1.5, 0])
    gap = np.array([0, 0, 0, 0, 1.0])
    data = replace(data, f=data.K @ u - data.G.T @ (data.w * p), g0=gap - data.G @ u)
    assert confirm(frozen(data), u, p).agrees
    np.testing.assert_allclose(minimise(frozen(data))[1], p, rtol=0, atol=EXACT)


def test_badly_scaled_steps(rng) -> None:
    """Stiffnesses over twelve decades, as in thin shells; forces of 1e-6 N and of 1e6 N."""
    for force in (1e-6, 1e6):
        data = random_quadratic(rng, "definite")
        unit = 10 ** rng.uniform(-3, 3, len(data.f))
        G = data.G / unit[None, :]
        scaled = Quadratic(data.K / np.outer(unit, unit), force * data.f / unit, G, force * data.g0, data.w)
        u, p = dual_by_nnls(data, math.inf)
        actual = minimise(frozen(scaled))
        np.testing.assert_allclose(actual[1] / force, p, rtol=0, atol=1e-7)
        np.testing.assert_allclose(actual[0] / unit / force, u, rtol=0, atol=1e-7)


def test_a_spoilt_answer_is_contradicted() -> None:
    data = random_quadratic(np.random.default_rng(5), "inclined")
    u, p = dual_by_nnls(data, math.inf)
    step, pressed = frozen(data), int(np.argmax(p))
    assert confirm(step, u, p).agrees
    assert not confirm(step, u + 1e-5, p).agrees
    slightly = confirm(step, u, 1.00001 * p)
    assert not slightly.agrees
    assert slightly.force_error == pytest.approx(1e-5, rel=1e-3)
    assert len(slightly.differing) == 0
    without = np.where(np.arange(len(p)) == pressed, 0.0, p)
    np.testing.assert_array_equal(confirm(step, u, without).differing, [pressed])


def test_rounding_excuses_no_displacement_and_a_changed_step_without_answer_nothing(monkeypatch) -> None:
    data = random_quadratic(np.random.default_rng(5), "inclined")
    u, p = dual_by_nnls(data, math.inf)
    step = frozen(data)
    monkeypatch.setattr(oracle, "_rounding", lambda *_: 1e-4 * float(np.max(data.w * p)))
    assert confirm(step, u, 1.00001 * p).agrees
    assert not confirm(step, u + 1e-5, 1.00001 * p).agrees
    monkeypatch.setattr(oracle, "_rounding", lambda *_: 1e-2 * float(np.max(data.w * p)))
    with pytest.raises(OracleError, match="rounding alone changes the forces by"):
        confirm(step, u, 1.00001 * p)
    monkeypatch.undo()
    settle, calls = oracle._settle, iter((False, True))

    def fails_once_changed(*given):
        if next(calls):
            raise OracleError("the set of the oracle does not settle")
        return settle(*given)

    monkeypatch.setattr(oracle, "_settle", fails_once_changed)
    assert not confirm(step, u, 1.00001 * p).agrees


def test_no_programme_no_answer(rng) -> None:
    step = frozen(random_quadratic(rng, "definite"))
    n = len(step.r)
    assert refusal(step) is None
    skew = sparse.csc_matrix(step.K.toarray() + 1e-3 * np.triu(np.ones((n, n)), 1))
    saddle = sparse.csc_matrix(step.K.toarray() - 5 * np.eye(n))
    flat = sparse.csc_matrix(np.ones((n, n)))
    refused = {
        "not symmetric": replace(step, K=skew),
        "not positive definite": replace(step, K=saddle),
        "not multipliers": replace(step, coupling=sparse.csr_matrix(np.diag(step.weights))),
    }
    for reason, wrong in refused.items():
        assert reason in str(refusal(wrong))
        with pytest.raises(OracleError, match=reason):
            confirm(wrong, np.zeros(n), np.zeros(6))
    assert refusal(replace(step, K=flat)) is not None


def test_contradicting_constraints_have_no_answer() -> None:
    """u <= -1 and u >= 1."""
    data = Quadratic(np.eye(1), np.zeros(1), np.array([[1.0], [-1.0]]), np.array([-1.0, -1.0]), np.ones(2))
    with pytest.raises(OracleError):
        minimise(frozen(data))


def test_definiteness_is_that_of_the_eigenvalues() -> None:
    for seed in range(20):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(2, 30))
        root = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.5) + np.eye(n)
        K = root @ root.T
        smallest = np.linalg.eigvalsh(K)[0]
        for shift, definite in ((0.99, True), (1.01, False)):
            assert positive_definite(sparse.csc_matrix(K - shift * smallest * np.eye(n))) == definite


def test_no_candidate_is_a_linear_system(rng) -> None:
    data = random_quadratic(rng, "definite")
    step = frozen(Quadratic(data.K, data.f, data.G[:0], data.g0[:0], data.w[:0]))
    du, pressure = minimise(step)
    np.testing.assert_allclose(du, np.linalg.solve(data.K, data.f), rtol=0, atol=EXACT)
    assert pressure.shape == (0,)
