"""Sentences of conclusion as data, and the tables of them: sentences.toml, and the questions of questions.toml."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.evidence import (
    Evidence,
    NothingError,
    Values,
    evaluated,
    given_to,
    read_declarations,
    read_values,
)
from studies.analysis.friction import FLOOR
from studies.analysis.statements import choices, contact, friction
from studies.experiments.friction.scenes import AGREED, COARSE, CONTACT, DELTA, MESH, MU

FINDING = "finding"  # the role of a sentence that names none
COLUMNS = ("statement", "page", "role", "text", "problems", "scope", "machine")
WORD = re.compile(r"<(\w+)>")  # stands for the value _word
VALUE_COLUMNS = ("statement", "field", "number", "word")
SENTENCES, QUESTIONS = Path(__file__).with_name("sentences.toml"), Path(__file__).with_name("questions.toml")
Maker = Callable[..., Iterator[Values]]
MAKERS = {"choices": choices, "contact": contact, "friction": friction}


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
    told = declaration["text"]
    parts = [{"text": part} if isinstance(part, str) else part for part in ([told] if isinstance(told, str) else told)]
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


def read_sentences() -> list[dict[str, Any]]:
    """All declarations of sentences, in the order of the file."""
    return [declaration for _, declaration in read_declarations(SENTENCES)]


def statements(store: Path, campaign: str) -> list[Statement]:
    """All that the tables of a campaign in its store allow to be said, in the order of the file."""
    evidence = Evidence(store, campaign)
    found = [each for declaration in read_sentences() for each in said_by(declaration, evidence.get)]
    names = [each.name for each in found]
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"said twice: {', '.join(twice)}")
    return found


def said_by(declaration: dict[str, Any], tables: Callable[[str], Any]) -> Iterator[Statement]:
    """What a declaration says, by values of its own or of its maker; nothing where its tables do not bear it."""
    if "maker" not in declaration:
        with suppress(NothingError):
            yield worded(declaration, read_values(declaration, tables, DEFAULTS))
        return
    maker = maker_of(declaration)
    if (given := given_to(maker, tables)) is not None:
        yield from (worded(declaration, values) for values in maker(**given))


def maker_of(declaration: dict[str, Any]) -> Maker:
    """The function that a declaration names."""
    module, _, name = declaration["maker"].partition(".")
    found: Maker = getattr(MAKERS[module], name)
    return found


def statement_tables(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``statements``, ``statement_values``, ``asks`` and ``readers``, of the tables that are written already."""
    found = statements(store, campaign)
    return {**as_tables(found), **question_tables({each.name for each in found})}


def read_questions() -> dict[str, list[dict[str, Any]]]:
    """The questions of users (``ask``) and of readers (``reader``)."""
    return tomllib.loads(QUESTIONS.read_text(encoding="utf-8"))


def question_tables(said: Collection[str]) -> dict[str, pd.DataFrame]:
    """``asks`` and ``readers``, a row a question; answers: the names of its statements that are in ``said``."""
    columns = {
        "asks": ["question", "threads", "answers", "command", "missing"],
        "readers": ["question", "answers", "page"],
    }
    questions = read_questions()
    tables = {name: pd.DataFrame(questions[name.removesuffix("s")])[of].fillna("") for name, of in columns.items()}
    for name, table in tables.items():
        there = [", ".join(each for each in answers if each in said) for answers in table["answers"]]
        tables[name] = table.assign(answers=there, answered=[bool(each) for each in there])
    return tables


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
