"""Quadratic programmes and complementarity problems against nnls to 1e-9, where strict complementarity fails, too."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.problem import ContactSolution, Outcome
from contact.solvers.lcp_pivoting import LcpError, active_set, by_nnls, lemke, principal_pivot
from contact.solvers.qp_backends import BACKENDS, Programme, ask, missing
from contact.verify import judge
from support.problems.contact_problems import (
    OPEN,
    PRESSED,
    TOUCHING,
    Quadratic,
    definite,
    dual_by_nnls,
    manufactured,
    random_quadratic,
)

NNLS = 1e-9  # all quantities are of the order one
BY_BACKEND = 1e-6  # of what a backend alone finds with tolerances of 1e-8
WAYS = {
    "qp": Qp(),
    "qp, osqp defaults": Qp(eps=1e-3, polish=False),
    **{f"qp, {backend}": Qp(backend=backend) for backend in BACKENDS if backend != "osqp"},
    "lcp, lemke": Lcp(),
    "lcp, active-set": Lcp(method="active-set"),
    "lcp, nnls": Lcp(method="nnls"),
    "lcp, full": Lcp(system="full"),
    "qp, full": Qp(system="full"),
}


SLOW = ("qp, osqp defaults",)  # as qp, but that more is left to what follows the backend


def where_installed(name: str, backend: str):
    reason = missing(backend)
    marks = [pytest.mark.skipif(reason is not None, reason=str(reason)), *[pytest.mark.slow] * (name in SLOW)]
    return pytest.param(name, marks=marks)


each_backend = pytest.mark.parametrize("backend", [where_installed(name, name) for name in BACKENDS])
each_way = pytest.mark.parametrize(
    "way", [where_installed(name, getattr(way, "backend", "osqp")) for name, way in WAYS.items()]
)


def agrees(way: str, data, *built_in: np.ndarray) -> None:
    """With what is built in, or else with nnls, whose answer the judge has passed."""
    problem = data.problem()
    solution = WAYS[way].solve(problem, ContactSolution.at_rest(len(data.f), len(data.w)))
    assert solution.outcome is Outcome.CONVERGED
    u, pressure = built_in or dual_by_nnls(data, math.inf)
    assert judge(problem, u, np.maximum(pressure, 0)).failures() == []
    np.testing.assert_allclose(solution.u, u, rtol=0, atol=NNLS)
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=NNLS)
    assert judge(problem, solution.u, solution.pressure).failures() == []


@each_way
@given(
    seed=st.integers(0, 2**32 - 1),
    kind=st.sampled_from(["obstacle", "definite", "inclined"]),
    states=st.lists(st.sampled_from([OPEN, PRESSED, TOUCHING]), min_size=1, max_size=12),
)
@settings(deadline=None, derandomize=True, max_examples=15)
def test_any_mixture_of_open_pressed_and_touching(way, seed, kind, states) -> None:
    agrees(way, *manufactured(np.random.default_rng(seed), kind, np.array(states)))


@each_way
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(["obstacle", "definite", "inclined"]))
@settings(deadline=None, derandomize=True, max_examples=8)
def test_random(way, seed, kind) -> None:
    agrees(way, random_quadratic(np.random.default_rng(seed), kind, 8))


@each_way
def test_flattened_patch_without_pressure(way) -> None:
    """A beam bent flat against a wall: the rim carries all, the patch between nothing, as in the nonlinear theory."""
    for m in (5, 20, 60):
        states = np.full(m, TOUCHING)
        states[[0, -1]] = PRESSED
        agrees(way, *manufactured(np.random.default_rng(m), "definite", states))


def test_nnls_itself_is_right_or_corrected() -> None:
    """Gaps of exactly zero mislead scipy's nnls now and then; what we make of it is right each time."""
    states = np.array([OPEN, TOUCHING, PRESSED, TOUCHING, OPEN, TOUCHING, TOUCHING, PRESSED])
    for seed in range(40):
        data, _, pressure = manufactured(np.random.default_rng(seed), "definite", states)
        S = data.G @ np.linalg.solve(data.K, data.G.T)
        actual = by_nnls(S, data.g0 + data.G @ np.linalg.solve(data.K, data.f))
        np.testing.assert_allclose(actual.z, data.w * pressure, rtol=0, atol=NNLS, err_msg=f"seed {seed}")


def test_nnls_alone_is_no_oracle_of_exact_touch() -> None:
    """Must fail beside must pass, a published solver: nodes that just touch, everything else open, nothing presses."""
    wrong, corrected = 0, 0
    for seed in range(300):
        data, u, pressure = manufactured(
            np.random.default_rng(seed), "definite", np.array([0, 0, 0, 2, 0, 2, 0, 2, 0, 0])
        )
        S = data.G @ np.linalg.solve(data.K, data.G.T)
        ours = by_nnls(S, data.g0 + data.G @ np.linalg.solve(data.K, data.f))
        np.testing.assert_allclose(ours.z, data.w * pressure, rtol=0, atol=NNLS)
        corrected += ours.event is not None
        if np.max(np.abs(dual_by_nnls(data, math.inf)[1] - pressure)) > 1e-3:
            wrong += 1
            agrees("lcp, nnls", data, u, pressure)
    assert corrected > 0
    if wrong == 0:  # the one of 1.15 names nodes without pressure, and gives them none
        pytest.skip(f"nnls of scipy {scipy.__version__} is right on all of them")


def test_nnls_is_refused_without_symmetry_and_pivots_are_not(rng) -> None:
    data = random_quadratic(rng, "definite", 6)
    skew = rng.normal(size=data.K.shape)
    data = Quadratic(data.K + 0.3 * (skew - skew.T), data.f, data.G, data.g0, data.w)
    problem, rest = data.problem(), ContactSolution.at_rest(len(data.f), 6)
    for algorithm in (Lcp(method="nnls"), Qp()):
        refused = algorithm.solve(problem, rest)
        assert refused.outcome is Outcome.REFUSED
        assert "transpose" in str(refused.history[-1]["event"])
    for method in ("lemke", "active-set"):
        solution = Lcp(method=method).solve(problem, rest)
        assert solution.outcome is Outcome.CONVERGED
        assert solution.active.any()
        assert judge(problem, solution.u, solution.pressure).failures() == []


@each_backend
def test_a_tangent_that_is_not_convex_is_shifted_and_told(backend) -> None:
    """The unknown that the foundation holds has no stiffness of its own but a negative one: K is indefinite."""
    K = np.diag([-0.5, 2.0, 3.0]) + 0.1
    data = Quadratic(K, np.array([1.0, 1.0, 0.5]), -np.eye(3)[:2], np.array([0.2, 5.0]), np.ones(2))
    solution = Qp(backend=backend).solve(data.problem(), ContactSolution.at_rest(3, 2))
    assert solution.outcome is Outcome.CONVERGED
    assert any("not convex" in str(row.get("event", "")) for row in solution.history)
    assert judge(data.problem(), solution.u, solution.pressure).failures() == []


def programme(rng, n: int, m: int) -> tuple[Programme, np.ndarray, np.ndarray]:
    """With its answer x, y: every other row holds, with a multiplier."""
    P, A, x = definite(rng, n), rng.normal(size=(m, n)), rng.normal(size=n)
    holds = np.arange(m) % 2 == 0
    y, slack = np.where(holds, rng.uniform(0.5, 2, m), 0.0), np.where(holds, 0.0, rng.uniform(0.5, 2, m))
    return Programme(sparse.csc_matrix(P), A.T @ y - P @ x, sparse.csc_matrix(A), A @ x - slack), x, y


@each_backend
def test_backends_have_the_signs_and_rows_that_they_should(rng, backend) -> None:
    for n, m in ((1, 1), (5, 1), (8, 3), (20, 12), (4, 0)):
        whole, x, y = programme(rng, n, m)
        answer = ask(backend, whole, 1e-8, True)
        assert answer.claimed, answer.status
        np.testing.assert_allclose(answer.x, x, rtol=0, atol=BY_BACKEND)
        np.testing.assert_allclose(answer.y, y, rtol=0, atol=BY_BACKEND)


@each_backend
def test_what_has_no_answer_is_not_claimed(rng, backend) -> None:
    good, _, _ = programme(rng, 4, 2)
    bad = {
        "infeasible": replace(good, A=sparse.csc_matrix([[1.0, 0, 0, 0], [-1.0, 0, 0, 0]]), b=np.ones(2)),
        "unbounded": replace(good, P=sparse.csc_matrix((4, 4))),
        "NaN in P": replace(good, P=good.P * np.nan),
        "NaN in q": replace(good, q=good.q * np.nan),
        "infinite b": replace(good, b=good.b * np.inf),
    }
    for spoilt, spoilt_programme in bad.items():
        answer = ask(backend, spoilt_programme, 1e-8, True)
        assert not answer.claimed, spoilt
        assert np.all(np.abs(np.append(answer.x, answer.y)) < 1e9), spoilt


@pytest.mark.parametrize("failure", [RuntimeError("out of memory"), type("Panic", (BaseException,), {})("unwrap")])
def test_a_backend_that_raises_is_told_and_exact_steps_go_on(rng, monkeypatch, failure) -> None:
    def fail(*_: object) -> None:
        raise failure

    monkeypatch.setitem(BACKENDS, "osqp", fail)
    data = random_quadratic(rng, "obstacle")
    solution = Qp().solve(data.problem(), ContactSolution.at_rest(len(data.f), len(data.w)))
    assert solution.outcome is Outcome.CONVERGED
    assert str(failure) in " ".join(str(row.get("event", "")) for row in solution.history)
    assert judge(data.problem(), solution.u, solution.pressure).failures() == []


@each_backend
def test_a_far_candidate_that_the_near_one_pushes_in_is_handed_over(backend) -> None:
    """The near one alone would press; what it leaves goes through the far wall, which then lifts it off its own."""
    flexible, free, walls = np.array([[1.0, 0.5], [0.5, 1.0]]), np.array([-1.0, -4.0]), np.array([0.0, 1.0])
    K = np.linalg.inv(flexible)
    data = Quadratic(K, K @ free, np.eye(2), walls, np.ones(2))
    solution = Qp(backend=backend).solve(data.problem(), ContactSolution.at_rest(2, 2))
    assert solution.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(solution.u, [0.5, -1.0], rtol=0, atol=NNLS)
    np.testing.assert_allclose(solution.pressure, [0.0, 3.0], rtol=0, atol=NNLS)
    assert not any("corrected" in str(row.get("event", "")) for row in solution.history)  # a second programme knew both


def test_osqp_is_quiet_where_nothing_presses(rng, capfd) -> None:
    data, _, _ = manufactured(rng, "definite", np.array([OPEN, OPEN, OPEN]))
    solution = Qp().solve(data.problem(), ContactSolution.at_rest(len(data.f), 3))
    assert solution.outcome is Outcome.CONVERGED
    assert not solution.active.any()
    assert "".join(capfd.readouterr()) == ""


def test_no_solution_is_said() -> None:
    with pytest.raises(LcpError, match="secondary ray"):
        lemke(np.array([[-1.0, 0.0], [0.0, 1.0]]), np.array([-1.0, -1.0]))
    with pytest.raises(LcpError, match="positive definite"):
        by_nnls(np.array([[1.0, 2.0], [2.0, 1.0]]), -np.ones(2))


def test_unknown_methods_are_refused_with_the_choices(rng) -> None:
    choices = (Lcp(method="magic"), "lemke, active-set, nnls"), (Qp(backend="magic"), "osqp, clarabel")
    for algorithm, hint in choices:
        assert hint in algorithm.supports(random_quadratic(rng, "definite").problem())


def test_single_swaps_that_come_back_are_given_up_at_once() -> None:
    """-z - 1 >= 0 has no solution with z >= 0: either set of its index is wrong, and no size is a reason to go on."""
    for n in (1, 50):
        M, q = np.eye(n), np.zeros(n)
        M[-1, -1], q[-1] = -1.0, -1.0
        with pytest.raises(LcpError, match=r"after \d updates: M is no P-matrix"):
            active_set(M, q)


def test_exchanged_forces_and_gaps_are_the_same_problem(rng) -> None:
    """Any z and w = M z + q keep to the problem in which some of them have changed places."""
    M, q, z = rng.normal(size=(6, 6)), rng.normal(size=6), rng.normal(size=6)
    w = M @ z + q
    for chosen in (np.zeros(6, bool), np.arange(6) % 3 == 0, np.ones(6, bool)):
        M_, q_ = principal_pivot(M, q, chosen)
        np.testing.assert_allclose(M_ @ np.where(chosen, w, z) + q_, np.where(chosen, z, w), rtol=0, atol=1e-12)
