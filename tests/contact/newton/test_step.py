"""The step of Newton on a fixed set, against the dense saddle-point system."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from contact.newton.loop import Step, iterate
from contact.newton.step import ROUNDING_MARGIN, Iterate, NewtonRun
from contact.problem import ContactSolution, Outcome
from contact.rounding import rounding_floor
from contact.solvers.sparse import SingularMatrixError
from support.problems.contact_problems import Quadratic, dense_step, random_quadratic

DENSE = 1e-9
EPSILONS = (1e-2, 1e4, 1e14, math.inf)
SOLVERS = ("auto", "multifrontal", "splu")


def is_dense(data: Quadratic, W: np.ndarray, run: NewtonRun, u: np.ndarray, active: np.ndarray, *, start=None) -> None:
    """The step on a set is that of the dense saddle-point system."""
    old = np.zeros(len(data.w)) if start is None else start
    du, pressure = run.step(run.linearise(u, None), u, old, active)
    exact_du, exact_pressure = dense_step(data, W, u, active, run.epsilon)
    np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * (1 + np.max(np.abs(exact_du))))
    size = 1 + np.max(np.abs(exact_pressure))
    np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * size)
    assert np.all(pressure[~active] == 0)


def coupling_matrix(rng, w: np.ndarray) -> np.ndarray:
    """A consistent matrix: neighbours share area, the rows sum to about w."""
    m = len(w)
    off = np.diag(rng.uniform(0.1, 0.2, m - 1), 1)
    return np.diag(w) + off + off.T


STEPS = [  # one unknown or three in a gap row, symmetric or non-symmetric mechanics and coupling
    ("obstacle", "lumped", True),
    ("definite", "consistent", True),
    ("inclined", "lumped", False),
    ("inclined", "consistent", False),
]


def test_step_is_that_of_the_dense_saddle_point() -> None:
    """For one and for three unknowns in a gap row, any epsilon, symmetric and non-symmetric mechanics, several sets."""
    for (kind, coupling, symmetric), epsilon, solver in product(STEPS, EPSILONS, SOLVERS):
        for seed in range(2):
            rng = np.random.default_rng(seed)
            data = random_quadratic(rng, kind)
            n, m = data.G.shape[1], len(data.w)
            if not symmetric:
                K = data.K + 0.3 * rng.normal(size=(n, n))
                data = Quadratic(K, data.f, data.G, data.g0, data.w)
            W = np.diag(data.w) if coupling == "lumped" else coupling_matrix(rng, data.w)
            problem = data.problem(None if coupling == "lumped" else W)
            u, old_pressure = rng.normal(size=n), rng.uniform(0, 1, m)
            for active in (rng.random(m) < 0.5, np.ones(m, bool), np.zeros(m, bool)):
                is_dense(data, W, NewtonRun(problem, epsilon, solver), u, active, start=old_pressure)


@pytest.mark.parametrize("epsilon", EPSILONS)
def test_stiff_and_soft_directions_lose_no_digit(rng, epsilon) -> None:
    """Stiffnesses over six decades, as a thin shell has them: the answer stays that of the scaled dense solve."""
    data = random_quadratic(rng, "inclined")
    n = data.G.shape[1]
    stiff = 10 ** rng.uniform(-3, 3, n)
    K = np.diag(stiff) + 0.1 * np.sqrt(np.outer(stiff, stiff)) * np.tri(n, k=-1) / n
    K = (K + K.T) / 2
    data = Quadratic(K, data.f, data.G, data.g0, data.w)
    run = NewtonRun(data.problem(), epsilon)
    u, active = np.zeros(n), np.array([True, False, True, True, False, True])
    du, pressure = run.step(run.linearise(u, None), u, np.zeros(6), active)
    exact_du, exact_pressure = dense_step(data, np.diag(data.w), u, active, epsilon)
    np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * np.max(np.abs(exact_du)))
    np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * np.max(np.abs(exact_pressure)))


@pytest.mark.parametrize("epsilon", [math.inf, 3.0])
@pytest.mark.parametrize("own", [True, False])
def test_candidates_may_share_unknowns(rng, epsilon, own) -> None:
    """As faces do that both deform: each with an unknown of its own beside, or none with any."""
    data = random_quadratic(rng, "definite")
    G = data.G.copy()
    G[1] += 0.3 * data.G[0] + 0.1 * data.G[2]
    if not own:
        G = (np.eye(6) + 0.4 * np.eye(6, k=1) + 0.4 * np.eye(6, k=-1)) @ data.G
    data = Quadratic(data.K, data.f, G, data.g0, data.w)
    run, u = NewtonRun(data.problem(), epsilon), np.zeros(len(data.f))
    for active in ([1, 1, 0, 0, 0, 0], [0, 1, 1, 1, 0, 1], [1, 1, 1, 1, 1, 1]):
        du, pressure = run.step(run.linearise(u, None), u, np.zeros(6), np.array(active, bool))
        exact_du, exact_pressure = dense_step(data, np.diag(data.w), u, np.array(active, bool), epsilon)
        np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * np.max(np.abs(exact_du)))
        np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * np.max(np.abs(exact_pressure)))


def test_gaps_that_depend_on_one_another_are_refused(rng) -> None:
    data = random_quadratic(rng, "definite")
    data.G[1] = data.G[0]
    run, u = NewtonRun(data.problem()), np.zeros(len(data.f))
    lin = run.linearise(u, None)
    with pytest.raises(ValueError, match="depend on one another"):
        run.step(lin, u, np.zeros(6), np.array([True, True, False, False, False, False]))
    run.step(lin, u, np.zeros(6), np.array([False, True, True, False, False, False]))  # apart they are no trouble


@pytest.mark.parametrize("others", [[], [0]])
def test_a_candidate_without_an_unknown_is_refused_by_name(rng, others) -> None:
    """A node held by its supports that the foundation reaches: a clear sentence, not a division by zero."""
    data = random_quadratic(rng, "inclined")
    data.G[2] = 0.0
    run, u, active = NewtonRun(data.problem()), np.zeros(len(data.f)), np.zeros(6, bool)
    active[[2, *others]] = True
    with pytest.raises(ValueError, match="contact candidate 2 has no unknown"):
        run.step(run.linearise(u, None), u, np.zeros(6), active)


def test_a_pivot_that_the_mechanics_does_not_hold() -> None:
    """K_kk = 0, a whole row and column of zeros, K_kk = -epsilon G_k^2 w: regular saddle points, solved like others."""
    pivots = "nothing", "only to others", "by minus the foundation"
    for solver, epsilon, held in product(SOLVERS, (1e2, 1e4, math.inf), pivots):
        for seed in range(2):
            rng = np.random.default_rng(seed)
            data = random_quadratic(rng, "definite")
            k = np.flatnonzero(data.G[0])[0]
            K = data.K.copy()
            if held == "nothing":
                K[k], K[:, k] = 0.0, 0.0
            K[k, k] = 0.0
            if held == "by minus the foundation":
                K[k, k] = -min(epsilon, 1e4) * data.G[0, k] ** 2 * data.w[0]
            data = Quadratic(K, data.f, data.G, data.g0, data.w)
            run, u = NewtonRun(data.problem(), epsilon, solver), rng.normal(size=len(data.f))
            for pressed in (1, 3):
                is_dense(data, np.diag(data.w), run, u, np.arange(6) < pressed)


def test_a_pressure_that_acts_on_nothing_is_singular(rng) -> None:
    """Must fail beside must pass: no stiffness and no contact area, so neither du_k nor p is determined."""
    data = random_quadratic(rng, "obstacle")
    data.w[0] = 0.0
    run, u, active = NewtonRun(data.problem()), np.zeros(len(data.f)), np.array([True] + 5 * [False])
    with pytest.raises(SingularMatrixError):
        run.step(run.linearise(u, None), u, np.zeros(6), active)


def test_a_pressure_of_rounding_is_one_of_forces_over_the_area() -> None:
    """On an area of 1e-6 what rounding makes of a force is a large pressure, and swaps nothing; ten times that does."""
    data = Quadratic(np.eye(1), np.ones(1), np.ones((1, 1)), -np.ones(1), np.array([1e-6]))
    run, u = NewtonRun(data.problem()), np.ones(1)
    lin = run.linearise(u, None)
    known = run.at(lin, u, np.zeros(1), np.ones(1, bool))
    rounding = ROUNDING_MARGIN * rounding_floor(lin, u, known.scale) / 1e-6
    wrong = [run.misplaced(replace(known, pressure=np.array([-k * rounding])), solved=True)[0] for k in (0.9, 10.0)]
    assert wrong == [False, True]


def test_a_body_without_candidates_asks_no_algorithm_for_its_step(rng) -> None:
    """One of anybody's may take it for granted that there is a set to choose, as the entries of the arena do."""

    def never(run: NewtonRun, at: Iterate) -> Step:
        raise AssertionError

    K = np.diag(1 + rng.random(5))
    data = Quadratic(K, rng.random(5), np.zeros((0, 5)), np.zeros(0), np.zeros(0))
    solution = iterate(NewtonRun(data.problem()), ContactSolution.at_rest(5, 0), never, 10)
    assert solution.outcome is Outcome.CONVERGED
    np.testing.assert_allclose(K @ solution.u, data.f, rtol=1e-12)
