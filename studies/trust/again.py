"""A spot check: some cells solved again here, from their requests alone, and held against what they claim.

What a field cannot tell, counters above all, is compared here. Which cells are drawn nobody can know beforehand.
"""

from __future__ import annotations

import secrets
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from studies.campaigns.cell import Cell
from studies.door.plugins import used
from studies.pool.process import Children
from studies.pool.task import Limits, Task
from studies.store.layout import Archive
from studies.trust.foreign import ClaimError

ALL = "all"
COUNTS = 0.1  # relative: another BLAS may turn an iteration, and does not halve their number
FEW = 2  # counts that are never too many
VALUES = 1e-6  # relative, of quantities


def drawn(ids: Sequence[str], number: int) -> set[str]:
    """So many of them, each as likely as the other."""
    return set(secrets.SystemRandom().sample(list(ids), min(number, len(ids))))


@dataclass(frozen=True)
class Again:
    """Cells solved here, in a process with the usual limits; ``lot``: which of them."""

    lot: Collection[str]
    children: Children
    aside: Archive

    def check(self, cell_id: str, cell: Cell, record: Mapping[str, Any]) -> None:
        """Solve a cell of the lot; raises ClaimError where it comes to something else."""
        task = Task("cell", cell_id, replace(cell, artefacts=False), used())
        ended = self.children.perform(task, str(self.aside.root), Limits())
        ours = self.aside.record(cell_id)
        if ours is None:
            raise ClaimError("outcome", f"claimed {record['class']!r}, solved again it ends in {ended!r}")
        compare(record, ours)


@contextmanager
def solving(lot: Collection[str]) -> Iterator[Again]:
    """What solves a lot again; its records are gone with it."""
    with closing(Children()) as children, tempfile.TemporaryDirectory() as folder:
        yield Again(lot, children, Archive(Path(folder)))


def compare(
    record: Mapping[str, Any], ours: Mapping[str, Any], said: str = "solved again {}", *, counted: bool = True
) -> None:
    """Class and quantities and, where ``counted``, loads and counters; raises ClaimError for the first that differs.

    said: of the value that ours has.
    """
    if record["class"] != ours["class"]:
        raise ClaimError("class", f"claimed {record['class']!r}, {said.format(repr(ours['class']))}")
    if counted and len(record["steps"]) != len(ours["steps"]):
        raise ClaimError("steps", f"claimed {len(record['steps'])} loads, {said.format(len(ours['steps']))}")
    compared = {"quantities": (VALUES, 0.0), "counters": (COUNTS, FEW)}
    for kind in ("quantities", "counters") if counted else ("quantities",):
        share, least = compared[kind]
        for name, value in ours[kind].items():
            told = record[kind].get(name)
            numbers = isinstance(told, int | float) and isinstance(value, int | float)
            if told != value and not (numbers and abs(told - value) <= max(share * abs(value), least)):
                raise ClaimError(name, f"claimed {told}, {said.format(value)}")
