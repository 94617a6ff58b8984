"""A sentence of conclusion as data, and what a declaration of sentences.toml comes to."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from studies.analysis.evidence import evaluated
from studies.analysis.friction import FLOOR
from studies.experiments.friction.scenes import AGREED, COARSE, CONTACT, DELTA, MESH, MU

FINDING = "finding"  # the role of a sentence that names none
Values = dict[str, Any]  # numbers and words by their names; those that begin with _ are not published
COLUMNS = ("statement", "page", "role", "text", "problems", "scope", "machine")
WORD = re.compile(r"<(\w+)>")  # stands for the value _word
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


# what the tables of experiments are made with, by names that are not published
DEFAULTS: Mapping[str, Any] = {
    "_cost_contact": CONTACT,
    "_steps_mesh": COARSE,
    "_steps_mu": MU,
    "_agreed": AGREED,
    "_floor": FLOOR,
    "_tyre": f"the paper's whole tyre on {MESH} elements, pressed by {DELTA:g} mm",
}


def worded(declaration: Mapping[str, Any], values: Values) -> Statement:
    """The words of a declaration, with values."""
    values = {**DEFAULTS, **values}
    given = declaration["text"]
    parts = [
        {"text": part} if isinstance(part, str) else part for part in ([given] if isinstance(given, str) else given)
    ]
    text = "".join(part["text"] for part in parts if evaluated(part.get("when", "True"), values))
    return Statement(
        name=re.sub(WORD, lambda found: str(values[f"_{found[1]}"]), declaration["name"]),
        page=declaration["page"],
        text=re.sub(WORD, lambda found: str(values[f"_{found[1]}"]), text),
        values={name: value for name, value in values.items() if not name.startswith("_")},
        problems=int(values["_problems"] if "_problems" in values else values["_rows"]),
        scope=declaration["scope"].format(**values),
        role=declaration.get("role", FINDING),
        machine=declaration.get("machine", False),
    )


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
