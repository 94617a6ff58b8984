"""The other side of the process that solves cells: starts it, hands it tasks, watches its time, kills it."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.pool.main import READY
from studies.store.layout import Archive
from studies.store.source_hash import ROOT

STARTUP_S = 120.0
TABLES_TAKE = 4  # times as long as a cell may
# workers of dask set it: memory that is given back at once is touched anew, which takes three times as long
NOT_PASSED_ON = ("MALLOC_TRIM_THRESHOLD_",)
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


@dataclass(frozen=True)
class Limits:
    """Of one cell: seconds of wall time, and MB of private memory beyond an idle process."""

    time_s: float = 900.0
    memory_MB: float = 8192.0


@dataclass(frozen=True)
class Task:
    """A cell, or a table, to be done; everything a worker elsewhere has to know."""

    kind: str
    id: str
    label: str
    scene: str = ""
    options: Mapping[str, Any] | None = None
    settings: Mapping[str, str] | None = None
    files: bool = False
    use: tuple[str, ...] = ()


class StoreFullError(OSError):
    """The store takes nothing any more."""


class Child:
    """One warm process of :mod:`studies.pool.main`, started when it is needed and again after it was killed."""

    def __init__(self, stopped: threading.Event | None = None) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._stopped = stopped or threading.Event()  # nothing is begun any more

    def ask(self, request: Mapping[str, Any], time_s: float) -> dict[str, Any]:
        """The answer to a request; of a process that was killed, or died, {"class", "reason"}."""
        process = self._process or self._start()
        if process is None or self._stopped.is_set():
            self.end()
            return {"class": "crash", "reason": "the process that solves cells does not start"}
        line = self._exchange(process, json.dumps(request), time_s)
        if line is None:
            self.end()
            return {"class": "time", "reason": f"killed after {time_s:g} s"}
        if not line:
            return {"class": "crash", "reason": self._why()}
        answer = json.loads(line)
        if answer["class"] == "memory":
            self.end()
        return dict(answer)

    def kill(self) -> None:
        """Kill the process, and whatever it has started; from any thread. Who waits for its answer sees its end."""
        process = self._process
        if process is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Kill the process and forget it."""
        self.kill()
        process, self._process = self._process, None
        if process is None:
            return
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()

    def _start(self) -> subprocess.Popen[bytes] | None:
        path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
        environment = {name: value for name, value in os.environ.items() if name not in NOT_PASSED_ON}
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "studies.pool.main"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**environment, **ONE_THREAD, "PYTHONPATH": path},
            process_group=0,
        )
        ready = self._exchange(self._process, None, STARTUP_S)
        if not ready or ready.decode().strip() != READY:
            self.end()
        return self._process

    @staticmethod
    def _exchange(process: subprocess.Popen[bytes], line: str | None, time_s: float) -> bytes | None:
        """Write a line and read one; empty when the process has ended, None when it was too slow."""
        assert process.stdin is not None
        assert process.stdout is not None
        if line is not None:
            try:
                process.stdin.write(line.encode() + b"\n")
                process.stdin.flush()
            except OSError:
                return b""
        until = time.monotonic() + time_s
        parts: list[bytes] = []
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            while not parts or not parts[-1].endswith(b"\n"):
                left = until - time.monotonic()
                if left <= 0 or not selector.select(left):
                    return None
                part = os.read(process.stdout.fileno(), 1 << 20)
                if not part:
                    return b""
                parts.append(part)
        return b"".join(parts)

    def _why(self) -> str:
        """How the process has ended; it is forgotten."""
        process = self._process
        assert process is not None
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

    def end(self) -> None:
        """Bury the children, once no thread waits for them."""
        _end(self._all)

    def perform(self, task: Task, root: str, limits: Limits) -> str:
        """Have a task done and put what came of it into the store; returns its class, empty for a table that was made.

        Raises StoreFullError.
        """
        archive = Archive(Path(root))
        time_s = limits.time_s * (TABLES_TAKE if task.kind == "table" else 1)
        request = {
            **{"kind": task.kind, "id": task.id, "name": task.id, "scene": task.scene},
            **{"options": task.options, "settings": task.settings, "use": task.use},
            "files": str(archive.tables if task.kind == "table" else archive.files(task.id)) if task.files else "",
            **{"time_s": time_s, "memory_MB": limits.memory_MB},
        }
        answer = self._child().ask(request, time_s)
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
