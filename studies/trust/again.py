"""A spot check: some cells solved again here, from their requests alone, and held against what they claim.

What a field cannot tell, counters above all, is compared here. Which cells are drawn nobody can know beforehand.
"""

from __future__ import annotations

import secrets
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from studies.campaigns.cell import Cell
from studies.door.plugins import used
from studies.pool.engine import engine
from studies.pool.task import Limits, Task
from studies.store.layout import Archive
from studies.trust.foreign import Refused

ALL = "all"
COUNTS = 0.1  # relative: another BLAS may turn an iteration, and does not halve their number
FEW = 2  # counts that are never too many
VALUES = 1e-6  # relative, of quantities


def drawn(ids: Sequence[str], number: int) -> set[str]:
    """So many of them, each as likely as the other."""
    return set(secrets.SystemRandom().sample(list(ids), min(number, len(ids))))


def check_again(cell_id: str, cell: Cell, record: Mapping[str, Any]) -> None:
    """Solve a cell in a process with the usual limits; raises Refused where it comes to something else."""
    with tempfile.TemporaryDirectory() as folder:
        task = Task("cell", cell_id, replace(cell, artefacts=False), used())
        ((_, ended),) = engine("serial")([task], Path(folder), Limits())
        ours = Archive(Path(folder)).record(cell_id)
    if ours is None:
        raise Refused("outcome", f"claimed {record['class']!r}, solved again it ends in {ended!r}")
    compare(record, ours)


def compare(record: Mapping[str, Any], ours: Mapping[str, Any]) -> None:
    """Class, loads, quantities and counters; raises Refused for the first that differs."""
    if record["class"] != ours["class"]:
        raise Refused("class", f"claimed {record['class']!r}, solved again {ours['class']!r}")
    if len(record["steps"]) != len(ours["steps"]):
        raise Refused("steps", f"claimed {len(record['steps'])} loads, solved again {len(ours['steps'])}")
    for name, value in ours["quantities"].items():
        _near(name, record["quantities"].get(name), value, VALUES, 0.0)
    for name, value in ours["counters"].items():
        _near(name, record["counters"].get(name), value, COUNTS, FEW)


def _near(name: str, told: Any, ours: Any, share: float, least: float) -> None:
    if told == ours:
        return
    numbers = isinstance(told, int | float) and isinstance(ours, int | float)
    if not numbers or not abs(told - ours) <= max(share * abs(ours), least):
        raise Refused(name, f"claimed {told}, solved again {ours}")
