"""A store that is changed: records of cells by their labels, and tables by their names."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd

from studies.output.atomic import write_json, write_table


def place(root: Path, label: str, campaign: str = "report") -> Path:
    """The directory of the cell with this label."""
    index = json.loads((root / "campaigns" / f"{campaign}.json").read_text(encoding="utf-8"))
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == label)


def edit_json(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    data = json.loads(path.read_text(encoding="utf-8"))
    change(data)
    write_json(path, data)


def edit_table(root: Path, name: str, change: Callable[[pd.DataFrame], pd.DataFrame]) -> None:
    path = root / "tables" / f"{name}.csv"
    write_table(path, change(pd.read_csv(path)))


def set_values(root: Path, name: str, row: int, **columns: object) -> None:
    """Give a row of a table other values."""
    edit_table(root, name, lambda data: data.astype(dict.fromkeys(columns, object)).pipe(_set, row, columns))


def _set(data: pd.DataFrame, row: int, columns: dict[str, object]) -> pd.DataFrame:
    data.loc[row, list(columns)] = list(columns.values())
    return data
