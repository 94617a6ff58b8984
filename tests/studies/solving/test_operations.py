"""Operations of a piece of work, against counts by hand, and against what dense algebra is known to take."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy import sparse

from contact.operations import COLUMNS, DENSE_PIVOTS, FACTORISATIONS, PROGRAMMES, SOLUTIONS
from contact.solvers.analysis import analysed
from contact.solvers.lcp_pivoting import active_set, lemke, principal_pivot
from contact.solvers.multifrontal import Multifrontal
from contact.solvers.qp_backends import Programme, ask, operations
from contact.solvers.sparse import Factor, checked_solve, factorise, response
from formulations.operations import ASSEMBLY
from studies.footprint import solve
from studies.solving.solve import KINDS, counted

N = 40


def dense(symmetric: bool) -> sparse.csc_matrix:
    """A full matrix, regular and well conditioned."""
    M = np.random.default_rng(3).normal(size=(N, N))
    return sparse.csc_matrix(M @ M.T + N * np.eye(N) if symmetric else M + N * np.eye(N))


def fronts(A: sparse.csc_matrix) -> Factor:
    return Multifrontal.of_matrix(*analysed(A))


def by_superlu(A: sparse.csc_matrix) -> Factor:
    return factorise(A, "splu")


@pytest.mark.parametrize(
    ("symmetric", "factors", "factorisation", "solution"),
    [
        (True, fronts, N**3 / 3, 2 * N**2),
        (False, fronts, 2 * N**3 / 3, 2 * N**2),
        (True, by_superlu, 2 * N**3 / 3, 2 * N**2),
    ],
)
def test_a_full_matrix_takes_what_cholesky_and_lu_take(
    symmetric: bool, factors: Callable[[sparse.csc_matrix], Factor], factorisation: float, solution: float
) -> None:
    A = dense(symmetric)
    with counted() as work:
        factor = factors(A)
    assert work[FACTORISATIONS] == pytest.approx(factorisation, rel=0.05)
    with counted() as work:
        checked_solve(factor, A, np.ones(N))
    assert work[SOLUTIONS] == pytest.approx(solution + 2 * N**2, rel=0.06)  # and its residual
    assert sum(work.values()) == work[SOLUTIONS]


def test_columns_are_counted_where_they_are_found() -> None:
    factor, some = fronts(dense(True)), sparse.csc_matrix(np.eye(N)[:, :3])
    with counted() as work:
        response(factor, some, some)
    assert work[COLUMNS] == pytest.approx(3 * 2 * N**2, rel=0.06)


def test_pivots_take_what_their_rows_and_their_inverses_take() -> None:
    M, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-1.0, -1.0])
    with counted() as work:
        lemke(M, q)
    # three pivots: z0 enters, then both z; each takes two rows of six numbers at the most, a product and a sum
    assert 3 * 2 * 6 <= work[DENSE_PIVOTS] <= 3 * 2 * 2 * 6 + 2 * 2**3 / 3 + 2 * 2**2
    with counted() as work:
        assert active_set(M, q, np.ones(2, bool)).pivots == 0
    assert work[DENSE_PIVOTS] == round(2 * 2**3 / 3 + 2 * 2**2) + 4 * 4
    with counted() as work:
        principal_pivot(M, q, np.array([True, False]))
    assert work[DENSE_PIVOTS] == 2 + 4 + 2


def test_a_programme_costs_its_iterations() -> None:
    P, A = sparse.csc_matrix(np.full((4, 4), 1.0) + 4 * np.eye(4)), sparse.csc_matrix(np.eye(4))
    programme = Programme(P, -np.ones(4), A, np.zeros(4))
    fill = min((10 + 4 + 4) * 3, 8 * 9 / 2)
    assert operations(programme, 10, 2) == 2 * fill**2 / 8 + 10 * (4 * fill + 2 * (16 + 8))
    values = []
    for eps in (1e-2, 1e-9):
        with counted() as work:
            assert ask("osqp", programme, eps, False).claimed
        values.append(work[PROGRAMMES])
    assert 0 < values[0] < values[1]


def test_a_cell_counts_all_its_kinds_and_the_same_twice() -> None:
    first, again = (solve("strip-contact", contact="lcp", mesh="4x1", load_fraction=2).result for _ in range(2))
    assert first.work == again.work
    assert set(first.work) == set(KINDS)
    assert first.counters["operations"] == sum(first.work.values())
    assert all(first.work[kind] > 0 for kind in (ASSEMBLY, FACTORISATIONS, SOLUTIONS, DENSE_PIVOTS))
    # of one element residual and tangent: some 0.25 million; the judge takes as many again as a few iterations
    each = first.work[ASSEMBLY] / 4 / first.counters["assemblies"]
    assert 2.5e5 < each < 2.5e6
