"""Small linear problems with friction whose answer is planted: states, forces and slips first, the loads from them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.coulomb import Coulomb, State
from contact.problem import ContactProblem, linear_mechanics


@dataclass(frozen=True, eq=False)
class Planted:
    """A problem and its only answer."""

    problem: ContactProblem
    u: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    state: np.ndarray


def linear(
    K: np.ndarray, f: np.ndarray, G: np.ndarray, S: np.ndarray, g0: np.ndarray, s0: np.ndarray, mu: np.ndarray
) -> ContactProblem:
    """r = K u - f, g = g0 + G u, s = s0 + S u; S (2m, n), s0 (m, 2)."""
    gaps, slips, m = sparse.csr_matrix(G), sparse.csr_matrix(S), len(g0)
    law = Coulomb(mu, lambda u: s0 + (slips @ u).reshape(-1, 2), lambda u: slips)
    mechanics = linear_mechanics(sparse.csc_matrix(K), f)
    return ContactProblem(mechanics, lambda u: g0 + gaps @ u, lambda u: gaps, np.ones(m), coulomb=law)


def with_mu(problem: ContactProblem, mu: np.ndarray) -> ContactProblem:
    """The same with other coefficients (m,)."""
    return replace(problem, coulomb=replace(problem.coulomb, mu=mu))


def planted(seed: int, mu: float, *, components: int = 2, m: int = 7, coupled: float = 0.3) -> Planted:
    """A body of m candidates with three unknowns each, in skew axes, and five unknowns more.

    K = 1 + coupled B with |B| = 1 is so definite that the answer is the only one up to mu = 1: the map from forces to
    ways is then close to a multiple of the identity. Normal forces are 1 to 2, slips and gaps 0.1 to 1.
    """
    rng = np.random.default_rng(seed)
    n = 3 * m + 5
    B = rng.standard_normal((n, n))
    B = B + B.T
    K = np.eye(n) + coupled * B / np.linalg.norm(B, 2)
    G, S = np.zeros((m, n)), np.zeros((2 * m, n))
    for i in range(m):
        axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        G[i, 3 * i : 3 * i + 3] = axes[0]
        S[2 * i, 3 * i : 3 * i + 3] = axes[1]
        if components == 2:
            S[2 * i + 1, 3 * i : 3 * i + 3] = axes[2]
    state = np.append([State.OPEN, State.STICK, State.SLIP], rng.integers(0, 3, m - 3)).astype(np.int8)
    closed, slips = state != State.OPEN, state == State.SLIP
    normal = np.where(closed, rng.uniform(1, 2, m), 0.0)
    angle = rng.uniform(0, 2 * np.pi, m)
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    if components == 1:
        way = np.column_stack([np.sign(way[:, 0]), np.zeros(m)])
    slip = np.where(slips, rng.uniform(0.1, 1, m), 0.0)[:, None] * way
    share = np.where(slips, 1.0, rng.uniform(0, 0.9, m))
    friction = -(mu * normal * share)[:, None] * way
    u = rng.standard_normal(n)
    f = K @ u - G.T @ normal - S.T @ friction.ravel()
    g0 = np.where(closed, 0.0, rng.uniform(0.1, 1, m)) - G @ u
    free_slip = np.where((state == State.OPEN)[:, None], rng.standard_normal((m, 2)), slip)
    if components == 1:
        free_slip[:, 1] = 0.0
    s0 = free_slip - (S @ u).reshape(-1, 2)
    return Planted(linear(K, f, G, S, g0, s0, np.full(m, mu)), u, normal, friction, state)


def tied(seed: int) -> ContactProblem:
    """The same with an infinite coefficient: the loads stay, the answer does not."""
    problem = planted(seed, 0.5).problem
    return with_mu(problem, np.full_like(problem.coulomb.mu, np.inf))
