"""A budget of wall time, handed on in shares: no work begins that is foreseen not to fit."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from studies.solving.result import Result
from studies.solving.solve import Interrupted


@dataclass
class Clock:
    """Seconds of wall time from when it is made; ``until``: what may be spent for now.

    now, work: wall time and CPU time [s]. What is foreseen is CPU time; a machine that others use takes longer.
    """

    budget: float
    now: Callable[[], float] = time.perf_counter
    work: Callable[[], float] = time.process_time

    def __post_init__(self) -> None:
        self._start, self._worked = self.now(), self.work()
        self.until = self.budget

    @property
    def spent(self) -> float:
        """Seconds so far."""
        return self.now() - self._start

    @property
    def left(self) -> float:
        """Seconds that may be spent for now."""
        return self.until - self.spent

    @property
    def wait(self) -> float:
        """Wall time over CPU time so far, at least 1."""
        return max(1.0, self.spent / max(self.work() - self._worked, 0.1))

    @contextmanager
    def share(self, part: float, kept: float = 0.0) -> Iterator[None]:
        """Inside, a part of what is left of the budget may be spent, ``kept`` seconds of it aside."""
        before, self.until = self.until, self.spent + part * max(self.budget - kept - self.spent, 0.0)
        try:
            yield
        finally:
            self.until = before

    def fits(self, foreseen: float) -> bool:
        """Whether there is time for so many CPU seconds."""
        return foreseen * self.wait <= self.left


class Late(KeyboardInterrupt):
    """Raised within a solve that takes longer than it may."""


def until(seconds: float, solve: Callable[[Callable[[str], None]], Result]) -> Result | None:
    """What is solved, given a ``progress`` to call; None where it takes longer than so many seconds."""
    end, late = time.perf_counter() + seconds, False

    def check(text: str) -> None:
        nonlocal late
        if time.perf_counter() > end:
            late = True
            raise Late

    try:
        return solve(check)
    except Interrupted:
        if not late:
            raise
        return None
