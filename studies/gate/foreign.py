"""Reading a store that nobody vouches for: plain files inside it alone, bounded in size, and only text and numbers.

Plans and records are read as those of ours are (:mod:`studies.run.archive`), which sees to their types. Beyond that no
link is followed, no name of a foreign store becomes a path before it has the form of one, and nothing is written here.
What the numbers mean does not enter.
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact.interchange.untrusted import LARGEST, MOST, read_bytes
from studies.ask.request import UsageError
from studies.output.vtu import FIELDS
from studies.run.archive import Archive, DamagedError
from studies.scenes.complete import Cell
from studies.solving.result import CLASSES

MOST_CELLS = 50_000  # of a plan
NAME, TABLE = re.compile(r"[\w-]{1,100}"), re.compile(r"[a-z_]{1,60}\.csv")
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
            raise UsageError(f"{self.root} is not a store: it has no campaign")
        return names

    def planned(self, campaign: str) -> list[tuple[Cell, str | None]]:
        """Cells of a campaign with the identities that they claim; raises ClaimError.

        What is resolved, and how it is named, is determined here anew.
        """
        archive = Archive(self.root)
        self._refuse_links(archive.index_path(campaign))
        try:
            rows = archive.index(campaign)["cells"]
        except UsageError as error:
            raise ClaimError("plan", str(error)) from None
        if len(rows) > MOST_CELLS:
            raise ClaimError("plan", f"campaign {campaign} has {len(rows)} cells, more than {MOST_CELLS}")
        for row in rows:
            if not all(isinstance(value, OPTIONS.get(key, ())) for key, value in row["options"].items()):
                raise ClaimError("plan", f"{row['label']!r} asks for what no cell can ask for")
        return [
            (
                Cell(
                    row["label"],
                    row["scene"],
                    row["options"],
                    row["settings"],
                    artefacts=row["files"],
                    expected=row.get("expected", ""),
                    group=row.get("group", ""),
                ),
                row["id"],
            )
            for row in rows
        ]

    def record(self, cell_id: str) -> dict[str, Any] | None:
        """The record of a cell, its keys and types checked; None when there is none. Raises ClaimError."""
        archive = Archive(self.root)
        self._refuse_links(archive.record_path(cell_id))
        try:
            data = archive.record(cell_id)
        except (DamagedError, OSError) as error:
            raise ClaimError("record", str(error)) from None
        if data is None:
            return None
        missing = [key for key in ("outcome", "provenance") if key not in data]
        if missing:
            raise ClaimError("record", f"lacks {', '.join(missing)}")
        mark = data.get("merged")
        if mark and not data["timing_s"]:  # it was merged there, too, and its seconds are kept apart
            data["timing_s"] = mark.get("timing_s", {})
        if not all(name == FIELDS or TABLE.fullmatch(name) for name in data["files"]):
            raise ClaimError("files", f"must be {FIELDS} and tables NAME.csv")
        if data["class"] not in CLASSES:
            raise ClaimError("class", f"{data['class']!r} must be one of {', '.join(CLASSES)}")
        lacks = [key for key in ORIGIN if data["provenance"].get(key) is None]
        if lacks or "threads" not in data["provenance"]["blas"]:
            raise ClaimError("provenance", f"lacks {', '.join(lacks) or 'the threads of BLAS'}")
        return {"measure": "", "work": {}, "cuts": [], "notes": [], **{key: data[key] for key in KEPT if key in data}}

    def table(self, cell_id: str, name: str) -> list[list[str]]:
        """The rows of a table beside a record, its head first; raises ClaimError."""
        try:
            text = self.beside(cell_id, name).decode("utf-8")
            if text.count(",") + text.count("\n") > MOST:
                raise ClaimError(name, f"has more than {MOST} values")
            rows = list(csv.reader(io.StringIO(text), strict=True))
        except (UnicodeDecodeError, csv.Error) as error:
            raise ClaimError(name, str(error)) from None
        if not rows or any(len(row) != len(rows[0]) for row in rows):
            raise ClaimError(name, "is not a table: its rows differ in length")
        return rows

    def beside(self, cell_id: str, name: str, largest: int = LARGEST) -> bytes:
        """A file beside a record, of at most so many bytes; raises ClaimError."""
        path = Archive(self.root).files(cell_id) / name
        self._refuse_links(path)
        try:
            return read_bytes(path, largest)
        except FileNotFoundError:
            raise ClaimError("files", f"{name} is not there") from None
        except (OSError, ValueError) as error:
            raise ClaimError("files", f"{name}: {error}") from None

    def _refuse_links(self, path: Path) -> None:
        """Raises ClaimError for a file that lies elsewhere."""
        inside = path.relative_to(self.root)
        if any((self.root / part).is_symlink() for part in (inside, *inside.parents[:-1])):
            raise ClaimError("files", f"{inside} leads through a link, which is not followed")
