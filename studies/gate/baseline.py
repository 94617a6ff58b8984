"""The committed baseline of a campaign: its values, the bounds of each column, and the record of its updates.

Three files side by side: NAME.csv (a line for each value of each cell: label, column, value), tolerances.toml, and
updates.csv (who replaced the baseline, when, why, and what changed).
"""

from __future__ import annotations

import datetime
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.scene import UsageError
from studies.output.atomic import write_table

HERE = Path(__file__).parent.parent / "baseline"
BASELINE = HERE / "quick.csv"
TOLERANCES, UPDATES = "tolerances.toml", "updates.csv"
OUTCOME, COMMAND = "outcome", "command"  # the two columns that are words
COLUMNS = ("label", "column", "value")
WORSE = ("up", "down", "either")


@dataclass(frozen=True)
class Bound:
    """How far a column may move in the direction that is ``worse``; ``cells``: pattern of labels.

    The value may differ by ``absolute`` + ``relative`` times the baseline's.
    """

    column: str
    worse: str
    relative: float
    absolute: float
    owner: str
    date: datetime.date
    reason: str
    cells: str = "*"

    def covers(self, label: str, column: str) -> bool:
        """Does it hold for this value?"""
        return fnmatchcase(column, self.column) and fnmatchcase(label, self.cells)

    def allowed(self, before: float) -> float:
        """The largest change in the direction that is worse."""
        return self.absolute + self.relative * abs(before)

    def exceeded(self, before: float, now: float) -> bool:
        """Is ``now`` worse than allowed? What is not a number is worse than any number."""
        if math.isnan(before) or math.isnan(now):
            return math.isnan(now) and not math.isnan(before)
        if before == now:  # infinities, too
            return False
        change = {"up": now - before, "down": before - now, "either": abs(now - before)}[self.worse]
        return change > self.allowed(before)


def read_bounds(path: Path) -> tuple[Bound, ...]:
    """The bounds in the order of the file; raises UsageError for one without owner, date or reason."""
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8")).get("bound", [])
    except ValueError as error:
        raise UsageError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    return tuple(_bound(entry, f"{path}: bound {number}") for number, entry in enumerate(entries, 1))


def _bound(entry: Mapping[str, Any], where: str) -> Bound:
    if not isinstance(entry, Mapping):
        raise UsageError(f"{where} is not a table: [[bound]] has two brackets")
    where += f" ({entry.get('column', 'no column')})"
    try:
        bound = Bound(**entry)
        allowed = bound.relative, bound.absolute
        held = bound.worse in WORSE and all(0 <= each < math.inf for each in allowed)
        signed = bound.owner.strip() and bound.reason.strip() and type(bound.date) is datetime.date
    except (TypeError, AttributeError) as error:
        raise UsageError(f"{where}: {error}") from None
    if not held:
        raise UsageError(f"{where}: worse must be one of {', '.join(WORSE)}, relative and absolute in [0, inf)")
    if not signed:
        raise UsageError(f"{where}: needs an owner, a reason and a date, as 2026-01-31 without quotes")
    return bound


def bound_of(bounds: tuple[Bound, ...], label: str, column: str) -> Bound:
    """The last bound that covers the value; raises UsageError when none does."""
    for bound in reversed(bounds):
        if bound.covers(label, column):
            return bound
    raise UsageError(f"no bound covers {column} of {label!r}: add one to {TOLERANCES}, with owner, date and reason")


UPDATE = "footprint check --campaign {} --update --owner NAME --reason TEXT"


def read_baseline(path: Path) -> pd.DataFrame:
    """COLUMNS as texts; raises UsageError when it is missing, damaged, has a value twice, or lacks one."""
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
        cells = table.pivot(index="label", columns="column", values="value")
        cells.drop(columns=[OUTCOME, COMMAND]).astype(float)
    except FileNotFoundError:
        raise UsageError(f"{path}: no baseline; {UPDATE.format(path.stem)} makes one") from None
    except (ValueError, KeyError, OSError) as error:
        raise UsageError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    if cells[[OUTCOME, COMMAND]].isna().any(axis=None):
        raise UsageError(f"{path}: a cell has no {OUTCOME} or no {COMMAND}")
    return table


def record_update(path: Path, owner: str, reason: str, now: pd.DataFrame, changed: str) -> None:
    """Add a line to the list of updates beside the baseline ``path``, named as its campaign; now: its new values."""
    line = {
        "date": datetime.date.today().isoformat(),
        "owner": owner.strip(),
        "reason": " ".join(reason.split()),
        "campaign": path.stem,
        "cells": now["label"].nunique(),
        "values": len(now),
        "changed": changed,
    }
    log = path.parent / UPDATES
    known = [pd.read_csv(log, dtype=str)] if log.exists() else []
    write_table(log, pd.concat([*known, pd.DataFrame([line])], ignore_index=True))
