"""The process that solves frozen problems: ``python -m studies.arena.solvers.served FD MEMORY_MB``.

FD is its end of a pipe, on which steps and orders come and answers go; beyond MEMORY_MB allocations fail.
Peak memory is that of the process: resident memory at its highest during a solve, which Linux resets on request, less
that before it, once what is free has been handed back. Matrices that a solver copies are in it, the problem is not.
Where the kernel tells no such thing, it is NaN. On Linux the process ends with the one that started it.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import resource
import signal
import sys
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver

PR_SET_PDEATHSIG = 1  # of <sys/prctl.h>
STATUS, RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")


def main() -> None:
    """Answer until the other side is gone."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    pipe: Connection[Any, Any] = Connection(int(sys.argv[1]))
    _limit(float(sys.argv[2]))
    pipe.send(True)
    step: FrozenStep | None = None
    with contextlib.suppress(EOFError, OSError):
        while True:
            order = pipe.recv()
            if isinstance(order, FrozenStep):
                step = order
                continue
            assert step is not None
            solver, tolerance = order
            solver.prepare(step)
            gc.freeze()  # what is imported is not searched for garbage before each solve, which takes 50 ms
            pipe.send(True)
            pipe.send(measured(solver, step, tolerance))


def measured(solver: Solver, step: FrozenStep, tolerance: float) -> tuple[Answer, float]:
    """The answer and its peak memory [MB]."""
    _hand_back()
    before = _resident_MB("VmRSS")
    try:
        answer = solver.solve(step, tolerance)
    except MemoryError:
        answer = Answer.none(step, "out of memory")
    return answer, _resident_MB("VmHWM") - before


def _hand_back() -> None:
    """Return free memory to the kernel and forget the highest so far."""
    gc.collect()
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).malloc_trim(0)
        with contextlib.suppress(OSError):
            RESET.write_text("5", encoding="ascii")


def _resident_MB(key: str) -> float:
    try:
        told = STATUS.read_text(encoding="ascii")
    except OSError:
        return np.nan
    return float(told.partition(f"{key}:")[2].split()[0]) / 1024


def _limit(memory_MB: float) -> None:
    """Of data, where the kernel counts what numpy allocates there."""
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    begun, hard = _resident_MB("VmData"), resource.getrlimit(kind)[1]
    soft = int((memory_MB + (0.0 if np.isnan(begun) else begun)) * 2**20)
    resource.setrlimit(kind, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


if __name__ == "__main__":
    main()
