"""What a submission claims of which task, with which choice: a TOML file that nobody vouches for.

A table a task: ``claim`` is "met", with what is chosen beside it, or "cannot", alone.
Whatever is wrong with the file ends in a UsageError of one line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import read_toml
from studies.arena.tasks.catalogue import GradedTask, Text, tasks
from studies.ask.request import UsageError, text_of

MET, CANNOT, NONE = "met", "cannot", ""
CLAIMS = (MET, CANNOT)
LONGEST = 80  # characters of a value


@dataclass(frozen=True)
class Claim:
    """What is said of a task, and what is chosen for it."""

    said: str = NONE
    chosen: Text = field(default_factory=dict)


def read_submission(path: Path) -> dict[str, Claim]:
    """The claims by task; raises UsageError, and OSError where the file cannot be opened."""
    try:
        tables = read_toml(path)
    except ValueError as error:
        raise UsageError(f"{path} is no submission: {str(error).splitlines()[0].partition(';')[0][:200]}") from None
    submission = {}
    for name, table in tables.items():
        task = tasks().get(name)
        if task is None:
            raise UsageError(f"{path}: {name[:40]!r} is none of the {len(tasks())} tasks, see footprint tasks")
        try:
            submission[name] = _claim(task, table)
        except UsageError as error:
            raise UsageError(f"{path}: {name}: {error}") from None
    return submission


def _claim(task: GradedTask, table: Any) -> Claim:
    if not isinstance(table, Mapping):
        raise UsageError(f"{str(table)[:40]!r} must be a table")
    chosen = {key: _text(key, value) for key, value in table.items() if key != "claim"}
    task.check(chosen)
    if "claim" not in table:
        raise UsageError(f"claim is missing: it must be {' or '.join(CLAIMS)}")
    said = table["claim"]
    if said not in CLAIMS:
        raise UsageError(f"claim = {str(said)[:40]!r} must be {' or '.join(CLAIMS)}")
    if said == CANNOT and chosen:
        raise UsageError(f"claim = {CANNOT!r} stands alone, without {next(iter(chosen))}")
    return Claim(said, chosen)


def _text(key: str, value: Any) -> str:
    """A value as it is written after KEY=; raises UsageError for what is no text, number or list of numbers."""
    values = value if isinstance(value, list) else [value]
    kinds: tuple[type, ...] = (int, float) if isinstance(value, list) else (int, float, str)
    if not values or len(values) > LONGEST or any(isinstance(v, bool) or not isinstance(v, kinds) for v in values):
        raise UsageError(f"{key[:40]!r} must be a text, a number or a list of numbers")
    if any(isinstance(v, int) and abs(v) > 10**LONGEST for v in values) or len(text := text_of(value)) > LONGEST:
        raise UsageError(f"{key[:40]!r} has more than {LONGEST} characters")
    return text
