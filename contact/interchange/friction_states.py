"""The exact answer of a frozen frictional step on given states, for the oracle; no state is guessed here.

On states that are right the conditions are equations in du, f and t::

    K du + r = G^T f + S^T t;   touching: g = 0;   stick: s = 0;   slip: t = -mu f s/|s|;   open: f = 0, t = 0

solved by Newton's method from an answer that is nearly right. They are kept together rather than condensed on the
forces, so that K may leave motions free that the contacts hold. Where contacts are redundant the forces are several:
the increment of least size is taken, which stays near to those that were given.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import lstsq

from contact.coulomb import State, radii
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import EXACT, SETTLINGS, solved

ITERATIONS = 40
LAST_DIGITS = 1e-13
ASTRAY = 10.0  # times what is known already: an increment as large as that is of a singular matrix
NO_SLIP = 1e-11  # of a displacement of one: too short to have a direction
DENSE = 1500  # equations up to which an increment of least size is looked for
DEPENDENT = 1e-11  # relative singular value that is none


@dataclass(frozen=True, eq=False)
class Known:
    """du (n,), normal forces (m,), friction (m, 2) [N] and states (m,), as they are known; passes: that it took."""

    du: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    state: np.ndarray
    passes: int = 0


def settle(step: FrozenFrictionalStep, near: Known) -> Known | None:
    """The exact answer where ``near`` can be put right, None where not.

    step: scaled, so that displacements and forces are of the order one.
    """
    seen = set[bytes]()
    for _ in range(SETTLINGS):
        solved = on_states(step, near)
        if solved is None:
            return None
        better = _put_right(step, solved)
        if np.array_equal(better, solved.state):
            pressed = solved.normal > 0  # what rounding has pulled carries no friction, either
            friction = np.where(pressed[:, None], solved.friction, 0.0)
            return Known(solved.du, np.where(pressed, solved.normal, 0.0), friction, better)
        if better.tobytes() in seen:
            return None
        seen.add(better.tobytes())
        near = Known(solved.du, solved.normal, solved.friction, better)
    return None


def on_states(step: FrozenFrictionalStep, near: Known) -> Known | None:
    """The answer on the states of ``near`` whatever its signs; None where Newton's method does not come to rest."""
    equations = _Equations(step, near.state)
    x, before = equations.start(near), np.inf
    for k in range(ITERATIONS):
        directions = equations.directions(x, first=k == 0)
        if directions is None:
            return None
        residual, jacobian = equations.at(x, *directions)
        change = _increment(jacobian, residual, float(np.max(np.abs(x), initial=0.0)))
        if change is None:
            return None
        x, moved, size = x + change, float(np.max(np.abs(change), initial=0.0)), float(np.max(np.abs(x), initial=0.0))
        # or no digit more is to be had
        if k and (moved <= LAST_DIGITS * size or before / 2 <= moved <= EXACT * size):
            return equations.known(x) if equations.solved(x) else None
        before = moved
    return None


class _Equations:
    """The equations in x = (du, f, t), the forces those of the candidates that touch."""

    def __init__(self, step: FrozenFrictionalStep, state: np.ndarray) -> None:
        self._step, self._state = step, state
        self._nodes = np.flatnonzero(state != State.OPEN)
        self._sticks = state[self._nodes] == State.STICK
        self._mu = np.where(self._sticks, 0.0, step.mu[self._nodes])
        pairs = (2 * self._nodes[:, None] + np.arange(2)).ravel()
        self._G, self._S = step.G[self._nodes], sparse.csr_matrix(step.S[pairs])
        # a slip that no unknown changes gives no equation for its friction, which is zero
        self._still = np.asarray(abs(self._S).sum(axis=1)).ravel() == 0

    def start(self, near: Known) -> np.ndarray:
        """x of what is known."""
        return np.concatenate([near.du, near.normal[self._nodes], near.friction[self._nodes].ravel()])

    def known(self, x: np.ndarray) -> Known:
        """The other way about."""
        du, f, t = self._split(x)
        normal, friction = np.zeros(len(self._state)), np.zeros((len(self._state), 2))
        normal[self._nodes], friction[self._nodes] = f, t.reshape(-1, 2)
        return Known(du, normal, friction, self._state)

    def directions(self, x: np.ndarray, *, first: bool = False) -> tuple[np.ndarray, np.ndarray] | None:
        """d = s/|s| (k, 2) and its derivative by s (k, 2, 2), 0 where no candidate slips; None where d is unknown.

        Where a slip is none, and in the ``first`` iteration, d is against the friction and its derivative is left out.
        """
        rubs = ~self._sticks & (self._mu > 0)
        slip, friction = self._slip(x), self._split(x)[2].reshape(-1, 2)
        moves = (np.linalg.norm(slip, axis=1) > NO_SLIP) & (not first)
        way = np.where(moves[:, None], slip, -friction)
        length = np.linalg.norm(way, axis=1)
        if np.any(length[rubs] == 0):
            return None
        d = np.divide(way, length[:, None], out=np.zeros_like(way), where=rubs[:, None])
        across, turns = np.eye(2) - d[:, :, None] * d[:, None, :], (rubs & moves)[:, None, None]
        return d, np.divide(across, length[:, None, None], out=np.zeros_like(across), where=turns)

    def at(self, x: np.ndarray, d: np.ndarray, bends: np.ndarray) -> tuple[np.ndarray, sparse.csc_matrix]:
        """Left sides and their derivatives by x."""
        step, k = self._step, len(self._nodes)
        du, f, t = self._split(x)
        pinned = np.where(np.repeat(self._sticks, 2), self._still, True)  # rows that are equations of t
        held = sparse.diags_array((~pinned).astype(float))
        pull = (self._mu[:, None] * d).ravel()
        turned = sparse.block_diag(list((self._mu * f)[:, None, None] * bends), format="csr") if k else None
        along = held @ self._S if turned is None else held @ self._S + turned @ self._S
        slip = np.where(pinned, t + np.repeat(f, 2) * pull, self._slip(x).ravel())
        residual = np.concatenate(
            [step.K @ du + step.r - self._G.T @ f - self._S.T @ t, self._G @ du + step.gap[self._nodes], slip]
        )
        ratio = sparse.csr_matrix((pull, (np.arange(2 * k), np.repeat(np.arange(k), 2))), shape=(2 * k, k))
        rows = (
            sparse.hstack([step.K, -self._G.T, -self._S.T]),
            sparse.hstack([self._G, sparse.csr_matrix((k, 3 * k))]),
            sparse.hstack([along, ratio, sparse.diags_array(pinned.astype(float))]),
        )
        return residual, sparse.csc_matrix(sparse.vstack(rows))

    def solved(self, x: np.ndarray) -> bool:
        """Whether the equations hold but for rounding, an increment of least size may leave some of them."""
        directions = self.directions(x)
        if directions is None:
            return False
        step, (du, f, t) = self._step, self._split(x)
        size = max(float(np.max(np.abs(part), initial=0.0)) for part in (step.r, step.K @ du, step.gap, f, t, du))
        return float(np.max(np.abs(self.at(x, *directions)[0]), initial=0.0)) <= EXACT * size

    def _slip(self, x: np.ndarray) -> np.ndarray:
        return self._step.slip[self._nodes] + (self._S @ self._split(x)[0]).reshape(-1, 2)

    def _split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        n, k = len(self._step.r), len(self._nodes)
        return x[:n], x[n : n + k], x[n + k :]


def _increment(jacobian: sparse.csc_matrix, residual: np.ndarray, known: float) -> np.ndarray | None:
    """-jacobian^-1 residual, that of least size where it is singular; None where it is too large for that."""
    try:
        change = solved(jacobian, -residual)
        if float(np.max(np.abs(change), initial=0.0)) <= ASTRAY * known:
            return change
    except RuntimeError:
        pass
    if len(residual) > DENSE:
        return None
    return np.asarray(lstsq(jacobian.toarray(), -residual, cond=DEPENDENT)[0])


def _put_right(step: FrozenFrictionalStep, solved: Known) -> np.ndarray:
    """The states (m,) with each that breaks a condition changed to the one it breaks it for."""
    f, t, state = solved.normal, np.linalg.norm(solved.friction, axis=1), solved.state
    small = EXACT * float(max(np.max(np.abs(f), initial=0.0), np.max(t, initial=0.0)))
    moved = step.G @ solved.du
    near = EXACT * float(np.max(np.abs(step.gap) + np.abs(moved), initial=1.0))
    bound = radii(step.mu, f)
    slip = step.slip + (step.S @ solved.du).reshape(-1, 2)
    slips = np.linalg.norm(slip, axis=1)
    far = EXACT * float(np.max(np.abs(step.slip) + np.abs(slip), initial=1.0))
    better = state.copy()
    better[(state == State.STICK) & (slips > far)] = State.SLIP  # nothing of it follows the foundation
    better[(state == State.OPEN) & (step.gap + moved < -near)] = State.STICK
    better[(state == State.STICK) & (t - bound > small)] = State.SLIP
    better[(state != State.OPEN) & (f < -small)] = State.OPEN
    return better
