"""The linearised step of a frictional problem under given states: one factorisation, other states by its columns.

With J = (G, S), F = (f, t) and v = (g, s), all of each candidate together::

    K du - J^T F = -r,    v = v_now + J du,    A F + B v = 0

A and B are those of the laws. Factorised is the system of one choice of states; a candidate of another state has inputs
z and outputs w in it, w = q + M z, of which its own law makes a small dense system:

    open   z = F, w = v        stick  z = v, w = F        slip   z = (g, t more than its law), w = (f, s)

Between two states that touch, g stays closed and only friction and slip are inputs. No choice of states enters here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.friction.held import Directions, HeldStates
from contact.friction.laws import Laws
from contact.newton.step import NewtonRun
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.problem import Linearised
from contact.solvers.sparse import SingularMatrixError, added, factor_flops, response, response_flops

REFINED = 1e-12  # relative change of the inputs that a step has found, above which it is solved again
REFINEMENTS = 3


@dataclass(frozen=True, eq=False)
class Stepped:
    """After the step: du (n,), gap and normal force (m,), slip and friction (m, 2)."""

    du: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    normal: np.ndarray
    friction: np.ndarray


class FrictionalStep:
    """The linearisation at u, factorised for the laws ``base``; raises SingularMatrixError, NotHeldError.

    K (n, n) is the tangent less what the curvature of the gaps takes off; residual (n,): without forces of the
    foundation; now (3m,): gap and slips of the candidates at u, one after another.
    """

    def __init__(
        self,
        run: NewtonRun,
        lin: Linearised,
        K: sparse.csc_matrix,
        ways: Directions,
        now: np.ndarray,
        mu: np.ndarray,
        base: Laws,
    ) -> None:
        self._run, self._residual, self._tangent = run, lin.residual, K
        self._ways, self._now, self._mu = ways, now, mu
        self._factorise(base)

    def step(self, laws: Laws) -> Stepped:
        """The step under the laws; raises SingularMatrixError, NotHeldError."""
        changed, places, z = self._exchanged(laws)
        du, w = self._free
        if len(places):
            for _ in range(REFINEMENTS):
                du, w = self._solution(z)
                of_z, of_w = self._law(laws, changed)
                left = [
                    np.einsum("cij,cj->ci", of, each.reshape(-1, 3)[changed]) for of, each in ((of_z, z), (of_w, w))
                ]
                change = self._inputs(of_z, of_w, changed, places, -sum(left))
                if np.all(np.abs(change) <= REFINED * np.max(np.abs(z))):
                    break
                z[places] += change
        return self._told(du, w, z, laws)

    def foreseen(self, laws: Laws) -> Stepped:
        """The step by columns alone, for the choice of states: du is not worked out."""
        _, places, z = self._exchanged(laws)
        w = self._q + (self._columns[:, self._place(places)] @ z[places] if len(places) else 0.0)
        return self._told(np.zeros(0), w, z, laws)

    def _factorise(self, base: Laws) -> None:
        run, ways, m = self._run, self._ways, len(self._mu)
        with run.tally.timed("contact_s"):
            slips = _pairs(base.spring)
            tangential = _tangential(m)
            spring = sparse.csc_matrix(tangential.T @ slips @ tangential)
            K = added(self._tangent, sparse.csc_matrix(ways.rows.T @ spring @ ways.rows))
            self._held = HeldStates.of(ways, base, self._mu, K)
            matrix = self._held.held.matrix
        self.base, self._matrix = base, matrix
        self._left = self._residual + ways.rows.T @ (spring @ self._now)
        forced = _inputs_are_forces(base)  # where forces are put in, ways come out
        with run.tally.timed("contact_s"):
            self._push = sparse.csc_matrix(ways.rows.T @ sparse.diags_array(forced.ravel().astype(float)))
            self._see = sparse.csr_matrix(sparse.diags_array(forced.ravel().astype(float)) @ ways.rows)
            self._seen = np.where(forced.ravel(), self._now, 0.0)
        self._factor = run.factorise(matrix)
        self._free = self._solution(np.zeros(3 * m))
        self._q = self._free[1]
        self._known, self._columns = np.zeros(0, int), np.zeros((3 * m, 0))
        self._sides: tuple[sparse.csc_matrix, sparse.csc_matrix, sparse.csc_matrix] | None = None

    def _solution(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """du (n,) and w (3m,) under the inputs z (3m,)."""
        held, force = self._held.held, self._push @ z - self._left
        slack = self._held.to_slack @ (z - self._now)
        y = self._run.solution(self._factor, self._matrix, held.load(force, slack))
        du = held.motion(y, slack)
        return du, self._see @ du + self._seen + self._held.multiplied @ held.forces(y, du, -force)

    def _exchanged(self, laws: Laws) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Candidates (c,) under other laws than in the base, their inputs (p,), and z (3m,) that obeys the laws."""
        changed, places = self._changes(laws)
        new = np.setdiff1d(places, self._known)
        if len(new) and response_flops(self._factor, *self._both(new)[:2]) > factor_flops(self._factor):
            self._factorise(laws)
            changed, places = self._changes(laws)
        z = np.zeros(3 * len(self._mu))
        if len(places):
            self._find(np.setdiff1d(places, self._known))
            of_z, of_w = self._law(laws, changed)
            q = np.einsum("cij,cj->ci", of_w, self._q.reshape(-1, 3)[changed])
            z[places] = self._inputs(of_z, of_w, changed, places, -q)
        return changed, places, z

    def _changes(self, laws: Laws) -> tuple[np.ndarray, np.ndarray]:
        """Candidates under other laws, and their inputs: none along a gap that stays closed, or where nothing moves."""
        turned = np.any(laws.direction != self.base.direction, axis=1) | (laws.across != self.base.across)
        changed = np.flatnonzero((laws.state != self.base.state) | turned)
        used = self._ways.own[changed]
        used[:, 0] &= ~(laws.closed & self.base.closed)[changed]
        return changed, (3 * changed[:, None] + np.arange(3))[used]

    def _law(self, laws: Laws, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the laws ask of z and of w, (c, 3, 3) each, by way of what they are in the base."""
        A, B = _asked(laws, self._mu, chosen)
        of_slip, _ = _asked(self.base, self._mu, chosen)  # t + mu f d + kappa e e.s = z, where the base slips
        forced = _inputs_are_forces(self.base)[chosen].astype(float)
        F_z, F_w = _diagonal(forced), _diagonal(1 - forced)
        slips = (self.base.state == State.SLIP)[chosen]
        F_w[slips, 1:] = np.concatenate([-of_slip[slips, 1:, :1], -self.base.spring[chosen[slips]]], axis=2)
        return A @ F_z + B @ _diagonal(1 - forced), A @ F_w + B @ _diagonal(forced)

    def _inputs(
        self, of_z: np.ndarray, of_w: np.ndarray, changed: np.ndarray, places: np.ndarray, b: np.ndarray
    ) -> np.ndarray:
        """The inputs (p,) for which the laws of the changed candidates come to b (c, 3); raises SingularMatrixError."""
        rows = (3 * changed[:, None] + np.arange(3)).ravel()
        kept = np.searchsorted(rows, places)
        M = self._columns[np.ix_(rows, self._place(places))].reshape(len(changed), 3, -1)
        matrix = np.einsum("cij,cjp->cip", of_w, M).reshape(len(rows), -1)
        each = kept // 3
        matrix[3 * each[:, None] + np.arange(3), np.arange(len(kept))[:, None]] += of_z[each, :, kept % 3]
        return _solved(matrix[kept], b.ravel()[kept])

    def _told(self, du: np.ndarray, w: np.ndarray, z: np.ndarray, laws: Laws) -> Stepped:
        """Forces and ways of all candidates; those of the laws themselves to the last digit."""
        m, forced = len(self._mu), _inputs_are_forces(self.base)
        w, z = w.reshape(m, 3), z.reshape(m, 3)
        force, way = np.where(forced, z, w), np.where(forced, w, z)
        way = np.where(self._ways.own, way, self._now.reshape(m, 3))
        gap, slip, normal = way[:, 0], way[:, 1:], force[:, 0]
        # where the base slips, z is what friction is more than its law
        lawful = -self._follow(laws, normal, slip)
        extra = np.where(
            (self.base.state == State.SLIP)[:, None], z[:, 1:] - self._follow(self.base, normal, slip), 0.0
        )
        friction = np.where((self.base.state == State.SLIP)[:, None], extra, force[:, 1:])
        slips, opens = laws.state == State.SLIP, ~laws.closed
        friction = np.where(slips[:, None], lawful, np.where(opens[:, None], 0.0, friction))
        return Stepped(du, gap, slip, np.where(opens, 0.0, normal), friction)

    def _follow(self, laws: Laws, normal: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """mu f d + kappa e (e.s) (m, 2) of those that slip."""
        slips = laws.state == State.SLIP
        pushed = np.where(slips, self._mu, 0.0) * np.where(slips, normal, 0.0)
        return np.asarray(pushed[:, None] * laws.direction + np.einsum("mij,mj->mi", laws.spring, slip))

    def _find(self, new: np.ndarray) -> None:
        """Columns of M for these inputs."""
        if len(new):
            with self._run.tally.timed("contact_s"):
                left, right, direct = self._both(new)
                found = response(self._factor, left, right) + direct.toarray()
                self._columns = np.hstack([self._columns, found])
            self._known = np.append(self._known, new)

    def _place(self, inputs: np.ndarray) -> np.ndarray:
        place = np.empty(3 * len(self._mu), int)
        place[self._known] = np.arange(len(self._known))
        return place[inputs]

    def _both(self, inputs: np.ndarray) -> tuple[sparse.csc_matrix, sparse.csc_matrix, sparse.csc_matrix]:
        """What of y is in w (n, 3m), what these inputs put on the right of y (n, p), and in w directly (3m, p)."""
        if self._sides is None:
            held, states = self._held.held, self._held
            pivot, slack = held.pivot, states.to_slack
            seen = sparse.csc_matrix(self._see + states.multiplied @ held.across)
            at_pivots = sparse.csc_matrix(seen[:, pivot])
            left = sparse.csc_matrix((seen - at_pivots @ held.following).T)
            done = sparse.csc_matrix(self._push - held.columns @ slack)
            right = sparse.csc_matrix(done - held.balancing.T @ done.tocsr()[pivot])
            direct = sparse.csc_matrix(at_pivots @ slack - states.multiplied @ self._push.tocsr()[pivot])
            self._sides = left, right, direct
        left, right, direct = self._sides
        return left, sparse.csc_matrix(right[:, inputs]), sparse.csc_matrix(direct[:, inputs])


def _inputs_are_forces(base: Laws) -> np.ndarray:
    """(m, 3) bool."""
    forced = np.repeat((base.state == State.OPEN)[:, None], 3, axis=1)
    forced[:, 1:] |= (base.state == State.SLIP)[:, None]
    return forced


def _asked(laws: Laws, mu: np.ndarray, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A and B (c, 3, 3) of A F + B v = 0."""
    state, A, B = laws.state[chosen], np.zeros((len(chosen), 3, 3)), np.zeros((len(chosen), 3, 3))
    opens, sticks, slips = (state == each for each in State)
    A[opens] = np.eye(3)
    B[sticks] = np.eye(3)
    B[slips, 0, 0] = 1.0
    A[slips, 1:, 1:] = np.eye(2)
    A[slips, 1:, 0] = mu[chosen[slips], None] * laws.direction[chosen[slips]]
    B[slips, 1:, 1:] = laws.spring[chosen[slips]]
    return A, B


def _diagonal(values: np.ndarray) -> np.ndarray:
    """(c, 3, 3) of (c, 3)."""
    return np.asarray(values[:, :, None] * np.eye(3))


def _tangential(m: int) -> sparse.csr_matrix:
    """(2m, 3m): slips from gaps and slips."""
    columns = (3 * np.arange(m)[:, None] + [1, 2]).ravel()
    return sparse.csr_matrix((np.ones(2 * m), columns, np.arange(2 * m + 1)), shape=(2 * m, 3 * m))


def _pairs(blocks: np.ndarray) -> sparse.csr_matrix:
    """Block diagonal (2m, 2m) of blocks (m, 2, 2)."""
    m = len(blocks)
    return sparse.csr_matrix(sparse.bsr_matrix((blocks, np.arange(m), np.arange(m + 1)), shape=(2 * m, 2 * m)))


def _solved(M: np.ndarray, b: np.ndarray) -> np.ndarray:
    """M^-1 b; raises SingularMatrixError."""
    spend(DENSE_PIVOTS, dense_solution(len(b)))
    try:
        return np.asarray(np.linalg.solve(M, b))
    except np.linalg.LinAlgError as error:
        raise SingularMatrixError(f"the frictional problem on {len(b)} inputs is singular") from error
