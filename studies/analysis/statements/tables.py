"""The tables of statements of a campaign: all sentences of sentences.toml, and the questions of questions.toml."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pandas as pd

from studies.analysis.evidence import Evidence, NothingError, given_to, read_declarations, read_values
from studies.analysis.statements import choices, contact, friction
from studies.analysis.statements.record import DEFAULTS, Statement, Values, as_tables, worded

SENTENCES, QUESTIONS = Path(__file__).with_name("sentences.toml"), Path(__file__).with_name("questions.toml")
Maker = Callable[..., Iterator[Values]]
MAKERS = {"choices": choices, "contact": contact, "friction": friction}


def read_sentences() -> list[dict[str, Any]]:
    """All declarations of sentences, in the order of the file."""
    return [declaration for _, declaration in read_declarations(SENTENCES)]


def statements(store: Path, campaign: str) -> list[Statement]:
    """All that the tables of a campaign in its store allow to be said, in the order of the file."""
    evidence = Evidence(store, campaign)
    sentences = [each for declaration in read_sentences() for each in said_by(declaration, evidence.get)]
    names = [each.name for each in sentences]
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"said twice: {', '.join(twice)}")
    return sentences


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
    maker: Maker = getattr(MAKERS[module], name)
    return maker


def statement_tables(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``statements``, ``statement_values`` and ``asks``, of the tables that are written already."""
    sentences = statements(store, campaign)
    return {**as_tables(sentences), "asks": asks({each.name for each in sentences})}


def read_questions() -> list[dict[str, Any]]:
    """The questions of users."""
    return list(tomllib.loads(QUESTIONS.read_text(encoding="utf-8"))["ask"])


def asks(said: Collection[str]) -> pd.DataFrame:
    """A row a question; answers: the names of its statements that are in ``said``."""
    table = pd.DataFrame(read_questions())[["question", "threads", "answers", "command", "missing"]].fillna("")
    there = [", ".join(each for each in answers if each in said) for answers in table["answers"]]
    return table.assign(answers=there, answered=[bool(each) for each in there])
