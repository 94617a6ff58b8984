"""Texts onto the disk, by a temporary name and a rename, so that no reader sees half a page.

One whose name ends in ``.gz`` is compressed, the same text always to the same bytes.
"""

from __future__ import annotations

import gzip
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
        with os.fdopen(descriptor, "wb") as file:
            file.write(as_bytes(path.name, text))
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def as_bytes(name: str, text: str) -> bytes:
    """What a file of this name holds."""
    return gzip.compress(text.encode(), mtime=0) if name.endswith(".gz") else text.encode()
