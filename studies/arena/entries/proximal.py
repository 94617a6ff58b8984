"""Proximal point with latent variables: gaps exp(psi) on the way, and exact steps from the set that they tell."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.algorithms.base import NewtonAlgorithm
from contact.catalogue import ALGORITHMS
from contact.events import Event, EventKind
from contact.newton.loop import iterate, settle_most
from contact.newton.state import Iterate
from contact.newton.step import NewtonRun
from contact.parameters import SHARED, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError, added
from studies.scene import Setting

FIRST = 0.1  # of the depth: the least room that a candidate begins with
FALL = 3.0  # the most by which psi falls in a Newton step
SMALLEST = 1e-8  # of the depth: room that is none
LOOSE = 1.0  # of the depth over the growth of alpha so far: how far g may be from exp(psi) when alpha grows
SETTLE = 0.05  # of the exact steps, as semismooth
SPENT = "proximal_iterations"


@dataclass(frozen=True)
class Proximal(NewtonAlgorithm):
    """The proximal point method in the entropy of the gap, with Newton on u and psi, g = exp(psi); then exact steps.

    Each proximal step k minimises the energy and the divergence of g from the gap before, over alpha_k::

        r(u) = G^T W p,    p = (psi_{k-1} - psi)/alpha_k,    g(u) = exp(psi)

    No gap closes, and none needs to be open at the start; one under pressure falls as exp(-alpha p). Newton leaves
    K du - G^T W dp = -(r - G^T W p), dp = -D (g + G du - exp(psi)), D = exp(-psi)/alpha, definite where K is. psi falls
    by what the step says, FALL at most; it rises as the logarithm of the gap that the step leads to, and so cannot
    overflow. The next proximal step begins with the same pressures once g is as near to exp(psi) as h over the growth
    of alpha so far. Once the largest p exp(psi) is ``crossover`` of c h^2, the set is where p > c exp(psi), and exact
    steps settle and correct it there.
    h is the depth to which the first linearised step enters the foundation when nothing resists, c the stiffness per
    area of all candidates that do: alpha_1 is ``alpha`` over c h.
    Source: Keith, Surowiec, Proximal Galerkin, Found. Comput. Math. (2024), arXiv:2307.12444; example 36 of MFEM.
    """

    alpha: float = 3.0
    growth: float = 3.0
    crossover: float = 1e-3
    name: ClassVar[str] = "proximal"
    parameters: ClassVar[tuple[Parameter, ...]] = (
        *SHARED,
        Parameter("alpha", "first proximal step, times stiffness per area and depth", low=1e-3, high=1e3),
        Parameter("growth", "of the proximal step from one to the next", low=1, high=100),
        Parameter("crossover", "largest pressure times gap at which the set is read off", low=1e-12, high=1),
    )

    def __post_init__(self) -> None:
        """Raises ValueError with the value and its range."""
        for parameter in self.parameters:
            Setting.of(parameter, None).parse(getattr(self, parameter.key))

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs the exact constraint: gaps that are exponentials have no penetration p/epsilon."""
        if np.isfinite(self.epsilon):
            return "its gaps are exponentials: epsilon must be infinite; a finite one is the business of regularised"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """By proximal steps from ``start``, and by exact steps from where they end."""
        run = self.run(problem)
        run.tally.counters[SPENT] = 0
        at = run.at(run.linearise(start.u, None), start.u, start.pressure, start.active)
        told = "the travel is an unknown, no proximal step has it" if problem.driven else ""
        if not (problem.driven or _answered(run, at)):
            try:
                for reached in self._approach(run, at):
                    at = reached
                    run.tally.counters[SPENT] += 1
            except SingularMatrixError as error:
                told = str(error)
        near = ContactSolution(at.u, np.where(at.active, at.pressure, 0.0), at.active, Outcome.CONVERGED)
        row, settle = len(run.tally.history), partial(settle_most, settle=SETTLE, most=self.max_updates)
        solution = iterate(run, near, settle, self.max_iterations, lin=at.lin)
        if told:
            event, also = Event(EventKind.SUBSTITUTE, f"exact steps alone: {told}"), run.tally.history[row].get("event")
            run.tally.tell(event + also if isinstance(also, Event) else event, row)
        return solution

    def _approach(self, run: NewtonRun, at: Iterate) -> Iterator[Iterate]:
        """The iterates of the proximal steps, up to the one whose set is read off; raises SingularMatrixError."""
        depth, c = _scales(run, at)
        if depth <= 0:
            return
        alpha = unit = self.alpha / (c * depth)
        noted = at.active
        psi = np.log(np.maximum(at.gap, FIRST * depth))
        before = psi + alpha * np.maximum(at.pressure, 0.0)
        for _ in range(self.max_iterations):
            pressure, room = (before - psi) / alpha, np.exp(psi)
            springs = 1 / (alpha * room)
            du = _sprung(run, at, pressure, springs)(pressure + (room - at.gap) * springs)
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


def _sprung(
    run: NewtonRun, at: Iterate, pressure: np.ndarray, springs: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """What gives du (n,) of (K + G^T W D G) du = G^T W q - r, with springs D (m,), for pressures q (m,) at du = 0.

    Raises SingularMatrixError.
    """
    problem = run.problem
    with run.tally.timed("contact_s"):
        push = sparse.csc_matrix(problem.push(at.u).T @ problem.weight_matrix)
        change = sparse.csc_matrix(push @ sparse.diags_array(springs) @ problem.gap_jacobian(at.u))
        matrix = added(problem.stiffness(at.lin, at.u, pressure), change)
    factor = run.factorise(matrix)
    return lambda load: run.solution(factor, matrix, push @ load - at.lin.residual)


def _answered(run: NewtonRun, at: Iterate) -> bool:
    """Whether there is nothing to solve, or no candidate."""
    return len(at.gap) == 0 or (run.balanced(at) and run.closed(at) and not run.misplaced(at).any())


def _scales(run: NewtonRun, at: Iterate) -> tuple[float, float]:
    """The depth [mm] that a step enters the foundation if nothing new resists, and the stiffness per area of who does.

    Candidates of the set are held by springs of their own stiffness. The depth is 0 where no candidate is concerned.
    Raises SingularMatrixError.
    """
    rows, own = run.problem.gap_jacobian(at.u), at.stiffness.per_area or 1.0
    held = np.where(at.active, own, 0.0)
    step, before = _sprung(run, at, at.pressure, held), np.where(at.active, at.pressure - held * at.gap, 0.0)
    free = rows @ step(before)
    pressed = at.active | (at.gap + free < 0)
    if not pressed.any():
        return 0.0, own
    depth = max(float(np.max(np.abs(at.gap + free)[pressed])), float(np.max(-at.gap)))
    give = float(np.mean((rows @ step(before + pressed) - free)[pressed]))
    load = float(np.max(at.pressure)) / depth if depth > 0 else 0.0
    return depth, max(1 / give if give > 0 else own, load)


ALGORITHMS[Proximal.name] = Proximal
