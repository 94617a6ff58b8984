"""The process that solves cells, one after another, and that may be killed: ``python -m studies.pool.main``.

It reads tasks from its standard input, a line of JSON each, and answers on what was its standard output. It ends when
the other side does. Its memory is limited by the kernel, for each task anew: beyond that, allocations fail.
"""

from __future__ import annotations

import errno
import json
import os
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

READY = "ready"
LATE = 10  # s after its limit, when nobody has killed this process: the kernel does
NO_SPACE = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO)


def main() -> None:
    """Answer until the input ends."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # whoever prints, prints no answer
    tasks: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin, tasks), daemon=True).start()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the other side decides
    _warm()
    answers.write(READY + "\n")
    answers.flush()
    while True:
        answer = _answer(json.loads(tasks.get()))
        answers.write(json.dumps(answer) + "\n")
        answers.flush()
        if answer["class"] == "memory":
            os._exit(0)  # what is left of the memory is in pieces


def _warm() -> None:
    """Load what solves, and let BLAS take its buffers, before the first limit: without memory it waits for ever."""
    import numpy as np
    from scipy.linalg import lu_factor

    from studies import solving  # noqa: F401

    square = np.eye(256) + np.ones((256, 256))
    lu_factor(square @ square)


def _listen(source: IO[str], tasks: queue.SimpleQueue[str]) -> None:
    for line in source:
        tasks.put(line)
    os._exit(1)  # nobody is left to answer to


def _answer(task: dict[str, Any]) -> dict[str, Any]:
    """{"class", "reason"} of a task that failed, {"class": "", "text": the record} of one that did not."""
    _limit(task["time_s"], task["memory_MB"])
    try:
        return {"class": "", "text": DO[task["kind"]](task)}
    except MemoryError as error:
        said = f": {error}" if str(error) else ""
        return {"class": "memory", "reason": f"more than {task['memory_MB']:g} MB{said}"}
    except OSError as error:
        if error.errno in NO_SPACE:
            return {"class": "disk", "reason": error.strerror}
        return _crashed(error)
    except Exception as error:
        return _crashed(error)
    finally:
        _limit(None, None)


def _crashed(error: Exception) -> dict[str, Any]:
    where = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{Path(where.filename).name}:{where.lineno}"
    return {"class": "crash", "reason": f"{type(error).__name__} at {place}: {' '.join(str(error).split())}"}


def _limit(time_s: float | None, memory_MB: float | None) -> None:
    """Limit private memory beyond what there is, and the time in case nobody watches; None takes a limit away."""
    signal.alarm(0 if time_s is None else int(time_s) + LATE)
    try:
        import resource
    except ModuleNotFoundError:
        return
    # of data, where the kernel counts what numpy allocates there: address space has the libraries in it, twice as much
    kind = resource.RLIMIT_DATA if sys.platform == "linux" else resource.RLIMIT_AS
    hard = resource.getrlimit(kind)[1]
    soft = hard if memory_MB is None else int(_data_MB() + memory_MB) * 2**20
    resource.setrlimit(kind, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


def _data_MB() -> float:
    """Private memory of this process."""
    try:
        told = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return 0.0
    return float(told.partition("VmData:")[2].split()[0]) / 1024


def _record(task: dict[str, Any]) -> str:
    from studies.door.plugins import load
    from studies.store.record import record_of

    load(task["use"])
    directory = Path(task["files"]) if task["files"] else None
    return record_of(task["id"], task["scene"], task["options"], task["settings"], directory)


def _table(task: dict[str, Any]) -> str:
    from studies.door.plugins import load

    load(task["use"])
    from studies.experiments.tables import make_table

    make_table(task["name"], Path(task["files"]))
    return ""


def _canary(task: dict[str, Any]) -> str:
    from studies.bench.canary import canary

    return json.dumps({"seconds": canary()})


DO: dict[str, Callable[[dict[str, Any]], str]] = {"cell": _record, "table": _table, "canary": _canary}


if __name__ == "__main__":
    main()
