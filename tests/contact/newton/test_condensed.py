"""One factorisation for every set of a linearised problem: against dense solves, and with what it must not spend."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.newton.condensed import Condensed
from contact.newton.step import NewtonRun
from contact.operations import dense_solution
from contact.problem import ContactProblem
from contact.solvers import lcp_pivoting
from contact.solvers.sparse import AUTO, SingularMatrixError, factorise, response, response_flops
from studies.scenes.complete import complete
from studies.solving.solve import solve
from support.problems.contact_problems import Quadratic, dense_step, random_quadratic

DENSE = 1e-9
SAME = 1e-10  # force and pressures of a tyre, condensed and in full
KINDS = [("obstacle", True), ("inclined", True), ("inclined", False)]


def linearised(problem: ContactProblem, u: np.ndarray, base: np.ndarray, epsilon: float, solver: str) -> Condensed:
    run = NewtonRun(problem, epsilon, solver)
    actual = run.linear(run.linearise(u, None), u, np.zeros(len(base)), base)
    assert isinstance(actual, Condensed)
    return actual


def example(kind: str, symmetric: bool, seed: int) -> tuple[Quadratic, np.ndarray, np.random.Generator]:
    rng = np.random.default_rng(seed)
    data = random_quadratic(rng, kind)
    if not symmetric:
        data = replace(data, K=data.K + 0.3 * rng.normal(size=data.K.shape))
    return data, rng.normal(size=len(data.f)), rng


def test_the_step_on_any_set_is_that_of_the_dense_saddle_point() -> None:
    """Sets near the one that was factorised, its complement, all and none, by one factorisation."""
    springs = 1e-2, 1e4, 1e14, math.inf
    for (kind, symmetric), epsilon, solver in product(KINDS, springs, ("multifrontal", "splu")):
        for seed in range(2):
            data, u, rng = example(kind, symmetric, seed)
            base = rng.random(6) < 0.5
            problem = replace(data.problem(), ordered=True)
            linear = linearised(problem, u, base, epsilon, solver)
            for active in (base ^ (np.arange(6) == 2), ~base, np.ones(6, bool), np.zeros(6, bool), base):
                du, pressure = linear.step(active)
                exact_du, exact_pressure = dense_step(data, np.diag(data.w), u, active, epsilon)
                np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * (1 + np.max(np.abs(exact_du))))
                size = 1 + np.max(np.abs(exact_pressure))
                np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * size)
                gap, foreseen = linear.foreseen(active)
                np.testing.assert_allclose(
                    gap, data.g0 + data.G @ (u + du), rtol=0, atol=DENSE * (1 + np.max(np.abs(du)))
                )
                np.testing.assert_allclose(foreseen, pressure, rtol=0, atol=DENSE * size)
                closed = (data.g0 + data.G @ (u + du) + pressure / epsilon)[active]
                assert np.all(np.abs(closed) <= 1e-14 * (1 + np.abs(data.G) @ (np.abs(u) + np.abs(du)))[active])


def test_the_matrix_is_the_principal_pivot_transform_of_the_delassus_matrix() -> None:
    """w = M z + q of all candidates, and exchanged back: compliance and gaps without any contact."""
    for (kind, symmetric), epsilon in product(KINDS, (1e2, math.inf)):
        data, u, rng = example(kind, symmetric, 0)
        base = rng.random(6) < 0.5
        M, q = linearised(data.problem(), u, base, epsilon, AUTO).block(np.arange(6))
        compliance = data.G @ np.linalg.solve(data.K, data.G.T) + np.diag(1 / (epsilon * data.w))
        free = data.g0 + data.G @ np.linalg.solve(data.K, data.f)
        back, gap = lcp_pivoting.principal_pivot(M, q, base)
        np.testing.assert_allclose(back, compliance, rtol=0, atol=DENSE * np.max(np.abs(compliance)))
        np.testing.assert_allclose(gap, free, rtol=0, atol=DENSE)
        if symmetric:
            np.testing.assert_allclose(M[np.ix_(base, ~base)], -M[np.ix_(~base, base)].T, rtol=0, atol=DENSE)


def test_two_bounds_on_one_unknown_are_exchanged() -> None:
    """Lower and upper wall of each unknown: the one is let go, and the other pushes where it was held."""
    rng = np.random.default_rng(3)
    one = random_quadratic(rng, "obstacle")
    u = rng.normal(size=len(one.f))
    data = Quadratic(one.K, one.f, np.vstack([one.G, -one.G]), np.append(one.g0, 3.0 - one.g0), np.ones(12))
    base = np.arange(12) < 3
    linear = linearised(data.problem(), u, base, math.inf, AUTO)
    for active in (np.roll(base, 6), np.isin(np.arange(12), (0, 7, 8))):
        du, pressure = linear.step(active)
        exact_du, exact_pressure = dense_step(data, np.eye(12), u, active, math.inf)
        np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE)
        np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE)
    with pytest.raises(ValueError, match="depend on one another"):
        linear.near(np.isin(np.arange(12), (0, 6)))


def test_a_set_that_leaves_a_mechanism_is_singular() -> None:
    """Held by one candidate alone, which is then let go."""
    K = np.array([[1.0, -1.0], [-1.0, 1.0]])
    data = Quadratic(K, np.array([1.0, 0.5]), -np.eye(2), np.full(2, 0.1), np.ones(2))
    linear = linearised(data.problem(), np.zeros(2), np.array([True, False]), math.inf, AUTO)
    with pytest.raises(SingularMatrixError):
        linear.step(np.zeros(2, bool))


@pytest.mark.parametrize("column", [1000, 0])
def test_where_columns_or_their_system_cost_more_the_set_is_factorised_anew(
    monkeypatch: pytest.MonkeyPatch, column: int
) -> None:
    data, u, _ = example("definite", True, 0)
    monkeypatch.setattr("contact.newton.exchange.response_flops", lambda factor, left, right: column * right.shape[1])
    monkeypatch.setattr("contact.newton.condensed.SETUP", 0.0)
    enough = 2 * column + dense_solution(2)
    monkeypatch.setattr("contact.newton.condensed.factor_flops", lambda factor: enough)
    linear = linearised(data.problem(), u, np.zeros(6, bool), math.inf, AUTO)
    few, many = np.arange(6) < 2, np.arange(6) < 5
    assert linear.near(few) is linear
    anew = linear.near(many)
    assert np.array_equal(anew.base, many)
    du, _ = anew.step(many)
    linear.foreseen(many)
    assert not linear.base.any()  # a question changes nothing
    np.testing.assert_allclose(du, dense_step(data, np.diag(data.w), u, many, math.inf)[0], rtol=0, atol=DENSE)


def test_exchanging_twice_changes_nothing() -> None:
    rng = np.random.default_rng(5)
    M, q = rng.normal(size=(7, 7)) + 4 * np.eye(7), rng.normal(size=7)
    chosen = np.arange(7) % 3 == 0
    again, constant = lcp_pivoting.principal_pivot(*lcp_pivoting.principal_pivot(M, q, chosen), chosen)
    np.testing.assert_allclose(again, M, atol=1e-12)
    np.testing.assert_allclose(constant, q, atol=1e-12)
    z = rng.normal(size=7)
    w = M @ z + q
    other, rest = lcp_pivoting.principal_pivot(M, q, chosen)
    np.testing.assert_allclose(other @ np.where(chosen, w, z) + rest, np.where(chosen, z, w), atol=1e-12)
    with pytest.raises(lcp_pivoting.LcpError, match="singular"):
        lcp_pivoting.principal_pivot(np.zeros((2, 2)), np.zeros(2), np.ones(2, bool))


def tyre(contact: str, **settings: str) -> tuple[dict[str, float], float, np.ndarray]:
    result = solve(*complete("tyre", {"delta_mm": "20", **settings}, "16x14", model="half", contact=contact))
    return dict(result.counters), float(result.steps[-1]["force_N"]), result.last.pressure


@pytest.mark.slow
def test_one_factorisation_an_iteration_is_enough() -> None:
    """Of the tyre pressed in one step, by every algorithm that enforces contact; the same answer as in full."""
    exact = {"epsilon": "inf"}
    _, force, pressure = tyre("semismooth", solver="splu", **exact)
    for contact in ("semismooth", "lcp", "qp", "trial-and-error"):
        counters, actual, pressed = tyre(contact, **exact)
        assert counters["factorisations"] <= counters["newton_iterations"] + 2, contact
        assert actual == pytest.approx(force, rel=SAME), contact
        np.testing.assert_allclose(pressed, pressure, rtol=0, atol=1e-8 * np.max(pressure))
        assert np.array_equal(pressed > 0, pressure > 0)
    for contact in ("lcp", "qp"):
        _, actual, pressed = tyre(contact, system="full", **exact)
        assert actual == pytest.approx(force, rel=SAME), contact
        assert np.array_equal(pressed > 0, pressure > 0)


def test_columns_by_fronts_are_those_of_the_inverse() -> None:
    """With sides that touch few unknowns, and different ones; the operations grow with the columns."""
    rng = np.random.default_rng(1)
    n = 300
    A = sparse.diags_array(
        [np.full(n, 4.0), *(np.full(n - k, -1.0) for k in (1, 1, 17, 17))], offsets=[0, 1, -1, 17, -17]
    )
    K = sparse.csc_matrix(A)
    sides = [sparse.csc_matrix(sparse.random_array((n, k), density=0.01, rng=rng)) for k in (9, 5)]
    left, right = (sparse.csc_matrix(side.multiply((np.arange(n) < 150)[:, None])) for side in sides)
    exact = left.T @ np.linalg.solve(K.toarray(), right.toarray())
    for solver in ("multifrontal", "splu"):
        factor = factorise(K, solver, ordered=True)
        np.testing.assert_allclose(response(factor, left, right), exact, rtol=0, atol=1e-12)
        assert 0 < response_flops(factor, left, right[:, :1]) < response_flops(factor, left, right)
    assert response_flops(factorise(K, "multifrontal", ordered=True), left, right[:, :0]) == 0
