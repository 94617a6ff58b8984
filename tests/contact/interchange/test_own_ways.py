"""Contacts with ways of their own: the same problem, whatever its matrix, in unknowns that none shares."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.interchange.friction_oracle import minimise
from contact.interchange.own_ways import with_own_ways
from contact.interchange.siconos import SiconosProblem
from contact.problem import ContactSolution
from contact.verify import judge

EXACT = 1e-9
MU = np.array([0.2, 0.3, 0.1])


def local(rng: np.random.Generator, rank: int = 9, skew: float = 0.0) -> SiconosProblem:
    root, turn = rng.standard_normal((9, rank)), rng.standard_normal((9, 9))
    W = root @ root.T / 9 + np.eye(9) * (rank == 9) + skew * (turn - turn.T)
    return SiconosProblem(3, MU, rng.standard_normal(9), W=sparse.csc_matrix(W))


def whole(rng: np.random.Generator) -> SiconosProblem:
    root, H = rng.standard_normal((11, 11)), rng.standard_normal((11, 9))
    M = sparse.csc_matrix(root @ root.T / 11 + np.eye(11))
    return SiconosProblem(3, MU, rng.standard_normal(9), M=M, H=sparse.csc_matrix(H), q=rng.standard_normal(11))


def ways(problem: SiconosProblem, forces: np.ndarray) -> np.ndarray:
    """u (9,) of forces (9,), by the problem's own equations."""
    if problem.W is not None:
        return problem.W @ forces + problem.offset
    v = np.linalg.solve(problem.M.toarray(), problem.H @ forces + problem.q)
    return problem.H.T @ v + problem.offset


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["definite", "singular", "not symmetric", "not positive", "global"])
def test_any_forces_make_the_ways_of_the_problem(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = {
        "definite": lambda: local(rng),
        "singular": lambda: local(rng, 5),
        "not symmetric": lambda: local(rng, skew=0.5),
        "not positive": lambda: SiconosProblem(3, MU, rng.standard_normal(9), W=sparse.diags_array(np.arange(9.0) - 4)),
        "global": lambda: whole(rng),
    }
    problem = made[kind]()
    step, forces = with_own_ways(problem), rng.standard_normal(9)
    x = np.linalg.solve(step.K.toarray(), step.H @ forces - step.r)
    np.testing.assert_allclose(step.H.T @ x + step.w, ways(problem, forces), rtol=0, atol=EXACT)


@pytest.mark.parametrize("make", [local, whole])
def test_an_active_set_has_the_answer_of_the_oracle(make) -> None:
    problem = make(np.random.default_rng(3))
    step, wanted = with_own_ways(problem), minimise(problem.step())
    found = Semismooth().solve(step.problem(), ContactSolution.at_rest(len(step.r), 3))
    assert found.outcome.converged
    assert judge(step.problem(), found.u, found.pressure, found.rubbed.force).failures() == []
    np.testing.assert_allclose(found.pressure, wanted.normal, rtol=0, atol=EXACT)
    np.testing.assert_allclose(found.rubbed.force, wanted.friction, rtol=0, atol=EXACT)


def test_in_a_plane_the_second_slip_is_none() -> None:
    W = sparse.csc_matrix(np.diag([1.0, 2.0, 3.0, 4.0]))
    step = with_own_ways(SiconosProblem(2, MU[:2], np.array([-1.0, 1.0, -2.0, 3.0]), W=W))
    assert np.diff(step.S.indptr).tolist() == [1, 0, 1, 0]
    found = minimise(SiconosProblem(2, MU[:2], np.array([-1.0, 1.0, -2.0, 3.0]), W=W).step())
    own = Semismooth().solve(step.problem(), ContactSolution.at_rest(len(step.r), 2))
    np.testing.assert_allclose(own.pressure, [1.0, 2 / 3], rtol=0, atol=EXACT)  # W is diagonal: each alone
    np.testing.assert_allclose(own.rubbed.force, found.friction, rtol=0, atol=EXACT)
