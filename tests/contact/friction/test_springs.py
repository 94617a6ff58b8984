"""Friction on springs: its tangent, its limit, one candidate in closed form, and the judge of a finite epsilon."""

from __future__ import annotations

import numpy as np
import pytest

from contact.algorithms.regularised import Regularised
from contact.coulomb import State
from contact.newton.friction_states import Directions, Local, directed
from contact.newton.friction_step import Linear, SprungStep
from contact.newton.step import NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.verify import judge
from support.problems.planted_friction import linear, planted


def solved(problem: ContactProblem, epsilon: float, n: int) -> ContactSolution:
    return Regularised(epsilon=epsilon).solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


def returned(problem: ContactProblem, u: np.ndarray, k: float) -> tuple[np.ndarray, np.ndarray]:
    """f = k <-g>, and t = -k s pulled back to the disc: the law, written apart from the algorithm."""
    f, y = k * np.maximum(-problem.gap(u), 0.0), -k * problem.coulomb.slip(u)
    size = np.linalg.norm(y, axis=1)
    return f, y * np.minimum(1.0, problem.coulomb.mu * f / np.where(size > 0, size, 1.0))[:, None]


@pytest.mark.parametrize("seed", range(5))
def test_the_error_falls_with_the_inverse_of_epsilon(seed: int) -> None:
    wanted, stiff = planted(seed, 0.5), np.array([1e3, 1e4, 1e5, 1e6])
    errors = []
    for epsilon in stiff:
        found = solved(wanted.problem, epsilon, len(wanted.u))
        assert found.outcome is Outcome.CONVERGED
        assert np.array_equal(found.rubbed.state, wanted.state)
        errors.append(np.max(np.abs(found.rubbed.force - wanted.friction)))
    assert np.polyfit(np.log(stiff), np.log(errors), 1)[0] == pytest.approx(-1, abs=0.02)


@pytest.mark.parametrize("epsilon", [1.0, 1e4, 1e12])
@pytest.mark.parametrize("mu", [0.1, 1.0])
def test_no_digit_is_lost_on_stiff_springs(mu: float, epsilon: float) -> None:
    """By the law where that can be worked out from u, by the answer without springs where it cannot."""
    wanted = planted(7, mu)
    found = solved(wanted.problem, epsilon, len(wanted.u))
    assert found.outcome is Outcome.CONVERGED
    f, t = returned(wanted.problem, found.u, epsilon) if epsilon < 1e5 else (wanted.normal, wanted.friction)
    assert np.max(np.abs(found.pressure - f)) < 1e-8
    assert np.max(np.abs(found.rubbed.force - t)) < 1e-8


@pytest.mark.parametrize("along", [0.1, 3.0])
def test_one_candidate_in_closed_form(along: float) -> None:
    """Body springs K beside the foundation's k: u_n = F_n/(K + k); in stick u_t = F_t/(K + k), else (F_t - mu f)/K."""
    K, k, mu, pressed = 2.0, 50.0, 0.3, 1.0
    G, S = np.array([[0.0, 0.0, 1.0]]), np.eye(3)[:2]
    load = np.array([0.6 * along, 0.8 * along, -pressed])
    problem = linear(K * np.eye(3), load, G, S, np.zeros(1), np.zeros((1, 2)), np.full(1, mu))
    found, f = solved(problem, k, 3), k * pressed / (K + k)
    sticks = along * k / (K + k) <= mu * f
    u_t = along / (K + k) if sticks else (along - mu * f) / K
    assert found.u == pytest.approx([0.6 * u_t, 0.8 * u_t, -pressed / (K + k)], rel=1e-12)
    assert found.pressure[0] == pytest.approx(f, rel=1e-12)
    assert np.linalg.norm(found.rubbed.force) == pytest.approx(k * u_t if sticks else mu * f, rel=1e-12)
    assert found.rubbed.state[0] == (State.STICK if sticks else State.SLIP)


def test_the_step_is_newtons_on_the_residual() -> None:
    """R = r - G^T f - S^T t(g, s) falls like 1 - h on the way of the step, but for terms in h^2."""
    one, k = planted(1, 0.5, m=5), 30.0
    problem, rng = one.problem, np.random.default_rng(8)
    u = one.u + 0.01 * rng.standard_normal(len(one.u))
    G = problem.gap_jacobian(u)
    u = u - G.T @ (problem.gap(u) + rng.uniform(0.2, 0.4, 5))  # rows of G are orthonormal: all are pushed in
    f, t = returned(problem, u, k)
    stuck = np.linalg.norm(t, axis=1) < 0.999 * problem.coulomb.mu * f
    assert 0 < stuck.sum() < 5
    state = np.where(stuck, State.STICK, State.SLIP).astype(np.int8)
    local = Local(problem.gap(u) + f / k, problem.coulomb.slip(u) + t / k, f, t, np.ones(5))
    laws = directed(local, state, problem.coulomb.mu * f)
    lin, now = problem.linearise(u, None), np.column_stack([problem.gap(u), problem.coulomb.slip(u)]).ravel()
    ways = Directions.of(G, problem.coulomb.slip_jacobian(u))
    linear = Linear(lin.tangent, lin.residual, ways, now, problem.coulomb.mu)
    du = SprungStep(NewtonRun(problem, k), linear, np.full(5, k)).step(laws).du

    def residual(h: float) -> np.ndarray:
        at = u + h * du
        return problem.linearise(at, None).residual - problem.contact_force(at, *returned(problem, at, k))

    lengths = np.array([1e-2, 1e-3])
    left = [np.max(np.abs(residual(h) - (1 - h) * residual(0.0))) for h in lengths]
    assert np.log10(left[0] / left[1]) == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize("epsilon", [10.0, 1e4])
def test_the_judge_takes_it_with_its_own_epsilon_alone(epsilon: float) -> None:
    wanted = planted(3, 0.5)
    found = solved(wanted.problem, epsilon, len(wanted.u))
    answer = wanted.problem, found.u, found.pressure, found.rubbed.force
    assert judge(*answer, epsilon=epsilon).failures() == []
    for other in (1.001 * epsilon, np.inf):
        assert {"penetration", "complementarity", "stick"} & set(judge(*answer, epsilon=other).failures())
    turned = found.rubbed.force @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert "direction" in judge(wanted.problem, found.u, found.pressure, turned, epsilon=epsilon).failures()
