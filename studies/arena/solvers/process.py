"""A process that solves frozen problems one after another and may be killed: a solver that hangs stops nothing else.

Both sides are here: :class:`Child` is the client, ``python -m studies.arena.solvers.process FD ALIVE MEMORY_MB`` the
server.
FD is its end of a pipe, on which steps and orders come and answers go, ALIVE as of the process that solves cells
(:mod:`studies.commands.worker`); beyond MEMORY_MB allocations fail.
Peak memory is that of the process: the highest resident memory during a solve, which Linux resets on request, less
that before it, after free memory is returned to the kernel. Matrices that a solver copies are included, the problem is
not. Where the kernel does not provide it, it is NaN.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver
from studies.run.children import Running
from studies.run.task import READY, end_with, limit, status_MB

STARTUP_S = 600.0  # on the clock, as on a machine that leaves it one part in a hundred (measured: 170 s for 0.7 s)
PATIENCE = 20  # times as long may a solve sleep; one that only waits for a processor does not sleep
WATCH_S = 0.1
DIED = "the process died"
RESET = Path("/proc/self/clear_refs")


class Child:
    """One process at a time, started when needed and again after it was killed; to be closed.

    limit_s: of a solve [s], of processor time, so that a loaded machine fails no solve; PATIENCE times that asleep.
    memory_MB: private memory beyond what the process begins with.
    """

    def __init__(self, limit_s: float, memory_MB: float = 8000.0) -> None:
        self.limit_s, self.memory_MB = limit_s, memory_MB
        self._running: Running | None = None
        self._step: FrozenStep | None = None

    def solve(self, solver: Solver, step: FrozenStep, tolerance: float) -> tuple[Answer, float]:
        """The answer and its peak memory [MB]; an answer with the reason where the process was killed or died."""
        running = self._begun()
        try:
            if step is not self._step:
                running.send(step)
                self._step = step
            running.send((solver, tolerance))
            running.pipe.recv()  # imports are done
            reason = self._late(running)
            if not reason:
                answer, peak = running.pipe.recv()
                return answer, peak
        except (EOFError, OSError):
            reason = DIED
        self.close()
        return Answer.none(step, reason), np.nan

    def close(self) -> None:
        """Kill the process."""
        if self._running is not None:
            self._running.kill()
            self._running.buried()
        self._running = self._step = None

    def _late(self, running: Running) -> str:
        """Wait for an answer; the reason where there was none in time, otherwise empty.

        Polled from this process: a kernel timer in the other one makes its clock tick in 4 ms (measured).
        """
        pid = running.process.pid
        (begun, _), asleep, last = _spent(pid), 0.0, time.monotonic()
        while not running.pipe.poll(WATCH_S):
            (spent, sleeps), now = _spent(pid), time.monotonic()
            asleep, last = asleep + (now - last if sleeps else 0.0), now
            if spent - begun > self.limit_s:
                return f"killed after {self.limit_s:g} s"
            if asleep > PATIENCE * self.limit_s:
                return f"killed after {PATIENCE * self.limit_s:g} s asleep"
        return ""

    def _begun(self) -> Running:
        """A process that is ready, with the search path of this one; raises OSError."""
        if self._running is None:
            self._running = Running.begun(__name__, repr(self.memory_MB), path=filter(None, sys.path))
            if not self._running.ready(STARTUP_S):
                self.close()
                raise OSError("the process that solves frozen problems does not start")
        return self._running


def _spent(pid: int) -> tuple[float, bool]:
    """Processor time of another process [s], and whether it sleeps.

    Where the kernel provides neither, NaN, which exceeds no limit, and True: then the wall clock decides.
    """
    try:
        stat = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return np.nan, True
    state, *numbers = stat.rpartition(")")[2].split()
    user, system = numbers[10:12]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK"), state != "R"


# --- the server -------------------------------------------------------------------------------------------------------


def main() -> None:
    """Answer until the client is gone."""
    pipe: Connection[Any, Any] = Connection(int(sys.argv[1]))
    end_with(int(sys.argv[2]))
    limit(None, float(sys.argv[3]))
    pipe.send(READY)
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
            gc.freeze()  # imported objects are not scanned for garbage before each solve, which takes 50 ms
            pipe.send(True)
            pipe.send(measured(solver, step, tolerance))


def measured(solver: Solver, step: FrozenStep, tolerance: float) -> tuple[Answer, float]:
    """The answer and its peak memory [MB]."""
    _hand_back()
    before = status_MB("VmRSS")
    try:
        answer = solver.solve(step, tolerance)
    except MemoryError:
        answer = Answer.none(step, "out of memory")
    return answer, status_MB("VmHWM") - before


def _hand_back() -> None:
    """Return free memory to the kernel and reset the peak."""
    gc.collect()
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).malloc_trim(0)
        with contextlib.suppress(OSError):
            RESET.write_text("5", encoding="ascii")


if __name__ == "__main__":
    main()
