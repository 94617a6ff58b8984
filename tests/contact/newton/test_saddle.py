"""Gaps that share their unknowns: the step with forces as unknowns against dense algebra, and its eigenvalues."""

import math

import numpy as np
import pytest
from scipy import sparse

from contact.newton.condensed import Condensed, Linear
from contact.newton.saddle import Saddle
from contact.newton.solves import LinearSolves, bound
from contact.problem import ContactProblem
from contact.solvers.sparse import negative_pivots
from support.problems.contact_problems import linear_mechanics

N, M = 30, 6
EXACT = 1e-10


def problem(sign: float = 1.0) -> ContactProblem:
    """Means of three unknowns each, every one with its neighbours'; sign: of the second lowest eigenvalue of K."""
    rng = np.random.default_rng(7)
    vectors = np.linalg.qr(rng.normal(size=(N, N)))[0]
    K = vectors @ np.diag([0.5, 0.6 * sign, *np.linspace(1, 9, N - 2)]) @ vectors.T
    G = np.zeros((M, N))
    for i in range(M):
        G[i, i : i + 3] = 0.3, 0.5, 0.2
    rows, gap = sparse.csr_matrix(G), rng.normal(size=M)
    return ContactProblem(
        linear_mechanics(K, rng.normal(size=N)), lambda u: gap + G @ u, lambda u: rows, rng.uniform(1, 2, M)
    )


@pytest.mark.parametrize("epsilon", [math.inf, 10.0])
def test_steps_are_those_of_dense_algebra(epsilon: float) -> None:
    posed, u, active = problem(), np.zeros(N), np.arange(M) % 3 < 2
    lin, nodes = posed.linearise(u, None), np.flatnonzero(active)
    run = LinearSolves(posed, epsilon)
    base = np.arange(M) < 4
    linear = Condensed(run, Linear.at(run, lin, u, np.zeros(M)), base)
    K, G = lin.tangent.toarray(), posed.gap_jacobian(u).toarray()[nodes]
    soft = np.diag(1 / (epsilon * posed.weights[nodes]))
    whole = np.block([[K, -G.T], [G, soft]])
    exact = np.linalg.solve(whole, np.append(-lin.residual, -posed.gap(u)[nodes]))
    for one in (linear, linear.near(active), Condensed(run, Linear.at(run, lin, u, np.zeros(M)), active)):
        du, pressure = one.step(active)
        np.testing.assert_allclose(du, exact[:N], rtol=0, atol=EXACT)
        np.testing.assert_allclose(pressure[nodes] * posed.weights[nodes], exact[N:], rtol=0, atol=EXACT)
        assert not pressure[~active].any()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_eigenvalues_on_what_a_set_leaves_free_are_those_of_the_condensed_matrix(sign: float) -> None:
    posed, u, nodes = problem(sign), np.zeros(N), np.arange(M)
    K = sparse.csc_matrix(posed.linearise(u, None).tangent)
    saddle = bound(posed, u, nodes, K, math.inf)
    assert isinstance(saddle, Saddle)
    free = np.linalg.svd(posed.gap_jacobian(u).toarray())[2][M:]
    expected = int(np.sum(np.linalg.eigvalsh(free @ K.toarray() @ free.T) < 0))
    assert expected == int(sign < 0)
    assert negative_pivots(saddle.matrix, ordered=True, multipliers=saddle.multipliers) == expected
