"""What a process is held to that works for another one: it ends with it, and memory and time are limited.

Of a process that solves cells (:mod:`.main`), and of any other that is begun by :class:`.process.Running`.
"""

from __future__ import annotations

import fcntl
import math
import os
import resource
import signal
import sys
from pathlib import Path

READY = "ready"
LATE = 10  # s after its limit, when the other side has not killed this process: the kernel does


def end_with(alive: int) -> None:
    """Have the kernel end this process and its group when a pipe closes, even in the middle of compiled code.

    A thread that waits for it needs the lock of the interpreter, which a factorisation may hold for hours. Without
    signals of input (O_ASYNC), and where nobody heeds them by default (macOS), that thread is all there is.
    """
    if sys.platform == "linux":
        fcntl.fcntl(alive, fcntl.F_SETOWN, -os.getpgrp())
        fcntl.fcntl(alive, fcntl.F_SETFL, fcntl.fcntl(alive, fcntl.F_GETFL) | os.O_ASYNC)


def limit(time_s: float | None, memory_MB: float | None) -> None:
    """Limit private memory beyond what there is, and the time in case no other side does; None takes a limit away."""
    signal.alarm(0 if time_s is None else int(time_s) + LATE)
    # of data, where the kernel counts what numpy allocates there: address space has the libraries in it, twice as much
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    hard = resource.getrlimit(kind)[1]
    data_MB = status_MB("VmData")
    soft = hard if memory_MB is None else int(memory_MB + (0.0 if math.isnan(data_MB) else data_MB)) * 2**20
    resource.setrlimit(kind, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


def status_MB(key: str) -> float:
    """Memory of this process as the kernel counts it: VmData what is private, VmRSS, VmHWM; NaN where it does not."""
    try:
        told = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return math.nan
    return float(told.partition(f"{key}:")[2].split()[0]) / 1024
