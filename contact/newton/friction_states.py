"""What the states of candidates ask of their forces, linearised, and which states there are next.

Alart and Curnier's function of a candidate with trial friction y = t - c s asks that t be y pulled back to the disc
of radius mu f. On its branches, with d = -y/|y| and e across it::

    open   f = 0, t = 0
    stick  g = 0, s = 0
    slip   g = 0, t = -mu f d - kappa e (e.s),    kappa = mu f c/(|y| - mu f)

At a solution t = -mu f s/|s|, so that d = s/|s| and kappa = mu f/|s|: the exact tangent. Before, kappa is never
negative and bounded, and one that has not slipped yet slips against its own friction: no division by a slip of none.
Source: Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375.
In a tangent: :mod:`contact.newton.friction_held`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.coulomb import State, radii

STIFFEST = 1e6  # kappa over c


@dataclass(frozen=True, eq=False)
class Laws:
    """State (m,) of each candidate, direction d (m, 2) of its slip and kappa (m,) [N/mm] across it; 0 but in slip."""

    state: np.ndarray
    direction: np.ndarray
    across: np.ndarray

    @classmethod
    def none(cls, m: int) -> Laws:
        """Every candidate open."""
        return cls(np.full(m, State.OPEN, np.int8), np.zeros((m, 2)), np.zeros(m))

    @property
    def closed(self) -> np.ndarray:
        """(m,) bool."""
        return np.asarray(self.state != State.OPEN)

    @property
    def spring(self) -> np.ndarray:
        """kappa e e^T (m, 2, 2)."""
        e = np.stack([-self.direction[:, 1], self.direction[:, 0]], axis=1)
        return np.asarray(self.across[:, None, None] * e[:, :, None] * e[:, None, :])

    @property
    def key(self) -> bytes:
        """The states, and the quadrants of their directions: what tells a cycle."""
        return bytes(self.state.tobytes() + np.sign(self.direction).astype(np.int8).tobytes())

    def changed(self, after: Laws, chosen: np.ndarray) -> Laws:
        """Those ``after`` for the ``chosen`` candidates alone."""
        laws = Laws(self.state.copy(), self.direction.copy(), self.across.copy())
        for mine, other in zip(vars(laws).values(), vars(after).values(), strict=True):
            mine[chosen] = other[chosen]
        return laws

    def same(self, other: Laws) -> bool:
        """Whether the states are the same."""
        return np.array_equal(self.state, other.state)


@dataclass(frozen=True, eq=False)
class Local:
    """What is known of the candidates: gap, normal (m,), slip, friction (m, 2).

    c [N/mm] (m,): weighs friction against slip, and pressure against gap where a candidate closes.
    """

    gap: np.ndarray
    slip: np.ndarray
    normal: np.ndarray
    friction: np.ndarray
    c: np.ndarray

    @property
    def trial(self) -> np.ndarray:
        """y (m, 2) [N]."""
        return np.asarray(self.friction - self.c[:, None] * self.slip)


@dataclass(frozen=True)
class Margins:
    """What rounding explains, and no state is left for: of forces [N], gaps and slips [mm]."""

    force: float
    gap: float
    slip: float


def expected(local: Local, laws: Laws, mu: np.ndarray, margins: Margins, held: np.ndarray) -> Laws:
    """The laws that Alart and Curnier's function is on at ``local``, found under ``laws``.

    Who sticks slips once |t| > mu f, who slips sticks once its slip opposes d, or where there is no d yet |y| < mu f;
    who is open closes where it penetrates, and sticks there if |s| <= mu |g|.  held (m,) bool: candidates which cannot
    stick, as nothing of theirs can follow.
    """
    was, sprung = laws.state, np.maximum(-local.gap, 0.0) * local.c
    closing = (was == State.OPEN) & (local.gap < -margins.gap)
    leaving = laws.closed & (local.normal < -margins.force)
    normal = np.where(closing, sprung, np.maximum(local.normal, 0.0))
    bound = radii(mu, normal)
    y, along = local.trial, np.einsum("mk,mk->m", local.slip, laws.direction)
    size = np.linalg.norm(y, axis=1)
    begins = ~laws.direction.any(axis=1)  # a slip of an earlier step: on the disc it may go on, inside it has turned
    on = np.where(begins, size >= bound - margins.force, along >= -margins.slip)
    slips = np.where(was == State.SLIP, on, size > bound + margins.force)
    slips = np.where(closing, size > bound, slips)
    slips = (slips | (mu == 0) | held) & ~np.isinf(mu)
    state = np.where((laws.closed & ~leaving) | closing, np.where(slips, State.SLIP, State.STICK), State.OPEN)
    return directed(local, state.astype(np.int8), bound)


def directed(local: Local, state: np.ndarray, bound: np.ndarray) -> Laws:
    """The laws of these states (m,) with the directions that ``local`` tells; bound (m,) [N]: mu f."""
    y = local.trial
    size, slips = np.linalg.norm(y, axis=1), state == State.SLIP
    d = np.divide(-y, size[:, None], out=np.zeros_like(y), where=(slips & (size > 0))[:, None])
    stiffest = STIFFEST * local.c
    beyond, pull = size - bound, np.where(slips, bound, 0.0) * local.c
    kappa = np.divide(pull, beyond, out=stiffest.copy(), where=pull < stiffest * beyond)
    return Laws(state, d, np.where(slips & (bound > 0) & (size > 0), kappa, 0.0))


def friction_of(local: Local, laws: Laws, mu: np.ndarray, rounding: float) -> np.ndarray:
    """t (m, 2) of the law itself: -mu f s/|s| where a candidate slips.

    Along y where s is rounding alone, or differs from its direction by rounding; never where s goes the other way:
    friction of an earlier step, balanced before the slip turned, must not pass for that of this one.
    """
    y, s = local.trial, local.slip
    slips = laws.state == State.SLIP  # the others have no bound that is needed, and an infinite one perhaps
    bound = radii(np.where(slips, mu, 0.0), local.normal)[:, None]
    unit = -_unit(y)
    ahead = np.maximum(np.einsum("mk,mk->m", s, unit), 0.0)
    off = np.linalg.norm(s - ahead[:, None] * unit, axis=1) > rounding
    slipped = -bound * np.where(off[:, None], _unit(s), unit)
    chosen = laws.state[:, None]
    return np.where(chosen == State.SLIP, slipped, np.where(chosen == State.STICK, local.friction, 0.0))


def _unit(v: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(v, axis=1)[:, None]
    return np.divide(v, size, out=np.zeros_like(v), where=size > 0)
