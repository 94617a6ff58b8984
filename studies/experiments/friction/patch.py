"""The contact patch of a tyre as a brush: dragged, spun, and turned on the spot, all of it known in closed form.

Dragged until everything slides, the force is mu F_n; spun, the moment is mu sum f r with the r where points are then.
A step that turns by a makes the slip a chord of its circle: it leans by a/2, and the moment of the model is that times
cos(a/2), whatever the springs. Turned by a little from rest, under the pressure p(r) on a disc of radius a with springs
k by area, a core r < c sticks::

    k phi c = mu p(c),    M = 2 pi (k phi c^4/4 + mu int_c^a p r^2 dr)
    loop from phi to -phi and back = 8 pi mu int_c^a p (phi r - mu p/k) r dr

Source: the brush model of tyres, Pacejka, Tyre and Vehicle Dynamics (2012); the integrals are worked out here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import Polynomial

from contact.coulomb import State
from studies.experiments.friction.brush import Brush, spun
from studies.experiments.rows import Row, tabulated

MU, STIFF, PRESSURE, DISC = 0.5, 50.0, 0.5, 50.0  # -, N/mm^3, MPa, mm
COUPLED = np.array([[40.0, 5.0, 8.0], [5.0, 60.0, -6.0], [8.0, -6.0, 50.0]])  # N/mm^3, of springs that lean
SECTORS = 8

PRESSURES = {"uniform": Polynomial([PRESSURE]), "parabolic": Polynomial([PRESSURE, 0.0, -PRESSURE / DISC**2])}


def uneven(n: int = 8, mu: float = MU) -> Brush:
    """A rectangular patch of n x 2n springs that lean; its pressures differ by a factor of three. Not moved."""
    x, y = (half * (np.arange(k) + 0.5 - k / 2) * 2 / k for half, k in ((30.0, n), (50.0, 2 * n)))
    places = np.array(list(product(x, y)))
    near = 0.01 * (1 + 0.3 * places[:, 0] / 30 - 0.2 * (places[:, 1] / 50) ** 2)
    return Brush(places, np.full(len(places), 6000.0 / len(places)), COUPLED, mu, lambda load: near, spun)


@dataclass(frozen=True)
class Parking:
    """A disc under a pressure, turned from rest until the share ``core`` of its radius sticks; see the module."""

    pressure: str
    core: float

    @property
    def c(self) -> float:
        """[mm]."""
        return self.core * DISC

    @property
    def phi(self) -> float:
        """[rad]."""
        return float(MU * PRESSURES[self.pressure](self.c) / (STIFF * self.c))

    @property
    def moment(self) -> float:
        """M [N mm]."""
        rest = (PRESSURES[self.pressure] * Polynomial([0.0, 0.0, 1.0])).integ()
        return float(2 * math.pi * (STIFF * self.phi * self.c**4 / 4 + MU * (rest(DISC) - rest(self.c))))

    @property
    def loop(self) -> float:
        """[N mm]."""
        p = PRESSURES[self.pressure]
        lost = (p * (Polynomial([0.0, self.phi]) - MU / STIFF * p) * Polynomial([0.0, 1.0])).integ()
        return float(8 * math.pi * MU * (lost(DISC) - lost(self.c)))

    def brush(self, rings: int) -> Brush:
        """Rings of the same width, each with its points where the moment of its area is."""
        edges = DISC * np.arange(rings + 1) / rings
        outer, inner = edges[1:], edges[:-1]
        r = 2 / 3 * (outer**3 - inner**3) / (outer**2 - inner**2)
        angle = 2 * math.pi * np.arange(SECTORS) / SECTORS
        places = (r[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)).reshape(-1, 2)
        areas = np.repeat(math.pi * (outer**2 - inner**2) / SECTORS, SECTORS)
        near = PRESSURES[self.pressure](np.repeat(r, SECTORS)) / STIFF
        return Brush(places, areas, STIFF * np.eye(3), MU, lambda load: near, spun)


@tabulated
def parking_table(rings: Sequence[int] = (10, 19, 40, 79), cores: Sequence[float] = (1 / 3, 2 / 3)) -> Iterator[Row]:
    """The disc turned until a core of ``cores`` of its radius sticks; then back as far, and forth again.

    core_mm: where the slip, continued from the two rings inmost of those that slip, is none.  moment_N_mm, loop_N_mm:
    at the first turn, and of the cycle after it.  Errors are relative; with 3 k + 1 rings the edge of a core of thirds
    falls alike between two of them.
    """
    for pressure, core, n in product(PRESSURES, cores, rings):
        disc = Parking(pressure, core)
        brush = disc.brush(n)
        states = brush.follow([disc.phi, -disc.phi, disc.phi])
        first, loop = states[0], sum(state.dissipation for state in states[1:])
        slip = np.linalg.norm((first.anchors[:, :2] - brush.places)[::SECTORS], axis=1)
        read = _root(np.linalg.norm(brush.places, axis=1)[::SECTORS], slip, first.solution.rubbed.state[::SECTORS])
        moment = brush.moment(first)
        yield (
            {"pressure": pressure, "core": core, "rings": n, "outcome": states[-1].solution.outcome.word}
            | {"turn_rad": disc.phi, "core_mm": read, "core_error": read / disc.c - 1}
            | {"moment_N_mm": moment, "moment_error": moment / disc.moment - 1}
            | {"loop_N_mm": loop, "loop_error": loop / disc.loop - 1}
        )


def _root(r: np.ndarray, slip: np.ndarray, state: np.ndarray) -> float:
    """Where the line through the first two that slip is zero."""
    first = int(np.flatnonzero(state == State.SLIP)[0])
    (a, b), (s, t) = r[first : first + 2], slip[first : first + 2]
    return float(a - s * (b - a) / (t - s))
