"""A store that nobody vouches for, before pages are made of it: files within bounds, values of their declared types.

Whether it has what a page needs is the business of who reads it afterwards; nothing of a page is known here.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import MOST, read_bytes, read_json
from studies.scene import UsageError
from studies.store.layout import Archive
from studies.store.schema import FAILURE, PLAN, RECORD, REFERENCE, Each, Kind, fault


def check_store(root: Path, campaign: str | None = None) -> None:
    """Raise UsageError, one line, for the first file of a campaign, by default of any, that may not be read.

    What is missing is passed over, and so are records that no plan asks for.
    """
    archive = Archive(root)
    for name in [campaign] if campaign else archive.campaigns():
        for row in _checked(archive.index_path(name), PLAN).get("cells", ()):
            if row.get("id") is not None:
                _checked(archive.record_path(row["id"]), RECORD)
                _checked(archive.failure_path(row["id"]), FAILURE)
    _checked(root / "references.json", {"references": Each(REFERENCE)})
    for path in _tables(root):
        _bounded(path)


def _checked(path: Path, kind: Kind) -> dict[str, Any]:
    """The record in a file, its values of their types; an empty one where there is none."""
    try:
        data = read_json(path)
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: cannot be read: {' '.join(str(error).split())}") from None
    wrong = fault(data, kind) if isinstance(data, dict) else "expected a record"
    if wrong:
        raise UsageError(f"{path}: {wrong}")
    return dict(data)


def _tables(root: Path) -> Iterator[Path]:
    yield from sorted(root.glob("tables/*.csv"))
    yield from sorted(root.glob("cells/*/*.csv"))
    yield from sorted(root.glob("references/*"))


def _bounded(path: Path) -> None:
    """Raise UsageError for a table that would take more memory than one of ours; each value takes a byte at least."""
    try:
        if not path.is_file():
            raise ValueError("it is no regular file")
        if path.stat().st_size > MOST:
            data = read_bytes(path)
            if data.count(b",") + data.count(b"\n") > MOST:
                raise ValueError(f"it has more than {MOST} values")
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: cannot be read: {error}") from None
