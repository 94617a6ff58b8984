"""A deck as cards: a keyword, its parameters, its lines of data. What a keyword means does not enter here.

Names and keywords are not case-sensitive; every error names the file and the line.

Words of a TOML file, each with the key it stands under, so that what is wrong is refused by name.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn, Protocol

from contact.interchange.untrusted import read_toml
from studies.ask.request import UsageError

LARGEST_FILE = 200_000_000  # bytes
LARGEST_NUMBER = 2**31 - 1  # of a node or an element
WHOLE = re.compile(r"[+-]?\d{1,12}")
REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?")
LARGEST = 1e60  # of a number: products of four are finite, in whatever units
RANGE = f"[-{LARGEST:g}, {LARGEST:g}]"
SHOWN = 40  # letters of a word from a file in a message


class Place(Protocol):
    """A place in a file: its name and a line."""

    def refuse(self, why: str) -> NoReturn:
        """Raise UsageError with the file and the place in it."""


@dataclass(frozen=True)
class Row:
    """A line of data: its fields, stripped, without the empty ones at its end."""

    file: str
    line: int
    fields: tuple[str, ...]

    def refuse(self, why: str) -> NoReturn:
        """Raise UsageError with file and line."""
        raise UsageError(f"{self.file}, line {self.line}: {why}")

    def text(self, place: int, default: str | None = None) -> str:
        """A field; raises UsageError where it is missing."""
        if place < len(self.fields) and self.fields[place]:
            return self.fields[place]
        return default if default is not None else self.refuse(f"field {place + 1} is missing")

    def real(self, place: int, default: float | None = None) -> float:
        """A field as a finite number."""
        word = self.text(place, "" if default is not None else None)
        if not word and default is not None:
            return default
        value = float(re.sub("[dD]", "e", word)) if REAL.fullmatch(word) else math.nan
        if not math.isfinite(value):
            self.refuse(f"{shown(word)} is not a finite number")
        return value if abs(value) <= LARGEST else self.refuse(f"{shown(word)} must lie in {RANGE}")

    def whole(self, place: int, default: int | None = None) -> int:
        """A field as a positive whole number."""
        word = self.text(place, "" if default is not None else None)
        if not word and default is not None:
            return default
        value = int(word) if WHOLE.fullmatch(word) else 0
        if not 1 <= value <= LARGEST_NUMBER:
            self.refuse(f"{shown(word)} is not a whole number in [1, {LARGEST_NUMBER}]")
        return value

    def at_most(self, count: int) -> None:
        """Raise UsageError for more fields."""
        if len(self.fields) > count:
            self.refuse(f"{len(self.fields)} fields, at most {count} are supported here")


@dataclass(frozen=True)
class Card:
    """A keyword without its star, its parameters by name ("" for one without a value), its data."""

    file: str
    line: int
    keyword: str
    parameters: dict[str, str]
    rows: list[Row] = field(default_factory=list)

    def refuse(self, why: str) -> NoReturn:
        """Raise UsageError with file, line and keyword."""
        raise UsageError(f"{self.file}, line {self.line}: *{shown(self.keyword)}{' ' * (why[:1] not in ',:')}{why}")

    def knows(self, *names: str) -> None:
        """Raise UsageError for any parameter but these."""
        for name in self.parameters:
            if name not in names:
                known = f"; it must be one of {', '.join(names)}" if names else ""
                self.refuse(f"has a parameter {shown(name)} that is not supported{known}")

    def parameter(self, name: str) -> str:
        """The value of a parameter; raises UsageError where it is missing."""
        return self.parameters.get(name) or self.refuse(f"needs {name}=")

    def only_row(self) -> Row:
        """The data, one line."""
        if len(self.rows) != 1:
            self.refuse(f"has {len(self.rows)} lines of data, only one is supported")
        return self.rows[0]


def shown(word: str) -> str:
    """A word of a file as a message has it: no longer than a line bears."""
    return word if len(word) <= SHOWN else word[: SHOWN - 3] + "..."


def cards_of(path: Path) -> list[Card]:
    """The cards of a deck in order; raises UsageError for a malformed deck, and OSError."""
    if path.stat().st_size > LARGEST_FILE:
        raise UsageError(f"{path}: larger than {LARGEST_FILE // 10**6} MB")
    cards = list[Card]()
    for number, line in _lines(path):
        if line.startswith("*"):
            cards.append(_card(path.name, number, line))
        elif cards:
            fields = tuple(part.strip() for part in line.split(","))
            while fields and not fields[-1]:
                fields = fields[:-1]
            cards[-1].rows.append(Row(path.name, number, fields))
        else:
            raise UsageError(f"{path.name}, line {number}: data before the first keyword: {shown(line)!r}")
    if not cards:
        raise UsageError(f"{path.name}: no keywords")
    return cards


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Number and text of all lines but comments and empty ones; a keyword that ends in a comma goes on below."""
    begun, at = "", 0
    for number, raw in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        line = raw.strip()
        if not line or line.startswith("**"):
            continue
        if begun and line.startswith("*"):
            raise UsageError(f"{path.name}, line {at}: a keyword that ends in a comma and does not go on")
        at = at if begun else number
        begun += line
        if begun.startswith("*") and begun.endswith(","):
            continue
        yield at, begun
        begun = ""
    if begun:
        raise UsageError(f"{path.name}, line {at}: a keyword that ends in a comma and does not go on")


def _card(file: str, number: int, line: str) -> Card:
    head, *rest = line[1:].split(",")
    parameters = dict[str, str]()
    for each in rest:
        name, _, value = each.partition("=")
        key = " ".join(name.upper().split())
        if key in parameters:
            raise UsageError(f"{file}, line {number}: parameter {shown(key)} twice")
        parameters[key] = named(value)
    return Card(file, number, " ".join(head.upper().split()), parameters)


def named(word: str) -> str:
    """The name of a set or a material."""
    return word.strip().strip('"').upper()


def listed(values: Sequence[object], most: int = 4) -> str:
    """The first few of several, and how many more there are."""
    more = f" and {len(values) - most} more" if len(values) > most else ""
    return ", ".join(map(str, values[:most])) + more


@dataclass(frozen=True)
class Said:
    """A value and where it stands."""

    file: str
    key: str
    value: object

    @classmethod
    def of(cls, path: Path) -> Said:
        """All of a file; raises UsageError for what is not TOML, and OSError."""
        try:
            return cls(path.name, "", read_toml(path))
        except ValueError as error:
            raise UsageError(f"{path.name}: cannot be read as TOML: {' '.join(str(error).split())}") from None

    def refuse(self, why: str) -> NoReturn:
        """Raise UsageError with file and key."""
        raise UsageError(f"{self.file}{self.key and ': '}{self.key}{' ' * (why[:1] not in ',:')}{why}")

    def table(self, *known: str) -> dict[str, Said]:
        """Its values by key, none but the known ones where there are any."""
        if not isinstance(self.value, dict):
            self.refuse("must be a table")
        for key in self.value:
            if known and key not in known:
                self.refuse(f"has a key {shown(key)} that is not supported; it must be one of {', '.join(known)}")
        return {
            key: Said(self.file, f"{self.key}{self.key and '.'}{shown(key)}", each) for key, each in self.value.items()
        }

    def needs(self, *keys: str) -> list[Said]:
        """The values of a table of these keys, none of which may be missing."""
        table = self.table(*keys)
        missing = [key for key in keys if key not in table]
        if missing:
            self.refuse(f"needs {listed(missing)}")
        return [table[key] for key in keys]

    def items(self, count: int | None = None) -> list[Said]:
        """The values of a list, of that many."""
        if not isinstance(self.value, list) or count not in (None, len(self.value)):
            self.refuse("must be a list" if count is None else f"must be a list of {count}")
        return [Said(self.file, f"{self.key}[{i}]", each) for i, each in enumerate(self.value)]

    def real(self) -> float:
        """A finite number."""
        if isinstance(self.value, bool) or not isinstance(self.value, int | float):
            self.refuse("must be a number")
        if not (math.isfinite(self.value) and abs(self.value) <= LARGEST):
            self.refuse(f"must lie in {RANGE}")
        return float(self.value)

    def text(self) -> str:
        """A word."""
        return self.value if isinstance(self.value, str) else self.refuse("must be a word in quotes")

    def flag(self) -> bool:
        """True or false."""
        return self.value if isinstance(self.value, bool) else self.refuse("must be true or false")
