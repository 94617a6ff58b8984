"""The process that solves cells, one after another, and that may be killed.

It is called as ``python -m studies.commands.worker FD ALIVE``.

FD is its end of a pipe, on which orders come and answers go. ALIVE is a pipe on which nothing comes: it closes when the
other side ends, however that ends, and then this process ends at once with all that it has started. Its memory is
limited by the kernel, for each task anew: beyond that, allocations fail.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from studies.ask.request import PartError
from studies.run.task import READY, Limits, Order, Task, end_with, limit

NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO)  # they come without the name of a file, too


def main() -> None:
    """Answer until the other side is gone."""
    end_with(int(sys.argv[2]))
    pipe, orders = Connection(int(sys.argv[1])), queue.SimpleQueue[Order]()
    threading.Thread(target=_listen, args=(pipe, orders), daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the other side decides
    _warm()
    pipe.send(READY)
    while True:
        answer = _answer(*orders.get())
        pipe.send(answer)
        if answer["class"] == "memory":
            os._exit(0)  # what is left of the memory is in pieces


def _warm() -> None:
    """Load what solves, and let BLAS take its buffers, before the first limit: without memory it waits for ever."""
    import numpy as np
    from scipy.linalg import lu_factor

    from studies.solving import solve  # noqa: F401

    square = np.eye(256) + np.ones((256, 256))
    lu_factor(square @ square)


def _listen(pipe: Connection[Any, Order], orders: queue.SimpleQueue[Order]) -> None:
    try:
        while True:
            orders.put(pipe.recv())
    except (EOFError, OSError):
        os._exit(1)  # no other side is left to answer to


def _answer(task: Task, limits: Limits, folder: Path | None) -> dict[str, Any]:
    """{"class", "reason"} of a task that failed, {"class": "", "text": the record} of one that did not."""
    limit(limits.time_s, limits.memory_MB)
    try:
        return {"class": "", "text": DO[task.kind](task, folder)}
    except Exception as error:
        if _is_of_memory(error):
            detail = f": {error}" if str(error) else ""
            return {"class": "memory", "reason": f"more than {limits.memory_MB:g} MB{detail}"}
        if isinstance(error, OSError) and _is_of_store(error, folder):
            return {"class": "disk", "reason": error.strerror}
        if isinstance(error, PartError):
            return {"class": "crash", "reason": str(error)}
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(where.filename).name}:{where.lineno}"
        return {"class": "crash", "reason": f"{type(error).__name__} at {place}: {' '.join(str(error).split())}"}
    finally:
        limit(None, None)


def _is_of_memory(error: BaseException | None) -> bool:
    """True of an allocation that failed, of a library that finds no room to be loaded, and of what comes of either."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        if isinstance(error, ImportError) and os.strerror(errno.ENOMEM) in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def _is_of_store(error: OSError, folder: Path | None) -> bool:
    """True where the folder of a task, or one that it lies in, is what takes nothing: full, read-only, no folder."""
    if error.errno in NO_SPACE:
        return True
    name = Path(str(error.filename))
    return folder is not None and (folder.is_relative_to(name) or name.is_relative_to(folder))


def _record(task: Task, folder: Path | None) -> str:
    from studies.scenes import SCENES
    from studies.scenes.plugins import load
    from studies.solving.solve import record_of

    load(task.use)
    assert task.request is not None
    return record_of(task.id, SCENES[task.request.scene], task.request, folder)


def _table(task: Task, folder: Path | None) -> str:
    from studies.scenes.plugins import load

    load(task.use)
    assert folder is not None
    make_table(task.id, folder)
    return ""


def make_table(name: str, directory: Path) -> bool:
    """Make a table unless the one there was made by the same sources and data; returns whether it was made now."""
    from studies.output.atomic import SCHEMA, write_table_once
    from studies.run.lists import MAKERS
    from studies.run.source_hash import data_of, sources_hash
    from studies.scenes.plugins import modules

    make = resolve_name(MAKERS[name])
    data = b"".join(path.read_bytes() for path in data_of(make.__module__))
    identity = f"{SCHEMA} {sources_hash([make.__module__, *modules()])}"
    identity += f" {hashlib.sha256(data).hexdigest()}" if data else ""
    return write_table_once(directory / f"{name}.csv", identity, make)


def _fuzz(task: Task, folder: Path | None) -> str:
    from studies.fuzz.examine import record_of

    return record_of(task.id)


def _canary(task: Task, folder: Path | None) -> str:
    from studies.run.times import canary

    return json.dumps({"seconds": canary()})


Do = Callable[[Task, Path | None], str]
DO: dict[str, Do] = {"cell": _record, "table": _table, "canary": _canary, "fuzz": _fuzz}


if __name__ == "__main__":
    main()
