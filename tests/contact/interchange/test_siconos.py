"""Siconos' text format: every storage read as its writers write it, the two kinds as steps, and other files refused.

Contacts with ways of their own: the same problem, whatever its matrix, in unknowns that none shares.
"""

from functools import partial
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import State
from contact.interchange.friction_oracle import minimise
from contact.interchange.own_ways import with_own_ways
from contact.interchange.siconos import SiconosError, SiconosProblem, parse, read
from contact.problem import ContactSolution
from contact.verify import judge

EXACT = 1e-10


def dense(A: np.ndarray) -> str:
    """NM_write_in_file, storage 0: twice the shape, columns one after another."""
    n, m = A.shape
    return f"0\n{n}\n{m}\n{n}\t{m}\n" + "\n".join(f"{x:.24e}" for x in A.ravel(order="F"))


def blocks(A: np.ndarray, size: int = 3) -> str:
    """SBM_write_in_file: the blocks that are not zero, by rows."""
    n, m = (k // size for k in A.shape)
    kept = [[j for j in range(m) if np.any(A[size * i : size * (i + 1), size * j : size * (j + 1)])] for i in range(n)]
    ends = ["\t".join(str(size * (i + 1)) for i in range(k)) for k in (n, m)]
    starts = np.cumsum([0, *map(len, kept)])
    said = [f"1\n{n * size}\n{m * size}\n{starts[-1]}\n{n}\n{m}", *ends, f"{n + 1}\n{starts[-1]}"]
    said += ["\t".join(map(str, starts)), "\t".join(str(j) for row in kept for j in row)]
    places = [(i, j) for i in range(n) for j in kept[i]]
    for k, (i, j) in enumerate(places):
        block = A[size * i : size * (i + 1), size * j : size * (j + 1)]
        said += [str(k), *(f"{x:32.24e}" for x in block.ravel(order="F"))]
    return "\n".join(said)


TITLE = "CSparse Version 3.1.9, May 4, 2016.  Copyright (c) Timothy A. Davis, 2006-2016"


def columns(A: np.ndarray) -> str:
    """CSparseMatrix_print_in_file, compressed columns."""
    said, at = [f"2\n{A.shape[0]}\n{A.shape[1]}\n2\n{TITLE}"], 0
    count = np.count_nonzero(A)
    said.append(f"{A.shape[0]}-by-{A.shape[1]}, nzmax: {count} nnz: {count}, 1-norm: {np.abs(A).sum(axis=0).max():g}")
    for j, column in enumerate(A.T):
        rows = np.flatnonzero(column)
        said.append(f"    col {j} : locations {at} to {at + len(rows) - 1}")
        said += [f"      {i} : {column[i]:.17g}" for i in rows]
        at += len(rows)
    return "\n".join(said)


def triplets(A: np.ndarray) -> str:
    """The same, of a matrix in triplets."""
    places = np.argwhere(A)
    head = f"2\n{A.shape[0]}\n{A.shape[1]}\n1\n{TITLE}\n"
    head += f"triplet: {A.shape[0]}-by-{A.shape[1]}, nzmax: {len(places) + 3} nnz: {len(places)}\n"
    return head + "\n".join(f"    {i} {j} : {A[i, j]:.17g}" for i, j in places)


STORAGES = {"dense": dense, "blocks": blocks, "columns": columns, "triplets": triplets}
MU = "0.4 0.5 0.6"


def numbers(x: np.ndarray) -> str:
    return " ".join(f"{value:.24e}" for value in x)


def random_local(rng, rank: int = 9) -> tuple[np.ndarray, np.ndarray]:
    """W (9, 9) of a rank, with a zero block, and q."""
    root = rng.normal(size=(9, rank))
    root[:3, rank // 2 :] = root[6:, : rank // 2] = 0.0
    return root @ root.T, rng.normal(size=9)


@pytest.mark.parametrize("write", STORAGES.values(), ids=STORAGES)
def test_every_storage_is_read(write, rng, tmp_path) -> None:
    W, q = random_local(rng)
    W[0, 1] += 0.5  # not symmetric: columns are not rows
    (tmp_path / "local.dat").write_text(f"3\n3\n{write(W)}\n{numbers(q)}\n{MU}\n0\n7 8 9")
    local = read(tmp_path / "local.dat")
    assert (local.kind, local.d, len(local.mu)) == ("local", 3, 3)
    np.testing.assert_allclose(local.W.toarray(), W, rtol=1e-15)
    np.testing.assert_array_equal(local.offset, q)
    np.testing.assert_array_equal(local.mu, [0.4, 0.5, 0.6])
    M, H, b = W + 9 * np.eye(9), rng.normal(size=(9, 9)), rng.normal(size=9)
    whole = parse(f"3\n3\n{write(M)}\n{write(H)}\n{numbers(q)}\n{numbers(b)}\n{MU}\n1\n")
    assert whole.kind == "global"
    for actual, wanted in ((whole.M.toarray(), M), (whole.H.toarray(), H), (whole.q, q), (whole.offset, b)):
        np.testing.assert_allclose(actual, wanted, rtol=1e-15)


def relative(step, forces: np.ndarray) -> np.ndarray:
    """u (3m,) of any forces (3m,): H^T v + w with K v = H l - r."""
    v = np.linalg.solve(step.K.toarray(), step.H @ forces - step.r)
    return step.H.T @ v + step.w


@pytest.mark.parametrize("rank", [9, 5])
@pytest.mark.parametrize("skew", [0.0, 0.3])
def test_a_local_problem_as_a_step_has_its_matrix(rank, skew, rng) -> None:
    """u = W l + q for any l, also where W is singular, and not symmetric on its range."""
    W, q = random_local(rng, rank)
    W = W + skew * W @ np.triu(np.ones((9, 9)), 1) @ W
    step, forces = parse(f"3 3 {dense(W)} {numbers(q)} {MU}").step(), rng.normal(size=9)
    assert len(step.r) == rank
    np.testing.assert_allclose(relative(step, forces), W @ forces + q, rtol=0, atol=EXACT * np.abs(W).max())


def test_a_global_problem_as_a_step_is_what_it_is(rng) -> None:
    M, H, q, b = random_local(rng)[0] + np.eye(9), rng.normal(size=(9, 9)), rng.normal(size=9), rng.normal(size=9)
    step, forces = parse(f"3 3 {dense(M)} {dense(H)} {numbers(q)} {numbers(b)} {MU}").step(), rng.normal(size=9)
    wanted = H.T @ np.linalg.solve(M, H @ forces + q) + b
    np.testing.assert_allclose(relative(step, forces), wanted, rtol=0, atol=EXACT)


@pytest.mark.parametrize("whole", [False, True])
def test_in_a_plane_nothing_pulls_in_the_second_direction(whole, rng) -> None:
    root, q = rng.normal(size=(4, 4)), rng.normal(size=4)
    W = root @ root.T + np.eye(4)
    text = f"{dense(np.linalg.inv(W))} {dense(np.eye(4))} {numbers(0 * q)}" if whole else dense(W)
    step = parse(f"2 2 {text} {numbers(q)} 0.3 0.3").step()
    forces = rng.normal(size=(2, 2))
    actual = relative(step, np.column_stack([forces, np.zeros(2)]).ravel()).reshape(2, 3)
    np.testing.assert_allclose(actual[:, :2].ravel(), W @ forces.ravel() + q, rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual[:, 2], 0.0, rtol=0, atol=EXACT)


def test_one_contact_by_hand() -> None:
    """W = 1, q = (-1, 3, 4), mu = 0.1: f = 1, slip against (3, 4), friction -0.1 (0.6, 0.8)."""
    step = parse(f"3 1 {dense(np.eye(3))} -1 3 4 0.1").step()
    actual = minimise(step)
    assert actual.state.tolist() == [State.SLIP]
    np.testing.assert_allclose(actual.normal, 1.0, rtol=0, atol=EXACT)
    np.testing.assert_allclose(actual.friction, [[-0.06, -0.08]], rtol=0, atol=EXACT)
    assert judge(step.problem(), actual.du, actual.normal, actual.friction).failures() == []


ONE = "0 3 3 3 3 1 0 0 0 1 0 0 0 1"
REFUSED = {
    "empty": ("", "index out of range"),
    "text": ("W q mu", "invalid literal"),
    "four dimensions": (f"4 1 {ONE} 0 0 0 0.1", "4 dimensions"),
    "no contact": ("3 0 0 0 0 0 0", "0 contacts"),
    "another storage": ("3 1 7 3 3 3 3", "storage 7"),
    "two shapes": ("3 1 0 3 3 3 4 1 0 0 0 1 0 0 0 1", "two shapes"),
    "no square": ("3 1 0 1 2 1 2 1 0", "square"),
    "another size": (f"3 2 {ONE} 0 0 0 0.1 0.1", "no second one"),
    "too short": (f"3 1 {ONE} 0 0 0", "0 of 1 finite numbers"),
    "NaN": (f"3 1 {ONE} 0 nan 0 0.1", "finite numbers"),
    "negative mu": (f"3 1 {ONE} 0 0 0 -0.1", "negative"),
    "block out of place": ("3 1 1 3 3 1 1 1 3 3 2 1 0 1 0 5", "where it belongs"),
    "blocks that do not fill": ("3 1 1 3 3 1 1 1 2 3 2 1 0 1 0 0", "do not fill"),
}


def test_other_texts_are_refused_in_one_line(tmp_path) -> None:
    for text, said in REFUSED.values():
        path = tmp_path / "problem.dat"
        path.write_text(text)
        with pytest.raises(SiconosError, match=said) as caught:
            read(path)
        assert "\n" not in str(caught.value)
        assert str(path) in str(caught.value)


def test_hdf5_is_refused_and_so_is_what_is_no_step(tmp_path) -> None:
    (tmp_path / "a.hdf5").write_bytes(b"\x89HDF\r\n\x1a\n")
    with pytest.raises(SiconosError, match="HDF5"):
        read(tmp_path / "a.hdf5")
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "nothing.dat")
    with pytest.raises(SiconosError, match="not positive"):
        parse(f"3 1 {dense(np.diag([1.0, -1.0, 1.0]))} 0 0 0 0.1").step()
    nilpotent = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    with pytest.raises(SiconosError, match="another space"):
        parse(f"3 1 {dense(nilpotent)} 0 0 0 0.1").step()


CLOSE = 1e-9
COEFFICIENTS = np.array([0.2, 0.3, 0.1])


def local(rng: np.random.Generator, rank: int = 9, skew: float = 0.0) -> SiconosProblem:
    root, turn = rng.standard_normal((9, rank)), rng.standard_normal((9, 9))
    W = root @ root.T / 9 + np.eye(9) * (rank == 9) + skew * (turn - turn.T)
    return SiconosProblem(3, COEFFICIENTS, rng.standard_normal(9), W=sparse.csc_matrix(W))


def whole(rng: np.random.Generator) -> SiconosProblem:
    root, H = rng.standard_normal((11, 11)), rng.standard_normal((11, 9))
    M = sparse.csc_matrix(root @ root.T / 11 + np.eye(11))
    return SiconosProblem(
        3, COEFFICIENTS, rng.standard_normal(9), M=M, H=sparse.csc_matrix(H), q=rng.standard_normal(11)
    )


def ways(problem: SiconosProblem, forces: np.ndarray) -> np.ndarray:
    """u (9,) of forces (9,), by the problem's own equations."""
    if problem.W is not None:
        return problem.W @ forces + problem.offset
    v = np.linalg.solve(problem.M.toarray(), problem.H @ forces + problem.q)
    return problem.H.T @ v + problem.offset


def indefinite(rng: np.random.Generator) -> SiconosProblem:
    return SiconosProblem(3, COEFFICIENTS, rng.standard_normal(9), W=sparse.diags_array(np.arange(9.0) - 4))


def test_any_forces_make_the_ways_of_the_problem() -> None:
    """Of definite, singular and unsymmetric matrices, of one that is not positive, and of a global problem."""
    kinds = local, partial(local, rank=5), partial(local, skew=0.5), indefinite, whole
    for make, seed in product(kinds, range(3)):
        rng = np.random.default_rng(seed)
        problem = make(rng)
        step, forces = with_own_ways(problem), rng.standard_normal(9)
        x = np.linalg.solve(step.K.toarray(), step.H @ forces - step.r)
        np.testing.assert_allclose(step.H.T @ x + step.w, ways(problem, forces), rtol=0, atol=CLOSE)


@pytest.mark.parametrize("make", [local, whole])
def test_an_active_set_has_the_answer_of_the_oracle(make) -> None:
    problem = make(np.random.default_rng(3))
    step, wanted = with_own_ways(problem), minimise(problem.step())
    solution = Semismooth().solve(step.problem(), ContactSolution.at_rest(len(step.r), 3))
    assert solution.outcome.converged
    assert judge(step.problem(), solution.u, solution.pressure, solution.rubbed.force).failures() == []
    np.testing.assert_allclose(solution.pressure, wanted.normal, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(solution.rubbed.force, wanted.friction, rtol=0, atol=CLOSE)


def test_in_a_plane_the_second_slip_of_its_own_way_is_none() -> None:
    W = sparse.csc_matrix(np.diag([1.0, 2.0, 3.0, 4.0]))
    step = with_own_ways(SiconosProblem(2, COEFFICIENTS[:2], np.array([-1.0, 1.0, -2.0, 3.0]), W=W))
    assert np.diff(step.S.indptr).tolist() == [1, 0, 1, 0]
    actual = minimise(SiconosProblem(2, COEFFICIENTS[:2], np.array([-1.0, 1.0, -2.0, 3.0]), W=W).step())
    own = Semismooth().solve(step.problem(), ContactSolution.at_rest(len(step.r), 2))
    np.testing.assert_allclose(own.pressure, [1.0, 2 / 3], rtol=0, atol=CLOSE)  # W is diagonal: each alone
    np.testing.assert_allclose(own.rubbed.force, actual.friction, rtol=0, atol=CLOSE)
