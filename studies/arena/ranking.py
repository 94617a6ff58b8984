"""The leaderboard as rows: entries by rank, their results on each machine, and which results are stale.

An entry is ranked by the machine where it solves fewest problems: by the problems of the split ``test`` that it solves
with the accuracy required, most first; then by the fewest false claims; then by the cost, the geometric mean over those
that it solves, in factorisations of K on the same machine, so that seconds of different machines are not compared.
Equal in all three is an equal rank. A stale result is listed, but not ranked.

Submitted results are read: sizes are bounded, types and ranges of all values are checked, and any fault of a file
raises a UsageError of one line that names the file and the value.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from contact.interchange.untrusted import MB, read_json
from studies.arena.collected.collection import TEST, split_of
from studies.arena.results import (
    ANOMALOUS,
    EXCLUDED,
    FAILED,
    FORMAT,
    MACHINE,
    MISSING,
    OK,
    STALE,
    STATUS,
    TEXT,
    VERSION,
    Asked,
    Counted,
    Result,
    Solved,
    mean_cost,
    plain,
    statuses,
)
from studies.ask.request import UsageError

LEAD = 1e-6  # the accuracy that is ranked by, or else the strictest tolerance that all results have in common
Split = Callable[[str], str]
Row = dict[str, Any]


@dataclass(frozen=True)
class Board:
    """The tolerance of the ranking, rows of entries, of results by machine, and of machines."""

    tolerance: float
    ranked: list[Row]
    runs: list[Row]
    machines: list[Row]
    stale: int
    secrets: int


def board(results: Sequence[Result], split: Split = split_of) -> Board:
    """Of all results; raises UsageError where those that are not stale have no tolerance in common."""
    fresh, old = ([each for each in results if each.stale is stale] for stale in (False, True))
    tolerance = _tolerance(fresh) if fresh else math.nan
    runs = [_run(each, _at(each, tolerance), split) for each in fresh]
    runs += [{**_nothing(each), "status": STALE} for each in old]
    machines = {each.place: {"place": each.place, **each.machine} for each in results}
    secrets = {at.held_out.secret for each in fresh if (at := _at(each, tolerance)).held_out is not None}
    own = [run for run in runs if run["status"] != STALE]
    return Board(tolerance, list(_ranked(own)), runs, list(machines.values()), len(old), len(secrets))


def _tolerance(results: Sequence[Result]) -> float:
    common = set.intersection(*({at.tolerance for at in each.tolerances} for each in results))
    if not common:
        raise UsageError("the results were asked for no tolerance in common")
    return LEAD if LEAD in common else min(common)


def _at(result: Result, tolerance: float) -> Asked:
    return next(at for at in result.tolerances if at.tolerance == tolerance)


def _run(result: Result, at: Asked, split: Split) -> Row:
    """Counts by status on the split TEST, beside it all that are OK, and the held-out tier."""
    tested = [each for each in at.public if split(each.problem) == TEST]
    held, counts = at.held_out, statuses(tested)
    private = {} if held is None else {"drawn": sum(held.statuses.values()), "drawn_ok": held.statuses[OK]}
    private |= {} if held is None else {"drawn_false": held.statuses[ANOMALOUS]}
    return {**_nothing(result), **counts, **private, "asked": len(tested), "cost": mean_cost(tested), "status": OK}


def _nothing(result: Result) -> Row:
    blank = dict.fromkeys((OK, ANOMALOUS, FAILED, EXCLUDED, MISSING, "asked", "drawn", "drawn_ok", "drawn_false"))
    return {"entry": result.entry, "place": result.place, **blank, "cost": math.nan}


def _ranked(runs: Iterable[Row]) -> Iterator[Row]:
    """One row per entry, by its worst machine; entries with equal figures share a rank."""
    groups: dict[str, list[Row]] = {}
    for run in runs:
        groups.setdefault(run["entry"], []).append(run)
    worst = [{**sorted(own, key=_order)[-1], "machines": len(own)} for own in groups.values()]
    worst.sort(key=lambda row: (_order(row), row["entry"]))
    rank, before = 0, None
    for at, row in enumerate(worst, 1):
        rank, before = (rank if _order(row) == before else at), _order(row)
        yield {"rank": rank, **row}


def _order(row: Row) -> tuple[float, float, float]:
    """Smallest first: the best."""
    return -row[OK], row[ANOMALOUS], row["cost"] if row["cost"] == row["cost"] else math.inf


LARGEST = 4 * MB
MOST = 10_000  # problems
HASH = re.compile(r"[0-9a-f]{16}")
NAME = re.compile(r"[\w.,=+-]{1,160}", re.ASCII)
Record = Mapping[str, Any]


def read_all(folder: Path) -> list[Result]:
    """All results of a folder, by the name of their file; raises UsageError naming the invalid file."""
    if not folder.is_dir():
        raise UsageError(f"{folder} is not a folder of results")
    results = [read_result(path) for path in sorted(folder.glob("*.json"))]
    if not results:
        raise UsageError(f"{folder}: no results (*.json) in it")
    keys: dict[tuple[str, str, str, str], None] = {}
    for result in results:
        key = (result.entry, result.place, result.harness, result.collection)
        if key in keys:
            raise UsageError(f"{folder}: {result.entry[:TEXT]!r} has two results on the machine {result.place}")
        keys[key] = None
    return results


def read_result(path: Path) -> Result:
    """A result; raises UsageError with one line for any fault."""
    try:
        content = read_json(path, LARGEST)
        return _result(_object(content, "it"))
    except (ValueError, OverflowError) as error:
        reason = (str(error).splitlines() or ["damaged"])[0]
        raise UsageError(f"{path} is not a result of the arena: {plain(reason)}") from None


def _result(record: Record) -> Result:
    if (record.get("format"), record.get("format_version")) != (FORMAT, VERSION):
        raise ValueError(f"it is not of the format {FORMAT!r}, version {VERSION}")
    machine = _object(record.get("machine"), "machine")
    given = _list(record.get("tolerances"), "tolerances", 10)
    tolerances = tuple(_one_tolerance(_object(each, "an entry of tolerances")) for each in given)
    if len({each.tolerance for each in tolerances}) < len(tolerances):
        raise ValueError("tolerances must be different")
    return Result(
        _text(record.get("entry"), "entry", TEXT),
        {key: _text(machine.get(key), f"machine {key}", 2 * TEXT) for key in MACHINE},
        _hash(record.get("harness"), "harness"),
        _hash(record.get("collection"), "collection"),
        _number(record.get("limit_s"), "limit_s", 1e-3, 1e6),
        tuple(sorted(tolerances, key=lambda each: -each.tolerance)),
    )


def _one_tolerance(record: Record) -> Asked:
    tolerance = _number(record.get("tolerance"), "tolerance", 1e-16, 1.0)
    public = tuple(_one_problem(_object(each, "a problem")) for each in _list(record.get("public"), "public", MOST))
    if len({each.problem for each in public}) < len(public):
        raise ValueError("public has a problem twice")
    counts = record.get("held_out")
    return Asked(tolerance, public, None if counts is None else _counted(_object(counts, "held_out")))


def _one_problem(record: Record) -> Solved:
    name, status = record.get("problem"), record.get("status")
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise ValueError(f"problem {_shown(name)} must be the name of one")
    if status not in STATUS:
        raise ValueError(f"status {_shown(status)} of {name} must be one of {', '.join(STATUS)}")
    return Solved(name, str(status), _cost(record.get("cost")))


def _counted(record: Record) -> Counted:
    counts = _object(record.get("statuses"), "statuses")
    statuses = {}
    for status in STATUS:
        value = counts.get(status)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= MOST:
            raise ValueError(f"held_out {status} = {_shown(value)} must be a whole number in [0, {MOST}]")
        statuses[status] = value
    return Counted(statuses, _cost(record.get("cost")), _hash(record.get("secret"), "secret"))


def _cost(value: object) -> float:
    return math.nan if value is None else _number(value, "cost", 0.0, 1e12)


def _number(value: object, what: str, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        _refuse(value, what, f"a number in [{low:g}, {high:g}]")
    return float(value)


def _text(value: object, what: str, most: int) -> str:
    if not isinstance(value, str) or not 1 <= len(value) <= most or not value.isprintable() or not value.strip():
        _refuse(value, what, f"1 to {most} printable characters")
    return value


def _hash(value: object, what: str) -> str:
    if not isinstance(value, str) or not HASH.fullmatch(value):
        _refuse(value, what, "16 hexadecimal digits")
    return value


def _object(value: object, what: str) -> Record:
    if not isinstance(value, dict):
        _refuse(value, what, "a JSON object")
    return value


def _list(value: object, what: str, most: int) -> list[Any]:
    if not isinstance(value, list) or not 1 <= len(value) <= most:
        _refuse(value, what, f"a list of 1 to {most}")
    return value


def _refuse(value: object, what: str, must: str) -> NoReturn:
    raise ValueError(f"{what} = {_shown(value)} must be {must}")


def _shown(value: object) -> str:
    """Any value in one line."""
    return repr(value)[:60]
