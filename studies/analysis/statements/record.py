"""A sentence of conclusion as data, and the tables that it is computed from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from inspect import signature
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.cells.answers import Answers

OPENING, FINDING, LIMIT, ANSWER = "opening", "finding", "limitation", "answer"
ANSWERS = "answers"  # the parameter of a maker that reads solved cells, not a table
COLUMNS = ("statement", "page", "role", "text", "problems", "scope", "machine")
VALUE_COLUMNS = ("statement", "field", "number", "word")


@dataclass(frozen=True, eq=False)
class Statement:
    """One or two sentences about a ``page``; ``text`` names its ``values`` in braces, with the format of a number.

    problems: how many solved problems it rests on.  scope: what it holds for, and what would make it false.  role:
    the opening of its page, a finding, a known limitation, or the answer to a question.  machine: its numbers are
    times, or depend on them, so that another machine has others.
    """

    name: str
    page: str
    text: str
    values: Mapping[str, float | str]
    problems: int
    scope: str
    role: str = FINDING
    machine: bool = False


Maker = Callable[..., Iterator[Statement]]


@dataclass(frozen=True, eq=False)
class Evidence:
    """The tables of a campaign in the folder of a store, those of experiments among them, and its solved cells."""

    store: Path
    campaign: str

    @cached_property
    def answers(self) -> Answers:
        """The solved cells."""
        return Answers.of(self.store, self.campaign)

    @cached_property
    def _read(self) -> dict[str, pd.DataFrame | None]:
        return {}

    def table(self, name: str) -> pd.DataFrame | None:
        """A table that is of this campaign, or of none; None where it is missing or empty."""
        if name not in self._read:
            path = self.store / "tables" / f"{name}.csv"
            found = pd.read_csv(path) if path.exists() and path.stat().st_size > 1 else pd.DataFrame()
            own = "campaign" not in found or bool((found["campaign"] == self.campaign).all())
            self._read[name] = found if own and len(found) else None
        return self._read[name]

    def given(self, maker: Callable[..., Any]) -> dict[str, Any] | None:
        """What a function asks for: its parameters are the names of the tables it reads. None where one is missing."""
        found: dict[str, Any] = {}
        for name in signature(maker).parameters:
            found[name] = self.answers if name == ANSWERS else self.table(name)
        return found if all(value is not None for value in found.values()) else None

    def said_by(self, maker: Maker) -> Iterator[Statement]:
        """What a maker says; where a table of it is missing it says nothing."""
        if (given := self.given(maker)) is not None:
            yield from maker(**given)


def as_tables(statements: list[Statement]) -> dict[str, pd.DataFrame]:
    """``statements`` with COLUMNS, and ``statement_values`` with VALUE_COLUMNS: a row a number or word of a text."""
    rows = [(s.name, s.page, s.role, s.text, s.problems, s.scope, s.machine) for s in statements]
    values = [
        (s.name, field, float("nan"), value) if isinstance(value, str) else (s.name, field, float(value), "")
        for s in statements
        for field, value in s.values.items()
    ]
    return {
        "statements": pd.DataFrame(rows, columns=list(COLUMNS)),
        "statement_values": pd.DataFrame(values, columns=list(VALUE_COLUMNS)),
    }
