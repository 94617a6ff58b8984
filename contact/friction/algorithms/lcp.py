"""The linearised step with friction on a polygon: a dense linear complementarity problem, by Lemke's pivots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.friction.algorithms.base import FrictionalNewton
from contact.friction.algorithms.compliance import Block, Chosen
from contact.friction.algorithms.programmed import finished, polygon, unfinished
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.solvers.lcp_pivoting import lemke

PIVOTS_EACH = 20  # allowed per unknown: far more than are needed where there is an end; the worst cases take 2^n


@dataclass(frozen=True)
class Lcp(FrictionalNewton):
    """Friction t = D b, b >= 0, is a sum along the corners D of a polygon in the disc; with l the size of the slip::

        0 <= f  _|_  g >= 0,    0 <= b  _|_  D^T s + l >= 0,    0 <= l  _|_  mu f - sum b >= 0

    with v = (g, s) of the condensed linearisation. The matrix is copositive, so that Lemke's pivots end for every mu,
    after up to 2^n of them: they are bounded, and beyond states are settled by exact steps alone, as the history says.
    sides: of the polygon; friction is up to 1 - cos(pi/sides) short. Candidates that slip along a line have none.
    finish: whether exact steps on the states of the answer put friction on the disc itself; without, a step ends with
    the forces of the polygon, which the judge refuses.
    Sources: Stewart, Trinkle, Int. J. Numer. Methods Eng. 39 (1996) 2673-2691; Anitescu, Potra, Nonlinear Dyn. 14
    (1997) 231-247.
    """

    sides: int = 8
    finish: bool = True
    name: ClassVar[str] = "lcp"

    def supports(self, problem: FrictionalProblem) -> str | None:
        """Needs a polygon with an even number of sides, and finite coefficients."""
        if self.sides < 4 or self.sides % 2:
            return f"a polygon of {self.sides} sides: an even number from 4 on is needed"
        if np.any(np.isinf(problem.mu)):
            return "an infinite coefficient is no row of a complementarity problem"
        return super().supports(problem)

    def solve(self, problem: FrictionalProblem, start: FrictionalSolution) -> FrictionalSolution:
        """Newton from ``start`` on linearised problems that are each solved to the end."""
        run = self.run(problem, lawful=self.finish)
        by = finished if self.finish else unfinished
        return run.finish(*by(run, run.start(start), self.choose, [], self.max_iterations))

    def choose(self, block: Block) -> Chosen:
        """Forces and states of the candidates of a condensed linearisation; raises LcpError."""
        c, (rubs, D) = len(block.mu), corners(block, self.sides)
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
        found = np.zeros((3 * len(block.mu), len(directions)))
        found[3 * i + 1 : 3 * i + 3] = directions.T
        rubs.append(np.full(len(directions), i))
        columns.append(found)
    return np.concatenate(rubs), np.hstack(columns)
