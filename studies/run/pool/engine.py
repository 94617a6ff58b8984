"""Engines: who does the tasks of a campaign. Each gives the same store; which one it was is written nowhere in it.

serial: one after another.  local:N: N threads, each with a process of its own.  dask:ADDRESS: the workers of a
scheduler of dask.distributed, which see the store under the same path; ``ADDRESS`` is tcp://HOST:PORT.
A cell is always solved in a child process that can be killed: a running task of dask cannot.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from pathlib import Path
from typing import Any

from studies.ask.scene import UsageError
from studies.run.pool.process import Children, StoreFullError
from studies.run.pool.task import Limits, Task
from studies.run.store.layout import Archive
from studies.solving.result import CRASH

MOST = 64
Engine = Callable[[Sequence[Task], Path, Limits], Iterator[tuple[Task, str]]]


def engine(name: str) -> Engine:
    """The engine of a name; it yields tasks with their classes as they are done. Raises UsageError."""
    kind, _, rest = name.partition(":")
    if name == "serial":
        return _serial
    if kind == "local" and rest.isascii() and rest.isdigit() and 1 <= int(rest) <= MOST:
        return lambda tasks, store, limits: _local(int(rest), tasks, store, limits)
    if kind == "dask" and rest:
        if importlib.util.find_spec("distributed") is None:
            raise UsageError("engine dask needs the extra dask: pip install -e '.[dask]' in the checkout of Footprint")
        return lambda tasks, store, limits: _dask(rest, tasks, store, limits)
    raise UsageError(f"engine {name!r} must be serial, local:N with N in [1, {MOST}], or dask:ADDRESS")


def _serial(tasks: Sequence[Task], store: Path, limits: Limits) -> Iterator[tuple[Task, str]]:
    with closing(Children()) as children:
        for task in tasks:
            yield task, children.perform(task, str(store), limits)


def _local(n: int, tasks: Sequence[Task], store: Path, limits: Limits) -> Iterator[tuple[Task, str]]:
    """The threads only wait; the first exception, or an interruption, drops what was not begun."""
    with closing(Children()) as children, ThreadPoolExecutor(n) as pool:
        try:
            futures = {pool.submit(children.perform, task, str(store), limits): task for task in tasks}
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            children.stop()


def _dask(address: str, tasks: Sequence[Task], store: Path, limits: Limits) -> Iterator[tuple[Task, str]]:
    """One key a task, never twice: what a failure is, and whether it is tried again, is decided here and not there."""
    from distributed import Client
    from distributed import as_completed as completed

    try:
        client = Client(address, timeout="20s")
    except (OSError, ValueError) as error:
        raise UsageError(f"engine dask:{address}: {' '.join(str(error).split())}") from None
    with client:
        root = str(store.resolve())
        futures = {
            client.submit(
                _on_worker, task, root, limits, key=f"footprint-{task.id}-{root}", pure=False, retries=0
            ): task
            for task in tasks
        }
        try:
            for future in completed(futures):
                yield futures[future], _result(future, futures[future], store)
        finally:
            client.cancel(list(futures))


def _on_worker(task: Task, root: str, limits: Limits) -> str:
    """Done by the worker of dask that this runs on, which keeps its children from task to task."""
    from distributed import get_worker

    children = vars(get_worker()).setdefault("footprint_children", Children())
    return str(children.perform(task, root, limits))


def _result(future: Any, task: Task, store: Path) -> str:
    """The class of a task; where its worker was lost for good, that is a failure like any other."""
    try:
        return str(future.result())
    except StoreFullError:
        raise
    except Exception as error:
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        Archive(store).note_failure(task.id, {"label": task.label, "class": CRASH, "reason": reason})
        return CRASH
