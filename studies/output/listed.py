"""The files that an answer names in its record, and those of the answer before it in the same directory.

What is there and is not named, or has a name that no answer gives, is somebody else's: it is never touched.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from pathlib import Path

OWN = re.compile(r"(figures/)?[A-Za-z0-9_-]+\.(csv|svg|vtu|pvd)")  # what an answer may have written beside its record


def forget(directory: Path, record: str, kept: Iterable[str]) -> None:
    """Remove what the record in a directory says to have written beside it, but for what is ``kept``."""
    for name in _named(directory / record) - {*kept}:
        (directory / name).unlink(missing_ok=True)


def _named(record: Path) -> set[str]:
    """None elsewhere, whatever it says."""
    try:
        told = json.loads(record.read_text(encoding="utf-8"))["files"]
        return {name for name in told if OWN.fullmatch(name)}
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return set()
