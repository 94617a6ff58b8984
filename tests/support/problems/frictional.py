"""Small problems with friction whose answer is built in, and Klarbring's springs with all of theirs.

Small linear problems with friction whose answer is planted: states, forces and slips first, the loads from them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.coulomb import Coulomb, State
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.problem import ContactProblem, linear_mechanics
from studies.arena.frictional_steps import dense_step


@dataclass(frozen=True, eq=False)
class Answer:
    """u (n,), normal forces (m,), friction (m, 2), states (m,)."""

    u: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    state: np.ndarray


def sure(K: np.ndarray, G: np.ndarray, S: np.ndarray) -> float:
    """A coefficient below which an answer is the only one, for symmetric positive definite K and independent rows.

    The difference of two answers has the energy e^2 = dl.W.dl = df.dg + dt.ds <= mu |df| |ds|, and |ds| <= e
    sqrt(largest of W_tt), |df| <= e/sqrt(smallest of W_nn - W_nt W_tt^-1 W_tn).
    """
    H = np.vstack([G, S])
    W, m = H @ np.linalg.solve(K, H.T), len(G)
    schur = W[:m, :m] - W[:m, m:] @ np.linalg.solve(W[m:, m:], W[m:, :m])
    return float(np.sqrt(np.linalg.eigvalsh(schur)[0] / np.linalg.eigvalsh(W[m:, m:])[-1]))


def manufactured(
    rng: np.random.Generator, m: int = 4, states: np.ndarray | None = None, share: float = 0.9
) -> tuple[FrozenFrictionalStep, Answer]:
    """A step and its only answer: K definite, 3m + 2 unknowns, mu up to ``share`` of what is :func:`sure`."""
    n = 3 * m + 2
    root = rng.normal(size=(n, n))
    K = root @ root.T / n + np.eye(n)
    G, S = rng.normal(size=(m, n)), rng.normal(size=(2 * m, n))
    mu = share * sure(K, G, S) * rng.uniform(0.3, 1.0, m)
    state = rng.integers(0, 3, m) if states is None else states
    u, away = rng.normal(size=n), rng.uniform(0.3, 2, m)
    normal = np.where(state == State.OPEN, 0.0, away)
    gap = np.where(state == State.OPEN, away, 0.0) - G @ u
    angle = rng.uniform(0, 2 * np.pi, m)
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    moved = np.where(state == State.STICK, 0.0, rng.uniform(0.3, 2, m))
    share_of_bound = np.where(state == State.SLIP, -1.0, rng.uniform(0, 0.95, m))
    friction = (share_of_bound * mu * normal)[:, None] * direction
    slip = moved[:, None] * direction - (S @ u).reshape(m, 2)
    r = G.T @ normal + S.T @ friction.ravel() - K @ u
    return dense_step(K, r, G, gap, S, slip, mu), Answer(u, normal, friction, state)


def klarbring(mu: float, load: tuple[float, float], coupling: float) -> FrozenFrictionalStep:
    """One node on springs in a plane, [[2, -coupling], [-coupling, 1]] along and across (Klarbring 1990), g = u_n.

    u = (u_t, u_n); a spring of its own holds a third displacement, across the plane of the springs.
    """
    K = np.array([[2.0, -coupling, 0.0], [-coupling, 1.0, 0.0], [0.0, 0.0, 1.0]])
    G, S = np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    return dense_step(K, -np.array([*load, 0.0]), G, np.zeros(1), S, np.zeros((1, 2)), np.array([mu]))


def all_answers(springs: FrozenFrictionalStep) -> list[Answer]:
    """Every answer of :func:`klarbring`, state by state, each by its two equations."""
    K, (along, across) = springs.K.toarray()[:2, :2], -springs.r[:2]
    mu, actual = float(springs.mu[0]), []

    def take(u_t: float, u_n: float, f: float, t: float, state: State) -> None:
        actual.append(Answer(np.array([u_t, u_n, 0.0]), np.array([f]), np.array([[t, 0.0]]), np.array([state])))

    u_t, u_n = np.linalg.solve(K, [along, across])
    if u_n > 0:
        take(u_t, u_n, 0.0, 0.0, State.OPEN)
    if -across >= 0 and abs(along) <= mu * -across:  # K 0 = load + (t, f)
        take(0.0, 0.0, -across, -along, State.STICK)
    for sense in (1.0, -1.0):  # k u = along - sense mu f,  c u = across + f
        matrix = np.array([[K[0, 0], sense * mu], [K[1, 0], -1.0]])
        u_t, f = np.linalg.solve(matrix, [along, across])
        if f > 0 and sense * u_t > 0:
            take(u_t, 0.0, f, -sense * mu * f, State.SLIP)
    return actual


def balanced(made: FrozenFrictionalStep, answer: Answer) -> FrozenFrictionalStep:
    """The same step with the load under which any ``answer`` is in equilibrium."""
    return replace(made, r=made.G.T @ answer.normal + made.S.T @ answer.friction.ravel() - made.K @ answer.u)


def in_units(made: FrozenFrictionalStep, length: float, force: float) -> FrozenFrictionalStep:
    """The same where a mm is so many units of length, and a N so many of force."""
    loads = {"K": made.K * (force / length), "r": made.r * force, "scale": made.scale * force}
    return replace(made, **loads, gap=made.gap * length, slip=made.slip * length)


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
