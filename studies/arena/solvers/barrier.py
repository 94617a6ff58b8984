"""Barrier with crossover: gaps stay open during the approach, and exact steps finish from the set that it predicts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.newton.step import Iterate, NewtonRun
from contact.parameters import SHARED, Parameter
from studies.arena.solvers.entry import Crossover, sprung

BOUNDARY = 0.9  # of the way to s = 0, and to p = 0, that a step may go
FULL = 0.5  # a step that goes so far, or farther, lets mu fall
COME = 1e-3  # of the reach: the foundation is in its position


@dataclass(frozen=True)
class Barrier(Crossover):
    """r(u) = G^T W p with p = -kappa b'(s), IPC's clamped barrier b on gaps s > 0, as kappa falls; then exact steps.

    b = -(s - d)^2 ln(s/d) up to s = d and 0 beyond, so that p s = mu phi(s/d), mu = kappa d^2::

        K du - G^T W p = -r,    p = mu phi/s - D (G du + ds),    D = max(p, mu phi/s)/s,    phi(x) = -x b'(x), d = 1

    is the Newton step with phi as it is; D, of the pressures before, gives it the few steps of a primal-dual method.
    A foundation that has come, or that touches, stands back by sigma, s = g + sigma, and comes on by ds = -sigma as the
    body yields. The filter shortens each step until no s is less than a twentieth of what it was; mu falls by
    ``reduction`` after each that goes half of its way.
    Once mu is ``crossover`` of the first, the set is where p > c g, and exact steps settle and correct it there.
    reach: d over the depth h to which the first linearised step enters the foundation when nothing resists; the first
    mu is c h d, with the stiffness per area c of all candidates that do.
    Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020) 49; Wright, Primal-Dual
    Interior-Point Methods (1997), for D and the fraction to the boundary.
    """

    reach: float = 0.1
    reduction: float = 0.1
    crossover: float = 2e-3
    name: ClassVar[str] = "barrier"
    kept: ClassVar[str] = "its gaps stay open"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("reach", "of the barrier, over the depth that a step without it enters", low=1e-6, high=10),
        Parameter("reduction", "of the barrier from one full step to the next", low=1e-3, high=0.9),
        Parameter("crossover", "share of the first barrier at which the set is read off", low=1e-12, high=1),
    )

    def approach(self, run: NewtonRun, at: Iterate, depth: float, c: float) -> Iterator[Iterate]:
        """See :meth:`Crossover.approach`."""
        d = self.reach * depth
        first = mu = c * depth * d
        sigma = max(float(np.max(-at.gap)), 0.0) + d / 2
        pressure, noted = np.maximum(at.pressure, 0.0), at.active
        for _ in range(self.max_iterations):
            s = at.gap + sigma
            barrier = mu * clamped(s / d) / s
            pressure = np.maximum(pressure, barrier)
            springs, rows = pressure / s, run.problem.gap_jacobian(at.u)
            du = sprung(run, at, pressure, springs)(barrier + springs * sigma)
            ds = rows @ du - sigma
            share = min(1.0, BOUNDARY * float(np.min(s[ds < 0] / -ds[ds < 0], initial=np.inf)))
            while np.any(run.problem.gap(at.u + share * du) + (1 - share) * sigma < (1 - BOUNDARY) / 2 * s):
                share /= 2
            pressure = np.maximum(barrier - springs * ds, (1 - BOUNDARY) * pressure)
            sigma *= 1 - share
            run.tally.note(at.residual, at.active, noted)
            noted = at.active
            at = run.advance(at, share * du, pressure, pressure > c * (s + share * ds))
            yield at
            if np.isinf(at.residual) or (mu <= self.crossover * first and sigma <= COME * d):
                return
            if share >= FULL:
                mu *= self.reduction


def clamped(x: np.ndarray) -> np.ndarray:
    """phi = -x b'(x) of b = -(x - 1)^2 ln x: 1 for x = 0, and 0 from x = 1 on with a continuous slope."""
    x = np.clip(x, np.finfo(float).tiny, 1.0)
    return np.asarray((1 - x) ** 2 - 2 * x * (1 - x) * np.log(x))


ALGORITHMS[Barrier.name] = Barrier
