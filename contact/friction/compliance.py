"""The linearised step with friction condensed on forces: v = v_free + W F of the candidates that may touch.

With K^-1 at hand, du = K^-1 (J^T F - r) and W = J K^-1 J^T [mm/N], three ways a candidate; a finite epsilon adds what
its springs give way. A programme in F is asked for forces and states of those that are expected to touch, joined by
those that its answer pushes in. A body that only the foundation holds has no W: K is then made a little stiffer along
its diagonal, which serves to choose states, no more.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.friction.held import Directions
from contact.friction.laws import Laws, Local, directed
from contact.friction.problem import State
from contact.friction.run import FrictionalRun, Point
from contact.newton.loop import StepError
from contact.problem import Outcome
from contact.solvers.sparse import Factor, SingularMatrixError, added, response

SHIFTS = (0.0, 1e-6, 1e-4)  # of the diagonal of K
SOFTEST = 1e9  # how much more a way may give than its own unknown does where all else stands still


@dataclass(frozen=True, eq=False)
class Block:
    """The problem of c candidates: W (3c, 3c) [mm/N], v (3c,) [mm] without forces, mu (c,), stiffness k (c,) [N/mm].

    own (c, 3): ways that can move, or have; the others neither move nor matter.
    """

    W: np.ndarray
    v: np.ndarray
    mu: np.ndarray
    k: np.ndarray
    own: np.ndarray


@dataclass(frozen=True, eq=False)
class Chosen:
    """Forces F (c, 3) and states (c,)."""

    forces: np.ndarray
    state: np.ndarray


Choose = Callable[[Block], Chosen]


@dataclass(frozen=True, eq=False)
class Reached:
    """What a programme makes of a linearisation: du (n,), all candidates, their laws, and the shift of K's diagonal."""

    du: np.ndarray
    local: Local
    laws: Laws
    shift: float


def reach(run: FrictionalRun, at: Point, near: np.ndarray, choose: Choose) -> Reached:
    """Ask for the candidates ``near`` (m,) and those that are pushed in; raises StepError and what choose raises."""
    contact, u = run.problem.contact, at.newton.u
    K = contact.stiffness(at.lin, u, at.newton.pressure)
    J = Directions.of(contact.gap_jacobian(u), run.problem.slip_jacobian(u))
    now, give = np.column_stack([contact.gap(u), run.problem.slip(u)]).ravel(), np.repeat(run.give, 3)
    factor, matrix, du, shift = _factorised(run, at, K, J.rows)
    v, m = now + J.rows @ du, len(run.problem.mu)
    near = near | (v[::3] < 0)
    F, state = np.zeros(3 * m), np.zeros(m, np.int8)
    own = J.own
    own[:, 1:] |= np.abs(now.reshape(m, 3)[:, 1:]) > run.slip_rounding(u)
    known, columns = np.zeros(0, int), np.zeros((3 * m, 0))
    while near.any():
        new = np.setdiff1d(np.flatnonzero(near), known)
        with run.newton.tally.timed("contact_s"):
            ways = (3 * new[:, None] + np.arange(3)).ravel()
            found = response(factor, sparse.csc_matrix(J.rows.T), sparse.csc_matrix(J.rows[ways].T))
            known, columns = np.append(known, new), np.hstack([columns, found])
            places = (3 * known[:, None] + np.arange(3)).ravel()
            W = columns[places] + np.diag(give[places])
            block = Block(W, v[places], run.problem.mu[known], at.local.c[known], own[known])
            chosen = choose(block)
        F[places], state[known] = chosen.forces.ravel(), chosen.state
        after = v + columns @ F[places]
        moved = float(np.max(np.abs(after - now), initial=0.0))
        pushed_in = (after[::3] < -run.margins(at, moved).gap) & ~near
        if not pushed_in.any():
            break
        near = near | pushed_in
    du = run.newton.solution(factor, matrix, J.rows.T @ F - at.lin.residual)
    way, force = (now + J.rows @ du + give * F).reshape(m, 3), F.reshape(m, 3)
    local = Local(way[:, 0], way[:, 1:], force[:, 0], force[:, 1:], at.local.c)
    bound = np.where(state == State.SLIP, run.problem.mu, 0.0) * np.maximum(local.normal, 0.0)
    return Reached(du, local, directed(local, state, bound), shift)


def _factorised(
    run: FrictionalRun, at: Point, K: sparse.csc_matrix, J: sparse.csr_matrix
) -> tuple[Factor, sparse.csc_matrix, np.ndarray, float]:
    """Factor, matrix, free motion and shift of the first that leaves a compliance worth the name; raises StepError."""
    own = np.abs(K.diagonal())
    own[own == 0] = np.max(own, initial=0.0) or 1.0
    size = float(np.max(abs(J) @ (np.linalg.norm(at.lin.residual) / own), initial=0.0))
    for shift in SHIFTS:
        matrix = added(K, sparse.csc_matrix(sparse.diags_array(shift * own))) if shift else K
        try:
            factor = run.newton.factorise(matrix)
            du = run.newton.solution(factor, matrix, -at.lin.residual)
        except SingularMatrixError:
            continue
        if shift == SHIFTS[-1] or float(np.max(np.abs(J @ du), initial=0.0)) <= SOFTEST * size:
            return factor, matrix, du, shift
    raise StepError(Outcome.UNSOLVED, f"no compliance of the candidates even with a shift of {SHIFTS[-1]:g}")
