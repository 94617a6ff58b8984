"""The linearised step with friction condensed on forces: v = v_free + W F of the candidates that may touch.

With K^-1 at hand, du = K^-1 (J^T F - r) and W = J K^-1 J^T [mm/N], three ways a candidate; a finite epsilon adds what
its springs give way. A programme in F is asked for forces and states of those that are expected to touch, joined by
those that its answer pushes in. A body that only the foundation holds has no W: springs hold those that are expected to
touch where they are, or all if there are none, then where the answer before left them, until states repeat.
Source of such springs: Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898 (proximal points).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.friction.held import Directions
from contact.friction.laws import Laws, Local, directed
from contact.friction.run import FrictionalRun, Point
from contact.friction.step import Stepped
from contact.newton.loop import StepError
from contact.problem import Outcome
from contact.solvers.sparse import Factor, SingularMatrixError, added, response

SOFTEST = 1e10  # how much more a way may give than its own unknown does where all else stands still
SPRING = 1e-2  # of the stiffness of a candidate's own unknowns: springs where only the foundation holds
PASSES = 30


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
    """What a programme makes of a linearisation: the step, its laws, and passes on springs, 0 for none.

    The step is that of the linearisation only where there were no springs.
    """

    stepped: Stepped
    laws: Laws
    passes: int


def reach(run: FrictionalRun, at: Point, near: np.ndarray, choose: Choose) -> Reached:
    """Ask for the candidates ``near`` (m,) and those that are pushed in; raises StepError and what choose raises."""
    body = _Body(run, at, near)
    m, passes = len(near), 0
    anchor, states = np.where(np.repeat(near, 3), 0.0, body.now), [np.full(m, -1)]
    while True:
        F, state = _asked(run, at, body, near, anchor, choose)
        if not body.spring.any() or np.array_equal(state, states[-1]) or passes == PASSES:
            break
        states.append(state)
        anchor, passes = body.ways(body.moved(F, anchor)), passes + 1
    du = body.moved(F, anchor)
    way, force = (body.ways(du) + np.repeat(run.give, 3) * F).reshape(m, 3), F.reshape(m, 3)
    local = Local(way[:, 0], way[:, 1:], force[:, 0], force[:, 1:], at.local.c)
    bound = np.where(state == State.SLIP, run.law.mu, 0.0) * np.maximum(local.normal, 0.0)
    stepped = Stepped(du, local.gap, local.slip, local.normal, local.friction)
    return Reached(stepped, directed(local, state, bound), passes)


def _asked(
    run: FrictionalRun, at: Point, body: _Body, near: np.ndarray, anchor: np.ndarray, choose: Choose
) -> tuple[np.ndarray, np.ndarray]:
    """Forces (3m,) and states (m,) with springs that pull towards the ways ``anchor`` (3m,)."""
    F, state, give = np.zeros(3 * len(near)), np.zeros(len(near), np.int8), np.repeat(run.give, 3)
    v = body.ways(body.moved(F, anchor))
    near = near | (v[::3] < 0)
    while near.any():
        with run.newton.tally.timed("contact_s"):
            nodes = np.flatnonzero(near)
            places, columns = body.columns(nodes)
            W = columns[places] + np.diag(give[places])
            chosen = choose(Block(W, v[places], run.law.mu[nodes], at.local.c[nodes], body.own[nodes]))
        F[places], state[nodes] = chosen.forces.ravel(), chosen.state
        after = v + columns @ F[places]
        moved = float(np.max(np.abs(after - body.now), initial=0.0))
        pushed_in = (after[::3] < -run.margins(at, moved).gap) & ~near
        if not pushed_in.any():
            break
        near = near | pushed_in
    return F, state


class _Body:
    """K factorised, with springs (3m,) [N/mm] on ways where it is singular alone; columns of W as they are wanted."""

    def __init__(self, run: FrictionalRun, at: Point, near: np.ndarray) -> None:
        """Raises StepError where springs on the candidates ``near``, or on all, do not hold it either."""
        contact, u = run.newton.problem, at.newton.u
        K = contact.stiffness(at.lin, u, at.newton.pressure)
        J = Directions.of(contact.gap_jacobian(u), run.law.slip_jacobian(u))
        self._run, self._residual, self._J, m = run, at.lin.residual, J.rows, len(near)
        self.now, self.own = np.column_stack([contact.gap(u), run.law.slip(u)]).ravel(), J.own
        self.own[:, 1:] |= np.abs(self.now.reshape(m, 3)[:, 1:]) > run.slip_rounding(u)
        self._known, self._columns = np.zeros(0, int), np.zeros((3 * m, 0))
        own = np.abs(K.diagonal())
        alone = np.linalg.norm(at.lin.residual) / np.where(own > 0, own, np.inf)
        size = float(np.max(abs(J.rows) @ alone, initial=0.0))
        for spring in (np.zeros(3 * m), SPRING * np.repeat(np.where(near | (not near.any()), at.local.c, 0.0), 3)):
            self.spring = spring
            held = sparse.csc_matrix(self._J.T @ sparse.diags_array(spring) @ self._J)
            self._matrix = added(K, held) if spring.any() else K
            try:
                self._factor: Factor = run.newton.factorise(self._matrix)
                free = self.ways(self.moved(np.zeros(3 * m), np.zeros(3 * m))) - self.now
            except SingularMatrixError as error:
                why = str(error)
                continue
            if spring.any() or float(np.max(np.abs(free), initial=0.0)) <= SOFTEST * size:
                return
            why = "the stiffness is singular to working precision"
        raise StepError(Outcome.UNSOLVED, f"candidates have no compliance: {why}")

    def moved(self, F: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        """du (n,) under the forces F (3m,)."""
        pull = F + self.spring * (anchor - self.now)
        return self._run.newton.solution(self._factor, self._matrix, self._J.T @ pull - self._residual)

    def ways(self, du: np.ndarray) -> np.ndarray:
        """Gaps and slips (3m,) after du."""
        return np.asarray(self.now + self._J @ du)

    def columns(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places (3c,) of the ways of these candidates, and their columns of W (3m, 3c)."""
        new = np.setdiff1d(nodes, self._known)
        if len(new):
            ways = (3 * new[:, None] + np.arange(3)).ravel()
            found = response(self._factor, sparse.csc_matrix(self._J.T), sparse.csc_matrix(self._J[ways].T))
            self._known, self._columns = np.append(self._known, new), np.hstack([self._columns, found])
        place = np.empty(len(self.own), int)
        place[self._known] = np.arange(len(self._known))
        inside = (3 * place[nodes][:, None] + np.arange(3)).ravel()
        return (3 * nodes[:, None] + np.arange(3)).ravel(), self._columns[:, inside]
