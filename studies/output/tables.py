"""Tables of one result: columns by name, written as CSV. A data frame is made of one where somebody asks for it.

To load pandas takes as long as a small solve; nothing here does.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from studies.output.atomic import write_by

if TYPE_CHECKING:
    import pandas as pd


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
