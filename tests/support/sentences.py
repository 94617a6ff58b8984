"""Sentences of conclusion of tables that are made up."""

from __future__ import annotations

import pandas as pd

from studies.analysis.statements.record import Statement, declared
from studies.analysis.statements.tables import read_sentences


def said(name: str, **tables: pd.DataFrame) -> list[Statement]:
    """What a declaration of sentences.toml says of tables by their names."""
    (declaration,) = [each for each in read_sentences() if each.get("name") == name]
    return list(declared(declaration, tables.get))
