"""Reading a store that nobody vouches for: plain files inside it alone, bounded in size, and only text and numbers.

No link is followed, nothing is unpickled, no name of a foreign store becomes a path before it has the form of one, and
nothing is written here. What the numbers mean does not enter.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import MOST, parsed_json
from studies.ask.request import UsageError
from studies.output.atomic import SCHEMA
from studies.run.archive import KEYS, Archive
from studies.run.schema import RECORD, fault, shortened, word
from studies.scenes.complete import Cell
from studies.solving.result import CLASSES

MB = 2**20
LARGEST_RECORD, LARGEST_TABLE = 32 * MB, 32 * MB
MOST_CELLS = 50_000  # of a plan
FIELDS = "fields.vtu"
ID, NAME, TABLE = re.compile(r"[0-9a-f]{16}"), re.compile(r"[\w-]{1,100}"), re.compile(r"[a-z_]{1,60}\.csv")
ORIGIN = ("version", "commit", "date", "packages", "blas", "machine")
OPTIONS = {**dict.fromkeys(("measure", "contact", "newton", "model", "mesh"), str), "steps": int}  # of a cell
KEPT = (  # of a record; whatever else stands there is left
    *("schema", "id", "scene", "measure", "contact", "newton", "mesh", "model", "model_reason", "settings"),
    *("outcome", "class", "path_end", "reason", "notes", "quantities", "steps", "cuts", "counters", "work"),
    *("timing_s", "provenance", "files"),
)


class ClaimError(ValueError):
    """A claim that is not taken: its name, and one line of what is wrong with it."""

    def __init__(self, claim: str, said: str) -> None:
        super().__init__(f"{claim}: {said}")


@dataclass(frozen=True)
class Foreign:
    """A store by its directory; everything in it is a claim."""

    root: Path

    def campaigns(self) -> list[str]:
        """Names of its campaigns; raises UsageError when it has none."""
        names = [name for name in Archive(self.root).campaigns() if NAME.fullmatch(name)]
        if not names:
            raise UsageError(f"{self.root} is no store: it has no campaign")
        return names

    def planned(self, campaign: str) -> list[tuple[Cell, str | None]]:
        """Cells of a campaign with the identities that they claim; raises ClaimError."""
        data = _json(self.read(f"campaigns/{campaign}.json", LARGEST_RECORD))
        if data.get("schema") != SCHEMA or not isinstance(data.get("cells"), list):
            raise ClaimError("plan", f"campaign {campaign} is none of schema {SCHEMA}")
        if len(data["cells"]) > MOST_CELLS:
            raise ClaimError("plan", f"campaign {campaign} has {len(data['cells'])} cells, more than {MOST_CELLS}")
        return [_cell(row) for row in data["cells"]]

    def record(self, cell_id: str) -> dict[str, Any] | None:
        """The record of a cell, its keys and types checked; None when there is none. Raises ClaimError."""
        if not ID.fullmatch(cell_id):
            raise ClaimError("identity", f"{cell_id[:40]!r} is none")
        try:
            data = _json(self.read(f"cells/{cell_id}.json", LARGEST_RECORD))
        except FileNotFoundError:
            return None
        return _checked(data, cell_id)

    def table(self, cell_id: str, name: str) -> list[list[str]]:
        """The rows of a table beside a record, its head first; raises ClaimError."""
        if not TABLE.fullmatch(name):
            raise ClaimError("files", f"{name[:60]!r} is neither a table nor {FIELDS}")
        text = _text(self._beside(cell_id, name, LARGEST_TABLE), name)
        if text.count(",") + text.count("\n") > MOST:
            raise ClaimError(name, f"has more than {MOST} values")
        try:
            rows = list(csv.reader(io.StringIO(text), strict=True))
        except csv.Error as error:
            raise ClaimError(name, str(error)) from None
        if not rows or any(len(row) != len(rows[0]) for row in rows):
            raise ClaimError(name, "is no table: its rows differ in length")
        return rows

    def fields(self, cell_id: str, largest: int) -> bytes:
        """The fields beside a record, of at most so many bytes; raises ClaimError."""
        return self._beside(cell_id, FIELDS, largest)

    def _beside(self, cell_id: str, name: str, largest: int) -> bytes:
        try:
            return self.read(f"cells/{cell_id}/{name}", largest)
        except FileNotFoundError:
            raise ClaimError("files", f"{name} is not there") from None

    def read(self, place: str, largest: int) -> bytes:
        """A regular file inside the store; raises ClaimError for a link, and for more bytes than ``largest``."""
        path = self.root
        for part in Path(place).parts:
            path /= part
            if path.is_symlink():
                raise ClaimError("files", f"{place} leads through a link, which is not followed")
        try:
            descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)  # a pipe must not hold us up
        except FileNotFoundError:
            raise
        except OSError as error:
            raise ClaimError("files", f"{place}: {error.strerror}") from None
        with os.fdopen(descriptor, "rb") as file:
            told = os.fstat(file.fileno())
            if not stat.S_ISREG(told.st_mode):
                raise ClaimError("files", f"{place} is no regular file")
            data = file.read(largest + 1)
        if len(data) > largest:
            raise ClaimError("files", f"{place} has {told.st_size} bytes, more than the {largest} that it may have")
        return data


def _text(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        raise ClaimError(name, "is no text") from None


def _json(data: bytes) -> dict[str, Any]:
    text = _text(data, "record")
    try:
        found = parsed_json(text)
    except ValueError as error:
        said = "cannot be read as JSON" if isinstance(error, json.JSONDecodeError) else str(error)
        raise ClaimError("record", said) from None
    if not isinstance(found, dict):
        raise ClaimError("record", "is none")
    return found


def _cell(row: Any) -> tuple[Cell, str | None]:
    """A row of a plan as a cell; what is resolved, and how it is named, is found here anew."""
    if not isinstance(row, dict):
        raise ClaimError("plan", "a row of it is none")
    options, settings, cell_id = row.get("options"), row.get("settings"), row.get("id")
    told = [row.get("label"), row.get("scene"), row.get("expected", ""), row.get("group", "")]
    if not all(map(word, told)):
        raise ClaimError("plan", "a row of it has no label, or no scene")
    if not isinstance(options, dict) or not isinstance(settings, dict):
        raise ClaimError("plan", f"{told[0]!r} has no options, or no settings")
    known = all(isinstance(value, OPTIONS.get(key, ())) for key, value in options.items())
    words = all(map(word, settings.values()))
    if not words or not known or not isinstance(cell_id, str | None):
        raise ClaimError("plan", f"{told[0]!r} asks for what no cell can ask for")
    label, scene, expected, group = told
    files = row.get("files") is True
    return Cell(label, scene, dict(options), dict(settings), artefacts=files, expected=expected, group=group), cell_id


def _checked(data: Mapping[str, Any], cell_id: str) -> dict[str, Any]:
    """The keys of a record that are kept; raises ClaimError for a type that none of ours has."""
    missing = [key for key in (*KEYS, "outcome", "provenance") if key not in data]
    if missing:
        raise ClaimError("record", f"lacks {', '.join(missing)}")
    if data["schema"] != SCHEMA or data["id"] != cell_id:
        told = f"{shortened(data['id'])}, schema {shortened(data['schema'])}"
        raise ClaimError("record", f"is of {told}, not of {cell_id}, schema {SCHEMA}")
    mark = data.get("merged")
    if isinstance(mark, dict) and not data["timing_s"]:  # it was merged there, too, and its seconds are kept apart
        data = {**data, "timing_s": mark.get("timing_s")}
    record = {"measure": "", "work": {}, "cuts": [], "notes": [], **{key: data[key] for key in KEPT if key in data}}
    if wrong := fault(record, RECORD):
        claim, _, said = wrong.partition(" = ")
        raise ClaimError(claim, said or "cannot be printed on a line")
    if not all(name == FIELDS or TABLE.fullmatch(name) for name in record["files"]):
        raise ClaimError("files", f"must be {FIELDS} and tables NAME.csv")
    if record["class"] not in CLASSES:
        raise ClaimError("class", f"{record['class']!r} must be one of {', '.join(CLASSES)}")
    lacks = [key for key in ORIGIN if record["provenance"].get(key) is None]
    if lacks or "threads" not in record["provenance"]["blas"]:
        raise ClaimError("provenance", f"lacks {', '.join(lacks) or 'the threads of BLAS'}")
    return record
