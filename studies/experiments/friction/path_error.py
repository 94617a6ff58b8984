"""What load steps cost in accuracy: a block on springs while the plane under it is dragged along a quarter circle.

The direction of the drag turns all the time, so that the answer depends on the path. With the stiffness k (2, 2) of the
springs, |k u| = mu N once it slips, and slip against friction, the block is where an ordinary differential equation
takes it, in the arc length sigma of the drag d::

    u' = d' - lam k u,    lam = (k u.k d' - (mu N)^2 N'/N)/(k u.k k u),    dissipation' = lam (mu N)^2

Before it sticks, u = d. A step of the path is an implicit Euler step of that, of first order in its length.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from contact.coulomb import Motion
from studies.experiments.friction.brush import Brush
from studies.experiments.rows import Row, tabulated

RADIUS, MU, NORMAL, STIFF = 10.0, 0.5, 8.0, 1.0  # mm, -, N, N/mm of the stiffer spring
WAY = math.pi / 2 * RADIUS
STEPS = (4, 8, 16, 32, 64, 128)
TIGHT = 1e-12  # of the reference


@dataclass(frozen=True)
class Block:
    """ratio: of the springs along y and x.  swell: share of NORMAL by which the normal force swells and comes back."""

    ratio: float = 1.0
    swell: float = 0.0

    @property
    def stiffness(self) -> np.ndarray:
        """k (2,) [N/mm]."""
        return np.array([STIFF, self.ratio * STIFF])

    def normal(self, way: float) -> float:
        """N [N]."""
        return NORMAL * (1 + self.swell * math.sin(2 * math.pi * way / WAY))

    def normal_rate(self, way: float) -> float:
        """dN/dsigma [N/mm]."""
        return NORMAL * self.swell * 2 * math.pi / WAY * math.cos(2 * math.pi * way / WAY)

    def reference(self) -> tuple[np.ndarray, float]:
        """u (2,) [mm] and the dissipation [N mm] at the end of the way."""
        k = self.stiffness

        def over(way: float) -> float:
            return float(np.linalg.norm(k * drag(way))) - MU * self.normal(way)

        slips = float(brentq(over, 0.0, WAY / 2, xtol=TIGHT))

        def rate(way: float, y: np.ndarray) -> np.ndarray:
            force, along = k * y[:2], direction(way)
            bound = MU * self.normal(way)
            lam = (force @ (k * along) - bound * MU * self.normal_rate(way)) / (force @ (k * force))
            return np.append(along - lam * force, lam * bound**2)

        found = solve_ivp(rate, (slips, WAY), np.append(drag(slips), 0.0), method="DOP853", rtol=TIGHT, atol=TIGHT)
        return found.y[:2, -1], float(found.y[2, -1])

    @property
    def brush(self) -> Brush:
        """The block as one spring of unit area, the load being the arc length."""
        k = np.diag([*self.stiffness, STIFF])
        return Brush(np.zeros((1, 2)), np.ones(1), k, MU, lambda way: np.array([self.normal(way) / STIFF]), _moved)


BLOCKS = {"springs alike": Block(), "springs unlike": Block(3.0), "normal force swells": Block(3.0, 0.3)}


def drag(way: float) -> np.ndarray:
    """d (2,) [mm] after an arc length on the circle that begins along x."""
    return RADIUS * np.array([math.sin(way / RADIUS), 1 - math.cos(way / RADIUS)])


def direction(way: float) -> np.ndarray:
    """d' (2,)."""
    return np.array([math.cos(way / RADIUS), math.sin(way / RADIUS)])


@tabulated
def path_table(steps: Sequence[int] = STEPS, blocks: Sequence[str] = tuple(BLOCKS)) -> Iterator[Row]:
    """Every block in every number of load steps: u_x_mm, u_y_mm, work_N_mm at the end, and their errors.

    end_error: distance from the reference over its length; work_error: relative.  iterations: of Newton, in all.
    """
    known = {name: BLOCKS[name].reference() for name in blocks}
    for name, count in product(blocks, steps):
        exact, work = known[name]
        states = BLOCKS[name].brush.follow([WAY * k / count for k in range(1, count + 1)])
        u, dissipated = states[-1].solution.u[:2], sum(state.dissipation for state in states)
        yield (
            {"case": name, "steps": count}
            | {"converged": len(states) == count and states[-1].solution.outcome.converged}
            | {"u_x_mm": float(u[0]), "u_y_mm": float(u[1]), "work_N_mm": dissipated}
            | {"end_error": float(np.linalg.norm(u - exact) / np.linalg.norm(exact))}
            | {"work_error": dissipated / work - 1}
            | {"iterations": sum(state.solution.counters["newton_iterations"] for state in states)}
        )


def _moved(way: float) -> Motion:
    return Motion(np.append(drag(way), 0.0), np.zeros(3), np.zeros(3))
