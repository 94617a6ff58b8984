"""No median without the number of problems it is of and the share that is solved; no ranking of fewer than five."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

import studies.analysis
from reports.origin import summary_table
from reports.store import Store
from studies.analysis.everything import written
from studies.analysis.outcomes import SUMMARY_COLUMNS, contact_summary, outcomes
from support.pages.medians import bare_columns, unfounded
from support.stores.sweeps import cells

CAMPAIGN = "made"
CONTACTS = {"semismooth": 1.0, "lcp": 0.5}


def sweep() -> pd.DataFrame:
    """Two algorithms on two scenes, on one of which lcp loses the finest mesh."""
    touching = [
        cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS),
        cells("heavy-strip", "lift_force", 1.0, contacts=CONTACTS),
    ]
    table = pd.concat(touching, ignore_index=True).assign(path_end="", reason="")
    lost = (table["scene"] == "heavy-strip") & (table["contact"] == "lcp") & (table["n1"] == 64)
    table.loc[lost, ["outcome", "reason"]] = ["cap-hit", "200 iterations"]
    return table


def store_of(path: Path, table: pd.DataFrame) -> Store:
    written(path, CAMPAIGN, {"outcomes": outcomes(table), "contact_summary": contact_summary(table)})
    return Store(path, CAMPAIGN, ())


def test_a_cost_is_that_of_what_both_solve(tmp_path: Path) -> None:
    text = str(summary_table(store_of(tmp_path, sweep())))
    assert unfounded(text) == []
    assert "| `lcp` | 7 | 8 | 87.5 % | 1 | 0 | 0.50 [0.50, 0.50] | 7 (2) |" in text


def test_too_few_problems_make_no_ratio(tmp_path: Path) -> None:
    """Four problems of one scene."""
    few = store_of(tmp_path, cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS))
    assert unfounded(str(summary_table(few))) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("| who | seconds |\n| :-- | --: |\n| `lcp` | 0.31 [0.27, 0.37] |", "without both-count"),
        ("| who | both | seconds |\n| :-- | --: | --: |\n| `lcp` | 9 | 0.31 [0.27, 0.37] |", "solved share"),
        ("| who | solves | both | s |\n| :-- | --: | --: | --: |\n| a | 1 | 4 (1) | 0.3 [–, –] |", "a median of 4"),
        ("- newton, 1 problems: mixed > plain; the same.", "ranked: 1 problems"),
    ],
)
def test_what_rests_on_too_little_is_seen(text: str, said: str) -> None:
    (found,) = unfounded(text)
    assert said in found


def declared() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every tuple of columns that a module of the analysis declares."""
    for each in pkgutil.walk_packages(studies.analysis.__path__, "studies.analysis."):
        module = importlib.import_module(each.name)
        for name, value in vars(module).items():
            if name.endswith("COLUMNS") and isinstance(value, tuple):
                yield f"{each.name}.{name}", value


def test_tables_declare_both_count_and_solved_share_beside_their_medians() -> None:
    known = dict(declared())
    assert SUMMARY_COLUMNS in known.values()
    whole = {name: columns for name, columns in known.items() if not name.endswith(".RATIO_COLUMNS")}
    assert {name: bare_columns(columns) for name, columns in whole.items() if bare_columns(columns)} == {}
    assert bare_columns(tuple(c for c in SUMMARY_COLUMNS if "solved" not in c)) == ["seconds_ratio", "operations_ratio"]
