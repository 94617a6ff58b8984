"""The committed baseline of a campaign: its values, the bounds of each column, and the record of its updates.

Three files side by side: NAME.csv (a line for each value of each cell: label, column, value), tolerances.toml, and
updates.csv (who replaced the baseline, when, why, and what changed).
"""

from __future__ import annotations

import datetime
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
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

    The value may be off by ``absolute`` + ``relative`` times the baseline's.
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
        """Is ``now`` worse than allowed? What is no number is worse than any number."""
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
    except FileNotFoundError:
        raise UsageError(f"{path}: missing; the bounds of the baseline stand there") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(entries, list) or not entries:
        raise UsageError(f"{path}: has no [[bound]]")
    return tuple(_bound(entry, f"{path}: bound {number}") for number, entry in enumerate(entries, 1))


def _bound(entry: Mapping[str, Any], where: str) -> Bound:
    where += f" ({entry.get('column', 'no column')})"
    for key in ("owner", "reason"):
        if not str(entry.get(key, "")).strip():
            raise UsageError(f"{where}: needs an {key}" if key == "owner" else f"{where}: needs a {key}")
    if type(entry.get("date")) is not datetime.date:
        raise UsageError(f"{where}: needs a date, as 2026-01-31 without quotes")
    names = [field.name for field in fields(Bound)]
    strange = [key for key in entry if key not in names] + [n for n in names if n != "cells" and n not in entry]
    if strange:
        raise UsageError(f"{where}: {strange[0]!r} must be given, and nothing but {', '.join(names)}")
    if entry["worse"] not in WORSE:
        raise UsageError(f"{where}: worse = {entry['worse']!r} must be one of {', '.join(WORSE)}")
    for key in ("relative", "absolute"):
        if isinstance(entry[key], bool) or not isinstance(entry[key], int | float) or not 0 <= entry[key] < math.inf:
            raise UsageError(f"{where}: {key} = {entry[key]!r} must be a number in [0, inf)")
    return Bound(**entry)


def bound_of(bounds: tuple[Bound, ...], label: str, column: str) -> Bound:
    """The last bound that covers the value; raises UsageError when none does."""
    for bound in reversed(bounds):
        if bound.covers(label, column):
            return bound
    raise UsageError(f"no bound covers {column} of {label!r}: add one to {TOLERANCES}, with owner, date and reason")


def read_baseline(path: Path) -> pd.DataFrame:
    """COLUMNS as texts; raises UsageError when it is missing, damaged, empty, has a value twice, or lacks one."""
    try:
        table = pd.read_csv(path, dtype=str, keep_default_na=False)
    except FileNotFoundError:
        raise UsageError(
            f"{path}: no baseline; footprint check --update --owner NAME --reason TEXT makes one"
        ) from None
    except (ValueError, OSError) as error:
        raise UsageError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    if tuple(table.columns) != COLUMNS:
        raise UsageError(f"{path}: must have the columns {', '.join(COLUMNS)}")
    twice = table[table.duplicated(["label", "column"])]
    if len(twice):
        raise UsageError(f"{path}: {twice['column'].iloc[0]} of {twice['label'].iloc[0]!r} stands there twice")
    numbers = table[~table["column"].isin((OUTCOME, COMMAND))]
    wrong = numbers[pd.to_numeric(numbers["value"], errors="coerce").isna() & (numbers["value"] != "nan")]
    if len(wrong):
        raise UsageError(f"{path}: {wrong['value'].iloc[0]!r} of {wrong['label'].iloc[0]!r} is no number")
    for column in (OUTCOME, COMMAND):
        without = table[~table["label"].isin(table["label"][table["column"] == column])]
        if len(without):
            raise UsageError(f"{path}: {without['label'].iloc[0]!r} has no {column}")
    return table


@dataclass(frozen=True)
class Update:
    """Who replaces a baseline, why, and by which campaign; raises UsageError without an owner or a reason."""

    owner: str
    reason: str
    campaign: str

    def __post_init__(self) -> None:
        if not self.owner.strip() or not self.reason.strip():
            raise UsageError("a baseline is updated with --owner NAME and --reason TEXT only")

    def record(self, path: Path, now: pd.DataFrame, changed: str) -> None:
        """Add a line to the list of updates beside the baseline ``path``; now: its new values."""
        line = {
            "date": datetime.date.today().isoformat(),
            "owner": self.owner.strip(),
            "reason": " ".join(self.reason.split()),
            "campaign": self.campaign,
            "cells": now["label"].nunique(),
            "values": len(now),
            "changed": changed,
        }
        log = path.parent / UPDATES
        known = [pd.read_csv(log, dtype=str)] if log.exists() else []
        write_table(log, pd.concat([*known, pd.DataFrame([line])], ignore_index=True))
