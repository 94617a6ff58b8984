"""The other side of the process that solves cells: starts it, hands it tasks, watches its time, kills it."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any

from studies.output.atomic import as_line
from studies.run.archive import Archive
from studies.run.source_hash import ROOT
from studies.run.task import KEPT, READY, Limits, Task

STARTUP_S = 120.0
LAST_WORDS = 300  # characters of the last line that a process has printed before it died
OUT_OF_MEMORY = re.compile(r"memory|alloc", re.IGNORECASE)  # what compiled code says before it aborts
TABLES_TAKE = 4  # times as long as a cell may
# workers of dask set it: memory that is given back at once is touched anew, which takes three times as long
NOT_PASSED_ON = ("MALLOC_TRIM_THRESHOLD_",)
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class StoreFullError(OSError):
    """The store takes nothing any more."""


@contextlib.contextmanager
def keeping_what_is_finished(store: Path) -> Iterator[None]:
    """Say of a store that takes nothing more that what was finished is in it; raises StoreFullError."""
    try:
        yield
    except StoreFullError as error:
        message = f"{store} cannot be written to: {error}; finished cells are kept, run again to continue"
        raise StoreFullError(message) from None


@dataclass(frozen=True, eq=False)
class Running:
    """A process that answers on a pipe; ``alive`` closes with this side, which ends the process, too."""

    process: subprocess.Popen[bytes]
    pipe: Connection[Any, Any]
    alive: IO[bytes]
    printed: IO[bytes]

    @classmethod
    def begun(cls, module: str, *words: str, path: Iterable[str] = ()) -> Running:
        """A module with the number of its end of the pipe, that of ``alive``, and words; path: where it finds more."""
        places = [str(ROOT), *(path or filter(None, [os.environ.get("PYTHONPATH")]))]
        environment = {name: value for name, value in os.environ.items() if name not in NOT_PASSED_ON}
        (pipe, theirs), (ends, alive), printed = Pipe(), os.pipe(), tempfile.TemporaryFile()  # noqa: SIM115  kept
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, str(theirs.fileno()), str(ends), *words],
            pass_fds=[theirs.fileno(), ends],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=printed,
            env={**environment, **ONE_THREAD, "PYTHONPATH": os.pathsep.join(places)},
            process_group=0,
        )
        theirs.close()
        os.close(ends)
        return cls(process, pipe, os.fdopen(alive, "wb"), printed)

    def ready(self, within_s: float = STARTUP_S) -> bool:
        """Whether it has begun to listen."""
        try:
            return self.pipe.poll(within_s) and self.pipe.recv() == READY
        except (EOFError, OSError):
            return False

    def send(self, order: object) -> None:
        """Hand on an order; what was printed before it is forgotten."""
        self.printed.seek(0)
        self.printed.truncate()
        self.pipe.send(order)

    def last_words(self) -> str:
        """The last line that was printed."""
        self.printed.seek(0)
        lines = self.printed.read().decode(errors="replace").split("\n")
        return next((" ".join(line.split())[:LAST_WORDS] for line in reversed(lines) if line.strip()), "")

    def kill(self) -> None:
        """Kill it, and whatever it has started; from any thread."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)

    def buried(self) -> None:
        """Wait for the end of a process that was killed."""
        self.process.wait()
        for each in (self.pipe, self.alive, self.printed):
            each.close()


class Child:
    """One warm process of :mod:`studies.commands.worker`, started when it is needed and again after it was killed."""

    def __init__(self, stopped: threading.Event | None = None) -> None:
        self._running: Running | None = None
        self._stopped = stopped or threading.Event()  # nothing is begun any more

    def ask(self, task: Task, limits: Limits, folder: Path | None = None) -> dict[str, Any]:
        """What came of a task; of a process that was killed, or died, {"class", "reason"}."""
        running = self._running or self._start()
        try:
            if self._stopped.is_set() or self._running is None:
                self.end()
                return {"class": "crash", "reason": "the process that solves cells does not start"}
            running.send((task, limits, folder))
            late = {"class": "time", "reason": f"killed after {limits.time_s:g} s"}
            answer = running.pipe.recv() if running.pipe.poll(limits.time_s) else late
        except (EOFError, OSError):
            return self._death(running, limits)
        if answer["class"] in ("time", "memory"):
            self.end()
        return answer

    def kill(self) -> None:
        """Kill the process, and whatever it has started; from any thread. Who waits for its answer sees its end."""
        if self._running is not None:
            self._running.kill()

    def end(self) -> None:
        """Kill the process and forget it."""
        self.kill()
        if self._running is not None:
            running, self._running = self._running, None
            running.buried()

    def _start(self) -> Running:
        """A new process, kept once it is ready."""
        running = self._running = Running.begun("studies.commands.worker")
        if not running.ready():
            self.end()
        return running

    def _death(self, running: Running, limits: Limits) -> dict[str, str]:
        """How a process has died; it is forgotten. Compiled code that aborts may have said that it was for memory."""
        try:
            code = running.process.wait(10)
        except subprocess.TimeoutExpired:
            code = 0
        words = running.last_words()
        self.end()
        how = f"the process ended by itself, exit code {code}"
        if code < 0:
            how = f"killed by {signal.Signals(-code).name}"
        reason = f"{how}: {words}" if words else how
        if code and OUT_OF_MEMORY.search(words):
            return {"class": "memory", "reason": f"more than {limits.memory_MB:g} MB: {reason}"}
        return {"class": "crash", "reason": reason}


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
        folder = archive.files(task.id) if task.artefacts else None
        if task.kind == "table":
            limits, folder = replace(limits, time_s=TABLES_TAKE * limits.time_s), archive.tables
        answer = self._child().ask(task, limits, folder)
        if self._stopped.is_set():
            return "stopped"
        if answer["class"] == "disk":
            raise StoreFullError(answer["reason"])
        try:
            if answer["class"]:
                archive.note_failure(task.id, {"label": task.label, **answer, "reason": as_line(answer["reason"])})
            elif task.kind in KEPT:
                archive.keep(task.id, answer["text"])
            else:
                archive.failure_path(task.id).unlink(missing_ok=True)
        except OSError as error:
            raise StoreFullError(error.strerror or str(error)) from error
        return str(answer["class"] or (json.loads(answer["text"])["class"] if task.kind in KEPT else ""))


def _end(children: list[Child]) -> None:
    for child in children:
        child.end()
