"""Reference tables as read or computed elsewhere; each file states its source and status in its first lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import pandas as pd

from studies.scene import Reference

DATA = Path(__file__).parent
At = Mapping[str, float | str]  # where a value holds
Row = tuple[At, Mapping[str, float]]  # and the values there by quantity


def read_reference(name: str) -> pd.DataFrame:
    """A reference table, its # lines skipped."""
    return pd.read_csv(DATA / name, comment="#")


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
    found: list[Row] = []
    for row in read_reference(name).to_numpy()[1:]:
        values = {quantity: sign * row[column] for quantity, (column, sign) in columns.items()}
        found.append(({"load_fraction": float(row[0])}, values))
    return references("read", source, uncertainty, found)
