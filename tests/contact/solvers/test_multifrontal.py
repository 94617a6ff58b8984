"""The multifrontal factorisation against dense algebra: random patterns in any order, and tangents of shells."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from contact.solvers import tree
from contact.solvers.analysis import PIECES, Analysis, analysed
from contact.solvers.bordered import Bordered
from contact.solvers.multifrontal import Multifrontal, PivotError
from contact.solvers.sparse import (
    BACKWARD_ERROR,
    checked_solve,
    factor_flops,
    factorise,
    instead,
    negative_pivots,
    response,
    response_flops,
)
from formulations.discretisation import Discretisation
from formulations.shell import ShellModel
from formulations.strains.catalogue import MEASURES
from support.problems.shells import PATCHES, SKEW_LAMINATE

ROUNDING = 1e-12


def pattern(n: int, density: float, unknowns: int, seed: int) -> sparse.csc_matrix:
    """Symmetric with a whole diagonal: n nodes of some unknowns each, entries of any sign."""
    rng = np.random.default_rng(seed)
    touching = np.triu(rng.random((n, n)) < density, 1)
    touching = np.kron(touching + touching.T + np.eye(n), np.ones((unknowns, unknowns))) > 0
    return sparse.csc_matrix(np.where(touching, rng.uniform(-1.0, 1.0, touching.shape), 0.0))


def symmetric(A: sparse.csc_matrix, shift: float) -> sparse.csc_matrix:
    actual = sparse.csc_matrix(A + A.T + shift * sparse.eye_array(A.shape[0]))
    actual.sort_indices()
    return actual


def factored(A: sparse.csc_matrix) -> Multifrontal:
    analysis = Analysis.of(A.indptr, A.indices)
    assert analysis is not None
    return Multifrontal.of_matrix(A, analysis)


SPARSE = {"n": st.integers(1, 60), "density": st.floats(0.0, 0.3), "unknowns": st.integers(1, 4)}


@settings(max_examples=60, deadline=None)
@given(**SPARSE, seed=st.integers(0, 2**32 - 1), whole=st.sampled_from([0, 8, 40]))
def test_any_symmetric_pattern_is_solved(n, density, unknowns, seed, whole) -> None:
    """Definite and indefinite, its inertia that of the eigenvalues; one right-hand side and several."""
    A, keep = pattern(n, density, unknowns, seed), tree.WHOLE
    b = np.random.default_rng(seed).random((A.shape[0], 3))
    try:
        tree.WHOLE = whole  # small patterns have many fronts, too
        for shift in (100.0, 0.3):
            K = symmetric(A, shift)
            eigenvalues = np.linalg.eigvalsh(K.toarray())
            if np.min(np.abs(eigenvalues)) < 1e-6:
                continue
            actual = factored(K)
            for rhs in (b, b[:, 0]):
                x = actual.solve(rhs)
                assert x.shape == rhs.shape
                exact = np.linalg.solve(K.toarray(), rhs)
                assert np.max(np.abs(x - exact)) <= 1e-6 * np.max(np.abs(exact))
            assert actual.negative == np.sum(eigenvalues < 0)
    finally:
        tree.WHOLE = keep


@settings(max_examples=40, deadline=None)
@given(**SPARSE, seed=st.integers(0, 2**32 - 1))
def test_values_need_not_be_symmetric(n, density, unknowns, seed) -> None:
    A = sparse.csc_matrix(pattern(n, density, unknowns, seed) + 30 * sparse.eye_array(n * unknowns))
    A.sort_indices()
    b = np.random.default_rng(seed).random(A.shape[0])
    x = factored(A).solve(b)
    assert np.max(np.abs(A @ x - b)) <= ROUNDING * np.max(np.abs(A)) * np.max(np.abs(x))


def tangent(n1: int, n2: int) -> sparse.csc_matrix:
    """Of a shell clamped at one end, numbered for elimination."""
    grid = PATCHES["torus"].grid(n1, n2)
    fixed = np.zeros((grid.n_nodes, 6), bool)
    fixed[grid.on_line(0, float(grid.nodes[:, 0].min()))] = True
    shell = Discretisation.build(PATCHES["torus"].surface, grid, SKEW_LAMINATE, fixed, ordered=True)
    K = sparse.csc_matrix(ShellModel(shell, MEASURES["exact"]).linearise(np.zeros(shell.n_free), None).tangent)
    K.sort_indices()
    return K


@pytest.mark.parametrize("shape", [(3, 3), (9, 2), (12, 11)])
def test_tangents_of_shells_and_their_inertia(shape) -> None:
    """Shifted through the spectrum: 50 tangents, all but the first indefinite."""
    K = tangent(*shape)
    eigenvalues = np.linalg.eigvalsh(K.toarray())
    b = np.ones(K.shape[0])
    for share in np.linspace(0.0, 0.9, 17):
        at = int(share * (len(eigenvalues) - 1))
        shift = 0.0 if share == 0 else float(np.mean(eigenvalues[at : at + 2]))
        A = K.copy()
        A.setdiag(K.diagonal() - shift)
        actual = factored(A)
        assert actual.negative == np.sum(eigenvalues < shift)
        x = checked_solve(actual, A, b)
        size = float(abs(A).sum(axis=0).max()) * np.max(np.abs(x)) + np.max(np.abs(b))
        assert np.max(np.abs(A @ x - b)) <= BACKWARD_ERROR * size


def test_fronts_cover_every_unknown_once_and_children_come_first() -> None:
    K = tangent(20, 20)
    actual = Analysis.of(K.indptr, K.indices)
    assert np.array_equal(np.sort(actual.order), np.arange(K.shape[0]))
    assert [front.start for front in actual.fronts[1:]] == [front.stop for front in actual.fronts[:-1]]
    children = [child for front in actual.fronts for child, _ in front.children]
    assert len(children) == len(set(children)) == len(actual.fronts) - 1
    assert all(child < k for k, front in enumerate(actual.fronts) for child, _ in front.children)
    assert len(actual.fronts) > 10


def test_a_boundary_in_many_pieces_goes_to_its_parent_at_once() -> None:
    """An arrow of leaves, each with every second unknown of a dense end: more pieces than PIECES."""
    n, leaf = 4 * PIECES, 3
    K = np.eye(n + 2 * leaf) * 50
    K[2 * leaf :, 2 * leaf :] += 1
    for k in range(2):
        own, end = slice(k * leaf, (k + 1) * leaf), np.arange(2 * leaf + k, n + 2 * leaf, 2)
        K[own, own] += 1
        K[np.ix_(range(own.start, own.stop), end)] = 0.5
        K[np.ix_(end, range(own.start, own.stop))] = 0.5
    A = sparse.csc_matrix(K)
    x = factored(A).solve(np.ones(len(K)))
    np.testing.assert_allclose(K @ x, 1.0, atol=ROUNDING)


def test_a_pattern_that_is_not_symmetric_is_filled_with_zeros() -> None:
    A = sparse.csc_matrix(np.array([[2.0, 1.0, 0.0], [0.0, 2.0, 1.0], [0.0, 0.0, 2.0]]))
    assert Analysis.of(A.indptr, A.indices) is None
    factor = factorise(A, "multifrontal", ordered=True)
    assert isinstance(factor, Multifrontal)
    np.testing.assert_allclose(A @ factor.solve(np.ones(3)), 1.0)


def test_what_it_cannot_do_superlu_does_instead_and_it_is_said() -> None:
    """Where there is no order, and where a front is singular that has the pivots of the next."""
    A = sparse.csc_matrix(np.eye(2))
    assert instead(factorise(A, "multifrontal", ordered=False), "multifrontal", ordered=False)
    assert not instead(factorise(A, "splu"), "splu", ordered=True)
    n = 2 * tree.WHOLE
    saddle = sparse.csc_matrix(np.block([[np.zeros((n, n)), np.eye(n)], [np.eye(n), np.zeros((n, n))]]))
    with pytest.raises(PivotError):
        factored(sparse.csc_matrix((np.array([0.0, 1.0]), np.array([0, 1]), np.array([0, 1, 2])), shape=(2, 2)))
    factor = factorise(saddle, "multifrontal", ordered=True)
    np.testing.assert_allclose(saddle @ factor.solve(np.ones(2 * n)), 1.0)


def test_it_is_a_solver_by_its_name() -> None:
    K = tangent(8, 8)
    factor, other = (factorise(K, name, ordered=True) for name in ("multifrontal", "splu"))
    assert isinstance(factor, Multifrontal)
    b = np.ones(K.shape[0])
    np.testing.assert_allclose(checked_solve(factor, K, b), checked_solve(other, K, b), rtol=1e-8)
    assert 0.2 < factor_flops(factor) / factor_flops(other) < 2.0
    assert factor.negative == negative_pivots(K) == 0


def bordered(K: sparse.csc_matrix, row: np.ndarray, column: np.ndarray) -> sparse.csc_matrix:
    """K beside a column and above a row, every place of which is taken."""
    n = K.shape[0]
    beside = sparse.csc_matrix((column, np.arange(n), np.array([0, n])), shape=(n, 1))
    last = sparse.csr_matrix((row, np.arange(n + 1), np.array([0, n + 1])), shape=(1, n + 1))
    return sparse.csc_matrix(sparse.vstack([sparse.hstack([K, beside]), last]))


def test_a_border_is_eliminated_by_itself() -> None:
    """Solutions and columns of the inverse, against the dense matrix; about half the operations of the whole."""
    rng, K = np.random.default_rng(0), tangent(8, 8)
    n, size = K.shape[0], float(np.max(np.abs(K.data)))
    A = bordered(K, size * rng.normal(size=n + 1), size * rng.normal(size=n))
    factor = factorise(A, "multifrontal", ordered=True)
    assert isinstance(factor, Bordered)
    b = rng.normal(size=n + 1)
    exact = np.linalg.solve(A.toarray(), b)
    np.testing.assert_allclose(checked_solve(factor, A, b), exact, rtol=0, atol=1e-9 * np.max(np.abs(exact)))
    left, right = (sparse.csc_matrix(sparse.random_array((n + 1, k), density=0.02, rng=rng)) for k in (4, 6))
    columns = left.T @ np.linalg.solve(A.toarray(), right.toarray())
    np.testing.assert_allclose(response(factor, left, right), columns, rtol=0, atol=1e-9 * np.max(np.abs(columns)))
    assert 0 < response_flops(factor, left, right) < np.inf
    assert factor_flops(factor) < 0.7 * Multifrontal.of_matrix(*analysed(A)).flops


@pytest.mark.parametrize("last", [0.0, 1e9])
def test_negative_eigenvalues_within_a_border(last) -> None:
    """Of a condition on the unknowns of a definite matrix one, of a stiff unknown beside them none, in any order."""
    K = tangent(8, 8)
    row = float(np.max(np.abs(K.data))) * np.random.default_rng(0).normal(size=K.shape[0])
    A = bordered(K, np.append(row, last * float(row @ row)), row)
    assert negative_pivots(A, ordered=True) == negative_pivots(A) == (last == 0)


def test_negative_eigenvalues_where_rows_have_to_be_exchanged() -> None:
    A = sparse.csc_matrix([[-1.5, -0.5, 0.0], [-0.5, 0.5, -1.0], [0.0, -1.0, 0.0]])
    assert negative_pivots(A) == np.sum(np.linalg.eigvalsh(A.toarray()) < 0) == 2


@pytest.mark.parametrize("ordered", [False, True])
@pytest.mark.parametrize("K", [np.diag([0.0, 1.0, 1.0]), np.zeros((3, 3))])
def test_a_singular_matrix_is_not_stable_for_its_multiplier(K, ordered) -> None:
    """K has motions without stiffness that the condition, of the second unknown, leaves free."""
    f = np.array([[0.0, 1.0, 0.0]])
    M = sparse.csc_matrix(np.block([[K, -f.T], [-f, np.zeros((1, 1))]]))
    assert negative_pivots(M, ordered=ordered, multipliers=1) == 1
    stiff = sparse.csc_matrix(np.block([[np.eye(3), -f.T], [-f, np.zeros((1, 1))]]))
    assert negative_pivots(stiff, ordered=ordered, multipliers=1) == 0


def test_a_border_that_holds_a_singular_matrix_is_eliminated_with_it() -> None:
    """As at a limit point: K has a motion without stiffness that only the border resists."""
    rng, K = np.random.default_rng(0), tangent(8, 8)
    dense = K.toarray()
    values, vectors = np.linalg.eigh(dense)
    soft = sparse.csc_matrix(dense - values[0] * np.outer(vectors[:, 0], vectors[:, 0]))
    n, size = K.shape[0], float(np.max(np.abs(K.data)))
    A = bordered(soft, size * np.append(vectors[:, 0], 0.0), size * vectors[:, 0])
    assert Bordered.of(A) is None
    b = rng.normal(size=n + 1)
    x = checked_solve(factorise(A, "multifrontal", ordered=True), A, b)
    np.testing.assert_allclose(A @ x, b, rtol=0, atol=1e-9)


def test_what_is_not_symmetric_within_its_border_is_left_alone() -> None:
    K = tangent(8, 8)
    skew = sparse.csc_matrix(K + 0.1 * sparse.triu(K, 1))
    n = K.shape[0]
    assert Bordered.of(bordered(skew, np.ones(n + 1), np.ones(n))) is None
    assert Bordered.of(K) is None  # its last row is not full
