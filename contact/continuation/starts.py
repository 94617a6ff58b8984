"""Starts that are no states of a path: its state at the same parameter on another grid, which is near.

A start changes how many iterations a state takes, and neither the problem nor what a path remembers: slips are counted
from the last state of the path itself. Where it comes from does not enter here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from contact.continuation.critical_points import State
from contact.events import Event, EventKind
from contact.problem import ContactProblem, ContactSolution, Linearised


@dataclass(frozen=True, eq=False)
class Start:
    """u (n,), pressures and set (m,) to set out from.

    memory: of the linearisation at u, where nothing else is remembered.  traction (m, 2) [MPa], state (m,): of
    friction, None without it.
    """

    u: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    memory: object = None
    traction: np.ndarray | None = None
    state: np.ndarray | None = None

    def instead_of(self, last: ContactSolution, weights: np.ndarray) -> ContactSolution:
        """The start, with what the path remembers at its ``last`` state; weights (m,) [mm^2] of the candidates."""
        rubbed = last.friction
        if rubbed is not None and self.traction is not None and self.state is not None:
            rubbed = replace(rubbed, force=weights[:, None] * self.traction, state=self.state)
        return replace(last, u=self.u, pressure=self.pressure, active=self.active, friction=rubbed)

    def remembered(self, problem: ContactProblem) -> ContactProblem:
        """The problem whose linearisation at the start has its memory."""
        if self.memory is None:
            return problem
        only, linearise = problem.only, problem.linearise

        def at(u: np.ndarray, memory: object) -> Linearised:
            begins = memory is None and np.array_equal(u, self.u)
            return linearise(u, self.memory if begins else memory)

        def chosen(which: np.ndarray) -> ContactProblem:
            assert only is not None
            return self.remembered(only(which))

        return replace(problem, linearise=at, only=None if only is None else chosen)


Starts = Callable[[int, State, float], Start | None]  # index of the requested point, last state, parameter of the next


def none_known(index: int, last: State, parameter: float) -> Start | None:
    """Every step sets out from the last state of the path."""
    return None


def after_in_vain(vain: ContactSolution, found: ContactSolution, why: Event) -> ContactSolution:
    """What was found from the last state of the path, after a start from elsewhere that has led to none."""
    counters = {key: vain.counters.get(key, 0) + value for key, value in found.counters.items()}
    *rows, last = vain.history or ({},)
    event = Event(EventKind.FAILED, f"not from the state of another grid: {why}; from the last of the path")
    return replace(found, counters=counters, history=(*rows, {**last, "event": event}, *found.history))
