"""Results on disk: text, JSON and tables, written aside and renamed, so that a reader never sees half a file.

To load pandas takes as long as a small solve; nothing here does, but where somebody asks for a data frame.
"""

from __future__ import annotations

import csv
import json
import math
import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = 2
LONGEST = 8000  # characters of a text
OWN = re.compile(r"(figures/)?[A-Za-z0-9_-]+\.(csv|svg|vtu|pvd)")  # what an answer may have written beside its record
PART = ".part-"  # how a file begins that is being written


def write_text(path: Path, text: str) -> None:
    """Write a text file by a temporary name; it is on the disk before it has its own."""

    def write(temporary: Path) -> None:
        with temporary.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())

    write_by(path, write)


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write strict JSON (infinities become the strings "inf" and "-inf", NaN becomes null)."""
    write_text(path, as_text(data))


def as_text(data: Mapping[str, Any]) -> str:
    """The text that write_json writes."""
    return json.dumps(plain(data), indent=1, allow_nan=False) + "\n"


def as_line(text: str) -> str:
    """A text of ours as a word: the messages of libraries may have several lines."""
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(text.split()))[:LONGEST]


def write_table(path: Path, table: pd.DataFrame) -> None:
    """Write a data frame as CSV with the shortest digits that read back to the same numbers."""
    write_by(path, lambda temporary: table.to_csv(temporary, index=False))


def write_table_once(path: Path, identity: str, make: Callable[[], pd.DataFrame]) -> bool:
    """Make and write a table unless the one that is there has this identity; returns whether it was made now.

    The identity stands beside the table, with the suffix .id. It goes first and comes last, so that a table without
    one, or with another, is made anew whenever it was stopped.
    """
    beside = path.with_suffix(".id")
    if path.exists() and beside.exists() and beside.read_text(encoding="utf-8") == identity:
        return False
    table = make()
    beside.unlink(missing_ok=True)
    write_table(path, table)
    write_text(beside, identity)
    return True


def write_by(path: Path, writer: Callable[[Path], object]) -> None:
    """Let ``writer`` fill a temporary file beside ``path``, then rename it; nothing is left behind on failure."""
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=PART, suffix=path.suffix)
    os.close(descriptor)
    temporary = Path(name)
    try:
        writer(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def forget(directory: Path, record: str, kept: Iterable[str]) -> None:
    """Remove what the record in a directory says to have written beside it, but for what is ``kept``.

    What it does not name, or by a name that no answer gives, is somebody else's: that is never touched.
    """
    for name in _named(directory / record) - {*kept}:
        (directory / name).unlink(missing_ok=True)


def _named(record: Path) -> set[str]:
    """None elsewhere, whatever it says."""
    try:
        files = json.loads(record.read_text(encoding="utf-8"))["files"]
        return {name for name in files if OWN.fullmatch(name)}
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return set()


def plain(data: Any) -> Any:
    """The data as JSON knows it."""
    if isinstance(data, Mapping):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [plain(value) for value in data]
    if hasattr(data, "item"):
        data = data.item()
    if isinstance(data, float) and not math.isfinite(data):
        return None if math.isnan(data) else str(data)
    return data + 0.0 if isinstance(data, float) else data  # + 0.0: no negative zero


@dataclass(frozen=True, eq=False)
class Table:
    """columns: name -> n values, all of the same length; None and NaN stand for a value that is missing."""

    columns: Mapping[str, Sequence[Any]]

    @classmethod
    def of(cls, columns: Mapping[str, Any]) -> Table:
        """Columns of arrays (n,), and of numbers and words that hold for all n rows."""
        values = np.broadcast_arrays(*columns.values())
        return cls({name: each.tolist() for name, each in zip(columns, values, strict=True)})

    @classmethod
    def of_rows(cls, rows: Sequence[Mapping[str, Any]], names: Iterable[str] = ()) -> Table:
        """Rows by name; where there is none, the columns of ``names`` are there all the same."""
        keys = dict.fromkeys(key for row in rows for key in row) if rows else names
        return cls({key: [row.get(key) for row in rows] for key in keys})

    @classmethod
    def stacked(cls, tables: Sequence[Table]) -> Table:
        """The rows of all, in order; a column that some of them lack is blank there."""
        parts = [(len(table), table.columns) for table in tables]
        names = dict.fromkeys(name for _, columns in parts for name in columns)
        return cls({name: [v for n, columns in parts for v in columns.get(name, [None] * n)] for name in names})

    def with_column(self, name: str, value: float) -> Table:
        """The same with a column before the others, of one value for all rows."""
        return Table({name: [value] * len(self), **self.columns})

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def rows(self) -> Iterator[dict[str, Any]]:
        """One by one, by name."""
        for values in zip(*self.columns.values(), strict=True):
            yield dict(zip(self.columns, values, strict=True))

    def frame(self) -> pd.DataFrame:
        """The same as a data frame."""
        import pandas as pd

        return pd.DataFrame(self.columns)

    def write(self, path: Path) -> None:
        """Write as CSV with the shortest digits that read back to the same numbers; what is missing is left blank."""
        write_by(path, self._write)

    def _write(self, path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(zip(*map(_present, self.columns.values()), strict=True))


def _present(values: Iterable[Any]) -> Iterator[Any]:
    """NaN is the only value that differs from itself."""
    return (value if value == value else None for value in values)
