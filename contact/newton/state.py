"""An iterate of Newton's method on a contact problem, and beside it what a solve has spent and written down."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from contact.events import Event
from contact.problem import ContactSolution, Linearised
from contact.scales import Stiffness

COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
TIMES = ("assembly_s", "factorisation_s", "solve_s", "contact_s")


@dataclass(frozen=True, eq=False)
class Iterate:
    """Where an iteration is, and the sizes that its tests of convergence compare with.

    lin: linearisation at u (n,).  gap, pressure (m,), set (m,) bool; of the iterate that a step starts from, ``active``
    is the set expected to press.
    push [N]: |G^T W p|.  scale, first_scale [N]: of the forces in balance, now and at the start.  residual:
    |r - G^T W p| over the scale, infinite once the iteration has blown up.  length, first_length [mm]: a large gap, now
    and the first not zero.  stiffness: of the candidates at the start.
    stepped (m,): set of the last step, None before it.  moved, moved_before: |du| of the last step and of the one
    before it on the same set.
    again: whether an iterate before had this set.  updates: of the set on one linearisation, in all so far.
    short: steps in succession, up to here, that have left some of the set to settle.
    """

    lin: Linearised
    u: np.ndarray
    gap: np.ndarray
    pressure: np.ndarray
    active: np.ndarray
    push: float
    scale: float
    first_scale: float
    residual: float
    length: float
    first_length: float
    stiffness: Stiffness
    stepped: np.ndarray | None = None
    moved: float = np.inf
    moved_before: float = np.inf
    again: bool = False
    updates: int = 0
    short: int = 0


@dataclass
class Tally:
    """Counters, clock and history: the only things that a solve adds to; nothing is decided by them.

    clock: what the times of the counters are read from.
    """

    counters: dict[str, float] = field(default_factory=lambda: dict.fromkeys(COUNTERS, 0) | dict.fromkeys(TIMES, 0.0))
    history: list[dict[str, object]] = field(default_factory=list)
    clock: Callable[[], float] = time.perf_counter

    @contextmanager
    def timed(self, what: str) -> Iterator[None]:
        """Add the time of what is done inside to a counter, unless it fails."""
        start = self.clock()
        yield
        self.counters[what] += self.clock() - start

    def add(self, solution: ContactSolution) -> None:
        """What another solve has spent, and its history."""
        for key, value in solution.counters.items():
            self.counters[key] = self.counters.get(key, 0) + value
        self.history += [dict(row) for row in solution.history]

    def note(self, residual: float, active: np.ndarray, before: np.ndarray, event: Event | None = None) -> None:
        """One row of history; the set changes are counted."""
        added, removed = int(np.sum(active & ~before)), int(np.sum(before & ~active))
        self.counters["set_changes"] += bool(added or removed)
        row: dict[str, object] = {"residual": residual, "contact_nodes": int(active.sum())}
        row |= {"added": added, "removed": removed}
        self.history.append(row | ({} if event is None else {"event": event}))

    def tell(self, event: Event, row: int = -1) -> None:
        """Write an event into a row of history, by default the last."""
        self.history[row]["event"] = event
