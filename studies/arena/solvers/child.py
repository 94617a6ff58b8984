"""A process that solves frozen problems one after another and may be killed: a solver that hangs stops nothing else.

Peak memory is that of the process: resident memory at its highest during a solve, which Linux resets on request, less
that before it, once what is free has been handed back. Matrices that a solver copies are in it, the problem is not.
Where the kernel tells no such thing, it is NaN.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import multiprocessing
import os
import resource
import signal
import sys
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from contact.interchange.linearised_step import FrozenStep
from studies.arena.solvers.base import Answer, Solver
from studies.pool.process import ONE_THREAD, STARTUP_S

PATIENCE = 5
GRACE_S = 0.2  # for a process that has closed its pipe to be gone
STATUS, RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")


class Child:
    """One process at a time, begun when it is needed and again after it was killed; to be closed.

    limit_s: of a solve [s], of processor time, so that no busy machine fails it; PATIENCE times that on the clock.
    memory_MB: private memory beyond what the process begins with.
    """

    def __init__(self, limit_s: float, memory_MB: float = 8000.0) -> None:
        self.limit_s, self.memory_MB = limit_s, memory_MB
        self._running: tuple[multiprocessing.process.BaseProcess, Connection[Any, Any]] | None = None
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
        process.join(GRACE_S)
        ended = process.exitcode
        process.kill()
        process.join()
        return ended

    def _begun(self) -> Connection[Any, Any]:
        if self._running is None:
            context = multiprocessing.get_context("spawn")
            pipe, theirs = context.Pipe()
            process = context.Process(target=_serve, args=(theirs, self.limit_s, self.memory_MB), daemon=True)
            with _one_thread():
                process.start()
            theirs.close()
            self._running = process, pipe
            if not (pipe.poll(STARTUP_S) and pipe.recv()):
                raise OSError("the process that solves does not start")
        return self._running[1]


@contextlib.contextmanager
def _one_thread() -> Iterator[None]:
    """The environment of a process whose libraries take one thread each."""
    before = dict(os.environ)
    os.environ.update(ONE_THREAD)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _serve(pipe: Connection[Any, Any], limit_s: float, memory_MB: float) -> None:
    """Answer until the other side is gone; what solvers print goes nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # the end, in the middle of compiled code, too
    _limit(memory_MB)
    pipe.send(True)
    step: FrozenStep | None = None
    with contextlib.suppress(EOFError, OSError):
        while True:
            order = pipe.recv()
            if isinstance(order, FrozenStep):
                step = order
            elif step is not None:
                solver, tolerance = order
                solver.prepare(step)
                pipe.send(True)
                signal.setitimer(signal.ITIMER_PROF, limit_s)
                answer = _measured(solver, step, tolerance)
                signal.setitimer(signal.ITIMER_PROF, 0.0)
                pipe.send(answer)


def _measured(solver: Solver, step: FrozenStep, tolerance: float) -> tuple[Answer, float]:
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
    """Beyond it allocations fail; of data, where the kernel counts what numpy allocates there."""
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    begun, hard = _resident_MB("VmData"), resource.getrlimit(kind)[1]
    soft = int((memory_MB + (0.0 if np.isnan(begun) else begun)) * 2**20)
    resource.setrlimit(kind, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))
