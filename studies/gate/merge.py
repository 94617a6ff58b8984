"""Taking the cells of a foreign store into one of ours: what holds is kept, what does not is named, one line each.

- A cell is asked for by its label and settings; request and identity are found here. Another identity means other
  sources or another request: it is refused.
- A cell that claims an equilibrium is taken when its field bears it out (:mod:`studies.gate.claims`), or when it was
  solved again. Without either it is refused.
- Of a cell that claims none only that, and its reason, are taken: an unverified failure, no quantity and no load of it.
- A cell that is here stays as it is. When it says the same, nothing is to be done; when not, that is named.
- Its seconds are kept apart: they are of another machine, and nothing bears them out.
- What was stopped there (time, memory, crash) is of that machine, and is not taken; nor are tables of experiments.

Each record comes last and whole, so that a merge that was stopped is gone on with by starting it again.
"""

from __future__ import annotations

import secrets
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from studies.ask.request import Request, UsageError
from studies.gate.claims import Verified, check_request, claims_success, verify
from studies.gate.foreign import FIELDS, ClaimError, Foreign
from studies.output.atomic import as_text, write_by, write_text
from studies.output.provenance import provenance
from studies.run.archive import Archive, DamagedError
from studies.run.campaign import Campaign
from studies.run.children import Children
from studies.run.collect import SOLVED_AGAIN, UNVERIFIED, VERIFIED
from studies.run.plan import Row, planned
from studies.run.running import Progress, write_plan
from studies.run.task import Limits
from studies.scenes.plugins import used

SOLIDS = ("crushed-ring-solid", "tyre-solid", "two-cylinders", "ironing")
NOT_SOLVED, ALREADY = "not solved there", "here already"
LARGEST, LARGEST_SOLID = 20_000, 4_096  # elements that are built to recompute a claim: about a GiB
OF_A_FAILURE = ("quantities", "counters", "work", "timing_s", "path_end")  # which nothing bears out
ALL = "all"  # of the cells, solved again
VALUES, COUNTS, FEW = 1e-6, 0.1, 2  # relative, of quantities and of counters, of which a few are never too many


Check = Callable[[Row, Mapping[str, Any]], None]  # of a planned cell and what its record claims


@contextmanager
def solving_again() -> Iterator[Check]:
    """What solves a cell here, in a process with the usual limits; its record is gone with it.

    The check raises ClaimError where the cell comes to something else.
    """
    with closing(Children()) as children, tempfile.TemporaryDirectory() as folder:
        aside = Archive(Path(folder))

        def check(row: Row, record: Mapping[str, Any]) -> None:
            task = row.task(used())
            ended, ours = children.perform(task, folder, Limits()), aside.record(task.id)
            if ours is None:
                raise ClaimError("outcome", f"claimed {record['class']!r}, solved again it ends in {ended!r}")
            compare(record, ours)

        yield check


def compare(
    record: Mapping[str, Any], ours: Mapping[str, Any], said: str = "solved again {}", *, counted: bool = True
) -> None:
    """Class and quantities and, where ``counted``, loads and counters; raises ClaimError for the first that differs.

    said: of the value that ours has.
    """
    if record["class"] != ours["class"]:
        raise ClaimError("class", f"claimed {record['class']!r}, {said.format(repr(ours['class']))}")
    if counted and len(record["steps"]) != len(ours["steps"]):
        raise ClaimError("steps", f"claimed {len(record['steps'])} loads, {said.format(len(ours['steps']))}")
    compared = {"quantities": (VALUES, 0.0), "counters": (COUNTS, FEW)}
    for kind in ("quantities", "counters") if counted else ("quantities",):
        share, least = compared[kind]
        for name, value in ours[kind].items():
            told = record[kind].get(name)
            numbers = isinstance(told, int | float) and isinstance(value, int | float)
            if told != value and not (numbers and abs(told - value) <= max(share * abs(value), least)):
                raise ClaimError(name, f"claimed {told}, {said.format(value)}")


@dataclass
class Summary:
    """How a merge has ended: cells by what became of them, and a line on each that was refused."""

    counts: Counter[str] = field(default_factory=Counter)
    refused: list[str] = field(default_factory=list)

    @property
    def line(self) -> str:
        """One line."""
        told = [f"{count} {what}" for what, count in self.counts.items()]
        return ", ".join([*told, *([f"{len(self.refused)} refused"] if self.refused else [])]) or "no cell"


def merge(
    source: Path,
    store: Path,
    again: int = 0,
    progress: Progress = lambda done, planned, label: None,
    say: Callable[[str], None] = lambda line: None,
) -> Summary:
    """Take what holds; raises UsageError for a source that is no store, or is the store itself.

    again: how many cells, drawn by lot, are solved again.  say: is told each refusal as it comes.
    """
    foreign, archive, summary = Foreign(source), Archive(store), Summary()
    if source.resolve() == store.resolve():
        raise UsageError(f"{source} cannot be merged into itself")
    names = foreign.campaigns()
    with archive.claimed():
        asked = dict(_asked(foreign, archive, names, summary, say))
        theirs = Archive(source)
        new = [each for each in asked if not archive.record_path(each).exists() and theirs.record_path(each).exists()]
        lot = secrets.SystemRandom().sample(new, min(again, len(new)))  # nobody can know which beforehand
        with solving_again() as check:
            for done, (cell_id, (row, claimed)) in enumerate(asked.items()):
                progress(done, len(asked), row.cell.label)
                try:
                    taken = _taken(foreign, archive, cell_id, row, claimed, check if cell_id in lot else None)
                    summary.counts[taken] += 1
                except ClaimError as refused:
                    _refuse(summary, say, f"{row.cell.label} ({cell_id}): {refused}")
        progress(len(asked), len(asked), "done")
    return summary


def _refuse(summary: Summary, say: Callable[[str], None], line: str) -> None:
    summary.refused.append(line)
    say(line)


def _asked(
    foreign: Foreign, archive: Archive, names: list[str], summary: Summary, say: Callable[[str], None]
) -> Iterator[tuple[str, tuple[Row, str | None]]]:
    """The cells that are solved, by their identity here: planned here, and the identity that the foreign plan claims.

    A plan that is not here yet is written.
    """
    for name in names:
        rows = []
        try:
            cells = foreign.planned(name)
        except (ClaimError, OSError) as refused:
            _refuse(summary, say, f"campaign {name}: {refused}")
            continue
        for cell, claimed in cells:
            try:
                row = planned(cell)
            except UsageError as error:
                _refuse(summary, say, f"{cell.label}: scene: {error}")
                continue
            rows.append(row)
            if row.id is not None:
                yield row.id, (row, claimed)
            elif claimed is not None:
                _refuse(summary, say, f"{cell.label} ({claimed}): request: {row.reason}")
        if not archive.index_path(name).exists():
            title = f"the cells {name} of another store"
            write_plan(archive, Campaign(name, title, tuple(row.cell for row in rows)), rows)


def _taken(foreign: Foreign, archive: Archive, cell_id: str, row: Row, claimed: str | None, check: Check | None) -> str:
    """What has become of a cell, in a word; check: solves it again, where that is asked for. Raises ClaimError."""
    if claimed is None:
        return NOT_SOLVED
    if claimed != cell_id:
        said = f"claimed {claimed}, here it is {cell_id}: other sources, or another request"
        raise ClaimError("identity", said)
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
    if check is not None:
        check(row, record)
    if success and FIELDS in record["files"]:
        found = _verified(record, request, foreign)
        tables = {name: foreign.table(cell_id, name) for name in record["files"] if name != FIELDS}
        _keep_files(archive.files(cell_id), found.fields, tables)
        return _keep(archive, foreign, {**record, "model_reason": request.model_reason}, VERIFIED, found.claimed)
    if check is not None:
        return _keep(archive, foreign, {**record, "files": []}, SOLVED_AGAIN, ["times", "machine"])
    if success:
        raise ClaimError("field", "none is kept to bear it out: footprint run --fields keeps them, or --again all")
    empty: dict[str, Any] = {key: {} for key in OF_A_FAILURE}
    return _keep(archive, foreign, {**record, **empty, "steps": [], "files": []}, UNVERIFIED, ["outcome", "reason"])


def _verified(record: Mapping[str, Any], request: Request, foreign: Foreign) -> Verified:
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
    compare(record, ours, "the cell here has {} and stays", counted=False)
    return True


def _keep_files(folder: Path, fields: bytes, tables: Mapping[str, list[list[str]]]) -> None:
    """The field as it was judged, and the tables as they were read."""
    for name, rows in tables.items():
        write_text(folder / name, "".join(",".join(map(_quoted, row)) + "\n" for row in rows))
    write_by(folder / FIELDS, lambda path: path.write_bytes(fields))


def _quoted(word: str) -> str:
    """A value of a table, as csv writes it."""
    return '"' + word.replace('"', '""') + '"' if any(each in word for each in ',"\n\r') else word


def _keep(archive: Archive, foreign: Foreign, record: Mapping[str, Any], status: str, claimed: list[str]) -> str:
    """Put the record with a mark of how far it was verified, where its seconds are, too; returns the status."""
    mark = {"from": foreign.root.resolve().name, "status": status, "claimed": claimed, "date": provenance()["date"]}
    mark["timing_s"] = record["timing_s"]
    archive.keep(record["id"], as_text({**record, "timing_s": {}, "merged": mark}))
    return status
