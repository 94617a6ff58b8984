"""The linearised step with friction condensed on forces: v = v_free + W F of the candidates that may touch.

With K^-1 at hand, du = K^-1 (J^T F - r) and W = J K^-1 J^T [mm/N], three ways a candidate; a finite epsilon adds what
its springs give way. A programme in F is asked for forces and states of those that are expected to touch, joined by
those that its answer pushes in. A body that only the foundation holds has no W, and one that it keeps from falling over
has one that is not definite, so that a programme ends far away or not at all: springs hold those that are expected to
touch where they are, or all if there are none, then where the answer before left them, until states repeat.
Sources of such springs: Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898 (proximal points); without monotonicity:
Pennanen, Math. Oper. Res. 27 (2002) 170-191.

On a polygon it is a dense linear complementarity problem, for Lemke's pivots. Friction t = D b, b >= 0, is a sum along
the corners D of a polygon in the disc; with l the size of the slip::

    0 <= f  _|_  g >= 0,    0 <= b  _|_  D^T s + l >= 0,    0 <= l  _|_  mu f - sum b >= 0

with v = (g, s) of the condensed linearisation. The matrix is copositive, so that Lemke's pivots end for every mu, after
up to 2^n of them: they are bounded.
Sources: Stewart, Trinkle, Int. J. Numer. Methods Eng. 39 (1996) 2673-2691; Anitescu, Potra, Nonlinear Dyn. 14 (1997)
231-247.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.newton.friction_held import Directions
from contact.newton.friction_run import FrictionalRun, Point
from contact.newton.friction_states import Laws, Local, directed
from contact.newton.friction_step import Stepped
from contact.newton.loop import StepError
from contact.problem import Outcome
from contact.solvers.lcp_pivoting import lemke
from contact.solvers.sparse import Factor, SingularMatrixError, added, negative_pivots, response, symmetric

SOFTEST = 1e10  # how much more a way may give than its own unknown does where all else stands still
SPRING = 1e-2  # of the stiffness of a candidate's own unknowns: springs where only the foundation holds
PASSES = 30


@dataclass(frozen=True, eq=False)
class Block:
    """The problem of c candidates: W (3c, 3c) [mm/N], v (3c,) [mm] without forces, mu (c,), stiffness k (c,) [N/mm].

    own (c, 3): ways that can move, or have; the others neither move nor matter.
    energetic: whether the stiffness is symmetric, so that W is but for rounding, which is as large as it is soft.
    """

    W: np.ndarray
    v: np.ndarray
    mu: np.ndarray
    k: np.ndarray
    own: np.ndarray
    energetic: bool = False


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
            c, own = at.local.c[nodes], body.own[nodes]
            chosen = choose(Block(W, v[places], run.law.mu[nodes], c, own, energetic=body.symmetric))
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
        K = run.law.on_tangent(contact.stiffness(at.lin, u, at.newton.pressure), u, at.friction)
        J = Directions.of(contact.gap_jacobian(u), run.law.slip_jacobian(u))
        self._run, self._residual, self._J, m = run, at.lin.residual, J.rows, len(near)
        self.now, self.own = np.column_stack([contact.gap(u), run.law.slip(u)]).ravel(), J.own
        self.own[:, 1:] |= np.abs(self.now.reshape(m, 3)[:, 1:]) > run.slip_rounding(u)
        self._known, self._columns = np.zeros(0, int), np.zeros((3 * m, 0))
        self.symmetric, own = symmetric(K), np.abs(K.diagonal())
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
            held_alone = float(np.max(np.abs(free), initial=0.0)) <= SOFTEST * size and not self._negative()
            if spring.any() or held_alone:
                return
            why = "the stiffness is singular to working precision, or not definite"
        raise StepError(Outcome.UNSOLVED, f"candidates have no compliance: {why}")

    def _negative(self) -> int:
        """Negative eigenvalues of the symmetric part of the matrix."""
        A, problem = self._matrix, self._run.newton.problem
        if self.symmetric:
            return negative_pivots(A, self._factor, ordered=problem.ordered, multipliers=problem.multipliers)
        return negative_pivots(sparse.csc_matrix((A + A.T) / 2), multipliers=problem.multipliers)

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
            fresh = response(self._factor, sparse.csc_matrix(self._J.T), sparse.csc_matrix(self._J[ways].T))
            self._known, self._columns = np.append(self._known, new), np.hstack([self._columns, fresh])
        place = np.empty(len(self.own), int)
        place[self._known] = np.arange(len(self._known))
        inside = (3 * place[nodes][:, None] + np.arange(3)).ravel()
        return (3 * nodes[:, None] + np.arange(3)).ravel(), self._columns[:, inside]


PIVOTS_EACH = 20  # allowed per unknown: far more than are needed where there is an end; the worst cases take 2^n
SIDES = 8  # of a polygon, unless asked for otherwise; friction is up to 1 - cos(pi/sides) short


def by_pivots(block: Block, sides: int = SIDES) -> Chosen:
    """Forces and states of the candidates of a condensed linearisation; raises LcpError."""
    c, (rubs, D) = len(block.mu), corners(block, sides)
    owners, which = np.unique(rubs, return_inverse=True)
    b, e = len(rubs), len(owners)
    length = float(np.max(np.abs(block.v), initial=0.0)) or 1.0
    give = float(np.mean(np.diag(block.W)[::3])) or 1.0
    acting = np.hstack([np.eye(3 * c)[:, ::3], D])
    M = np.zeros((c + b + e, c + b + e))
    M[: c + b, : c + b] = acting.T @ (block.W / give) @ acting
    M[c + np.arange(b), c + b + which] = 1.0
    M[c + b + which, c + np.arange(b)] = -1.0
    M[c + b + np.arange(e), owners] = block.mu[owners]
    q = np.append(acting.T @ block.v / length, np.zeros(e))
    z = lemke(M, q, most=PIVOTS_EACH * len(q)).z
    forces = (acting @ z[: c + b]).reshape(c, 3) * (length / give)
    moves = np.zeros(c)
    moves[owners] = z[c + b :]
    slips = (moves > 0) | (block.mu == 0)
    state = np.where(z[:c] > 0, np.where(slips, State.SLIP, State.STICK), State.OPEN).astype(np.int8)
    return Chosen(forces, state)


def corners(block: Block, sides: int) -> tuple[np.ndarray, np.ndarray]:
    """The candidates (b,) and columns (3c, b) of the corners of their polygons: two where a slip has one way."""
    rubs, columns = [np.zeros(0, int)], [np.zeros((3 * len(block.mu), 0))]
    for i in np.flatnonzero(block.mu > 0).tolist():
        one, two = block.own[i, 1:]
        directions = (
            polygon(sides) if one and two else polygon(2)[:, :: 1 if one else -1] if one or two else np.zeros((0, 2))
        )
        D = np.zeros((3 * len(block.mu), len(directions)))
        D[3 * i + 1 : 3 * i + 3] = directions.T
        rubs.append(np.full(len(directions), i))
        columns.append(D)
    return np.concatenate(rubs), np.hstack(columns)


def polygon(sides: int) -> np.ndarray:
    """Unit vectors (sides, 2) to the corners of a polygon in the disc of radius 1."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.column_stack([np.cos(angle), np.sin(angle)])


def no_polygon(sides: int, mu: np.ndarray, unbounded: str) -> str | None:
    """Why friction on a polygon of so many sides does not apply, or None; unbounded: what an infinite mu (m,) is."""
    if sides < 4 or sides % 2:
        return f"a polygon of {sides} sides: an even number from 4 on is needed"
    return f"an infinite coefficient {unbounded}" if np.any(np.isinf(mu)) else None
