"""Reference tables as read or computed elsewhere; each file states its source and status in its first lines."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from studies.ask.scene import Reference

if TYPE_CHECKING:
    import pandas as pd

DATA = Path(__file__).parent
At = Mapping[str, float | str]  # where a value is valid
Row = tuple[At, Mapping[str, float]]  # and the values there by quantity


def read_reference(name: str) -> pd.DataFrame:
    """A reference table, its # lines skipped."""
    import pandas as pd  # slow to load: needed for the whole table alone

    return pd.read_csv(DATA / name, comment="#")


def reference_rows(name: str) -> list[dict[str, float]]:
    """The rows of a reference table of numbers, by the names of its columns; NaN where one is blank."""
    with (DATA / name).open(encoding="utf-8") as file:
        lines = csv.DictReader(line for line in file if not line.startswith("#"))
        return [{column: float(value or "nan") for column, value in line.items()} for line in lines]


def references(
    kind: str, source: str, uncertainty: float | Mapping[str, float], rows: Iterable[Row]
) -> tuple[Reference, ...]:
    """Every value of the rows; uncertainty: relative, of all or by quantity."""

    def within(quantity: str) -> float:
        return uncertainty[quantity] if isinstance(uncertainty, Mapping) else uncertainty

    return tuple(
        Reference(quantity, float(value), at, kind, source, within(quantity))
        for at, values in rows
        for quantity, value in values.items()
    )


def tabulated(
    name: str, source: str, uncertainty: float, columns: Mapping[str, tuple[int, float]]
) -> tuple[Reference, ...]:
    """The rows of a table after the unloaded one, the load fraction first; columns: quantity -> column and its sign."""
    rows: list[Row] = []
    for row in [tuple(named.values()) for named in reference_rows(name)[1:]]:
        values = {quantity: sign * row[column] for quantity, (column, sign) in columns.items()}
        rows.append(({"load_fraction": row[0]}, values))
    return references("read", source, uncertainty, rows)
