"""A process that solves frozen problems one after another and may be killed: a solver that hangs stops nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver
from studies.pool.process import ONE_THREAD
from studies.store.source_hash import ROOT

STARTUP_S = 600.0  # on the clock, as on a machine that leaves it one part in a hundred (measured: 170 s for 0.7 s)
PATIENCE = 20  # times as long may a solve sleep; one that only waits for a processor does not sleep
WATCH_S = 0.1


class Child:
    """One process at a time, begun when it is needed and again after it was killed; to be closed.

    limit_s: of a solve [s], of processor time, so that no busy machine fails it; PATIENCE times that asleep.
    memory_MB: private memory beyond what the process begins with.
    """

    def __init__(self, limit_s: float, memory_MB: float = 8000.0) -> None:
        self.limit_s, self.memory_MB = limit_s, memory_MB
        self._running: tuple[subprocess.Popen[bytes], Connection[Any, Any]] | None = None
        self._step: FrozenStep | None = None

    def solve(self, solver: Solver, step: FrozenStep, tolerance: float) -> tuple[Answer, float]:
        """The answer and its peak memory [MB]; of a process that was killed, or died, the reason."""
        pipe = self._begun()
        try:
            if step is not self._step:
                pipe.send(step)
                self._step = step
            pipe.send((solver, tolerance))
            pipe.recv()  # imports are done
            reason = self._late(pipe)
            if not reason:
                answer, peak = pipe.recv()
                return answer, peak
        except (EOFError, OSError):
            reason = "the process died"
        self.close()
        return Answer.none(step, reason), np.nan

    def close(self) -> None:
        """Kill the process."""
        if self._running is not None:
            process, pipe = self._running
            process.kill()
            process.wait()
            pipe.close()
        self._running, self._step = None, None

    def _late(self, pipe: Connection[Any, Any]) -> str:
        """Wait for an answer; why there was none in time, or nothing.

        Watched from here: a timer of the kernel in the other process makes its clock tick in 4 ms (measured).
        """
        assert self._running is not None
        pid = self._running[0].pid
        (begun, _), asleep, seen = _spent(pid), 0.0, time.monotonic()
        while not pipe.poll(WATCH_S):
            (spent, sleeps), now = _spent(pid), time.monotonic()
            asleep, seen = asleep + (now - seen if sleeps else 0.0), now
            if spent - begun > self.limit_s:
                return f"killed after {self.limit_s:g} s"
            if asleep > PATIENCE * self.limit_s:
                return f"killed after {PATIENCE * self.limit_s:g} s asleep"
        return ""

    def _begun(self) -> Connection[Any, Any]:
        """The pipe to a process that is ready; raises OSError."""
        if self._running is None:
            pipe, theirs = Pipe()
            words = [str(theirs.fileno()), repr(self.memory_MB)]
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", "studies.arena.solvers.served", *words],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,  # solvers print when they are told not to
                env={**os.environ, **ONE_THREAD, "PYTHONPATH": os.pathsep.join([str(ROOT), *filter(None, sys.path)])},
            )
            theirs.close()
            self._running = process, pipe
            try:
                ready = pipe.poll(STARTUP_S) and pipe.recv()
            except EOFError:
                ready = False
            if not ready:
                self.close()
                raise OSError("the process that solves frozen problems does not start")
        return self._running[1]


def _spent(pid: int) -> tuple[float, bool]:
    """Processor time of another process [s], and whether it sleeps.

    Where the kernel tells neither, NaN, which is never too much, and yes: then the clock decides.
    """
    try:
        told = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return np.nan, True
    state, *numbers = told.rpartition(")")[2].split()
    user, system = numbers[10:12]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK"), state != "R"
