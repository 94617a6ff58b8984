"""Proximal point with latent variables: gaps exp(psi) during the approach, then exact steps from the predicted set."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from contact.catalogue import ALGORITHMS
from contact.newton.step import Iterate, NewtonRun
from contact.parameters import SHARED, Parameter
from studies.arena.solvers.entry import Crossover, sprung

FIRST = 0.1  # of the depth: the smallest initial gap of a candidate
FALL = 3.0  # the most by which psi falls in a Newton step
SMALLEST = 1e-8  # of the depth: a gap that counts as closed
LOOSE = 1.0  # of the depth over the growth of alpha so far: how far g may be from exp(psi) when alpha grows


@dataclass(frozen=True)
class Proximal(Crossover):
    """The proximal point method in the entropy of the gap, with Newton on u and psi, g = exp(psi); then exact steps.

    Each proximal step k minimises the energy and the divergence of g from the gap before, over alpha_k::

        r(u) = G^T W p,    p = (psi_{k-1} - psi)/alpha_k,    g(u) = exp(psi)

    No gap closes, and none needs to be open at the start; one under pressure falls as exp(-alpha p). Newton leaves
    K du - G^T W dp = -(r - G^T W p), dp = -D (g + G du - exp(psi)), D = exp(-psi)/alpha, definite where K is. psi falls
    by what the step says, FALL at most; it rises as the logarithm of the gap that the step leads to, and so cannot
    overflow. The next proximal step begins with the same pressures once g is as near to exp(psi) as h over the growth
    of alpha so far: that is not a balance, and the pressures of gaps that open lag behind. With ``growth`` 1 the steps
    find the set of a membrane by themselves, in tens; with 3 they foretell it, in one to four. Once the largest
    p exp(psi) is ``crossover`` of c h^2, the set is where p > c g, and exact steps settle and correct it there.
    h is the depth to which the first linearised step enters the foundation when nothing resists, c the stiffness per
    area of all candidates that do: alpha_1 is ``alpha`` over c h, and from 1 to 100 as good.
    Source: Keith, Surowiec, Proximal Galerkin, Found. Comput. Math. (2024), arXiv:2307.12444; example 36 of MFEM.
    """

    alpha: float = 10.0
    growth: float = 3.0
    crossover: float = 1e-3
    name: ClassVar[str] = "proximal"
    kept: ClassVar[str] = "its gaps are exponentials"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("alpha", "first proximal step, times stiffness per area and depth", low=1e-3, high=1e3),
        Parameter("growth", "of the proximal step from one to the next", low=1, high=100),
        Parameter("crossover", "largest pressure times gap at which the set is read off", low=1e-12, high=1),
    )

    def approach(self, run: NewtonRun, at: Iterate, depth: float, c: float) -> Iterator[Iterate]:
        """See :meth:`Crossover.approach`."""
        alpha = unit = self.alpha / (c * depth)
        noted = at.active
        psi = np.log(np.maximum(at.gap, FIRST * depth))
        before = psi + alpha * np.maximum(at.pressure, 0.0)
        for _ in range(self.max_iterations):
            pressure, room = (before - psi) / alpha, np.exp(psi)
            springs = 1 / (alpha * room)
            du = sprung(run, at, pressure, springs)(pressure + (room - at.gap) * springs)
            change = (at.gap + run.problem.gap_jacobian(at.u) @ du) / room - 1
            psi += np.where(change > 0, np.log1p(np.maximum(change, 0.0)), np.maximum(change, -FALL))
            pressure, room = (before - psi) / alpha, np.exp(psi)
            run.tally.note(at.residual, at.active, noted)
            noted = at.active
            at = run.advance(at, du, pressure, pressure > c * room)
            yield at
            close = np.max(np.abs(at.gap - room)) <= LOOSE * depth * unit / alpha
            if np.isinf(at.residual) or (close and np.max(pressure * room) <= self.crossover * c * depth**2):
                return
            if close:
                alpha, pressure = self.growth * alpha, np.maximum(pressure, 0.0)
                psi = np.maximum(psi - alpha * pressure, np.log(SMALLEST * depth))
                before = psi + alpha * pressure


ALGORITHMS[Proximal.name] = Proximal
