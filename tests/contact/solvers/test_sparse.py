"""Linear solvers: singular matrices are refused, solutions checked."""

import math
from importlib.util import find_spec

import numpy as np
import pytest
from scipy import sparse

from contact.solvers.sparse import SOLVERS, UNLIKE, SingularMatrixError, checked_solve, factor_flops, factorise

BACKWARD = 1e-13


@pytest.fixture(params=[name for name in SOLVERS if name != "pardiso" or find_spec("pypardiso")])
def solver(request: pytest.FixtureRequest) -> str:
    return request.param


def backward_error(A: np.ndarray, x: np.ndarray, b: np.ndarray) -> float:
    return np.max(np.abs(b - A @ x)) / (np.abs(A).sum(axis=1).max() * np.max(np.abs(x)) + np.max(np.abs(b)))


def test_regular_systems_are_solved_to_a_small_backward_error(rng, solver) -> None:
    kinds = "definite", "nonsymmetric", "saddle", "tiny diagonal", "scaled over 1e12"
    for kind in kinds:
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
            A = np.block([[1e-18 * np.eye(n), A], [A.T, np.eye(n)]])  # no pivots on its diagonal
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


def test_exactly_singular_systems_are_refused(solver) -> None:
    singular = np.zeros((3, 3)), np.diag([1.0, 0.0, 2.0]), np.array([[1.0, -1.0], [-1.0, 1.0]]), np.ones((4, 4))
    for A in singular:
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


def test_operations_of_a_large_factor_are_estimated_without_a_copy_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A band matrix, whose columns are all alike: the two counts differ by what columns are taken to be unlike."""
    n = 400
    A = sparse.csc_matrix(
        sparse.diags_array([np.full(n - abs(k), 8.0 if k == 0 else -1.0) for k in range(-3, 4)], offsets=range(-3, 4))
    )
    factor = factorise(A, "splu", ordered=True)
    counted = factor_flops(factor)
    assert counted == pytest.approx(2 * n * 4**2, rel=0.02)
    monkeypatch.setattr("contact.solvers.sparse.LARGE_FILL", 10)
    assert factor_flops(factor) == UNLIKE * factor.nnz**2 / (2 * n)
    assert factor.nnz >= factor.L.nnz + factor.U.nnz  # it counts stored zeros, too: an estimate
