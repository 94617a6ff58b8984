"""An elastic bar on a plane, on a drum or in one, with friction: the model of :mod:`strip` and :mod:`drum`.

Elements of constant strain u' + w/R; x runs along the foundation, w off it. Small displacements: a strip in a hollow
drum, pushed, is the one on a drum, pulled, with the signs of R, of the tension and of the pull turned.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.coulomb import Coulomb
from contact.friction.path import PathState, Stage, follow
from contact.problem import ContactProblem, ContactSolution, linear_mechanics

EA = 1e4  # N
STIFF = 1e9  # N/mm, of what drives an end
SLIPS = 1e-9  # of the largest slip: below, a node sticks


@dataclass(frozen=True, eq=False)
class Bar:
    """n elements over ``length`` [mm]; u_0, w_0, u_1, ..: node by node.

    curvature [1/mm]: of the drum, 0 on a plane, negative in a hollow one.  press [N/mm]: dead load on the
    foundation.  tension [N]: at rest, negative in a hollow drum.  held: whether the first end does not move along, else
    it carries the tension as a dead load.  driven: whether the last end goes where a stiff spring takes it, else it
    carries what it is pulled by beyond the tension.
    """

    n: int
    length: float
    mu: float
    curvature: float = 0.0
    press: float = 0.0
    tension: float = 0.0
    held: bool = False
    driven: bool = False

    @property
    def shares(self) -> np.ndarray:
        """Length [mm] of each node (n + 1,)."""
        shares = np.full(self.n + 1, self.length / self.n)
        shares[[0, -1]] /= 2
        return shares

    def stage_at(self, pull: float, anchors: np.ndarray) -> Stage:
        """Pulled by ``pull`` [N] beyond the tension, or driven to ``pull`` [mm]."""
        n, h, size = self.n, self.length / self.n, 2 * (self.n + 1)
        e = np.arange(n)
        rows = np.repeat(e, 4)
        columns = (2 * e[:, None] + np.arange(4)).ravel()
        strain = np.tile([-1 / h, self.curvature / 2, 1 / h, self.curvature / 2], n)
        B = sparse.csr_matrix((strain, (rows, columns)), shape=(n, size))
        springs, load = np.zeros(size), np.zeros(size)
        load[1::2] -= self.press * self.shares
        if not self.curvature:
            springs[1::2] = EA / h  # off the plane nothing else holds a bar
        if self.held:
            springs[0] = STIFF
        if self.driven:
            springs[-2], load[-2] = STIFF, STIFF * pull
        else:
            load[-2] = pull
        K = sparse.csc_matrix(EA * h * (B.T @ B) + sparse.diags_array(springs))
        # the ends carry the tension themselves: what is left of it presses on the drum
        load[1::2] -= self.tension * self.curvature * self.shares
        across, along = (_every(size, start) for start in (1, 0))
        slips = sparse.csr_matrix(sparse.kron(along, [[1.0], [0.0]]))
        largest = max(float(np.max(np.abs(load))), abs(pull))

        def gap_jacobian(u: np.ndarray) -> sparse.csr_matrix:
            return across

        law = Coulomb(np.full(n + 1, self.mu), lambda u: (slips @ u - anchors).reshape(-1, 2), lambda u: slips)
        mechanics = linear_mechanics(K, load, largest)
        problem = ContactProblem(mechanics, lambda u: across @ u, gap_jacobian, self.shares, coulomb=law)
        return Stage(problem, lambda u: np.asarray(slips @ u))

    @property
    def rest(self) -> PathState:
        """Pressed, sticking, under its tension."""
        size, m = 2 * (self.n + 1), self.n + 1
        at = ContactSolution.at_rest(size, m)
        pressed = np.full(m, self.press + self.tension * self.curvature)
        return PathState(0.0, replace(at, pressure=pressed, active=np.ones(m, bool)), np.zeros(2 * m))

    def follow(self, pulls: Sequence[float]) -> list[PathState]:
        """The states at these pulls in turn, from rest; a front passes many nodes on one linearisation."""
        return list(follow(self.stage_at, pulls, Semismooth(settle=0.0), self.rest))


def front(bar: Bar, slip: np.ndarray) -> float:
    """How far from its last end [mm] a bar slips, read off its slips (n + 1,) [mm] alone.

    Towards the front slip is a parabola with its vertex there, s ~ (x - front)^2: the vertex of the one through the
    last three nodes that slip. Uniform friction makes a parabola of all of it, and the reading exact on any mesh.
    """
    x = bar.length * np.arange(bar.n + 1) / bar.n
    moves = np.abs(slip) > SLIPS * np.max(np.abs(slip))
    first = int(np.flatnonzero(moves)[0])
    curved, sloped, _ = np.polyfit(x[first : first + 3] - x[first], slip[first : first + 3], 2)
    return float(bar.length - x[first] + sloped / (2 * curved))


def _every(size: int, start: int) -> sparse.csr_matrix:
    """Every second unknown from ``start``."""
    columns = np.arange(start, size, 2)
    return sparse.csr_matrix((np.ones(len(columns)), columns, np.arange(len(columns) + 1)), shape=(len(columns), size))
