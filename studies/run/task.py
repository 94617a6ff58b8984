"""What is asked of a process that solves cells, and what it is held to: it ends with who asks, and keeps to limits.

Only what a warm process has loaded anyway enters here.
"""

from __future__ import annotations

import math
import os
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

from studies.ask.request import Request


@dataclass(frozen=True)
class Limits:
    """Of one cell: seconds of wall time, and MB of private memory beyond an idle process."""

    time_s: float = 900.0
    memory_MB: float = 8192.0


KEPT = ("cell", "fuzz")  # kinds of tasks whose answers are records


@dataclass(frozen=True)
class Task:
    """A cell, a table of the whole store, a random case, or the canary, to be done; all that a worker has to know.

    label: for people.  request: of a cell, as it was resolved.  artefacts: its fields and tables are kept.
    use: the files of plug-ins that are loaded before.
    """

    kind: str
    id: str
    label: str = ""
    request: Request | None = None
    artefacts: bool = False
    use: tuple[str, ...] = ()


Order = tuple[Task, Limits, Path | None]  # and the folder that the files of the task go to, if they are kept


READY = "ready"
LATE = 10  # s after its limit, when the other side has not killed this process: the kernel does
BLOCK = 256  # rows of a matrix that is multiplied in blocks


def end_with(alive: int) -> None:
    """Have the kernel end this process and its group when a pipe closes, even in the middle of compiled code.

    A thread that waits for it needs the lock of the interpreter, which a factorisation may hold for hours. Without
    signals of input (O_ASYNC), and where nobody heeds them by default (macOS), that thread is all there is.
    """
    if sys.platform == "linux":
        import fcntl  # as limits, not there on every system; a solve in its own process does without

        fcntl.fcntl(alive, fcntl.F_SETOWN, -os.getpgrp())
        fcntl.fcntl(alive, fcntl.F_SETFL, fcntl.fcntl(alive, fcntl.F_GETFL) | os.O_ASYNC)


def limit(time_s: float | None, memory_MB: float | None) -> None:
    """Limit private memory beyond what there is, and the time in case no other side does; None takes a limit away."""
    import resource  # as above

    if memory_MB is not None:
        _settle_libraries()
    signal.alarm(0 if time_s is None else int(time_s) + LATE)
    # of data, where the kernel counts what numpy allocates there: address space has the libraries in it, twice as much
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    hard = resource.getrlimit(kind)[1]
    data_MB = status_MB("VmData")
    soft = hard if memory_MB is None else int(memory_MB + (0.0 if math.isnan(data_MB) else data_MB)) * 2**20
    resource.setrlimit(kind, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


def _settle_libraries() -> None:
    """Let both libraries of linear algebra, numpy's and scipy's, take the buffers that they keep: refused one in the
    middle of a product they try for ever.
    """
    import numpy as np  # loaded with a limit alone
    from scipy.linalg import cholesky

    one = np.eye(BLOCK)
    cholesky(one @ one)


def status_MB(key: str) -> float:
    """Memory of this process as the kernel counts it: VmData what is private, VmRSS, VmHWM; NaN where it does not."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return math.nan
    return float(status.partition(f"{key}:")[2].split()[0]) / 1024
