"""A campaign of six small cells, and the content of its store without what differs from run to run.

Stores that are made up: their tables made again after a change, and copies that cost little.
"""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from studies.analysis.everything import compared, written
from studies.analysis.statements.tables import claims_table, statement_tables
from studies.run.campaign import find
from studies.run.collect import collect
from studies.run.running import Summary, run

SMALL = """
title = "small"
[[cross]]
name = "small"
contacts = ["semismooth", "qp"]
tolerances = [1e-9]
[cross.scenes.cantilever]
meshes = ["2x1", "4x1"]
[cross.scenes.strip-contact]
meshes = ["4x1", "8x1"]
set = { load_fraction = "5" }
"""
APART = ("timing_s", "provenance")


def small(folder: Path) -> Path:
    """Write the file of the campaign."""
    path = folder / "small.toml"
    path.write_text(SMALL)
    return path


def again(folder: Path, store: Path, **options: Any) -> Summary:
    """Solve what is missing."""
    return run(find(str(small(folder))), store, **options)


def content(store: Path) -> dict[str, Any]:
    """Everything in a store apart from timings and provenance."""
    by_name: dict[str, Any] = {}
    for path in sorted(each for each in store.rglob("*") if each.is_file() and each.name != ".lock"):
        name = path.relative_to(store).as_posix()
        by_name[name] = path.read_bytes()
        if name.startswith("cells/") and name.endswith(".json"):
            record = json.loads(by_name[name])
            by_name[name] = {key: value for key, value in record.items() if key not in APART}
    return by_name


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
