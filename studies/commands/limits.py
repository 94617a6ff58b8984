"""``--time-limit`` and ``--memory-limit`` of one solve: a look ahead, then limits of this process that hold.

The error of a mesh has its own bound of time, ``--budget``. What a solve will take is found elsewhere
(:mod:`studies.solving.refinement.foresight`).
"""

from __future__ import annotations

import argparse
import math
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NoReturn

from studies.ask.request import Request, UsageError
from studies.ask.scene import Scene
from studies.commands import INTERRUPTED, NOT_CONVERGED
from studies.commands.options import positive

TIME_HELP = (
    "wall time, e.g. 60s: refuse a solve forecast to take twice as long; stop at the limit and write the finished loads"
)
MEMORY_HELP = "memory beyond that of an idle process: refuse a solve forecast to need more; stop at the limit"
LARGEST_S = 5e5  # a table may take four times as long as a cell, and poll counts ms in 32 bits: to 2.1e6 s
LARGEST_MB = 1e9
LARGE = 3000  # elements, from which on a solve is worth a look ahead
TWICE = 2.0  # factor of the error of foreseen seconds


class OutOfTimeError(KeyboardInterrupt):
    """The limit of time is reached; says so."""


def add_limits(parser: argparse.ArgumentParser) -> None:
    """Both."""
    parser.add_argument("--time-limit", metavar="SECONDS", help=TIME_HELP)
    parser.add_argument("--memory-limit", type=float, metavar="MB", help=MEMORY_HELP)


def _seconds(text: str | None, name: str) -> float:
    if text is None:
        return math.inf
    from studies.solving.refinement.cascade import parse_budget  # loaded with a bound alone

    return parse_budget(text, name)


def look_ahead(options: argparse.Namespace, scene: Scene, request: Request) -> None:
    """Print what a large solve will take; raises UsageError where that is more than a limit."""
    if options.time_limit is not None and options.error is not None:
        raise UsageError("with --error, --budget limits the time: give no --time-limit")
    time_s, memory_MB = _seconds(options.time_limit, "time-limit"), math.inf
    if options.time_limit is not None:
        positive("time-limit", time_s, LARGEST_S)
    if options.memory_limit is not None:
        memory_MB = positive("memory-limit", options.memory_limit, LARGEST_MB)
    large = math.prod(request.mesh) >= LARGE
    if options.error is not None or not (large or math.isfinite(time_s) or math.isfinite(memory_MB)):
        return
    from studies.solving.refinement.foresight import foresee  # loaded where there is something to foresee

    ahead = foresee(scene, request)
    if ahead is None:
        return
    forecast = f"{request.mesh_text}: {ahead}"
    if ahead.memory_MB > memory_MB:
        raise UsageError(f"{forecast}: more than --memory-limit {memory_MB:g}; a coarser mesh needs less")
    if ahead.seconds is not None and ahead.seconds > TWICE * time_s:
        raise UsageError(f"{forecast}: more than --time-limit {time_s:g}; a coarser mesh takes less")
    if large:
        print(forecast, flush=True)


def bound_of(options: argparse.Namespace) -> float:
    """Seconds that a solve may take, inf where it may take any."""
    return min(_seconds(options.time_limit, "time-limit"), _seconds(options.budget, "budget"))


@contextmanager
def limited(options: argparse.Namespace) -> Iterator[None]:
    """Raises OutOfTimeError at the end of the time, between two steps of compiled code, and MemoryError."""
    time_s = _seconds(options.time_limit, "time-limit")

    def stop(*_: object) -> NoReturn:
        raise OutOfTimeError(f"stopped at the limit of {time_s:g} s")

    _limit_memory(options.memory_limit, options.memory_limit)
    before = signal.signal(signal.SIGALRM, stop) if math.isfinite(time_s) else None
    if before is not None:
        signal.setitimer(signal.ITIMER_REAL, time_s)
    try:
        yield
    finally:
        if before is not None:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
        _limit_memory(options.memory_limit, None)


def code_of(stop: BaseException | None) -> int:
    """The exit code of what was stopped: by its limit of time, or by somebody."""
    return NOT_CONVERGED if isinstance(stop, OutOfTimeError) else INTERRUPTED


def _limit_memory(asked: float | None, memory_MB: float | None) -> None:
    """Where one is asked for: set it, or take it away again."""
    if asked is not None:
        from studies.run.task import limit  # loaded with a limit alone

        limit(None, memory_MB)
