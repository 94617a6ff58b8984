"""Declarations of sentences and claims: what they say of tables that are made up, and the tables that they name.

A sentence of conclusion by its name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from reports.chapter import statements
from reports.store import Store
from studies.analysis.evidence import VALUE
from studies.analysis.statements.record import Statement
from studies.analysis.statements.tables import read_sentences, said_by


def said(name: str, **tables: pd.DataFrame) -> list[Statement]:
    """What a declaration of sentences.toml says of tables by their names."""
    (declaration,) = [each for each in read_sentences() if each.get("name") == name]
    return list(said_by(declaration, tables.get))


def tables_of(declaration: Mapping[str, Any]) -> set[str]:
    """The tables that a declaration names."""
    named = {each.get("from") for each in (declaration, *declaration["values"].values()) if isinstance(each, Mapping)}
    texts = [text for text in _texts(declaration["values"]) if not text.startswith("= ")]
    named |= {actual["table"] for actual in map(VALUE.fullmatch, texts) if actual}
    return {name for name in named if name}


def _texts(values: Mapping[str, Any]) -> Iterator[str]:
    for value in values.values():
        if isinstance(value, str):
            yield value
        elif isinstance(value, Mapping):
            yield from _texts(value.get("each", {}))


def sentence(store: Store, name: str) -> str:
    """Its text, nothing where the campaign does not make it."""
    return next((each.text for each in statements(store) if each.name == name), "")
