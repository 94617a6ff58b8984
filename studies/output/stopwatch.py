"""The one stopwatch: what a piece of work takes by a clock. Nothing is repeated, summed up or judged here."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")
Clock = Callable[[], float]
CPU: Clock = time.process_time  # of this process: what other programs do meanwhile disturbs it least
WALL: Clock = time.perf_counter


def timed(work: Callable[[], T], clock: Clock = CPU) -> tuple[float, T]:
    """Seconds by the clock, and what the work has returned."""
    start = clock()
    done = work()
    return clock() - start, done
