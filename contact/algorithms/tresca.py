"""Friction with given bounds b (m,) [N] as a quadratic programme in the forces of a condensed linearisation::

    min F.W.F/2 + v.F    subject to    f >= 0,    |t_i| <= b_i

the disc as a second-order cone, or a polygon in it; where a slip has one way both are |t| <= b. With given bounds
friction has a potential (Tresca); with b = mu f of the pass before, damped where passes do not contract, they come to a
fixed point, which is the law of Coulomb.
Source: Panagiotopoulos, Ingenieur-Archiv 44 (1975) 421-432.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from contact.coulomb import State
from contact.newton.friction_compliance import Block, Chosen
from contact.newton.loop import StepError
from contact.operations import DENSE_PIVOTS, eigenvalues_alone, spend
from contact.problem import Outcome
from contact.solvers.qp_backends import Answer, Programme
from contact.solvers.sparse import asymmetry, symmetric

SHIFTS = (0.0, *(10.0**k for k in range(-6, 3)))  # of the diagonal, tried on a compliance that is not convex
PASSES = 60
CONTRACTS = 0.9  # a change that falls by less is damped
ROUNDING = 1e-12  # of a unit diagonal: an eigenvalue that much below zero is none


@dataclass(frozen=True, eq=False)
class Tresca:
    """The programme of a block in x = F/(size unit): unit (3c,) [N/mm^1/2] makes the diagonal of W one.

    Both ways of a slip have one unit, so that a disc stays one.  sides: of the polygon, 0 for the disc.  shift: of the
    diagonal, 0 unless W is not positive semidefinite.
    """

    block: Block
    unit: np.ndarray
    size: float
    shift: float
    sides: int

    @classmethod
    def of(cls, block: Block, sides: int) -> Tresca:
        """Raises StepError where W has no energy, or is far from convex."""
        W = sparse.csc_matrix(block.W)
        if not (block.energetic or symmetric(W)):
            off = f"the compliance differs from its transpose by {asymmetry(W):.1e} of its size"
            raise StepError(Outcome.REFUSED, f"{off}: no energy to minimise")
        give = np.abs(np.diag(block.W)).reshape(-1, 3).copy()
        give[:, 1:] = np.max(give[:, 1:], axis=1)[:, None]
        give[give == 0] = np.max(give, initial=0.0) or 1.0
        unit = 1 / np.sqrt(give.ravel())
        spend(DENSE_PIVOTS, eigenvalues_alone(len(unit)))
        lowest = float(np.linalg.eigvalsh(unit[:, None] * block.W * unit)[0])
        shift = next((s for s in SHIFTS if lowest + s >= -ROUNDING), None)
        if shift is None:
            raise StepError(Outcome.UNSOLVED, "the compliance is far from convex: no programme was made of it")
        return cls(block, unit, float(np.max(np.abs(unit * block.v), initial=0.0)) or 1.0, shift, sides)

    def programme(self, bound: np.ndarray) -> tuple[Programme, np.ndarray]:
        """The programme for bounds (c,), and which of the forces (3c,) are its unknowns."""
        used = self.block.own & (bound > 0)[:, None]
        used[:, 0] = True
        chosen, n = np.flatnonzero(used.ravel()), used.size
        unit = self.unit[chosen]
        P = unit[:, None] * self.block.W[np.ix_(chosen, chosen)] * unit + self.shift * np.eye(len(chosen))
        radius = bound / (self.unit[1::3] * self.size)
        both = np.flatnonzero(used[:, 1:].all(axis=1))
        along = np.flatnonzero((used * [0, 1, 1]).sum(axis=1) == 1)
        way = 3 * along + np.where(used[along, 1], 1, 2)
        rows = [_rows(3 * np.arange(len(bound)), n), _rows(way, n), -_rows(way, n)]
        limits = [np.zeros(len(bound)), -radius[along], -radius[along]]
        first, second = _rows(3 * both + 1, n), _rows(3 * both + 2, n)
        if self.sides:
            for c, s in facets(self.sides):
                rows.append(-c * first - s * second)
                limits.append(-radius[both] * math.cos(math.pi / self.sides))
        else:
            discs = sparse.vstack([sparse.csr_matrix((len(both), n)), first, second], format="csr")
            order = np.arange(3 * len(both)).reshape(3, -1).T.ravel()
            rows.append(discs[order])
            limits.append(np.column_stack([-radius[both], *np.zeros((2, len(both)))]).ravel())
        A = sparse.csc_matrix(sparse.vstack(rows, format="csc")[:, chosen])
        q = unit * self.block.v[chosen] / self.size
        discs_number = 0 if self.sides else len(both)
        return Programme(sparse.csc_matrix((P + P.T) / 2), q, A, np.concatenate(limits), discs=discs_number), chosen

    def forces(self, x: np.ndarray, chosen: np.ndarray) -> np.ndarray:
        """F (c, 3) of the unknowns of the programme."""
        F = np.zeros(len(self.unit))
        F[chosen] = self.size * self.unit[chosen] * x
        return F.reshape(-1, 3)

    def states(self, forces: np.ndarray, bound: np.ndarray) -> np.ndarray:
        """(c,): whether force or gap is the larger, and what is left of friction or slip, each way in N."""
        block = self.block
        v = (block.v + block.W @ forces.ravel()).reshape(-1, 3) * block.k[:, None]
        t = forces[:, 1:]
        if self.sides:
            used = np.max(t @ facets(self.sides).T, axis=1) / math.cos(math.pi / self.sides)
            used = np.where(block.own[:, 1:].all(axis=1), used, np.linalg.norm(t, axis=1))
        else:
            used = np.linalg.norm(t, axis=1)
        slips = np.linalg.norm(np.where(block.own[:, 1:], v[:, 1:], 0.0), axis=1) > bound - used
        closed = np.where(slips | (block.mu == 0), State.SLIP, State.STICK)
        return np.where(forces[:, 0] > v[:, 0], closed, State.OPEN).astype(np.int8)


def by_passes(
    block: Block, sides: int, near: float, ask: Callable[[Programme], Answer], words: list[str]
) -> tuple[Chosen, Answer]:
    """The fixed point of the passes, where bounds change by no more than ``near`` of the largest; raises StepError.

    words: what there is to say of it.
    """
    tresca, bound = Tresca.of(block, sides), np.zeros(len(block.mu))
    if tresca.shift:
        words.append(f"not convex: states found with a shift of {tresca.shift:g} of the diagonal")
    damping, before = 1.0, np.inf
    for _ in range(PASSES):
        programme, chosen = tresca.programme(bound)
        answer = ask(programme)
        forces = tresca.forces(answer.x, chosen)
        wanted = block.mu * np.maximum(forces[:, 0], 0.0)
        change = float(np.max(np.abs(wanted - bound), initial=0.0))
        if not answer.claimed or change <= near * float(np.max(wanted, initial=0.0)):
            break
        damping = damping / 2 if change > CONTRACTS * before else damping
        bound, before = bound + damping * (wanted - bound), change
    else:
        words.append(f"bounds of friction came to no fixed point in {PASSES} passes")
    return Chosen(forces, tresca.states(forces, bound)), answer


def facets(sides: int) -> np.ndarray:
    """Unit vectors (sides, 2) across the sides of the polygon."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _rows(places: np.ndarray, n: int) -> sparse.csr_matrix:
    return sparse.csr_matrix((np.ones(len(places)), places, np.arange(len(places) + 1)), shape=(len(places), n))
