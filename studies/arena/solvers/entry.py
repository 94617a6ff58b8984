"""Common parts of the entries: parameters checked against their ranges, and the crossover to exact steps.

Nothing specific to a single method, such as a barrier or an entropy, may enter here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np
from scipy import sparse

from contact.algorithms.base import NewtonAlgorithm
from contact.events import Event, EventKind
from contact.newton.loop import iterate, settle_most
from contact.newton.step import Iterate, NewtonRun
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.solvers.sparse import SingularMatrixError, added
from studies.ask.scene import Setting

SETTLE = 0.05  # of the exact steps, as semismooth
FAR = 1e6  # times the expected distance: an approach that goes farther has failed, as on problems without an answer


@dataclass(frozen=True)
class Entry(NewtonAlgorithm):
    """An algorithm whose parameters no scene has checked: it may be made in Python, with any values."""

    def __post_init__(self) -> None:
        """Raises ValueError with the value and its range."""
        for parameter in self.parameters:
            Setting.of(parameter, None).parse(getattr(self, parameter.key))


@dataclass(frozen=True)
class Crossover(Entry, ABC):
    """Linearised steps of :meth:`approach`, then exact ones from the set p > c g of the last of them.

    kept: its constraint on the gaps during the approach, for the refusal of a penetration p/epsilon.
    """

    name: ClassVar[str]
    kept: ClassVar[str]

    @abstractmethod
    def approach(self, run: NewtonRun, at: Iterate, depth: float, c: float) -> Iterator[Iterate]:
        """The iterates from ``at`` up to the one whose set is read off.

        depth [mm], c [MPa/mm]: of :func:`scales`.  Raises SingularMatrixError.
        """

    def supports(self, problem: ContactProblem) -> str | None:
        """Needs the exact constraint."""
        if np.isfinite(self.epsilon):
            return f"{self.kept}: epsilon must be infinite; a finite one is the business of regularised"
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        """By the approach from ``start``, and by exact steps from where that ends.

        The exact steps weigh pressure against gap by the c of the structure: by the stiffness of the candidates alone,
        a thousand times that and more where a thin body bends, they would take a gap that is no more than the rest of a
        Newton step for one that is open, and drop the whole set.
        """
        run, spent = self.run(problem), f"{self.name.replace('-', '_')}_iterations"
        run.tally.counters[spent] = 0
        at = run.at(run.linearise(start.u, None), start.u, start.pressure, start.active)
        reason, c = "the travel is an unknown, none of its steps has it" if problem.driven else "", 0.0
        depth = 0.0
        if not (problem.driven or _answered(run, at)):
            try:
                depth, c = scales(run, at)
                for reached in self.approach(run, at, depth, c) if depth > 0 else ():
                    at = reached
                    run.tally.counters[spent] += 1
            except SingularMatrixError as error:
                reason = str(error)
        if _lost(run, start.u, at, depth):
            reason = "the approach ends far out, where a large gap hides a small one"
            at = run.at(run.linearise(start.u, None), start.u, start.pressure, start.active)
        weight = c / (at.stiffness.per_area or 1.0) or 1.0
        row, settle = len(run.tally.history), partial(settle_most, settle=SETTLE, c=weight, most=self.max_updates)
        near = ContactSolution(at.u, np.where(at.active, at.pressure, 0.0), at.active, Outcome.CONVERGED)
        solution = iterate(run, near, settle, self.max_iterations, weight, at.lin)
        if reason:
            event = Event(EventKind.SUBSTITUTE, f"exact steps alone: {reason}")
            also = run.tally.history[row].get("event")
            run.tally.tell(event + also if isinstance(also, Event) else event, row)
        return solution


def sprung(
    run: NewtonRun, at: Iterate, pressure: np.ndarray, springs: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """A function for du (n,) of (K + G^T W D G) du = G^T W q - r, with springs D (m,), for pressures q (m,) at du = 0.

    K is that under ``pressure`` (m,).  Raises SingularMatrixError.
    """
    problem = run.problem
    with run.tally.timed("contact_s"):
        push = sparse.csc_matrix(problem.push(at.u).T @ problem.weight_matrix)
        change = sparse.csc_matrix(push @ sparse.diags_array(springs) @ problem.gap_jacobian(at.u))
        matrix = added(problem.stiffness(at.lin, at.u, pressure), change)
    factor = run.factorise(matrix)
    return lambda load: run.solution(factor, matrix, push @ load - at.lin.residual)


def scales(run: NewtonRun, at: Iterate) -> tuple[float, float]:
    """Depth [mm] to which a step enters the foundation without new contact, and stiffness per area of those entering.

    Candidates of the set are held by springs of their own stiffness. The depth is 0 where no candidate enters.
    Raises SingularMatrixError.
    """
    rows, own = run.problem.gap_jacobian(at.u), at.stiffness.per_area or 1.0
    held = np.where(at.active, own, 0.0)
    step, before = sprung(run, at, at.pressure, held), np.where(at.active, at.pressure - held * at.gap, 0.0)
    free = rows @ step(before)
    pressed = at.active | (at.gap + free < 0)
    if not pressed.any():
        return 0.0, own
    depth = max(float(np.max(np.abs(at.gap + free)[pressed])), float(np.max(-at.gap)))
    give = float(np.mean((rows @ step(before + pressed) - free)[pressed]))
    load = float(np.max(at.pressure)) / depth if depth > 0 else 0.0
    return depth, max(1 / give if give > 0 else own, load)


def _lost(run: NewtonRun, begun: np.ndarray, at: Iterate, depth: float) -> bool:
    """Whether the candidates have moved FAR times as far as the depth and the gaps at u = ``begun`` (n,) require."""
    gap = run.problem.gap(begun)
    expected = depth + float(np.max(np.abs(gap), initial=0.0))
    return not float(np.max(np.abs(at.gap - gap), initial=0.0)) <= FAR * expected


def _answered(run: NewtonRun, at: Iterate) -> bool:
    """Whether there is nothing to solve, or no candidate."""
    return len(at.gap) == 0 or (run.balanced(at) and run.closed(at) and not run.misplaced(at).any())
