"""Texts onto the disk, by a temporary name and a rename, so that no reader sees half a page."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path


def write_texts(directory: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write texts by their names relative to ``directory``; returns the paths in the order given."""
    for name, text in texts.items():
        _write(directory / name, text)
    return [directory / name for name in texts]


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=".part-", suffix=path.suffix)
    temporary = Path(name)
    try:
        with os.fdopen(descriptor, "w", encoding="utf-8", newline="\n") as file:
            file.write(text)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
