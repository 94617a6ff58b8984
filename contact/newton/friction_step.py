"""The linearised step of a problem with friction under given states: one factorisation, others by its columns.

With J = (G, S), F = (f, t) and v = (g, s), all of each candidate together::

    K du - J^T F = -r,    v = v_now + J du,    A F + B v = 0

A and B are those of the laws. Factorised is the system of one choice of states (:mod:`contact.newton.exchange`); a
candidate of another state has inputs z and outputs w in it, w = q + M z, of which its own law makes a small dense
system:

    open   z = F, w = v        stick  z = v, w = F        slip   z = (g, t more than its law), w = (f, s)

Between two states that touch, g stays closed and only friction and slip are inputs. No choice of states enters here.

On springs gaps and slips give way under their forces. With k = w epsilon [N/mm] the laws hold for g + f/k and s + t/k
instead of g and s. Under given states, with e across the direction d of a slip, forces are F = -C (v + J du),
v = (g, s)::

    stick   C = k
    slip    C_n = k,    C_tn = -mu k d,    C_tt = kappa/(1 + kappa/k) e e^T

which is not symmetric. Only the displacements are unknowns, K + J^T C J is what is factorised, and no candidate needs
unknowns of its own. Where a spring is stiffer than they are, its force is not k times a rounded way: it is what is left
of the forces on them.
Source: Simo, Laursen, Comput. Struct. 42 (1992) 97-116.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.newton.exchange import Exchange
from contact.newton.friction_held import DEPENDENT, Directions, held_states
from contact.newton.friction_states import Laws
from contact.newton.held import Ports
from contact.newton.solves import LinearSolves
from contact.operations import DENSE_PIVOTS, dense_solution, spend
from contact.solvers.sparse import SingularMatrixError, added, factor_flops


@dataclass(frozen=True, eq=False)
class Stepped:
    """After the step: du (n,), gap and normal force (m,), slip and friction (m, 2)."""

    du: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    normal: np.ndarray
    friction: np.ndarray


@dataclass(frozen=True, eq=False)
class Linear:
    """A linearisation, the same for all states: K (n, n), less what the curvature of gaps takes off, and r (n,).

    residual: without forces of the foundation.  now (3m,): gap and slips of the candidates, one after another.
    """

    tangent: sparse.csc_matrix
    residual: np.ndarray
    ways: Directions
    now: np.ndarray
    mu: np.ndarray


class FrictionalStep(Exchange):
    """The linearisation factorised for the laws ``base``; raises SingularMatrixError, NotHeldError."""

    def __init__(self, run: LinearSolves, linear: Linear, base: Laws) -> None:
        self.base, self._linear, J, m = base, linear, linear.ways.rows, len(linear.mu)
        with run.tally.timed("contact_s"):
            tangential = _tangential(m)
            self._spring = sparse.csc_matrix(tangential.T @ _pairs(base.spring) @ tangential)
            K = added(linear.tangent, sparse.csc_matrix(J.T @ self._spring @ J))
            held, to_slack, multiplied = held_states(linear.ways, base, linear.mu, K)
        self._inputs_are_forces = _inputs_are_forces(base)
        forced = self._inputs_are_forces.ravel()
        ports = Ports(J, J, forced, to_slack, multiplied)
        super().__init__(run, held, ports, linear.now, np.zeros(3 * m), self._without_springs(linear))

    def _without_springs(self, linear: Linear) -> np.ndarray:
        return np.asarray(linear.residual + linear.ways.rows.T @ (self._spring @ linear.now))

    def under(self, residual: np.ndarray, now: np.ndarray) -> FrictionalStep:
        """The same factors for another residual (n,) and other ways (3m,) before the step."""
        other = copy(self)
        other._linear = replace(self._linear, residual=residual, now=now)
        other._load(now, self._without_springs(other._linear))
        return other

    def near(self, laws: Laws) -> FrictionalStep:
        """The same linearisation, factorised for the laws where that costs less than the columns they ask for here."""
        cost = self.cost(self._changes(laws)[1])
        return FrictionalStep(self._run, self._linear, laws) if cost and cost > factor_flops(self._factor) else self

    def step(self, laws: Laws) -> Stepped:
        """The step under the laws; raises SingularMatrixError."""
        changed, places, z = self._exchanged(laws)
        of_z, of_w = self._law(laws, changed)

        def missing(z: np.ndarray, w: np.ndarray) -> np.ndarray:
            left = [np.einsum("cij,cj->ci", of, each.reshape(-1, 3)[changed]) for of, each in ((of_z, z), (of_w, w))]
            return self._inputs(of_z, of_w, changed, places, -sum(left))

        du, w = self.solved(z, places, missing)
        return self._reached(du, w, z, laws)

    def foreseen(self, laws: Laws) -> Stepped:
        """The step by columns alone, for the choice of states: du is not worked out."""
        _, places, z = self._exchanged(laws)
        return self._reached(np.zeros(0), self.outputs(z, places), z, laws)

    def _exchanged(self, laws: Laws) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Candidates (c,) under other laws than in the base, their inputs (p,), and z (3m,) that obeys the laws."""
        (changed, places), z = self._changes(laws), np.zeros(len(self._now))
        if len(places):
            of_z, of_w = self._law(laws, changed)
            q = np.einsum("cij,cj->ci", of_w, self.q.reshape(-1, 3)[changed])
            z[places] = self._inputs(of_z, of_w, changed, places, -q)
        return changed, places, z

    def _changes(self, laws: Laws) -> tuple[np.ndarray, np.ndarray]:
        """Candidates under other laws, and their inputs: none along a gap that stays closed, or where nothing moves."""
        turned = np.any(laws.direction != self.base.direction, axis=1) | (laws.across != self.base.across)
        changed = np.flatnonzero((laws.state != self.base.state) | turned)
        used = self._linear.ways.own[changed]
        used[:, 0] &= ~(laws.closed & self.base.closed)[changed]
        return changed, (3 * changed[:, None] + np.arange(3))[used]

    def _law(self, laws: Laws, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the laws ask of z and of w, (c, 3, 3) each, by way of what they are in the base."""
        mu = self._linear.mu
        A, B = _asked(laws, mu, chosen)
        of_slip, _ = _asked(self.base, mu, chosen)  # t + mu f d + kappa e e.s = z, where the base slips
        forced = self._inputs_are_forces[chosen].astype(float)
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
        M = self.columns(places)[rows].reshape(len(changed), 3, -1)
        matrix = np.einsum("cij,cjp->cip", of_w, M).reshape(len(rows), -1)
        each = kept // 3
        matrix[3 * each[:, None] + np.arange(3), np.arange(len(kept))[:, None]] += of_z[each, :, kept % 3]
        return _solved(matrix[kept], b.ravel()[kept])

    def _reached(self, du: np.ndarray, w: np.ndarray, z: np.ndarray, laws: Laws) -> Stepped:
        """Forces and ways of all candidates; those of the laws themselves to the last digit."""
        forced = self._inputs_are_forces
        w, z = w.reshape(-1, 3), z.reshape(-1, 3)
        force, way = np.where(forced, z, w), np.where(forced, w, z)
        way = np.where(self._linear.ways.own, way, self._now.reshape(-1, 3))
        gap, slip, normal = way[:, 0], way[:, 1:], force[:, 0]
        # where the base slips, z is what friction is more than its law
        extra = z[:, 1:] - self._follow(self.base, normal, slip)
        friction = np.where((self.base.state == State.SLIP)[:, None], extra, force[:, 1:])
        slips, opens = laws.state == State.SLIP, ~laws.closed
        lawful = -self._follow(laws, normal, slip)
        friction = np.where(slips[:, None], lawful, np.where(opens[:, None], 0.0, friction))
        return Stepped(du, gap, slip, np.where(opens, 0.0, normal), friction)

    def _follow(self, laws: Laws, normal: np.ndarray, slip: np.ndarray) -> np.ndarray:
        """mu f d + kappa e (e.s) (m, 2) of those that slip."""
        slips = laws.state == State.SLIP
        pushed = np.where(slips, self._linear.mu, 0.0) * np.where(slips, normal, 0.0)
        return np.asarray(pushed[:, None] * laws.direction + np.einsum("mij,mj->mi", laws.spring, slip))


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


class SprungStep:
    """The linearisation on springs of k (m,) [N/mm], factorised for every choice of states."""

    def __init__(self, run: LinearSolves, linear: Linear, k: np.ndarray) -> None:
        self._run, self._linear, self._k = run, linear, k
        self._last: tuple[Laws, Stepped] | None = None

    def under(self, residual: np.ndarray, now: np.ndarray) -> SprungStep:
        """The same for another residual (n,) and other ways (3m,) before the step."""
        return SprungStep(self._run, replace(self._linear, residual=residual, now=now), self._k)

    def near(self, laws: Laws) -> SprungStep:
        """The same for all."""
        return self

    def step(self, laws: Laws) -> Stepped:
        """The step under the laws, gaps and slips without what springs give way; raises SingularMatrixError."""
        if self._last is None or self._last[0] is not laws:
            self._last = laws, self._solved(laws)
        return self._last[1]

    def foreseen(self, laws: Laws) -> Stepped:
        """The same: every choice of states is a factorisation."""
        return self.step(laws)

    def _solved(self, laws: Laws) -> Stepped:
        run, linear, J, m = self._run, self._linear, self._linear.ways.rows, len(self._k)
        with run.tally.timed("contact_s"):
            C = _stiffness(laws, linear.mu, self._k)
            blocks = sparse.csr_matrix(sparse.bsr_matrix((C, np.arange(m), np.arange(m + 1)), shape=(3 * m, 3 * m)))
            matrix = added(linear.tangent, sparse.csc_matrix(J.T @ blocks @ J))
            left = -linear.residual - J.T @ (blocks @ linear.now)
        du = run.solution(run.factorise(matrix), matrix, left)
        with run.tally.timed("contact_s"):
            way = (linear.now + J @ du).reshape(m, 3)
            F = -np.einsum("mij,mj->mi", C, way)
            self._react(F, du, laws.closed)
        normal, friction = np.where(laws.closed, F[:, 0], 0.0), np.where(laws.closed[:, None], F[:, 1:], 0.0)
        give = np.divide(1.0, self._k, out=np.zeros(m), where=self._k > 0)
        gap, slip = way[:, 0] + give * normal, way[:, 1:] + give[:, None] * friction
        return Stepped(du, gap, slip, normal, friction)

    def _react(self, F: np.ndarray, du: np.ndarray, closed: np.ndarray) -> None:
        """Put the forces on unknowns of a candidate's own in place of those of stiff springs."""
        K, ways = self._linear.tangent, self._linear.ways
        used = np.bincount(ways.rows.indices, minlength=K.shape[0])
        left, own = K @ du + self._linear.residual, np.abs(K.diagonal())
        for i in np.flatnonzero(closed).tolist():
            unknowns, J = ways.block(i)
            acts = J.any(axis=1)
            alone = np.array_equal(used[unknowns], np.sum(J != 0, axis=0))
            if not alone or self._k[i] * np.sum(J * J) <= np.max(own[unknowns], initial=0.0):
                continue
            size = np.linalg.svd(J[acts], compute_uv=False)
            if len(size) == np.sum(acts) and size[-1] > DEPENDENT * size[0]:
                F[i, acts] = np.linalg.lstsq(J[acts].T, left[unknowns], rcond=None)[0]


def _stiffness(laws: Laws, mu: np.ndarray, k: np.ndarray) -> np.ndarray:
    """C (m, 3, 3)."""
    C = np.where(laws.closed, k, 0.0)[:, None, None] * np.eye(3)
    slips = laws.state == State.SLIP
    kappa, stiff = laws.across, k > 0
    soft = np.divide(
        kappa, 1 + np.divide(kappa, k, out=np.zeros_like(k), where=stiff), out=np.zeros_like(k), where=stiff
    )
    e = np.stack([-laws.direction[:, 1], laws.direction[:, 0]], axis=1)
    C[slips, 1:, 0] = -(np.where(slips, mu, 0.0) * k)[slips, None] * laws.direction[slips]
    C[slips, 1:, 1:] = (soft[:, None, None] * e[:, :, None] * e[:, None, :])[slips]
    return C
