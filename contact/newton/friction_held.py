"""States of candidates with friction put into a tangent: which rows hold a candidate, and by which it is pushed.

Which states there are does not enter here: that is :mod:`contact.newton.friction_states`.

In a tangent states are motions that obey them, each in the places of the candidate's own unknowns. Who sticks holds as
many unknowns as it has directions, who slips one: T of :class:`contact.newton.held.Held` is made of the rows by which
it is held, and the T on the left of those by which forces act: a slipping candidate is held along its gap, and pushed
along G - mu d.S. The springs across a slip are added to K. A system is as large as K, has its places, and no zero on
the diagonal; it is symmetric unless a candidate slips. Candidates that share all that could hold them, as averaged gaps
and slips do, have forces for unknowns, as in :class:`contact.newton.saddle.Saddle`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.linalg import qr

from contact.coulomb import State
from contact.newton.friction_states import Laws
from contact.newton.held import Bound, Held
from contact.newton.pivots import Grip, largest
from contact.newton.saddle import Saddle

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
) -> tuple[Bound, sparse.csr_matrix, sparse.csr_matrix]:
    """K du - J^T F = -r under the laws, with v = (g, s) after the step where a candidate is not free along it.

    The rows of unit slope that hold, and those that push; to_slack (a, 3m): values of the held rows of unit v;
    multiplied (3m, a): forces F of unit multipliers; friction that follows a normal force is not among them.
    Candidates between two faces share unknowns: each is held by those that are its own, or all by their forces.
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
        return _jointly(ways, laws, mu, K, touching)
    size = largest(sparse.csc_matrix(K[:, pivot]))
    size[size == 0] = np.max(np.abs(K.data), initial=0.0) or 1.0
    ones, zeros = np.ones(len(pivot)), np.zeros(len(pivot))
    return Held(K, rows, acting, Grip(pivot, ones), zeros, zeros, size), slack, force


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


def _jointly(
    ways: Directions, laws: Laws, mu: np.ndarray, K: sparse.csc_matrix, touching: list[int]
) -> tuple[Saddle, sparse.csr_matrix, sparse.csr_matrix]:
    """The same with forces as unknowns: of those that share all that could hold them."""
    J, own, m = ways.rows, ways.own, len(mu)
    chosen = [3 * i + np.flatnonzero(own[i] if laws.state[i] == State.STICK else [True]) for i in touching]
    held, every = np.concatenate(chosen), np.arange(m)
    lost = np.flatnonzero((laws.state == State.SLIP) & ~own[:, 0])
    if len(lost):
        raise NotHeldError(f"contact candidate {lost[0]} has no unknown: its supports hold it")
    follow = -np.where(laws.state == State.SLIP, mu, 0.0)[:, None] * laws.direction
    columns = np.concatenate([3 * every + 1, 3 * every + 2])
    friction = sparse.csr_matrix((follow.T.ravel(), (np.tile(3 * every, 2), columns)), shape=(3 * m, 3 * m))
    place = sparse.csr_matrix((np.ones(len(held)), held, np.arange(len(held) + 1)), shape=(len(held), 3 * m))
    saddle = Saddle.of(K, J[held], sparse.csr_matrix((J + friction @ J)[held]), np.zeros(len(held)))
    return saddle, place, sparse.csr_matrix(place.T)


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
            f"contact candidate {i} of the scene cannot stick: its supports leave it fewer directions than its slip "
            "has; leave such candidates out of the contact, or set a finite epsilon"
        )
    return np.asarray(order[: len(J)])
