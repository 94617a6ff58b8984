"""An oracle of steps with friction: Tresca problems by an interior-point solver that shares no line with ours.

For given bounds b (m,) of friction [N] a step is a convex programme, with the disc |t| <= b as a second-order cone::

    min 1/2 du.K.du + r.du + sum b_i |s0_i + S_i du|    subject to    g + G du >= 0

whose multipliers are the forces. The bounds are mu f of the pass before, damped where they do not contract. An
interior-point solver knows forces to 1e-6 and no closer, so each pass that is near to the one before is asked for its
states alone: open, stick or slip. The exact answer on them, where s = 0 on all that stick and t = -mu f s/|s| on all
that slip, is a fixed point to rounding. It then has to obey every condition. That it is the only one nobody says: at
large mu it need not be.
"""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.friction.frozen import FrozenFrictionalStep
from contact.friction.problem import State
from contact.interchange.oracle import AGREEMENT, EXACT, SETTLINGS, TOLERANCES, OracleError
from contact.interchange.oracle import refusal as refusal_of_contact
from contact.solvers.sparse import Factor, SingularMatrixError, checked_solve, factorise

PASSES = 100
NEAR = 1e-3  # change of bounds from pass to pass, of the largest, below which states are tried
CONTRACTS = 0.9  # a change that falls by less is damped
ITERATIONS = 40
LAST_DIGITS = 1e-13

Forces = tuple[np.ndarray, np.ndarray]  # normal (m,), friction (m, 2)


@dataclass(frozen=True, eq=False)
class OracleAnswer:
    """du (n,), normal (m,) [N], friction (m, 2) [N], states (m,), and the Tresca problems that it took."""

    du: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    state: np.ndarray
    passes: int


@dataclass(frozen=True, eq=False)
class Confirmation:
    """The oracle's answer, and how far another one is from it.

    displacement_error: |difference| over the larger of du and the free response [-].  force_error: largest difference
    of a force, normal or friction, over the largest of them [-].  differing: candidates of which one differs by more
    than the agreement.
    """

    own: OracleAnswer
    displacement_error: float
    force_error: float
    differing: np.ndarray

    @property
    def agrees(self) -> bool:
        """True when forces and displacement are those of the oracle. Where answers are several, both may be right."""
        return max(self.displacement_error, self.force_error) <= AGREEMENT


def refusal(step: FrozenFrictionalStep) -> str | None:
    """Why there is no sequence of convex programmes, or None."""
    if not np.all(np.isfinite(step.mu)):
        return "an infinite coefficient has no Tresca bound"
    return refusal_of_contact(step.step)


def minimise(step: FrozenFrictionalStep) -> OracleAnswer:
    """The oracle's answer; raises OracleError."""
    reason = refusal(step)
    if reason is not None:
        raise OracleError(reason)
    try:
        exact, solve = _Exact.of(step), tresca(step)
        bound, damping, before = np.zeros(len(step.mu)), 1.0, np.inf
        for passes in range(1, PASSES + 1):
            (normal, friction), state = solve(bound)
            wanted = np.where(state == State.OPEN, 0.0, step.mu * np.maximum(normal, 0.0))
            change = float(np.max(np.abs(wanted - bound), initial=0.0))
            if change <= NEAR * float(np.max(wanted, initial=0.0)):
                found = exact.settle(state, friction)
                if found is not None:
                    return OracleAnswer(*found, passes)
            damping = damping / 2 if change > CONTRACTS * before else damping
            bound, before = bound + damping * (wanted - bound), change
    except (SingularMatrixError, RuntimeError, np.linalg.LinAlgError) as error:
        raise OracleError(f"the oracle failed: {error}") from None
    raise OracleError(f"Tresca bounds came to no fixed point in {PASSES} passes")


def tresca(step: FrozenFrictionalStep) -> Callable[[np.ndarray], tuple[Forces, np.ndarray]]:
    """The programme as a function: bounds (m,) to forces and states (m,); it raises OracleError.

    In unknowns y with a unit diagonal of K, du = size unit y, size the displacement to be expected.
    """
    import cvxpy as cp

    base, m = step.step, len(step.mu)
    unit = 1 / np.sqrt(base.K.diagonal())
    free = checked_solve(factorise(base.K), base.K, -base.r)
    G, S = (sparse.csr_matrix(A @ sparse.diags_array(unit)) for A in (base.G, step.S))
    across = np.sqrt(np.asarray(G.multiply(G).sum(axis=1)).ravel())
    across[across == 0] = 1.0
    slips = np.sqrt(np.asarray(S.multiply(S).sum(axis=1)).ravel().reshape(m, 2).sum(axis=1))
    along = np.where(slips > 0, slips, 1.0)
    reach = [free / unit, -base.gap / across, np.linalg.norm(step.slip, axis=1) / along]
    size = max(float(np.max(np.abs(reach[0]), initial=0.0)), *(float(np.max(x, initial=0.0)) for x in reach[1:])) or 1.0

    y, tau, b = cp.Variable(len(unit)), cp.Variable(m), cp.Parameter(m, nonneg=True)
    K = sparse.diags_array(unit) @ base.K @ sparse.diags_array(unit)
    room = (sparse.diags_array(1 / across) @ G) @ y + base.gap / (across * size)
    twice = np.repeat(along, 2)
    slip = (sparse.diags_array(1 / twice) @ S) @ y + step.slip.ravel() / (twice * size)
    cost = cp.quad_form(y, cp.psd_wrap(sparse.csc_matrix((K + K.T) / 2))) / 2 + (unit * base.r / size) @ y + b @ tau
    cone = cp.SOC(tau, cp.reshape(slip, (2, m), order="F"))
    programme = cp.Problem(cp.Minimize(cost), [room >= 0, cone])

    def solve(bound: np.ndarray) -> tuple[Forces, np.ndarray]:
        b.value = bound * along / size
        for tolerance in TOLERANCES:
            tight = dict.fromkeys(("tol_gap_abs", "tol_gap_rel", "tol_feas", "tol_ktratio"), tolerance)
            with contextlib.suppress(cp.error.SolverError), warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # "may be inaccurate": such an answer is not taken
                programme.solve(solver=cp.CLARABEL, **tight)
                if programme.status == "optimal":
                    break
        else:
            raise OracleError(f"the oracle found no solution: {programme.status}")
        f = np.atleast_1d(programme.constraints[0].dual_value)
        t = np.asarray(cone.dual_value[1]).reshape(2, m, order="F").T
        s = np.linalg.norm(slip.value.reshape(m, 2), axis=1)
        left = b.value - np.linalg.norm(t, axis=1)
        state = np.where(f <= room.value, State.OPEN, np.where(s > left, State.SLIP, State.STICK))
        return (f * size / across, t * (size / along)[:, None]), state

    return solve


@dataclass(frozen=True, eq=False)
class _Exact:
    """Answers on given states, condensed on the forces that act, three a candidate: u_i = q_i + (W l)_i."""

    step: FrozenFrictionalStep
    factor: Factor
    free: np.ndarray

    @classmethod
    def of(cls, step: FrozenFrictionalStep) -> _Exact:
        K = step.step.K
        factor = factorise(K)
        return cls(step, factor, checked_solve(factor, K, -step.step.r))

    def settle(
        self, state: np.ndarray, friction: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
        """du, normal, friction and states where states and friction, nearly right, can be put right; None where not."""
        step, H = self.step, self.step.H
        rest = step.w + H.T @ self.free
        for _ in range(SETTLINGS):
            nodes = np.flatnonzero(state != State.OPEN)
            columns = (3 * nodes[:, None] + np.arange(3)).ravel()
            act = sparse.csc_matrix(H[:, columns])
            moved = [checked_solve(self.factor, step.step.K, column) for column in act.toarray().T]
            flexible = np.column_stack([np.zeros((len(self.free), 0)), *moved])
            W = act.T @ flexible
            forces = _on_states(
                (W + W.T) / 2, rest[columns], state[nodes] == State.SLIP, step.mu[nodes], friction[nodes]
            )
            if forces is None:
                return None
            du, every = self.free + flexible @ forces, np.zeros((len(state), 3))
            every[nodes] = forces.reshape(-1, 3)
            better = self._put_right(state, step.w + H.T @ du, every)
            if np.array_equal(better, state):
                return du, np.maximum(every[:, 0], 0.0), every[:, 1:], state
            state = better
        return None

    def _put_right(self, state: np.ndarray, u: np.ndarray, forces: np.ndarray) -> np.ndarray:
        """The states (m,) with each that breaks a condition changed to the one it breaks it for."""
        f, t = forces[:, 0], np.linalg.norm(forces[:, 1:], axis=1)
        small = EXACT * float(np.max(np.abs(forces), initial=0.0))
        near = EXACT * float(np.max(np.abs(self.step.w) + np.abs(u - self.step.w), initial=0.0))
        better = state.copy()
        better[(state == State.OPEN) & (u[::3] < -near)] = State.STICK
        better[(state == State.STICK) & (t - self.step.mu * f > small)] = State.SLIP
        better[(state != State.OPEN) & (f < -small)] = State.OPEN
        return better


def _on_states(
    W: np.ndarray, q: np.ndarray, slips: np.ndarray, mu: np.ndarray, friction: np.ndarray
) -> np.ndarray | None:
    """Forces (3k,) of candidates that all touch: no gap, no slip of those that stick, t = -mu f s/|s| of the others.

    Newton's method, from the directions of ``friction`` (k, 2); None where it does not come to rest.
    """
    k = len(mu)
    if not k:
        return np.zeros(0)
    forces, before = np.zeros(3 * k), np.inf
    direction = -friction / np.maximum(np.linalg.norm(friction, axis=1), np.finfo(float).tiny)[:, None]
    turning = np.zeros((k, 2, 2))  # ds/|s| of a direction: none in the first iteration
    for _ in range(ITERATIONS):
        A, b = W.copy(), -q.copy()
        for i in np.flatnonzero(slips):
            rows = slice(3 * i + 1, 3 * i + 3)
            bend = mu[i] * forces[3 * i] * turning[i]
            A[rows] = bend @ W[rows]
            A[rows, rows] += np.eye(2)
            A[rows, 3 * i] += mu[i] * direction[i]
            b[rows] = bend @ (W[rows] @ forces)
        new = np.linalg.solve(A, b)
        change, size = float(np.max(np.abs(new - forces))), float(np.max(np.abs(new)))
        forces = new
        if not np.isfinite(size):
            return None
        if change <= LAST_DIGITS * size or before / 2 <= change <= EXACT * size:  # or no digit more is to be had
            return forces
        before = change
        for k, s in _slips(W, q, forces, slips):
            length = float(np.linalg.norm(s))
            if length == 0:
                return None
            direction[k] = s / length
            turning[k] = (np.eye(2) - np.outer(direction[k], direction[k])) / length
    return None


def _slips(W: np.ndarray, q: np.ndarray, forces: np.ndarray, slips: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Number and slip (2,) of each candidate that slips."""
    u = (q + W @ forces).reshape(-1, 3)
    for i in np.flatnonzero(slips):
        yield int(i), u[i, 1:]


def confirm(step: FrozenFrictionalStep, du: np.ndarray, normal: np.ndarray, friction: np.ndarray) -> Confirmation:
    """Compare an answer of the step with the oracle's; raises OracleError where that has none."""
    own = minimise(step)
    free = checked_solve(factorise(step.step.K), step.step.K, -step.step.r)
    size = float(max(np.linalg.norm(free), np.linalg.norm(own.du))) or 1.0
    theirs, ours = np.column_stack([normal, friction]), np.column_stack([own.normal, own.friction])
    largest = float(max(np.max(np.abs(theirs), initial=0.0), np.max(np.abs(ours), initial=0.0))) or 1.0
    error = np.linalg.norm(theirs - ours, axis=1) / largest
    return Confirmation(
        own,
        float(np.linalg.norm(du - own.du)) / size,
        float(np.max(error, initial=0.0)),
        np.flatnonzero(error > AGREEMENT),
    )
