"""Friction on a polygon, by programmes and by pivots: its error, what finishes it, and where it has to stop."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.algorithms.tresca import Tresca
from contact.coulomb import State
from contact.events import EventKind, events
from contact.newton import friction_compliance
from contact.newton.friction_compliance import Block
from contact.problem import ContactProblem, ContactSolution, Outcome, linear_mechanics
from contact.solvers.lcp_pivoting import LcpError, lemke
from contact.solvers.qp_backends import ask
from contact.verify import judge
from support.problems.frictional import linear, planted, with_mu

SIDES = np.array([4, 8, 16, 32])


def dragged(angle: float, K: np.ndarray | None = None) -> ContactProblem:
    """One candidate pressed by 1 N with mu = 0.5 on a foundation that has gone 10 mm in the direction ``angle``."""
    G, S = np.array([[0.0, 0.0, 1.0]]), np.eye(3)[:2]
    slip = -10 * np.array([[math.cos(angle), math.sin(angle)]])
    body = np.eye(3) if K is None else K
    return linear(body, np.array([0.0, 0.0, -1.0]), G, S, np.zeros(1), slip, np.full(1, 0.5))


def solved(algorithm: Qp | Lcp, problem: ContactProblem) -> ContactSolution:
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    return algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


def test_friction_between_two_corners_is_short_by_the_cosine() -> None:
    for kind in (Qp, Lcp):
        short = []
        for sides in SIDES.tolist():
            solution = solved(kind(sides=sides, finish=False), dragged(math.pi / sides))
            assert solution.outcome is Outcome.CONVERGED
            short.append(1 - float(np.linalg.norm(solution.rubbed.force)) / 0.5)
            assert short[-1] == pytest.approx(1 - math.cos(math.pi / sides), abs=1e-6)
        assert np.polyfit(np.log(SIDES), np.log(short), 1)[0] == pytest.approx(-2, abs=0.05)


def test_it_is_never_shorter_nor_beyond_the_disc() -> None:
    for kind, angle in product((Qp, Lcp), np.linspace(0.05, 1.5, 5)):
        solution = solved(kind(sides=8, finish=False), dragged(angle))
        against = solution.rubbed.force[0] @ [math.cos(angle), math.sin(angle)] / 0.5
        assert math.cos(math.pi / 8) - 1e-6 <= against <= 1 + 1e-6


def test_the_judge_refuses_the_polygon_and_takes_what_exact_steps_make_of_it() -> None:
    for kind in (Qp, Lcp):
        problem = planted(5, 0.5).problem
        for finish in (False, True):
            solution = solved(kind(finish=finish), problem)
            assert solution.outcome is Outcome.CONVERGED
            assert bool(judge(problem, solution.u, solution.pressure, solution.rubbed.force).failures()) is not finish
            messages = [str(event) for event in events(solution.history, EventKind.SUBSTITUTE)]
            assert any("forces are those of the programme" in text for text in messages) is not finish


def test_a_slip_with_one_way_has_no_polygon() -> None:
    wanted = planted(5, 0.5, components=1)
    solution = solved(Lcp(sides=4, finish=False), wanted.problem)
    assert solution.outcome is Outcome.CONVERGED
    assert np.max(np.abs(solution.rubbed.force - wanted.friction)) < 1e-9


def test_discs_are_those_of_cvxpy(rng: np.random.Generator) -> None:
    """The same programme written down in another language, for another solver."""
    import cvxpy as cp

    c = 4
    root = rng.standard_normal((3 * c, 3 * c))
    W, v, bound = root @ root.T + np.eye(3 * c), rng.standard_normal(3 * c), rng.uniform(0.1, 0.5, c)
    v[::3] -= 2
    block = Block(W, v, np.ones(c), np.ones(c), np.ones((c, 3), bool))
    programme, chosen = Tresca.of(block, 0).programme(bound)
    tresca = Tresca.of(block, 0)
    actual = tresca.forces(ask("clarabel", programme, 1e-10, polish=False).x, chosen)
    F = cp.Variable(3 * c)
    discs = [cp.norm(F[3 * i + 1 : 3 * i + 3]) <= bound[i] for i in range(c)]
    cp.Problem(cp.Minimize(cp.quad_form(F, cp.psd_wrap(W)) / 2 + v @ F), [F[::3] >= 0, *discs]).solve(
        solver=cp.SCS, eps=1e-10, max_iters=100_000
    )
    assert np.max(np.abs(actual.ravel() - F.value)) < 1e-6
    assert np.max(np.linalg.norm(actual[:, 1:], axis=1) / bound) == pytest.approx(1, abs=1e-6)


def test_a_backend_without_discs_says_so() -> None:
    block = Block(np.eye(3), np.array([-1.0, 1.0, 1.0]), np.ones(1), np.ones(1), np.ones((1, 3), bool))
    programme, _ = Tresca.of(block, 0).programme(np.ones(1))
    answer = ask("osqp", programme, 1e-8, polish=False)
    assert not answer.claimed
    assert "no discs" in answer.status


def test_no_energy_no_programme() -> None:
    K = np.array([[1.0, 0.3, 0.0], [-0.3, 1.0, 0.0], [0.0, 0.0, 1.0]])
    problem = dragged(0.4, K)
    solution = solved(Qp(), problem)
    assert solution.outcome is Outcome.REFUSED
    assert "no energy to minimise" in str(events(solution.history, EventKind.FAILED)[-1])
    solution = solved(Lcp(), problem)
    assert solution.outcome is Outcome.CONVERGED
    assert not judge(problem, solution.u, solution.pressure, solution.rubbed.force).failures()


def test_pivots_are_bounded() -> None:
    """Murty's matrix takes 2^n of them: Lemke's method goes on until it may not."""
    n = 9
    M, q = 2 * np.tril(np.ones((n, n)), -1) + np.eye(n), -(2.0 ** np.arange(n, 0, -1) * 1.0)
    M = M.T
    with pytest.raises(LcpError, match="without an end"):
        lemke(M, q, most=3)
    z = lemke(M, q).z
    assert np.min(M @ z + q) > -1e-9


def test_where_pivots_may_not_go_on_exact_steps_take_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(friction_compliance, "PIVOTS_EACH", 0)
    wanted = planted(5, 0.5)
    solution = solved(Lcp(), wanted.problem)
    assert solution.outcome is Outcome.CONVERGED
    assert np.max(np.abs(solution.rubbed.force - wanted.friction)) < 1e-8
    assert any("settled by exact steps instead" in str(event) for event in events(solution.history))
    refused = solved(Lcp(finish=False), wanted.problem)
    assert refused.outcome is Outcome.UNSOLVED


def test_a_body_that_only_the_foundation_holds() -> None:
    """Two masses and springs between them, pressed and pulled: the first sticks, the second slips."""
    for kind in (Qp, Lcp):
        K, along, off = np.zeros((4, 4)), [0, 2], [1, 3]
        K[np.ix_(along, along)] = K[np.ix_(off, off)] = [[1.0, -1.0], [-1.0, 1.0]]
        G, S = np.eye(4)[off], np.zeros((4, 4))
        S[[0, 2]] = np.eye(4)[along]
        load = np.array([0.0, -1.0, 0.8, -1.0])
        problem = linear(K, load, G, S, np.zeros(2), np.zeros((2, 2)), np.full(2, 0.5))
        solution = solved(kind(), problem)
        assert solution.outcome is Outcome.CONVERGED
        assert solution.rubbed.state.tolist() == [State.STICK, State.SLIP]
        assert solution.u == pytest.approx([0.0, 0.0, 0.3, 0.0], abs=1e-12)
        assert solution.rubbed.force[:, 0] == pytest.approx([-0.3, -0.5], abs=1e-12)
        assert any("only the foundation holds" in str(event) for event in events(solution.history))
        lost = replace(problem, linearise=linear_mechanics(sparse.csc_matrix(K), 3 * load))
        assert not solved(kind(), with_mu(lost, np.full(2, 0.1))).outcome.converged


def test_a_polygon_needs_an_even_number_of_sides() -> None:
    for kind, sides in product((Qp, Lcp), (2, 7)):
        assert "even number" in (kind(sides=sides).supports(dragged(0.0)) or "")
