"""Random frozen steps with friction in which candidates stay open, stick and slip, each by a seed of its own."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.interchange.linearised_step import FrozenFrictionalStep


def random_step(seed: int) -> FrozenFrictionalStep:
    """4 to 9 candidates with three unknowns each, in skew axes, and up to five unknowns more.

    K is symmetric positive definite with eigenvalues from 1 up to 1 to 1000 in random directions, mu from 0 to 1, every
    ninth 0. The load is that of an answer that is drawn first, with every state in it; at these mu it need not be the
    only one.
    """
    rng = np.random.default_rng([seed, 2026])
    m = int(rng.integers(4, 10))
    n = 3 * m + int(rng.integers(0, 6))
    directions = np.linalg.qr(rng.standard_normal((n, n)))[0]
    K = (directions * 10 ** rng.uniform(0, rng.uniform(0, 3), n)) @ directions.T
    G, S = np.zeros((m, n)), np.zeros((2 * m, n))
    for i in range(m):
        axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
        G[i, 3 * i : 3 * i + 3], S[2 * i : 2 * i + 2, 3 * i : 3 * i + 3] = axes[0], axes[1:]
    state = rng.permutation(np.append([State.OPEN, State.STICK, State.SLIP], rng.integers(0, 3, m - 3)))
    mu = np.where(rng.uniform(size=m) < 1 / 9, 0.0, rng.uniform(0, 1, m))
    closed, slips = state != State.OPEN, state == State.SLIP
    normal = np.where(closed, 10 ** rng.uniform(-1, 1, m), 0.0)
    angle = rng.uniform(0, 2 * np.pi, m)
    way = np.column_stack([np.cos(angle), np.sin(angle)])
    moved = np.where(slips, 10 ** rng.uniform(-2, 0, m), 0.0)[:, None] * way
    moved = np.where(closed[:, None], moved, rng.standard_normal((m, 2)))
    friction = -(mu * normal * np.where(slips, 1.0, rng.uniform(0, 0.95, m)))[:, None] * way
    u = rng.standard_normal(n)
    r = G.T @ normal + S.T @ friction.ravel() - K @ u
    gap = np.where(closed, 0.0, 10 ** rng.uniform(-2, 0, m)) - G @ u
    return dense_step(K, r, G, gap, S, moved - (S @ u).reshape(m, 2), mu)


def dense_step(
    K: np.ndarray, r: np.ndarray, G: np.ndarray, gap: np.ndarray, S: np.ndarray, slip: np.ndarray, mu: np.ndarray
) -> FrozenFrictionalStep:
    """Of dense matrices, with areas one."""
    scale = float(np.linalg.norm(r))
    contact = sparse.csc_matrix(K), r, sparse.csr_matrix(G), gap, np.ones(len(gap)), scale
    return FrozenFrictionalStep(*contact, S=sparse.csr_matrix(S), slip=slip, mu=mu)
