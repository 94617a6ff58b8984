"""The store: results on disk, written aside and renamed, so that a reader never sees half a file."""

from __future__ import annotations

import json
import math
import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

SCHEMA = 2
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
