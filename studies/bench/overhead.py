"""``footprint bench overhead``: what running a cell costs beside solving it."""

import statistics
import tempfile
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import pandas as pd

from studies.output.stopwatch import WALL, timed
from studies.run.archive import Archive
from studies.run.children import Children
from studies.run.plan import planned
from studies.run.task import Limits
from studies.scenes.complete import Cell

TRIVIAL = Cell(
    "trivial", "cantilever", {"mesh": "1x1", "measure": "linear"}, {"load_fraction": "0.001"}, artefacts=False
)
SECOND = Cell("of about 1 s", "hemisphere", {"mesh": "24x24"}, artefacts=False)
REPEATS = 9


@dataclass(frozen=True)
class Cost:
    """One row: what was done, its seconds, those of the solve inside it, and the bound it must keep."""

    what: str
    seconds: float
    solve: float
    bound: str
    kept: bool


def harness(repeats: int = REPEATS) -> list[Cost]:
    """Medians over repeats; the store lies in a temporary directory."""
    with tempfile.TemporaryDirectory() as folder, closing(Children()) as children:
        return list(_cells(children, Path(folder), repeats))


def shown(costs: list[Cost]) -> str:
    """A table for the terminal."""
    table = pd.DataFrame(costs).assign(beside_ms=[1e3 * (cost.seconds - cost.solve) for cost in costs])
    return table.to_string(index=False, float_format="{:.4f}".format)


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
