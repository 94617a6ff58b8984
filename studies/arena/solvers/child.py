"""A process that solves frozen problems one after another and may be killed: a solver that hangs stops nothing else."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver
from studies.pool.process import ONE_THREAD
from studies.store.source_hash import ROOT

STARTUP_S = 600.0  # on the clock, as on a machine that leaves it one part in a hundred (measured: 170 s for 0.7 s)
PATIENCE = 20  # times as long on the clock, for what sleeps
GRACE_S = 0.5  # for a process that has closed its pipe to be gone


class Child:
    """One process at a time, begun when it is needed and again after it was killed; to be closed.

    limit_s: of a solve [s], of processor time, so that no busy machine fails it; PATIENCE times that on the clock.
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
            if pipe.poll(PATIENCE * self.limit_s):
                answer, peak = pipe.recv()
                return answer, peak
            reason = f"killed after {PATIENCE * self.limit_s:g} s on the clock"
        except (EOFError, OSError):
            reason = "the process died"
        if self.close() == -signal.SIGPROF:
            reason = f"killed after {self.limit_s:g} s"
        return Answer.none(step, reason), np.nan

    def close(self) -> int | None:
        """Kill the process; its exit code, where it has ended by itself."""
        if self._running is None:
            return None
        process, pipe = self._running
        self._running, self._step = None, None
        pipe.close()
        try:
            return process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            return None

    def _begun(self) -> Connection[Any, Any]:
        """The pipe to a process that is ready; raises OSError."""
        if self._running is None:
            pipe, theirs = Pipe()
            words = [str(theirs.fileno()), repr(self.limit_s), repr(self.memory_MB)]
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
