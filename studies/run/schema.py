"""What the files of a store may hold: the type of every value, declared once (kinds.toml).

Numbers are finite (the reader of JSON sees to that; infinities are words), texts are short and printable on one line.
Whether a value is right does not enter here.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studies.output.atomic import LONGEST

ID = re.compile(r"[\w-]{1,100}")  # becomes the name of a file
INFINITE = ("inf", "-inf")  # as JSON has infinities


def word(value: Any) -> bool:
    """A text that is printed on one line."""
    return isinstance(value, str) and len(value) <= LONGEST and value.isprintable()


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


def axis(value: Any) -> bool:
    """A list of numbers or words, or "all"."""
    return value == "all" or (isinstance(value, list) and all(map(scalar, value)))


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

REQUEST_KEYS = ("scene", "mesh", "settings")
ROW_KEYS = ("label", "id", "scene", "command", "options", "settings", "files", "request", "reason")
PLAIN = (word, identity, file_name, whole, flag, finite, count, number, scalar, setting, option)
LISTED = (axis, mesh, leaf, canary)
WAYS: dict[str, Callable[[Kind], Each | Named | Maybe]] = {"each": Each, "named": Named, "maybe": Maybe}


def _read() -> dict[str, Kind]:
    """The kinds of kinds.toml by name, each made of those before it."""
    kinds: dict[str, Kind] = {kind.__name__: kind for kind in (*PLAIN, *LISTED)}

    def made(declared: Any) -> Kind:
        if isinstance(declared, dict):
            return {key: made(inside) for keys, inside in declared.items() for key in keys.split()}
        way, _, name = declared.rpartition(" ")
        return WAYS[way](kinds[name]) if way else kinds[name]

    for name, declaration in tomllib.loads(Path(__file__).with_name("kinds.toml").read_text(encoding="utf-8")).items():
        kinds[name] = made(declaration)
    return kinds


KINDS = _read()
PLAN, RECORD, FAILURE, REFERENCE, TIMES = (KINDS[x] for x in ("plan", "record", "failure", "reference", "times"))


def fault(value: Any, kind: Kind, at: str = "") -> str:
    """The first value that is not of its kind, with its place, in words; nothing where all are."""
    return next(_faults(value, kind, at), "")


def plan_fault(data: Mapping[str, Any]) -> str:
    """The first fault of a plan, or of a row that lacks something."""
    message = fault(data, PLAN)
    for i, row in enumerate(() if message else data["cells"]):
        lacks = [key for key in ROW_KEYS if key not in row]
        lacks += [
            f"request.{key}" for key in REQUEST_KEYS if row.get("request") is not None and key not in row["request"]
        ]
        if lacks:
            return f"cells[{i}] lacks {', '.join(lacks)}"
    return message


def _faults(value: Any, kind: Kind, at: str) -> Iterator[str]:
    if kind is None:
        kind = {} if isinstance(value, dict) else Each(None) if isinstance(value, list) else scalar
    if callable(kind):  # most of all: first
        if not kind(value):
            meaning = str(kind.__doc__).rstrip(".")
            yield f"{at} = {shortened(value)} must be {meaning[0].lower()}{meaning[1:]}"
    elif isinstance(kind, Maybe):
        if value is not None:
            yield from _faults(value, kind.kind, at)
    elif isinstance(kind, Each):
        if not isinstance(value, list):
            yield f"{at} = {shortened(value)} must be a list"
            return
        for i, inside in enumerate(value):
            yield from _faults(inside, kind.kind, f"{at}[{i}]")
    else:
        if not isinstance(value, dict):
            yield f"{at} = {shortened(value)} must be a set of values by name"
            return
        for key, inside in value.items():
            if not word(key):
                yield f"{at} has the name {shortened(key)}, which cannot be printed on a line"
            within = kind.kind if isinstance(kind, Named) else kind.get(key)
            yield from _faults(inside, within, f"{at}.{key}" if at else key)


def shortened(value: Any, most: int = 60) -> str:
    """A value as Python writes it, cut; of one that holds others only that."""
    if isinstance(value, dict | list):
        return f"{'{' if isinstance(value, dict) else '['}{len(value)} values{'}' if isinstance(value, dict) else ']'}"
    text = repr(value[: most + 1] if isinstance(value, str) else value)
    return text if len(text) <= most else text[:most] + "..."
