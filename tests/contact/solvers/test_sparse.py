"""Linear solvers: singular matrices are refused, solutions checked; the pivot substitution against a dense solve."""

from __future__ import annotations

import math
from importlib.util import find_spec

import numpy as np
import pytest
from scipy import sparse

from contact.newton.step import NewtonRun
from contact.solvers.sparse import SOLVERS, UNLIKE, SingularMatrixError, checked_solve, factor_flops, factorise
from support.contact_problems import Quadratic, random_quadratic

BACKWARD = 1e-13
DENSE = 1e-9  # agreement of the pivot substitution with the dense saddle-point solve
EPSILONS = (1e-2, 1e4, 1e14, math.inf)


@pytest.fixture(params=[name for name in SOLVERS if name != "pardiso" or find_spec("pypardiso")])
def solver(request: pytest.FixtureRequest) -> str:
    return request.param


def backward_error(A: np.ndarray, x: np.ndarray, b: np.ndarray) -> float:
    return np.max(np.abs(b - A @ x)) / (np.abs(A).sum(axis=1).max() * np.max(np.abs(x)) + np.max(np.abs(b)))


@pytest.mark.parametrize("kind", ["definite", "nonsymmetric", "saddle", "tiny diagonal", "scaled over 1e12"])
def test_regular_systems_are_solved_to_a_small_backward_error(rng, solver, kind) -> None:
    n = 40
    A = rng.normal(size=(n, n)) * (rng.random((n, n)) < 0.2) + 4 * np.eye(n)
    if kind in ("definite", "scaled over 1e12"):
        A = A @ A.T
    if kind == "scaled over 1e12":
        scale = 10 ** np.linspace(-3, 3, n)
        A = scale[:, None] * A * scale
    if kind == "saddle":
        A = np.block([[A @ A.T, np.eye(n, 5)], [np.eye(5, n), np.zeros((5, 5))]])
    if kind == "tiny diagonal":
        A = np.block([[1e-18 * np.eye(n), A], [A.T, np.eye(n)]])  # pivots on the diagonal alone would lose everything
    exact = rng.normal(size=len(A))
    matrix, b = sparse.csc_matrix(A), A @ exact
    x = checked_solve(factorise(matrix, solver), matrix, b)
    assert backward_error(A, x, b) <= BACKWARD
    if kind != "scaled over 1e12":
        np.testing.assert_allclose(x, exact, rtol=0, atol=1e-10)


def test_a_poor_factor_is_improved_by_one_refinement_or_refused(rng) -> None:
    """The check is on the solution, not on the factor's word: 1e-6 off is refined away, 0.3 off is refused."""
    A = np.diag(rng.uniform(1, 2, 10)) + 0.1 * rng.normal(size=(10, 10))
    b, matrix = rng.normal(size=10), sparse.csc_matrix(A)

    class Poor:
        def __init__(self, error: float) -> None:
            self.error = error

        def solve(self, right: np.ndarray) -> np.ndarray:
            return (1 + self.error) * np.linalg.solve(A, right)

    x = checked_solve(Poor(1e-6), matrix, b)
    assert backward_error(A, x, b) <= BACKWARD
    with pytest.raises(SingularMatrixError, match="backward error"):
        checked_solve(Poor(0.3), matrix, b)
    with pytest.raises(SingularMatrixError, match="not finite"):
        checked_solve(Poor(math.nan), matrix, b)


@pytest.mark.parametrize(
    "A",
    [np.zeros((3, 3)), np.diag([1.0, 0.0, 2.0]), np.array([[1.0, -1.0], [-1.0, 1.0]]), np.ones((4, 4))],
    ids=["zero", "empty row", "floating spring", "rank one"],
)
def test_exactly_singular_systems_are_refused(solver, A) -> None:
    matrix = sparse.csc_matrix(A)
    with pytest.raises(SingularMatrixError):
        checked_solve(factorise(matrix, solver), matrix, np.arange(1.0, len(A) + 1))


def test_singular_to_working_precision_is_refused(solver) -> None:
    """A floating chain of unequal springs under a force that nothing balances: the last pivot is rounding, not zero.

    A small backward error proves nothing here: x is up to 1e15 times too large. What is returned must meet the load to
    a digit at least, and most of these systems allow no such x.
    """
    refused = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        elongation = np.diff(np.eye(12), axis=0)
        matrix = sparse.csc_matrix(elongation.T @ np.diag(rng.uniform(0.1, 3, 11)) @ elongation)
        b = rng.normal(size=12)
        try:
            x = checked_solve(factorise(matrix, solver), matrix, b)
        except SingularMatrixError:
            refused += 1
        else:
            assert np.max(np.abs(b - matrix @ x)) <= 0.1 * np.max(np.abs(b))
    assert refused >= 6


def test_zero_load_gives_zero(solver) -> None:
    matrix = sparse.csc_matrix(np.diag([1.0, 2.0]))
    assert np.all(checked_solve(factorise(matrix, solver), matrix, np.zeros(2)) == 0)


def test_unknown_solver_is_refused() -> None:
    with pytest.raises(KeyError):
        factorise(sparse.eye_array(2, format="csc"), "magic")


# --- the step of Newton on a fixed set ----------------------------------------------------------------------------


def coupling_matrix(rng, w: np.ndarray) -> np.ndarray:
    """A consistent matrix: neighbours share area, the rows sum to about w."""
    m = len(w)
    off = np.diag(rng.uniform(0.1, 0.2, m - 1), 1)
    return np.diag(w) + off + off.T


def dense_step(data, W, u, active, epsilon, K):
    """Du and p_A of K du - G^T W p = -r, G_A du + p_A/epsilon = -g_A by one dense solve."""
    A = np.flatnonzero(active)
    G = data.G[A]
    push = data.G.T @ W[:, A]
    system = np.block([[K, -push], [G, np.eye(len(A)) / epsilon]])
    right = -np.concatenate([data.K @ u - data.f, (data.g0 + data.G @ u)[A]])
    # scaled by rows and columns so that a small epsilon does not spoil the reference itself
    scale = 1 / np.sqrt(np.abs(system).max(axis=1))
    solution = scale * np.linalg.solve(scale[:, None] * system * scale, scale * right)
    pressure = np.zeros(len(active))
    pressure[A] = solution[len(u) :]
    return solution[: len(u)], pressure


STEPS = [  # one unknown or three in a gap row, symmetric or non-symmetric mechanics and coupling
    ("obstacle", "lumped", True),
    ("definite", "consistent", True),
    ("inclined", "lumped", False),
    ("inclined", "consistent", False),
]


@pytest.mark.parametrize("epsilon", EPSILONS)
@pytest.mark.parametrize(("kind", "coupling", "symmetric"), STEPS)
def test_step_is_that_of_the_dense_saddle_point(solver, epsilon, coupling, kind, symmetric) -> None:
    """For one and for three unknowns in a gap row, any epsilon, symmetric and non-symmetric mechanics, several sets."""
    for seed in range(4):
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
            run = NewtonRun(problem, epsilon, solver)
            du, pressure = run.step(run.linearise(u, None), u, old_pressure, active)
            exact_du, exact_pressure = dense_step(data, W, u, active, epsilon, data.K)
            np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * (1 + np.max(np.abs(exact_du))))
            size = 1 + np.max(np.abs(exact_pressure))
            np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * size)
            assert np.all(pressure[~active] == 0)


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
    exact_du, exact_pressure = dense_step(data, np.diag(data.w), u, active, epsilon, K)
    np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * np.max(np.abs(exact_du)))
    np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * np.max(np.abs(exact_pressure)))


def test_candidates_that_share_an_unknown_are_refused(rng) -> None:
    data = random_quadratic(rng, "definite")
    data.G[1] += data.G[0]
    run, u = NewtonRun(data.problem()), np.zeros(len(data.f))
    lin = run.linearise(u, None)
    with pytest.raises(ValueError, match="share an unknown"):
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


@pytest.mark.parametrize("epsilon", [1e2, 1e4, math.inf])
@pytest.mark.parametrize("held", ["nothing", "only to others", "by minus the foundation"])
def test_a_pivot_that_the_mechanics_does_not_hold(solver, epsilon, held) -> None:
    """K_kk = 0, a whole row and column of zeros, K_kk = -epsilon G_k^2 w: regular saddle points, solved like others."""
    for seed in range(4):
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
            active = np.arange(6) < pressed
            du, pressure = run.step(run.linearise(u, None), u, np.zeros(6), active)
            exact_du, exact_pressure = dense_step(data, np.diag(data.w), u, active, epsilon, K)
            np.testing.assert_allclose(du, exact_du, rtol=0, atol=DENSE * (1 + np.max(np.abs(exact_du))))
            size = 1 + np.max(np.abs(exact_pressure))
            np.testing.assert_allclose(pressure, exact_pressure, rtol=0, atol=DENSE * size)


def test_a_pressure_that_acts_on_nothing_is_singular(rng) -> None:
    """Must fail beside must pass: no stiffness and no contact area, so neither du_k nor p is determined."""
    data = random_quadratic(rng, "obstacle")
    data.w[0] = 0.0
    run, u, active = NewtonRun(data.problem()), np.zeros(len(data.f)), np.array([True] + 5 * [False])
    with pytest.raises(SingularMatrixError):
        run.step(run.linearise(u, None), u, np.zeros(6), active)


def test_operations_of_a_large_factor_are_estimated_without_a_copy_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A band matrix, whose columns are all alike: the two counts differ by what columns are taken to be unlike."""
    n = 400
    A = sparse.csc_matrix(
        sparse.diags_array([np.full(n - abs(k), 8.0 if k == 0 else -1.0) for k in range(-3, 4)], offsets=range(-3, 4))
    )
    factor = factorise(A, ordered=True)
    counted = factor_flops(factor)
    assert counted == pytest.approx(2 * n * 4**2, rel=0.02)
    monkeypatch.setattr("contact.solvers.sparse.LARGE_FILL", 10)
    assert factor_flops(factor) == UNLIKE * factor.nnz**2 / (2 * n)
    assert factor.nnz >= factor.L.nnz + factor.U.nnz  # it counts stored zeros, too: an estimate
