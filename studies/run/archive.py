"""Where things lie in a store, and what is read back from it: records of cells, failures, indexes of campaigns.

::

    cells/ID.json      the record of a cell; cells/ID/ has its fields and tables, if it wants them
    failures/ID.json   how the last attempt ended of a cell that has no record: tried again by the next run
    campaigns/NAME.json, tables/, references/, references.json, timing/NAME.json
    aside/             records that could not be read

A record comes last and by a rename, so it is there whole or not at all. What a store says is checked wherever it is
read: files within bounds, values of their declared types. Whether it has what a page needs is the business of who reads
it afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import MOST, read_bytes, read_json
from studies.ask.scene import UsageError
from studies.output.atomic import PART, SCHEMA, write_json, write_text
from studies.run.schema import FAILURE, RECORD, REFERENCE, Each, fault, plan_fault, shortened

KEYS = ("schema", "id", "scene", "settings", "class", "reason", "quantities", "steps", "counters", "timing_s", "files")
FAILURE_KEYS = ("schema", "id", "class", "reason")


class DamagedError(ValueError):
    """A file of the store that is not what it should be; one line."""


@dataclass(frozen=True)
class Archive:
    """A store by its directory."""

    root: Path

    def record_path(self, cell_id: str) -> Path:
        """Of a cell that was solved, or refused."""
        return self.root / "cells" / f"{cell_id}.json"

    def files(self, cell_id: str) -> Path:
        """Directory of the fields and tables of a cell."""
        return self.root / "cells" / cell_id

    def failure_path(self, cell_id: str) -> Path:
        """Of a cell, or a table, that was stopped or died."""
        return self.root / "failures" / f"{cell_id}.json"

    def index_path(self, campaign: str) -> Path:
        """Of the plan of a campaign."""
        return self.root / "campaigns" / f"{campaign}.json"

    @property
    def tables(self) -> Path:
        """Directory of the tables of the whole store."""
        return self.root / "tables"

    def record(self, cell_id: str) -> dict[str, Any] | None:
        """The record of a cell, or None; raises DamagedError when it is not one."""
        return read_file(self.record_path(cell_id), KEYS, lambda data: fault(data, RECORD), cell_id)

    def failure(self, cell_id: str) -> dict[str, Any] | None:
        """What happened to a cell without a record, or None; what cannot be read says nothing."""
        try:
            return read_file(self.failure_path(cell_id), FAILURE_KEYS, lambda data: fault(data, FAILURE), cell_id)
        except DamagedError:
            return None

    def index(self, campaign: str) -> dict[str, Any]:
        """The plan of a campaign; raises UsageError when it has none, or another schema's."""
        path = self.index_path(campaign)
        try:
            plan = read_file(path, ("schema", "campaign", "cells"), plan_fault)
        except DamagedError as error:
            raise UsageError(str(error)) from None
        if plan is None:
            there = ", ".join(self.campaigns()) or "none"
            raise UsageError(f"{self.root} has no campaign {campaign!r}; it has {there}")
        return plan

    def campaigns(self) -> list[str]:
        """Names of the campaigns that were begun here."""
        return sorted(path.stem for path in (self.root / "campaigns").glob("*.json"))

    def keep(self, cell_id: str, text: str) -> None:
        """Put the record of a cell; what is known of its failures goes."""
        write_text(self.record_path(cell_id), text)
        self.failure_path(cell_id).unlink(missing_ok=True)

    def note_failure(self, cell_id: str, failure: Mapping[str, Any]) -> None:
        """Put how an attempt has ended."""
        write_json(self.failure_path(cell_id), {"schema": SCHEMA, "id": cell_id, **failure})

    def has(self, cell_id: str, *, files: bool) -> bool:
        """True when the record is there, with its files if they are wanted; raises DamagedError."""
        record = self.record(cell_id)
        if record is None:
            return False
        refused = record["class"] == "unsupported"
        names = record["files"]
        return refused or not files or bool(names and all((self.files(cell_id) / name).exists() for name in names))

    def set_aside(self, cell_id: str) -> Path:
        """Move a damaged record out of the way, never over another one; returns where it is now."""
        folder = self.root / "aside"
        folder.mkdir(exist_ok=True)
        names = chain([f"{cell_id}.json"], (f"{cell_id}.{k}.json" for k in count(1)))
        place = next(path for path in map(folder.joinpath, names) if not path.exists())
        self.record_path(cell_id).rename(place)
        return place

    @contextmanager
    def claimed(self) -> Iterator[None]:
        """Hold the store alone; the lock goes with the process, however that ends. Raises UsageError when it is held.

        What a killed run was writing is swept away: it never had a name.
        """
        self._refuse_others()
        import fcntl  # as killing a cell, not there on every system; reading a store does without

        try:
            self.root.mkdir(parents=True, exist_ok=True)
            lock = (self.root / ".lock").open("a+", encoding="utf-8")
        except OSError as error:
            raise UsageError(f"--store {self.root} cannot be written to: {error.strerror}") from None
        with lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                message = f"{self.root} is in use by another run; wait for it or choose another --store"
                raise UsageError(message) from None
            for part in self.root.rglob(f"{PART}*"):
                part.unlink(missing_ok=True)
            yield

    def _refuse_others(self) -> None:
        """Raise UsageError when another version of the program, or something else, has put its things here."""
        if self.root.exists() and not self.root.is_dir():
            raise UsageError(f"--store {self.root} is a file, not a directory")
        schemas = {1} if (self.root / "campaign.json").exists() else set()
        for name in self.campaigns():
            try:
                schemas.add(int(read_json(self.index_path(name))["schema"]))
            except (OSError, ValueError, KeyError, TypeError):
                continue  # it will be written anew
        for schema in schemas - {SCHEMA}:
            raise UsageError(f"{self.root} has schema {schema}, this program writes {SCHEMA}: choose another --store")


def read_file(
    path: Path, keys: tuple[str, ...], fault_of: Callable[[Mapping[str, Any]], str], cell_id: str | None = None
) -> dict[str, Any] | None:
    """A JSON file with these keys, this schema and this id, its values of their types; None when it is not there.

    Raises DamagedError; what may not be read is not damaged: PermissionError.
    """
    try:
        data = read_json(path)
    except FileNotFoundError:
        return None
    except PermissionError:
        raise
    except (OSError, ValueError) as error:
        raise DamagedError(f"{path} cannot be read: {' '.join(str(error).split())}") from None
    if not isinstance(data, dict):
        raise DamagedError(f"{path} is not a record")
    missing = [key for key in keys if key not in data]
    if data.get("schema") != SCHEMA:
        raise DamagedError(f"{path} has schema {shortened(data.get('schema'))}, this program reads {SCHEMA}")
    if missing:
        raise DamagedError(f"{path} lacks {', '.join(missing)}")
    if wrong := fault_of(data):
        raise DamagedError(f"{path}: {wrong}")
    if cell_id is not None and data["id"] != cell_id:
        raise DamagedError(f"{path} is of {data['id']!r}")
    return data


def check_store(root: Path, campaign: str | None = None) -> None:
    """Raise UsageError, one line, for the first file of a campaign, by default of any, that may not be read.

    Records and tables that are missing are passed over, and so are records that no plan asks for.
    """
    archive = Archive(root)
    try:
        for name in [campaign] if campaign else archive.campaigns():
            for row in archive.index(name)["cells"]:
                if row["id"] is not None:
                    archive.record(row["id"])
                    failed = archive.failure_path(row["id"])
                    read_file(failed, FAILURE_KEYS, lambda data: fault(data, FAILURE), row["id"])
        read_file(root / "references.json", ("references",), lambda data: fault(data, {"references": Each(REFERENCE)}))
    except DamagedError as error:
        raise UsageError(str(error)) from None
    for pattern in ("tables/*.csv", "cells/*/*.csv", "references/*"):
        for path in sorted(root.glob(pattern)):
            _bounded(path)


def _bounded(path: Path) -> None:
    """Raise UsageError for a table that would take more memory than one of ours; each value takes a byte at least."""
    try:
        if not path.is_file():
            raise ValueError("it is not a regular file")
        if path.stat().st_size > MOST:
            data = read_bytes(path)
            if data.count(b",") + data.count(b"\n") > MOST:
                raise ValueError(f"it has more than {MOST} values")
    except (OSError, ValueError) as error:
        raise UsageError(f"{path}: cannot be read: {error}") from None
