"""The other side of the process that solves cells: starts it, hands it tasks, watches its time, kills it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import weakref
from dataclasses import replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from studies.pool.main import READY
from studies.pool.task import Limits, Order, Task
from studies.store.layout import Archive
from studies.store.source_hash import ROOT

STARTUP_S = 120.0
TABLES_TAKE = 4  # times as long as a cell may
# workers of dask set it: memory that is given back at once is touched anew, which takes three times as long
NOT_PASSED_ON = ("MALLOC_TRIM_THRESHOLD_",)
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class StoreFullError(OSError):
    """The store takes nothing any more."""


class Child:
    """One warm process of :mod:`studies.pool.main`, started when it is needed and again after it was killed."""

    def __init__(self, stopped: threading.Event | None = None) -> None:
        self._started: tuple[subprocess.Popen[bytes], Connection[Order, Any]] | None = None
        self._stopped = stopped or threading.Event()  # nothing is begun any more

    def ask(self, task: Task, limits: Limits, folder: Path | None = None) -> dict[str, Any]:
        """What came of a task; of a process that was killed, or died, {"class", "reason"}."""
        process, pipe = self._started or self._start()
        try:
            if self._stopped.is_set() or self._started is None:
                self.end()
                return {"class": "crash", "reason": "the process that solves cells does not start"}
            pipe.send((task, limits, folder))
            late = {"class": "time", "reason": f"killed after {limits.time_s:g} s"}
            answer = pipe.recv() if pipe.poll(limits.time_s) else late
        except (EOFError, OSError):
            return {"class": "crash", "reason": self._why(process)}
        if answer["class"] in ("time", "memory"):
            self.end()
        return answer

    def kill(self) -> None:
        """Kill the process, and whatever it has started; from any thread. Who waits for its answer sees its end."""
        if self._started is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._started[0].pid, signal.SIGKILL)

    def end(self) -> None:
        """Kill the process and forget it."""
        self.kill()
        if self._started is not None:
            (process, pipe), self._started = self._started, None
            process.wait()
            pipe.close()

    def _start(self) -> tuple[subprocess.Popen[bytes], Connection[Order, Any]]:
        """A new process and this end of its pipe, kept once it is ready."""
        path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {name: value for name, value in os.environ.items() if name not in NOT_PASSED_ON}
        pipe, theirs = Pipe()
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "studies.pool.main", str(theirs.fileno())],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            env={**environment, **ONE_THREAD, "PYTHONPATH": path},
            process_group=0,
        )
        theirs.close()
        self._started = process, pipe
        try:
            ready = pipe.poll(STARTUP_S) and pipe.recv() == READY
        except (EOFError, OSError):
            ready = False
        if not ready:
            self.end()
        return process, pipe

    def _why(self, process: subprocess.Popen[bytes]) -> str:
        """How the process has ended; it is forgotten."""
        try:
            code = process.wait(10)
        except subprocess.TimeoutExpired:
            code = 0
        self.end()
        if code < 0:
            return f"killed by {signal.Signals(-code).name}"
        return f"the process ended by itself, exit code {code}"


class Children:
    """The processes of one engine, one for each thread that asks; they end with it."""

    def __init__(self) -> None:
        self._of_thread = threading.local()
        self._all: list[Child] = []
        self._stopped = threading.Event()
        weakref.finalize(self, _end, self._all)

    def _child(self) -> Child:
        """The child of this thread."""
        if not hasattr(self._of_thread, "child"):
            self._of_thread.child = Child(self._stopped)
            self._all.append(self._of_thread.child)
        return self._of_thread.child

    def stop(self) -> None:
        """Kill all children; what they were doing is dropped, and not taken for their failure."""
        self._stopped.set()
        for child in self._all:
            child.kill()

    def close(self) -> None:
        """Bury the children, once no thread waits for them."""
        _end(self._all)

    def perform(self, task: Task, root: str, limits: Limits) -> str:
        """Have a task done and put what came of it into the store; returns its class, empty for a table that was made.

        Raises StoreFullError.
        """
        archive = Archive(Path(root))
        folder = archive.files(task.id) if task.cell is not None and task.cell.artefacts else None
        if task.kind == "table":
            limits, folder = replace(limits, time_s=TABLES_TAKE * limits.time_s), archive.tables
        answer = self._child().ask(task, limits, folder)
        if self._stopped.is_set():
            return "stopped"
        if answer["class"] == "disk":
            raise StoreFullError(answer["reason"])
        try:
            if answer["class"]:
                archive.note_failure(task.id, {"label": task.label, **answer})
            elif task.kind == "cell":
                archive.keep(task.id, answer["text"])
            else:
                archive.failure_path(task.id).unlink(missing_ok=True)
        except OSError as error:
            raise StoreFullError(error.strerror or str(error)) from error
        return str(answer["class"] or (json.loads(answer["text"])["class"] if task.kind == "cell" else ""))


def _end(children: list[Child]) -> None:
    for child in children:
        child.end()
