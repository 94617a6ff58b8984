"""The layout of a repository that hands in an algorithm, written from the files that come with the package."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import as_file, files
from pathlib import Path

from studies.scene import UsageError
from studies.store.atomic import write_text

TEMPLATE = "template"


def write_layout(directory: Path) -> list[Path]:
    """Write all files, their names relative to ``directory`` are returned; raises UsageError unless it is empty."""
    if directory.exists() and (not directory.is_dir() or any(directory.iterdir())):
        raise UsageError(f"--template {directory} must be an empty directory, or none yet")
    with as_file(files("studies.arena.card").joinpath(TEMPLATE)) as source:
        written = sorted(_within(source))
        for path in written:
            target = directory / path
            target.parent.mkdir(parents=True, exist_ok=True)
            write_text(target, (source / path).read_text(encoding="utf-8"))
    return written


def _within(source: Path) -> Iterator[Path]:
    for path in source.rglob("*"):
        if path.is_file() and "__pycache__" not in path.parts:
            yield path.relative_to(source)
