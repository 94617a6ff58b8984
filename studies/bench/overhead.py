"""``footprint bench overhead``: what running a cell costs beside solving it, and what reading a large store costs."""

import statistics
import tempfile
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from studies.output.atomic import SCHEMA, as_text, write_json
from studies.output.stopwatch import WALL, timed
from studies.output.terminal import columns
from studies.run.archive import Archive
from studies.run.campaign import Campaign
from studies.run.children import Children
from studies.run.collect import collect
from studies.run.plan import plan, planned
from studies.run.task import Limits
from studies.scenes.complete import Cell

TRIVIAL = Cell(
    "trivial", "cantilever", {"mesh": "1x1", "measure": "linear"}, {"load_fraction": "0.001"}, artefacts=False
)
SECOND = Cell("of about 1 s", "hemisphere", {"mesh": "24x24"}, artefacts=False)
LARGE = 10_000


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
        return [*_cells(children, root / "cells", repeats), *_store(children, root / "large", large)]


def lines(costs: list[Cost]) -> Iterator[str]:
    """A table for the terminal."""
    rows = [("what", "s", "solve s", "beside ms", "bound")]
    for cost in costs:
        beside = None if cost.solve is None else (f"{cost.solve:.4f}", f"{1e3 * (cost.seconds - cost.solve):.1f}")
        bound = f"{cost.bound}: {'kept' if cost.kept else 'BROKEN'}" if cost.bound else ""
        rows.append((cost.what, f"{cost.seconds:.4f}", *(beside or ("", "")), bound))
    yield from columns(rows, right=range(1, 4))


def _cells(children: Children, root: Path, repeats: int) -> Iterator[Cost]:
    """The whole of a task: to the process and back, the record written and on the disk; the process is warm."""
    for cell, times in ((TRIVIAL, repeats), (SECOND, max(2, repeats // 3))):
        spent, inside = [], []
        for _ in range(1 + times):
            task = planned(cell).task(artefacts=True)
            spent.append(timed(partial(children.perform, task, str(root), Limits()), WALL)[0])
            record = Archive(root).record(task.id)
            assert record is not None
            inside.append(record["timing_s"]["total"])
        beside = statistics.median(a - b for a, b in zip(spent[1:], inside[1:], strict=True))
        total, solve = statistics.median(spent[1:]), statistics.median(inside[1:])
        bound, kept = ("50 ms", beside < 0.05) if cell is TRIVIAL else ("5 %", beside < 0.05 * solve)
        yield Cost(f"cell: {cell.label}", total, total - beside, f"beside the solve under {bound}", kept)


def _store(children: Children, root: Path, count: int) -> Iterator[Cost]:
    """A store of copies of one record is planned, read and filtered."""
    task = planned(TRIVIAL).task(artefacts=True)
    children.perform(task, str(root), Limits())
    archive = Archive(root)
    record = archive.record(task.id)
    assert record is not None
    fractions = [{"load_fraction": f"{1e-6 * (i + 1):.9g}"} for i in range(count)]
    cells = tuple(replace(TRIVIAL, label=f"cell {i}", settings=settings) for i, settings in enumerate(fractions))
    spent, rows = timed(lambda: plan(Campaign("large", "large", cells)), WALL)
    yield Cost(f"{count} cells planned", spent, None, "", True)
    for row in rows:
        archive.record_path(str(row.id)).write_text(as_text({**record, "id": row.id}), encoding="utf-8")
    told = {"schema": SCHEMA, "campaign": "large", "title": "large", "pages": "", "tables": []}
    write_json(archive.index_path("large"), {**told, "cells": [row.as_json() for row in rows]})

    def filtered() -> int:
        table = collect(root, "large")
        return len(table[(table["outcome"] == "converged") & (table["c.dofs"] > 0)])

    spent, found = timed(filtered, WALL)
    assert found == count
    yield Cost(f"{count} cells listed, collected and filtered", spent, None, "under 5 s", spent < 5.0)
