"""Stores that are made up: their tables made again after a change, and copies that cost little."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from studies.analysis.everything import compared, written
from studies.analysis.statements.tables import claims_table, statement_tables
from studies.run.collect import collect


def analysed_again(store: Path, campaign: str = "report") -> None:
    """Write the tables of comparisons and of statements, as ``footprint analyse`` does."""
    written(store, campaign, compared(store, campaign, collect(store, campaign)))
    said_again(store, campaign)


def said_again(store: Path, campaign: str = "report") -> None:
    """Write the tables of statements."""
    written(store, campaign, statement_tables(store, campaign))
    written(store, campaign, claims_table(store, campaign))


@contextmanager
def linked(store: Path, to: Path) -> Iterator[Path]:
    """A copy whose files are the same ones until they are replaced; none may be written to, which is looked for."""
    before = _written(store)
    yield Path(shutil.copytree(store, to, copy_function=os.link))
    assert _written(store) == before, "a file that others read was changed in place: replace it, as write_text does"


def _written(store: Path) -> dict[str, int]:
    return {entry.path: entry.stat().st_mtime_ns for entry in _files(store)}


def _files(folder: Path | str) -> Iterator[os.DirEntry[str]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir():
                yield from _files(entry.path)
            else:
                yield entry
