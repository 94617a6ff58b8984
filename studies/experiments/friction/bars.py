"""An elastic bar dragged over a plane, and a strip on a drum: partial slip, gross slip and cycles in closed form.

On a plane, pressed so that friction is at most tau per length, a bar EA that is pulled by F at its end slips along
F/tau and its end comes by F^2/(2 EA tau); back to 0 it keeps half of that, and a cycle from F to -F and back takes
2 F^3/(3 EA tau). On a drum of radius R, where a strip under tension presses itself, with T0 and T1 at its ends::

    slip angle ln(T1/T0)/mu,    u = R/(EA mu) (T1 - T0 - T0 ln(T1/T0)),    gross slip at T1/T0 = exp(mu theta)

Elements of constant strain u' + w/R; x runs along the foundation, w off it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pandas as pd
from scipy import sparse

from contact.friction.path import PathState, Stage, follow
from contact.friction.problem import FrictionalProblem, FrictionalSolution, State
from contact.friction.semismooth import Semismooth
from contact.problem import ContactProblem, linear_mechanics

EA, TAU, PULL, LENGTH = 1e4, 0.5, 20.0, 100.0  # N, N/mm, N, mm
RADIUS, T0, T1, MU = 100.0, 10.0, 15.0, 0.3
STIFF = 1e9  # N/mm, of what drives an end


@dataclass(frozen=True, eq=False)
class Bar:
    """n elements over ``length`` [mm]; u_0, w_0, u_1, ..: node by node.

    curvature [1/mm]: of the drum, 0 on a plane.  press [N/mm]: dead load on the foundation.  tension [N]: at rest.
    held: whether the first end does not move along, else it carries the tension as a dead load.  driven: whether the
    last end goes where a stiff spring takes it, else it carries what it is pulled by beyond the tension.
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

        contact = ContactProblem(linear_mechanics(K, load, largest), lambda u: across @ u, gap_jacobian, self.shares)
        mu = np.full(n + 1, self.mu)
        problem = FrictionalProblem(contact, mu, lambda u: (slips @ u - anchors).reshape(-1, 2), lambda u: slips)
        return Stage(problem, lambda u: np.asarray(slips @ u))

    @property
    def rest(self) -> PathState:
        """Pressed, sticking, under its tension."""
        size, m = 2 * (self.n + 1), self.n + 1
        at = FrictionalSolution.at_rest(size, m)
        pressed = (self.press + self.tension * self.curvature) * self.shares
        return PathState(0.0, replace(at, normal=pressed, state=np.full(m, State.STICK, np.int8)), np.zeros(2 * m))

    def follow(self, pulls: Sequence[float]) -> list[PathState]:
        """The states at these pulls in turn, from rest; a front passes many nodes on one linearisation."""
        return list(follow(self.stage_at, pulls, Semismooth(settle=0.0), self.rest))


def strip_table(meshes: Sequence[int] = (25, 50, 100, 200), steps: Sequence[int] = (1, 4)) -> pd.DataFrame:
    """The dragged strip: relative errors of every mesh and number of load steps between two turning points.

    end, back: end displacement at F and back at 0; loop: dissipation of a cycle from F to -F and back.
    """
    end, rows = PULL**2 / (2 * EA * TAU), []
    for n in meshes:
        for count in steps:
            turns = (0.0, PULL, 0.0, PULL, -PULL, PULL)
            pulls = [a + (b - a) * k / count for a, b in pairwise(turns) for k in range(1, count + 1)]
            states = Bar(n, LENGTH, 1.0, press=TAU).follow(pulls)
            ends = [float(state.solution.u[-2]) for state in states]
            first = states[count - 1].solution
            loop = sum(state.dissipation for state in states[3 * count :])
            rows.append(
                {"elements": n, "steps": count, "converged": all(s.solution.outcome.converged for s in states)}
                | {"end": ends[count - 1] / end - 1, "back": ends[2 * count - 1] / (end / 2) - 1}
                | {"loop": loop / (2 * PULL**3 / (3 * EA * TAU)) - 1}
                | {"slip_mm": float(np.sum((first.state == State.SLIP) * Bar(n, LENGTH, 1.0).shares))}
                | {"least_dissipation": min(state.dissipation for state in states)}
            )
    return pd.DataFrame(rows)


def drum_table(meshes: Sequence[int] = (25, 50, 100, 200), wrap: float = 2.0) -> pd.DataFrame:
    """Partial slip on the drum: the end displacement [mm], its relative error, and the slip angle [rad]."""
    exact = RADIUS / (EA * MU) * (T1 - T0 - T0 * math.log(T1 / T0))
    rows = []
    for n in meshes:
        bar = Bar(n, RADIUS * wrap, MU, curvature=1 / RADIUS, tension=T0, held=True)
        found = bar.follow([T1 - T0])[-1].solution
        angle = float(np.sum((found.state == State.SLIP) * bar.shares)) / RADIUS
        row = {"elements": n, "outcome": found.outcome.word, "end_mm": float(found.u[-2]), "slip_rad": angle}
        rows.append(row | {"error": float(found.u[-2]) / exact - 1})
    return pd.DataFrame(rows)


def capstan_table(
    turns: Sequence[tuple[float, float]] = ((0.2, 1.0), (0.3, 2.0), (0.5, 2.0), (0.5, 4.0)), n: int = 100
) -> pd.DataFrame:
    """Gross slip on the drum by (mu, theta): T1/T0 and its relative error from exp(mu theta)."""
    rows = []
    for mu, theta in turns:
        bar = Bar(n, RADIUS * theta, mu, curvature=1 / RADIUS, tension=T0, driven=True)
        found = bar.follow([10.0])[-1].solution
        ratio = 1 + STIFF * (10.0 - float(found.u[-2])) / T0
        balance = 1 - float(np.sum(found.friction[:, 0])) / T0  # of all forces along, without the stiff spring's digits
        row = {
            "mu": mu,
            "theta": theta,
            "outcome": found.outcome.word,
            "slipping": int(np.sum(found.state == State.SLIP)),
        }
        rows.append(row | {"ratio": balance, "error": balance / math.exp(mu * theta) - 1, "at_spring": ratio})
    return pd.DataFrame(rows)


def _every(size: int, start: int) -> sparse.csr_matrix:
    """Every second unknown from ``start``."""
    columns = np.arange(start, size, 2)
    return sparse.csr_matrix((np.ones(len(columns)), columns, np.arange(len(columns) + 1)), shape=(len(columns), size))
