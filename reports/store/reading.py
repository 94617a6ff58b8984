"""JSON and CSV files read and checked; whatever is wrong with one ends in a StoreError of one line."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

SCHEMA = 2


class StoreError(ValueError):
    """A store that cannot be reported; its message is the one line the user reads."""


def read_table(path: Path, columns: Iterable[str] = (), comment: str | None = None) -> pd.DataFrame:
    """A CSV file with at least these columns; raises StoreError when it is missing or damaged."""
    table = _read(path, lambda: pd.read_csv(path, comment=comment))
    missing = [column for column in columns if column not in table]
    if missing:
        raise StoreError(f"{path}: lacks the columns {', '.join(missing)}")
    return table


def read_record(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    """A JSON file with at least these keys; raises StoreError when it is missing or damaged."""
    data = _read(path, lambda: json.loads(path.read_text(encoding="utf-8")))
    require(data, keys, path)
    return dict(data)


def read_versioned(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    """As read_record, of this schema."""
    data = read_record(path, ("schema",))
    if data["schema"] != SCHEMA:
        raise StoreError(f"{path}: schema {data['schema']!r}, but this program reads {SCHEMA}")
    require(data, keys, path)
    return data


def require(data: object, keys: Iterable[str], path: Path) -> None:
    """Raises StoreError for what is no record, or lacks a key."""
    if not isinstance(data, Mapping):
        raise StoreError(f"{path}: expected a record, found {type(data).__name__}")
    missing = [key for key in keys if key not in data]
    if missing:
        raise StoreError(f"{path}: lacks {', '.join(missing)}")


def _read(path: Path, reader: Callable[[], Any]) -> Any:
    try:
        return reader()
    except FileNotFoundError:
        raise StoreError(f"{path}: missing") from None
    except (OSError, ValueError) as error:
        raise StoreError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
