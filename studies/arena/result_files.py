"""Results of the arena that somebody else hands in: read within bounds, each value held to its type and range.

Whatever is wrong with a file ends in a UsageError of one line that names the file and the value.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from contact.interchange.untrusted import MB, read_json
from studies.arena.results import FORMAT, MACHINE, STATUS, TEXT, VERSION, Asked, Counted, Result, Solved, plain
from studies.ask.request import UsageError

LARGEST = 4 * MB
MOST = 10_000  # problems
HASH = re.compile(r"[0-9a-f]{16}")
NAME = re.compile(r"[\w.,=+-]{1,160}", re.ASCII)
Told = Mapping[str, Any]


def read_all(folder: Path) -> list[Result]:
    """All results of a folder, by the name of their file; raises UsageError naming the invalid file."""
    if not folder.is_dir():
        raise UsageError(f"{folder} is no folder of results")
    found = [read_result(path) for path in sorted(folder.glob("*.json"))]
    if not found:
        raise UsageError(f"{folder}: no results (*.json) in it")
    seen: dict[tuple[str, str, str, str], None] = {}
    for result in found:
        key = (result.entry, result.place, result.harness, result.collection)
        if key in seen:
            raise UsageError(f"{folder}: {result.entry[:TEXT]!r} has two results on the machine {result.place}")
        seen[key] = None
    return found


def read_result(path: Path) -> Result:
    """A result; raises UsageError with one line for whatever is wrong with it."""
    try:
        told = read_json(path, LARGEST)
        return _result(_object(told, "it"))
    except (ValueError, OverflowError) as error:
        said = (str(error).splitlines() or ["damaged"])[0]
        raise UsageError(f"{path} is no result of the arena: {plain(said)}") from None


def _result(told: Told) -> Result:
    if (told.get("format"), told.get("format_version")) != (FORMAT, VERSION):
        raise ValueError(f"it is not of the format {FORMAT!r}, version {VERSION}")
    machine = _object(told.get("machine"), "machine")
    given = _list(told.get("tolerances"), "tolerances", 10)
    tolerances = tuple(_one_tolerance(_object(each, "an entry of tolerances")) for each in given)
    if len({each.tolerance for each in tolerances}) < len(tolerances):
        raise ValueError("tolerances must be different")
    return Result(
        _text(told.get("entry"), "entry", TEXT),
        {key: _text(machine.get(key), f"machine {key}", 2 * TEXT) for key in MACHINE},
        _hash(told.get("harness"), "harness"),
        _hash(told.get("collection"), "collection"),
        _number(told.get("limit_s"), "limit_s", 1e-3, 1e6),
        tuple(sorted(tolerances, key=lambda each: -each.tolerance)),
    )


def _one_tolerance(told: Told) -> Asked:
    tolerance = _number(told.get("tolerance"), "tolerance", 1e-16, 1.0)
    public = tuple(_one_problem(_object(each, "a problem")) for each in _list(told.get("public"), "public", MOST))
    if len({each.problem for each in public}) < len(public):
        raise ValueError("public has a problem twice")
    counts = told.get("held_out")
    return Asked(tolerance, public, None if counts is None else _counted(_object(counts, "held_out")))


def _one_problem(told: Told) -> Solved:
    name, status = told.get("problem"), told.get("status")
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise ValueError(f"problem {_shown(name)} must be the name of one")
    if status not in STATUS:
        raise ValueError(f"status {_shown(status)} of {name} must be one of {', '.join(STATUS)}")
    return Solved(name, str(status), _cost(told.get("cost")))


def _counted(told: Told) -> Counted:
    counts = _object(told.get("statuses"), "statuses")
    found = {}
    for status in STATUS:
        value = counts.get(status)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= MOST:
            raise ValueError(f"held_out {status} = {_shown(value)} must be a whole number in [0, {MOST}]")
        found[status] = value
    return Counted(found, _cost(told.get("cost")), _hash(told.get("secret"), "secret"))


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


def _object(value: object, what: str) -> Told:
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
    """A value in a line, whatever it is."""
    return repr(value)[:60]
