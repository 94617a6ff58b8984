"""Reference tables as read or computed elsewhere; each file states its source and status in its first lines."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from studies.scene import Reference

DATA = Path(__file__).parent


def read_reference(name: str) -> pd.DataFrame:
    """A reference table, its # lines skipped."""
    return pd.read_csv(DATA / name, comment="#")


def tabulated(
    name: str, source: str, uncertainty: float, columns: Mapping[str, tuple[int, float]]
) -> tuple[Reference, ...]:
    """The rows of a table after the unloaded one, the load fraction first; columns: quantity -> column and its sign."""
    return tuple(
        Reference(quantity, float(sign * row[column]), {"load_fraction": float(row[0])}, "read", source, uncertainty)
        for row in read_reference(name).to_numpy()[1:]
        for quantity, (column, sign) in columns.items()
    )
