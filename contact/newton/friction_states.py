"""What the states of candidates ask of their forces, linearised, and their place in a tangent.

Alart and Curnier's function of a candidate with trial friction y = t - c s asks that t be y pulled back to the disc
of radius mu f. On its branches, with d = -y/|y| and e across it::

    open   f = 0, t = 0
    stick  g = 0, s = 0
    slip   g = 0, t = -mu f d - kappa e (e.s),    kappa = mu f c/(|y| - mu f)

At a solution t = -mu f s/|s|, so that d = s/|s| and kappa = mu f/|s|: the exact tangent. Before, kappa is never
negative and bounded, and one that has not slipped yet slips against its own friction: no division by a slip of none.
Source: Alart, Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353-375.

In a tangent states are motions that obey them, each in the places of the candidate's own unknowns. Who sticks holds as
many unknowns as it has directions, who slips one: T of :class:`contact.newton.held.Held` is made of the rows by which
it is held, and the T on the left of those by which forces act: a slipping candidate is held along its gap, and pushed
along G - mu d.S. The springs across a slip are added to K. A system is as large as K, has its places, and no zero on
the diagonal; it is symmetric unless a candidate slips.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import qr

from contact.coulomb import State, radii
from contact.newton.held import Grip, Held, largest, matched

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
        found = Laws(self.state.copy(), self.direction.copy(), self.across.copy())
        for mine, other in zip(vars(found).values(), vars(after).values(), strict=True):
            mine[chosen] = other[chosen]
        return found

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


Block = tuple[np.ndarray, np.ndarray]  # rows (r, k), and the columns (k,) that they are on
DEPENDENT = 1e-9  # of the largest pivot: below, a direction of a candidate is none of its own


class NotHeldError(ValueError):
    """Candidates that unknowns of their own cannot hold in the states asked for; the message says why."""


@dataclass(frozen=True, eq=False)
class Directions:
    """The ways of all candidates: rows J (3m, n) of gap, first and second slip of each, one after another."""

    rows: sparse.csr_matrix

    @classmethod
    def of(cls, gaps: sparse.csr_matrix, slips: sparse.csr_matrix) -> Directions:
        """G (m, n) and S (2m, n) in one."""
        m = gaps.shape[0]
        order = np.column_stack([np.arange(m), m + 2 * np.arange(m), m + 2 * np.arange(m) + 1]).ravel()
        rows = sparse.csr_matrix(sparse.vstack([gaps, slips], format="csr")[order])
        rows.eliminate_zeros()
        return cls(rows)

    @property
    def own(self) -> np.ndarray:
        """(m, 3) bool: along which ways there is an unknown."""
        return np.asarray(np.diff(self.rows.indptr).reshape(-1, 3) > 0)

    def block(self, i: int) -> tuple[np.ndarray, np.ndarray]:
        """The unknowns (k,) of a candidate and its rows (3, k) on them."""
        starts = self.rows.indptr[3 * i : 3 * i + 4]
        inside = slice(starts[0], starts[-1])
        unknowns, place = np.unique(self.rows.indices[inside], return_inverse=True)
        J = np.zeros((3, len(unknowns)))
        J[np.repeat(np.arange(3), np.diff(starts)), place] = self.rows.data[inside]
        return unknowns, J


def held_states(
    ways: Directions, laws: Laws, mu: np.ndarray, K: sparse.csc_matrix
) -> tuple[Held, sparse.csr_matrix, sparse.csr_matrix]:
    """K du - J^T F = -r under the laws, with v = (g, s) after the step where a candidate is not free along it.

    The rows of unit slope that hold, and those that push; to_slack (a, 3m): values of the held rows of unit v;
    multiplied (3m, a): forces F of unit multipliers; friction that follows a normal force is not among them.
    Candidates between two faces share unknowns: each is held by those that are its own, or all of them by all.
    K (n, n) has the springs across slips already. Raises NotHeldError.
    """
    touching = np.flatnonzero(laws.closed).tolist()
    blocks = {i: ways.block(i) for i in touching}
    used = np.bincount(np.concatenate([np.zeros(0, int), *(unknowns for unknowns, _ in blocks.values())]))
    try:
        rows, acting, pivot, slack, force = _singly(ways, laws, mu, blocks, used > 1)
    except NotHeldError:
        if np.max(used, initial=0) <= 1:
            raise
        rows, acting, pivot, slack, force = _jointly(ways, laws, mu, touching)
    size = largest(sparse.csc_matrix(K[:, pivot]))
    size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
    ones, zeros = np.ones(len(pivot)), np.zeros(len(pivot))
    held = Held(K, rows, acting, Grip(pivot, ones), zeros, zeros, size)
    return held, slack, force


HeldRows = tuple[sparse.csr_matrix, sparse.csr_matrix, np.ndarray, sparse.csr_matrix, sparse.csr_matrix]


def _singly(ways: Directions, laws: Laws, mu: np.ndarray, blocks: Mapping[int, Block], shared: np.ndarray) -> HeldRows:
    """Rows that hold and push, their unknowns, to_slack and multiplied, each candidate by unknowns of its own."""
    (d, n), own = ways.rows.shape, ways.own
    holds, pushes, slacks, forces = (list[tuple[np.ndarray, np.ndarray]]() for _ in range(4))
    pivots = [np.zeros(0, int)]
    for i, (unknowns, J) in blocks.items():
        three, alone = np.arange(3 * i, 3 * i + 3), np.flatnonzero(~shared[unknowns])
        if laws.state[i] == State.STICK:
            chosen = np.flatnonzero(own[i])
            place = alone[_independent(J[np.ix_(chosen, alone)], i)]
            inverse = np.linalg.inv(J[np.ix_(chosen, place)])
            rows = acting = inverse @ J[chosen]
            back, force = inverse, inverse.T
        else:
            chosen, pushed = np.zeros(1, int), J[0] - mu[i] * (laws.direction[i] @ J[1:])
            place = alone[[np.argmax((J[0] * pushed)[alone])]] if own[i, 0] and len(alone) else np.zeros(0, int)
            if not len(place) or J[0, place[0]] == 0:
                raise NotHeldError(f"contact candidate {i} has no unknown: its supports hold it")
            k = place[0]
            rows, acting = J[:1] / J[0, k], (pushed / pushed[k])[None]
            back, force = np.array([[1 / J[0, k]]]), np.array([[1 / pushed[k]]])
        holds.append((rows, unknowns))
        pushes.append((acting, unknowns))
        slacks.append((back, three[chosen]))
        forces.append((force.T, three[chosen]))
        pivots.append(unknowns[place])
    multiplied = sparse.csr_matrix(_stacked(forces, d).T)
    return (
        _stacked(holds, n),
        _stacked(pushes, n),
        np.concatenate(pivots).astype(np.intp),
        _stacked(slacks, d),
        multiplied,
    )


def _jointly(ways: Directions, laws: Laws, mu: np.ndarray, touching: list[int]) -> HeldRows:
    """The same by unknowns that several may share, and the inverse of all that they hold."""
    J, own = ways.rows, ways.own
    chosen = [3 * i + np.flatnonzero(own[i] if laws.state[i] == State.STICK else [True]) for i in touching]
    held = np.concatenate(chosen)
    follow = -np.where(laws.state == State.SLIP, mu, 0.0)[:, None] * laws.direction
    m, every = len(mu), np.arange(len(mu))
    columns = np.concatenate([3 * every + 1, 3 * every + 2])
    friction = sparse.csr_matrix((follow.T.ravel(), (np.tile(3 * every, 2), columns)), shape=(3 * m, 3 * m))
    rows, acting = J[held], sparse.csr_matrix((J + friction @ J)[held])
    try:
        pivot = matched(rows, held // 3).pivot
        back, force = (sparse.csr_matrix(np.linalg.inv(each[:, pivot].toarray())) for each in (rows, acting))
    except (ValueError, np.linalg.LinAlgError) as error:
        raise NotHeldError(f"contact candidates cannot be held together: {error}") from None
    place = sparse.csr_matrix((np.ones(len(held)), held, np.arange(len(held) + 1)), shape=(len(held), 3 * m))
    unit = sparse.csr_matrix(back @ rows), sparse.csr_matrix(force @ acting)
    return *unit, pivot, sparse.csr_matrix(back @ place), sparse.csr_matrix(place.T @ force.T)


def _stacked(blocks: Sequence[Block], n: int) -> sparse.csr_matrix:
    """Dense blocks of rows one below the other, each on its columns of n."""
    columns = [np.tile(unknowns, len(block)) for block, unknowns in blocks]
    lengths = [block.shape[1] for block, _ in blocks for _ in range(len(block))]
    data = np.concatenate([np.zeros(0), *(block.ravel() for block, _ in blocks)])
    places = np.concatenate([np.zeros(0, int), *columns]), np.cumsum([0, *lengths])
    return sparse.csr_matrix((data, *places), shape=(len(lengths), n))


def _independent(J: np.ndarray, i: int) -> np.ndarray:
    """The unknowns that hold the rows (r, k) most firmly."""
    _, R, order = qr(J, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(R))
    if len(pivots) < len(J) or pivots[-1] <= DEPENDENT * pivots[0]:
        raise NotHeldError(
            f"contact candidate {i} of the scene cannot stick: its supports leave it less ways than its slip has; "
            "leave such candidates out of the contact, or set a finite epsilon"
        )
    return np.asarray(order[: len(J)])
