"""``footprint bench overhead``: what starting a command costs, what running a cell costs beside solving it, and what
reading a large store costs.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from studies.analysis.collect import collect
from studies.campaigns.cell import Cell
from studies.campaigns.file import Campaign
from studies.campaigns.plan import Row, identity, plan
from studies.columns import columns
from studies.pool.process import ONE_THREAD, Children
from studies.pool.task import Limits, Task
from studies.store.atomic import SCHEMA, as_text, write_json
from studies.store.layout import Archive
from studies.store.source_hash import ROOT

TRIVIAL = Cell(
    "trivial", "cantilever", {"mesh": "1x1", "measure": "linear"}, {"load_fraction": "0.001"}, artefacts=False
)
SECOND = Cell("of about 1 s", "hemisphere", {"mesh": "24x24"}, artefacts=False)
LARGE = 10_000
FLOOR = ("-c", "import numpy, scipy.linalg, scipy.sparse.linalg")  # nothing is solved without
REFUSED = ("-m", "studies.cli", "solve", "tyre", "--mesh", "0x0", "--out", "unused")  # once all that solves is loaded
MOST_OF_FLOOR = 1.5


@dataclass(frozen=True)
class Cost:
    """One row: what was done, its seconds, those of the solve inside it if any, and the bound it must keep."""

    what: str
    seconds: float
    solve: float | None
    bound: str
    kept: bool


def harness(repeats: int = 9, large: int = LARGE) -> list[Cost]:
    """Medians over repeats; the store lies in a temporary directory."""
    with tempfile.TemporaryDirectory() as folder, closing(Children()) as children:
        root = Path(folder)
        return [
            *_start(root / "compiled", repeats),
            *_cells(children, root / "cells", repeats),
            *_store(children, root / "large", large),
        ]


def lines(costs: list[Cost]) -> Iterator[str]:
    """A table for the terminal."""
    rows = [("what", "s", "solve s", "beside ms", "bound")]
    for cost in costs:
        beside = None if cost.solve is None else (f"{cost.solve:.4f}", f"{1e3 * (cost.seconds - cost.solve):.1f}")
        bound = f"{cost.bound}: {'kept' if cost.kept else 'BROKEN'}" if cost.bound else ""
        rows.append((cost.what, f"{cost.seconds:.4f}", *(beside or ("", "")), bound))
    yield from columns(rows, right=range(1, 4))


def _start(compiled: Path, repeats: int) -> Iterator[Cost]:
    """A solve that is refused before it begins, beside the import of numpy and scipy: processor time, in turns."""
    _spent(FLOOR, compiled), _spent(REFUSED, compiled)
    turns = [(_spent(FLOOR, compiled), _spent(REFUSED, compiled)) for _ in range(repeats)]
    floor, ours = zip(*turns, strict=True)
    ratio = statistics.median(b / a for a, b in turns)
    yield Cost("numpy and scipy imported", statistics.median(floor), None, "", True)
    bound = f"{ratio:.2f} of that, under {MOST_OF_FLOOR:g}"
    yield Cost("command imported, request read", statistics.median(ours), None, bound, ratio < MOST_OF_FLOOR)


def _spent(words: Sequence[str], compiled: Path) -> float:
    """Processor time of a process of Python, user and system [s]; what it compiles is kept, as on installation."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": path, "PYTHONPYCACHEPREFIX": str(compiled)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    done = subprocess.run([sys.executable, "-P", *words], env=environment, capture_output=True, check=False)
    assert done.returncode == (2 if words is REFUSED else 0), done.stderr
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _cells(children: Children, root: Path, repeats: int) -> Iterator[Cost]:
    """The whole of a task: to the process and back, the record written and on the disk; the process is warm."""
    for cell, times in ((TRIVIAL, repeats), (SECOND, max(2, repeats // 3))):
        spent, inside = [], []
        for _ in range(1 + times):
            task = Task("cell", identity(cell), cell)
            start = time.perf_counter()
            children.perform(task, str(root), Limits())
            spent.append(time.perf_counter() - start)
            record = Archive(root).record(task.id)
            assert record is not None
            inside.append(record["timing_s"]["total"])
        beside = statistics.median(a - b for a, b in zip(spent[1:], inside[1:], strict=True))
        total, solve = statistics.median(spent[1:]), statistics.median(inside[1:])
        bound, kept = ("50 ms", beside < 0.05) if cell is TRIVIAL else ("5 %", beside < 0.05 * solve)
        yield Cost(f"cell: {cell.label}", total, total - beside, f"beside the solve under {bound}", kept)


def _store(children: Children, root: Path, count: int) -> Iterator[Cost]:
    """A store of copies of one record is planned, read and filtered."""
    task = Task("cell", identity(TRIVIAL), TRIVIAL)
    children.perform(task, str(root), Limits())
    archive = Archive(root)
    record = archive.record(task.id)
    assert record is not None
    start = time.perf_counter()
    fractions = [{"load_fraction": f"{1e-6 * (i + 1):.9g}"} for i in range(count)]
    cells = tuple(replace(TRIVIAL, label=f"cell {i}", settings=settings) for i, settings in enumerate(fractions))
    rows: list[Row] = plan(Campaign("large", "large", cells))
    yield Cost(f"{count} cells planned", time.perf_counter() - start, None, "", True)
    for row in rows:
        archive.record_path(str(row.id)).write_text(as_text({**record, "id": row.id}), encoding="utf-8")
    told = {"schema": SCHEMA, "campaign": "large", "title": "large", "pages": "", "tables": []}
    write_json(archive.index_path("large"), {**told, "cells": [row.as_json() for row in rows]})
    start = time.perf_counter()
    table = collect(root, "large")
    found = table[(table["outcome"] == "converged") & (table["c.dofs"] > 0)]
    assert len(found) == count
    spent = time.perf_counter() - start
    yield Cost(f"{count} cells listed, collected and filtered", spent, None, "under 5 s", spent < 5.0)
