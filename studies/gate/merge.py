"""Taking the cells of a foreign store into one of ours: what holds is kept, what does not is named, one line each.

- A cell is asked for by its label and settings; request and identity are found here. Another identity means other
  sources or another request: it is refused.
- A cell that claims an equilibrium is taken when its field bears it out (:mod:`studies.gate.claims`). Without one it
  is refused: who wants it solves it here.
- Of a cell that claims none only that, and its reason, are taken: an unverified failure, no quantity and no load of it.
- A cell that is here stays as it is. When it says the same, nothing is to be done; when not, that is named.
- Its seconds are kept apart: they are of another machine, and nothing bears them out.
- What was stopped there (time, memory, crash) is of that machine, and is not taken; nor are tables of experiments.

Each record comes last and whole, so that a merge that was stopped is gone on with by starting it again.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from studies.ask.request import Request, UsageError
from studies.gate.claims import check_request, claims_success, verify
from studies.gate.foreign import ClaimError, Foreign
from studies.output.atomic import as_text, write_by, write_text
from studies.output.provenance import provenance
from studies.output.vtu import FIELDS
from studies.run.archive import Archive, DamagedError
from studies.run.campaign import Campaign
from studies.run.collect import UNVERIFIED, VERIFIED
from studies.run.plan import Row, planned
from studies.run.running import Progress, write_plan

SOLIDS = ("crushed-ring-solid", "tyre-solid", "two-cylinders", "ironing")
NOT_SOLVED, ALREADY = "not solved there", "here already"
LARGEST, LARGEST_SOLID = 20_000, 4_096  # elements that are built to recompute a claim: about a GiB
OF_A_FAILURE = ("quantities", "counters", "work", "timing_s", "path_end")  # which nothing bears out
VALUES = 1e-6  # relative, of quantities


@dataclass
class Summary:
    """How a merge has ended: cells by what became of them, and a line on each that was refused."""

    say: Callable[[str], None]
    counts: Counter[str] = field(default_factory=Counter)
    refused: list[str] = field(default_factory=list)

    def refuse(self, line: str) -> None:
        """One more, said as it comes."""
        self.refused.append(line)
        self.say(line)

    @property
    def line(self) -> str:
        """One line."""
        parts = [f"{count} {what}" for what, count in self.counts.items()]
        return ", ".join([*parts, *([f"{len(self.refused)} refused"] if self.refused else [])]) or "no cell"


def merge(
    source: Path,
    store: Path,
    progress: Progress = lambda done, planned, label: None,
    say: Callable[[str], None] = lambda line: None,
) -> Summary:
    """Take what holds; raises UsageError for a source that is not a store, or is the store itself.

    say: called with each refusal as it comes.
    """
    foreign, archive, summary = Foreign(source), Archive(store), Summary(say)
    if source.resolve() == store.resolve():
        raise UsageError(f"{source} cannot be merged into itself")
    names = foreign.campaigns()
    with archive.claimed():
        asked = dict(_asked(foreign, archive, names, summary))
        for done, (cell_id, (row, claimed)) in enumerate(asked.items()):
            progress(done, len(asked), row.cell.label)
            try:
                summary.counts[_taken(foreign, archive, cell_id, row, claimed)] += 1
            except ClaimError as refused:
                summary.refuse(f"{row.cell.label} ({cell_id}): {refused}")
        progress(len(asked), len(asked), "done")
    return summary


def _asked(
    foreign: Foreign, archive: Archive, names: list[str], summary: Summary
) -> Iterator[tuple[str, tuple[Row, str | None]]]:
    """The cells that are solved, by their identity here: planned here, and the identity that the foreign plan claims.

    A plan that is not here yet is written.
    """
    for name in names:
        rows = []
        try:
            cells = foreign.planned(name)
        except (ClaimError, OSError) as refused:
            summary.refuse(f"campaign {name}: {refused}")
            continue
        for cell, claimed in cells:
            try:
                row = planned(cell)
            except UsageError as error:
                summary.refuse(f"{cell.label}: scene: {error}")
                continue
            rows.append(row)
            if row.id is not None:
                yield row.id, (row, claimed)
            elif claimed is not None:
                summary.refuse(f"{cell.label} ({claimed}): request: {row.reason}")
        if not archive.index_path(name).exists():
            title = f"the cells {name} of another store"
            write_plan(archive, Campaign(name, title, tuple(row.cell for row in rows)), rows)


def _taken(foreign: Foreign, archive: Archive, cell_id: str, row: Row, claimed: str | None) -> str:
    """What has become of a cell, in a word; raises ClaimError."""
    if claimed is None:
        return NOT_SOLVED
    if claimed != cell_id:
        message = f"claimed {claimed}, here it is {cell_id}: other sources, or another request"
        raise ClaimError("identity", message)
    record = foreign.record(cell_id)
    if record is None:
        return NOT_SOLVED
    assert row.request is not None
    _check_size(row.request)
    if _is_here(archive, cell_id, record):
        return ALREADY
    request = row.request
    check_request(record, request)
    success = claims_success(record)
    if success:
        if FIELDS not in record["files"]:
            raise ClaimError("field", "none is kept to verify it: run footprint run --fields")
        field, claims = _verified(record, request, foreign)
        tables = {name: foreign.table(cell_id, name) for name in record["files"] if name != FIELDS}
        _keep_files(archive.files(cell_id), field, tables)
        return _keep(archive, foreign, {**record, "model_reason": request.model_reason}, VERIFIED, claims)
    empty: dict[str, Any] = {key: {} for key in OF_A_FAILURE}
    return _keep(archive, foreign, {**record, **empty, "steps": [], "files": []}, UNVERIFIED, ["outcome", "reason"])


def _verified(record: Mapping[str, Any], request: Request, foreign: Foreign) -> tuple[bytes, list[str]]:
    """What a record claims, recomputed; numbers beyond all measure are a claim like any other. Raises ClaimError."""
    try:
        with np.errstate(all="ignore"):
            return verify(record, request, foreign)
    except ClaimError:
        raise
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        raise ClaimError("field", f"cannot be judged: {' '.join(str(error).split())[:200]}") from None


def _check_size(request: Request) -> None:
    """Raises ClaimError for what a stranger's plan would have us build beyond any use; nothing is built for that."""
    n1, n2 = request.mesh
    most = LARGEST_SOLID if request.scene in SOLIDS else LARGEST
    if n1 * n2 > most:
        raise ClaimError("mesh", f"{n1}x{n2} has {n1 * n2} elements, more than the {most} that are built for a claim")


def _is_here(archive: Archive, cell_id: str, record: Mapping[str, Any]) -> bool:
    """Whether the store has the cell and says the same of it; raises ClaimError where it says something else."""
    try:
        ours = archive.record(cell_id)
    except DamagedError as error:
        raise ClaimError("here", f"{error}; footprint run sets it aside") from None
    if ours is None:
        return False
    there, here = ((each["class"], each["quantities"]) for each in (record, ours))
    if there[0] != here[0]:
        raise ClaimError("class", f"claimed {there[0]!r}, the cell here has {here[0]!r} and stays")
    for name, value in here[1].items():
        claimed = there[1].get(name)
        numbers = isinstance(claimed, int | float) and isinstance(value, int | float)
        if claimed != value and not (numbers and abs(claimed - value) <= VALUES * abs(value)):
            raise ClaimError(name, f"claimed {claimed}, the cell here has {value} and stays")
    return True


def _keep_files(folder: Path, fields: bytes, tables: Mapping[str, list[list[str]]]) -> None:
    """The field as it was judged, and the tables as they were read."""
    for name, rows in tables.items():
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(rows)
        write_text(folder / name, text.getvalue())
    write_by(folder / FIELDS, lambda path: path.write_bytes(fields))


def _keep(archive: Archive, foreign: Foreign, record: Mapping[str, Any], status: str, claimed: list[str]) -> str:
    """Put the record with a mark of how far it was verified, where its seconds are, too; returns the status."""
    mark = {"from": foreign.root.resolve().name, "status": status, "claimed": claimed, "date": provenance()["date"]}
    mark["timing_s"] = record["timing_s"]
    archive.keep(record["id"], as_text({**record, "timing_s": {}, "merged": mark}))
    return status
