"""Running a campaign: plan it, solve what is missing, lose nothing, and say how complete it is.

A cell that is in the store is not solved again; one that was stopped, or died, is tried again by every run.

Engines do the tasks. Each gives the same store; which one it was is written nowhere in it.
serial: one after another.  local:N: N threads, each with a process of its own.  dask:ADDRESS: the workers of a
scheduler of dask.distributed, which see the store under the same path; ``ADDRESS`` is tcp://HOST:PORT.
A cell is always solved in a child process that can be killed: a running task of dask cannot.
"""

from __future__ import annotations

import importlib.util
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from studies.ask.scene import UsageError
from studies.output.atomic import SCHEMA, write_json, write_text
from studies.run.archive import Archive, DamagedError
from studies.run.campaign import Campaign
from studies.run.children import Children, StoreFullError, keeping_what_is_finished
from studies.run.plan import Row, plan, solved_rows
from studies.run.task import Limits, Task
from studies.scenes import SCENES
from studies.scenes.data import DATA
from studies.scenes.plugins import used
from studies.solving.result import CLASSES, CRASH, MEMORY, TIME, UNSUPPORTED, WRONG

FAILURES = (WRONG, TIME, MEMORY, CRASH)
Progress = Callable[[int, int, str], None]


@dataclass
class Summary:
    """How a run has ended: cells planned, solved now, their classes; tables asked for, and those that were not made."""

    planned: int
    solved: int = 0
    asked: int = 0
    classes: Counter[str] = field(default_factory=Counter)
    tables: list[str] = field(default_factory=list)

    @property
    def failed(self) -> list[str]:
        """What is not a finding but a failure: cells refused by the judge, stopped or dead, and tables not made."""
        counts = {**{name: self.classes[name] for name in FAILURES}, "tables not made": len(self.tables)}
        return [f"{number} {name}" for name, number in counts.items() if number]

    @property
    def line(self) -> str:
        """One line."""
        counts = ", ".join(f"{self.classes[name]} {name}" for name in CLASSES if self.classes[name])
        summary = f"{self.planned} cells: {counts or 'none'}; {self.solved} solved now"
        if self.asked and not self.planned:
            summary = f"{self.asked - len(self.tables)} of {self.asked} tables"
        return summary + (f"; tables not made: {', '.join(self.tables)}" if self.tables else "")


def run(
    campaign: Campaign,
    store: Path,
    engine: str = "serial",
    limits: Limits = Limits(),  # noqa: B008  frozen
    progress: Progress = lambda done, planned, label: None,
    say: Callable[[str], None] = lambda line: None,
    *,
    resume: bool = False,
    fields: bool = False,
) -> Summary:
    """Solve what is missing of a campaign. Raises UsageError, and StoreFullError with everything finished kept.

    resume: refuse to begin a campaign that this store does not know.  fields: keep those of every cell, so that
    another store can recompute what the cells claim; the plan and the identities stay as they are.
    """
    archive, work = Archive(store), engine_of(engine)
    if resume and not archive.index_path(campaign.name).exists():
        raise UsageError(f"--resume: {store} has no campaign {campaign.name!r} yet; leave --resume out to begin it")
    rows = plan(campaign)
    if rows and not campaign.tables and all(row.id is None for row in rows):
        raise UsageError(f"{campaign.name}: no cell can be solved: {rows[0].reason}")
    with archive.claimed(), keeping_what_is_finished(store):
        tasks = _begun(archive, campaign, rows, say, fields=fields)
        done, summary = len(rows) - len(tasks), Summary(len(rows), asked=len(campaign.tables))
        progress(done, len(rows), "")
        for count, (task, ended) in enumerate(work(tasks, store, limits), start=max(done, 0)):
            summary.solved += task.kind == "cell"
            if task.kind == "table" and ended:
                summary.tables.append(f"{task.label} ({ended})")
                failure = archive.failure(task.id)
                say(f"{task.label}: {failure['reason'] if failure else ended}")
            progress(min(count + 1, len(rows)), len(rows), task.label)
    summary.classes = classes(archive, rows)
    progress(len(rows), len(rows), "done")
    return summary


def classes(archive: Archive, rows: list[Row]) -> Counter[str]:
    """How many cells have ended how."""
    counts: Counter[str] = Counter()
    for row in rows:
        if row.id is None:
            counts[UNSUPPORTED] += 1
            continue
        ended = archive.record(row.id) or archive.failure(row.id)
        counts[ended["class"] if ended else "missing"] += 1
    return counts


def _begun(
    archive: Archive, campaign: Campaign, rows: list[Row], say: Callable[[str], None], *, fields: bool
) -> list[Task]:
    """Write the plan; what is left to do of it. Raises StoreFullError."""
    use = used()
    try:
        write_plan(archive, campaign, rows)
        tables = [Task("table", name, f"table {name}", use=use) for name in campaign.tables]
        return [*tables, *_missing(archive, rows, use, say, fields=fields)]
    except OSError as error:
        raise StoreFullError(f"{error.filename}: {error.strerror}" if error.filename else str(error)) from None


def write_plan(archive: Archive, campaign: Campaign, rows: list[Row]) -> None:
    """The index, and what the pages need to know of the scenes; the same bytes for the same campaign."""
    references = [
        {"scene": scene, **asdict(reference)} for scene in sorted(SCENES) for reference in SCENES[scene].references
    ]
    for table in sorted(DATA.glob("*.csv")):
        write_text(archive.root / "references" / table.name, table.read_text(encoding="utf-8"))
    write_json(archive.root / "references.json", {"schema": SCHEMA, "references": references})
    header = {"schema": SCHEMA, "campaign": campaign.name, "title": campaign.title, "pages": campaign.pages}
    cells = [row.as_json() for row in rows]
    write_json(archive.index_path(campaign.name), {**header, "tables": campaign.tables, "cells": cells})


def _missing(
    archive: Archive, rows: list[Row], use: tuple[str, ...], say: Callable[[str], None], *, fields: bool
) -> list[Task]:
    """The cells without a record, or without the files that are wanted; a damaged one is set aside."""
    tasks = []
    for cell_id, row in solved_rows(rows):
        files = row.cell.artefacts or fields
        try:
            if archive.has(cell_id, files=files):
                continue
        except DamagedError as error:
            say(f"{error}; set aside as {archive.set_aside(cell_id)}, solved again")
        tasks.append(row.task(use, artefacts=files))
    return tasks


MOST = 64
Engine = Callable[[Sequence[Task], Path, Limits], Iterator[tuple[Task, str]]]


def engine_of(name: str) -> Engine:
    """The engine of a name; it yields tasks with their classes as they are done. Raises UsageError."""
    kind, _, rest = name.partition(":")
    if name == "serial":
        return lambda tasks, store, limits: _local(1, tasks, store, limits)
    if kind == "local" and rest.isascii() and rest.isdigit() and 1 <= int(rest) <= MOST:
        return lambda tasks, store, limits: _local(int(rest), tasks, store, limits)
    if kind == "dask" and rest:
        if importlib.util.find_spec("distributed") is None:
            raise UsageError("engine dask needs the extra dask: pip install -e '.[dask]' in the checkout of Footprint")
        return lambda tasks, store, limits: _dask(rest, tasks, store, limits)
    raise UsageError(f"engine {name!r} must be serial, local:N with N in [1, {MOST}], or dask:ADDRESS")


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
