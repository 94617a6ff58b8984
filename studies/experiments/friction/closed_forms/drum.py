"""A strip that presses itself on a drum, pulled, or in a hollow one, pushed: partial and gross slip in closed form.

With the normal force N0 along it at rest and N1 at the end that moves, both tension on a drum of radius R and both
compression in one::

    slip angle ln(N1/N0)/mu,    u = R/(EA mu) (N1 - N0 - N0 ln(N1/N0)),    gross slip at N1/N0 = exp(mu theta)

Errors have a rate where the front lies at the same place between two nodes on all meshes, see :mod:`strip`: the wrap
is ln(N1/N0)/(0.6 mu) and the numbers of elements are those of the strip.
Source: the equation of the capstan (Euler, Eytelwein); the rest follows by integration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd

from contact.coulomb import State
from studies.experiments.friction.closed_forms.bars import EA, STIFF, Bar, front
from studies.experiments.friction.closed_forms.strip import MESHES

RADIUS, N0, N1, MU = 100.0, 10.0, 15.0, 0.3  # mm, N, N
ANGLE = math.log(N1 / N0) / MU
END = RADIUS / (EA * MU) * (N1 - N0 - N0 * math.log(N1 / N0))  # mm, 0.03151163
SIDES = {"on": 1.0, "inside": -1.0}
DRIVEN = 10.0  # mm: far beyond the first gross slip


def drum_table(
    meshes: Sequence[int] = MESHES, sides: Sequence[str] = tuple(SIDES), wrap: float = ANGLE / 0.6
) -> pd.DataFrame:
    """Partial slip on the drum and inside: end displacement, slip angle by the vertex of slips, and errors, relative.

    wrap: angle [rad] of the strip.
    """
    rows = []
    for side, n in product(sides, meshes):
        sign = SIDES[side]
        bar = Bar(n, RADIUS * wrap, MU, curvature=sign / RADIUS, tension=sign * N0, held=True)
        found = bar.follow([sign * (N1 - N0)])[-1].solution
        end, angle = abs(float(found.u[-2])), front(bar, found.u[::2]) / RADIUS
        rows.append(
            {"side": side, "elements": n, "outcome": found.outcome.word}
            | {"end_mm": end, "end_error": end / END - 1}
            | {"slip_rad": angle, "slip_error": angle / ANGLE - 1}
        )
    return pd.DataFrame(rows)


def capstan_table(
    turns: Sequence[tuple[float, float]] = ((0.2, 1.0), (0.3, 2.0), (0.5, 2.0), (0.5, 4.0)),
    meshes: Sequence[int] = (12, 25, 50, 100),
    sides: Sequence[str] = tuple(SIDES),
) -> pd.DataFrame:
    """Gross slip by (mu, theta): ratio N1/N0, and its relative error from exp(mu theta).

    ratio: by the balance of all forces along the strip; at_spring: by the stiff spring that drives the end, which has
    fewer digits.  slipping: nodes.
    """
    rows = []
    for side, (mu, theta), n in product(sides, turns, meshes):
        sign = SIDES[side]
        bar = Bar(n, RADIUS * theta, mu, curvature=sign / RADIUS, tension=sign * N0, driven=True)
        found = bar.follow([sign * DRIVEN])[-1].solution
        ratio = 1 - sign * float(np.sum(found.rubbed.force[:, 0])) / N0
        rows.append(
            {"side": side, "mu": mu, "theta_rad": theta, "elements": n, "outcome": found.outcome.word}
            | {"slipping": int(np.sum(found.rubbed.state == State.SLIP)), "ratio": ratio}
            | {"error": ratio / math.exp(mu * theta) - 1}
            | {"at_spring": 1 + STIFF * (DRIVEN - sign * float(found.u[-2])) / N0}
        )
    return pd.DataFrame(rows)
