"""What the files of a store may hold: the type of every value, declared once, for records, failures and plans.

Numbers are finite (the reader of JSON sees to that; infinities are words), texts are short and printable on one line.
Whether a value is right does not enter here.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

LONGEST = 8000  # characters of a text
ID = re.compile(r"[\w-]{1,100}")  # becomes the name of a file
INFINITE = ("inf", "-inf")  # as JSON has infinities


def word(value: Any) -> bool:
    """A text that is printed on one line."""
    return isinstance(value, str) and len(value) <= LONGEST and value.isprintable()


def as_line(text: str) -> str:
    """A text of ours as a word: the messages of libraries may have several lines."""
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(text.split()))[:LONGEST]


def identity(value: Any) -> bool:
    """A name that becomes one of a file."""
    return isinstance(value, str) and ID.fullmatch(value) is not None


def file_name(value: Any) -> bool:
    """The name of a file, without its folder."""
    return word(value) and not value.startswith(".") and not {*"/\\"} & {*value}


def whole(value: Any) -> bool:
    """A whole number."""
    return isinstance(value, int) and not isinstance(value, bool)


def flag(value: Any) -> bool:
    """True or false."""
    return isinstance(value, bool)


def finite(value: Any) -> bool:
    """A number."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def count(value: Any) -> bool:
    """A number of at least 0."""
    return finite(value) and bool(value >= 0)


def number(value: Any) -> bool:
    """A number, an infinity, or none."""
    return finite(value) or value is None or (isinstance(value, str) and value in INFINITE)


def scalar(value: Any) -> bool:
    """A number, a word, true or false, or nothing."""
    return value is None or isinstance(value, bool) or finite(value) or word(value)


def setting(value: Any) -> bool:
    """A word, a number, true or false, or a list of numbers."""
    return (value is not None and scalar(value)) or (isinstance(value, list) and all(map(finite, value)))


def option(value: Any) -> bool:
    """A word, or a whole number."""
    return word(value) or whole(value)


def mesh(value: Any) -> bool:
    """Two whole numbers of at least 1."""
    return isinstance(value, list) and len(value) == 2 and all(whole(n) and n > 0 for n in value)


def leaf(value: Any) -> bool:
    """Three whole numbers."""
    return isinstance(value, list) and len(value) == 3 and all(map(whole, value))


def canary(value: Any) -> bool:
    """Two times, and whether they count."""
    return isinstance(value, list) and len(value) == 3 and count(value[0]) and count(value[1]) and flag(value[2])


@dataclass(frozen=True)
class Each:
    """A list of values of one kind."""

    kind: Kind


@dataclass(frozen=True)
class Named:
    """Values of one kind by name."""

    kind: Kind


@dataclass(frozen=True)
class Maybe:
    """A value of a kind, or nothing."""

    kind: Kind


# the mapping: kinds by name, all else plain; None: whatever it is, with words for texts
Kind = Callable[[Any], bool] | Each | Named | Maybe | Mapping[str, Any] | None

ORIGIN = Named(scalar)
MACHINE = {**dict.fromkeys(("version", "commit"), Maybe(word)), "date": word}
STEP = {
    **dict.fromkeys(("failures", "diagnosis"), Each(word)),
    **dict.fromkeys(("kkt", "balances"), Named(number)),
    **dict.fromkeys(("substeps", "newton_iterations", "limit_point", "rounding"), number),
    "stability": {"word": word},
}
RECORD: Mapping[str, Kind] = {
    "schema": whole,
    "id": identity,
    **dict.fromkeys(("scene", "measure", "contact", "newton", "mesh", "model", "model_reason"), word),
    **dict.fromkeys(("outcome", "class", "reason"), word),
    "settings": Named(setting),
    "path_end": {"parameter": number, **dict.fromkeys(("kind", "found_by", "stage"), word)},
    "quantities": Named(number),
    "steps": Each(STEP),
    **dict.fromkeys(("notes", "cuts", "files"), Each(word)),
    **dict.fromkeys(("counters", "work", "timing_s"), Named(count)),
    "provenance": {**MACHINE, **dict.fromkeys(("packages", "blas", "machine"), ORIGIN)},
    "merged": {"status": word, "timing_s": Named(count)},
    "case": Named(scalar),
}
FAILURE: Mapping[str, Kind] = {"schema": whole, "id": word, "class": word, "reason": word}
REQUEST: Mapping[str, Kind] = {
    **dict.fromkeys(("scene", "measure", "contact", "newton", "model", "model_reason"), word),
    "mesh": mesh,
    "steps": whole,
    "settings": Named(setting),
    "leaves": Each(leaf),
}
REQUEST_KEYS = ("scene", "mesh", "settings")
ROW: Mapping[str, Kind] = {
    **dict.fromkeys(("label", "scene", "command", "expected", "group", "reason"), word),
    "id": Maybe(identity),
    "options": Named(option),
    "settings": Named(word),
    "files": flag,
    "request": Maybe(REQUEST),
}
ROW_KEYS = ("label", "id", "scene", "command", "options", "settings", "files", "request", "reason")
PLAN: Mapping[str, Kind] = {
    "schema": whole,
    "campaign": file_name,
    **dict.fromkeys(("title", "pages"), word),
    "tables": Each(identity),
    "cells": Each(ROW),
}

REFERENCE: Mapping[str, Kind] = {
    **dict.fromkeys(("scene", "quantity", "kind", "source"), word),
    **{"value": finite, "uncertainty": finite, "at": Named(scalar)},
}

TIMES: Mapping[str, Kind] = {
    **{"canaries": Each(canary), "rounds": whole, "provenance": RECORD["provenance"]},
    "cells": Each({"label": word, "id": file_name, **dict.fromkeys(("warm", "cold", "discarded"), Each(count))}),
}


def fault(value: Any, kind: Kind, at: str = "") -> str:
    """The first value that is not of its kind, with its place, in words; nothing where all are."""
    return next(_faults(value, kind, at), "")


def plan_fault(data: Mapping[str, Any]) -> str:
    """The first fault of a plan, or of a row that lacks something."""
    found = fault(data, PLAN)
    for i, row in enumerate(() if found else data["cells"]):
        lacks = [key for key in ROW_KEYS if key not in row]
        lacks += [
            f"request.{key}" for key in REQUEST_KEYS if row.get("request") is not None and key not in row["request"]
        ]
        if lacks:
            return f"cells[{i}] lacks {', '.join(lacks)}"
    return found


def _faults(value: Any, kind: Kind, at: str) -> Iterator[str]:
    if kind is None:
        kind = {} if isinstance(value, dict) else Each(None) if isinstance(value, list) else scalar
    if isinstance(kind, Maybe):
        if value is not None:
            yield from _faults(value, kind.kind, at)
    elif isinstance(kind, Each):
        if not isinstance(value, list):
            yield f"{at} = {shortened(value)} must be a list"
            return
        for i, inside in enumerate(value):
            yield from _faults(inside, kind.kind, f"{at}[{i}]")
    elif isinstance(kind, Named | Mapping):
        if not isinstance(value, dict):
            yield f"{at} = {shortened(value)} must be a set of values by name"
            return
        for key, inside in value.items():
            if not word(key):
                yield f"{at} has the name {shortened(key)}, which cannot be printed on a line"
            within = kind.kind if isinstance(kind, Named) else kind.get(key)
            yield from _faults(inside, within, f"{at}.{key}" if at else key)
    elif not kind(value):
        meaning = str(kind.__doc__).rstrip(".")
        yield f"{at} = {shortened(value)} must be {meaning[0].lower()}{meaning[1:]}"


def shortened(value: Any, most: int = 60) -> str:
    """A value as Python writes it, cut; of one that holds others only that."""
    if isinstance(value, dict | list):
        return f"{'{' if isinstance(value, dict) else '['}{len(value)} values{'}' if isinstance(value, dict) else ']'}"
    text = repr(value[: most + 1] if isinstance(value, str) else value)
    return text if len(text) <= most else text[:most] + "..."
