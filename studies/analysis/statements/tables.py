"""The tables of statements of a campaign, from all makers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from studies.analysis.statements import asked, choices, laws
from studies.analysis.statements.contact import agreement, algorithms, arena, friction, friction_algorithms, robustness
from studies.analysis.statements.questions import asks, readers
from studies.analysis.statements.record import Evidence, Maker, Statement, as_tables
from studies.analysis.statements.shells import benchmarks, tyre
from studies.analysis.statements.trade import cost

MAKERS: Sequence[Maker] = (
    *(*tyre.MAKERS, *benchmarks.MAKERS, *laws.MAKERS),
    *(*algorithms.MAKERS, *choices.MAKERS),
    *(*agreement.MAKERS, *robustness.MAKERS, *friction.MAKERS, *friction_algorithms.MAKERS),
    *(*arena.MAKERS, *cost.MAKERS, *asked.MAKERS),
)


def statements(store: Path, campaign: str) -> list[Statement]:
    """All that the tables of a campaign in its store allow to be said, by page and in the order of the makers."""
    evidence = Evidence(store, campaign)
    found = [each for maker in MAKERS for each in evidence.said_by(maker)]
    names = [each.name for each in found]
    if len(set(names)) < len(names):
        twice = sorted({name for name in names if names.count(name) > 1})
        raise ValueError(f"said twice: {', '.join(twice)}")
    return found


def statement_tables(store: Path, campaign: str) -> dict[str, pd.DataFrame]:
    """``statements``, ``statement_values``, ``asks`` and ``readers``, of the tables that are written already."""
    found = statements(store, campaign)
    said = {each.name for each in found}
    return {**as_tables(found), "asks": asks(said), "readers": readers(said)}
