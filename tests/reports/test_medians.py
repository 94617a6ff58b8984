"""No median without the number of problems it is of and the share that is solved; no ranking of fewer than five."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path

import pandas as pd
import pytest

import studies.analysis
from reports.chapters.trade.compared import contacts_part, measures_part, profiles_part
from reports.chapters.trade.solved_and_failed import solved_and_failed
from reports.store.tables import Store
from studies.analysis.everything import written
from studies.analysis.findings.contact_summary import SUMMARY_COLUMNS, contact_summary
from studies.analysis.findings.equal_accuracy import cheaper_measures, equal_accuracy
from studies.analysis.findings.outcomes import outcomes
from studies.analysis.ranking.fronts import fronts
from studies.analysis.ranking.profiles import PAIR_COLUMNS, profiles
from studies.analysis.ranking.unsolved import unsolved
from studies.analysis.verify import verified
from support.pages.medians import bare_columns, unfounded
from support.stores.sweeps import cells

CAMPAIGN = "made"
CONTACTS = {"semismooth": 1.0, "lcp": 0.5}


def sweep() -> pd.DataFrame:
    """Two algorithms on two scenes, on one of which lcp loses the finest mesh; three measures on a third one."""
    touching = [
        cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS),
        cells("heavy-strip", "lift_force", 1.0, contacts=CONTACTS),
    ]
    measured = cells(measures={"exact": 0.0, "sanders": 0.0, "linear": 0.5}, sizes=(4, 8, 16, 32, 64))
    table = pd.concat([*touching, measured], ignore_index=True).assign(path_end="", reason="")
    lost = (table["scene"] == "heavy-strip") & (table["contact"] == "lcp") & (table["n1"] == 64)
    table.loc[lost, ["outcome", "reason"]] = ["cap-hit", "200 iterations"]
    return table


def store_of(path: Path, table: pd.DataFrame) -> Store:
    scenes = fronts(table, verified(table))
    profile, pairs, flips = profiles(scenes)
    tables = {"profiles": profile, "pairs": pairs, "flips": flips, "unsolved": unsolved(table)}
    tables |= {"outcomes": outcomes(table), "contact_summary": contact_summary(table)}
    tables |= {"equal_accuracy": equal_accuracy(scenes), "cheaper_measures": cheaper_measures(scenes)}
    written(path, CAMPAIGN, tables)
    return Store(path, CAMPAIGN, ())


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return store_of(tmp_path_factory.mktemp("medians"), sweep())


PARTS = (measures_part, contacts_part, profiles_part, solved_and_failed)


def test_pages_say_what_their_medians_rest_on(store: Store) -> None:
    texts = [part(store).text for part in PARTS]
    assert [unfounded(text) for text in texts] == [[]] * len(PARTS)
    assert any("[" in line for line in texts[1].splitlines() if line.startswith("| `lcp` |")), "there is a median"


LINES = {
    "failures stand in the table of scenes": (
        solved_and_failed,
        "| `heavy-strip` | 4/4 | **3/4** |",
        "| all | 8/8 | **7/8** |",
        "| `heavy-strip` | `lcp` | 4 | 3 | 75 % | 0 | 1 | 0 | 1 iteration limit |",
    ),
    "a cost is that of what both solve": (
        contacts_part,
        "| `lcp` | 8 | 87.5 % of 8 | 0 | `heavy-strip` 1/4 | 7 (2) | 0.50 [0.50, 0.50] | 0.50 [0.50, 0.50] |",
    ),
    "equal measures are no cheaper": (
        measures_part,
        "| `sanders` | classical nonlinear | 100 % of 5 | 5 (1) | 1.00 [–, –] | 1.00 [–, –] | 0, 0, 0 |",
        "| `linear` | linear | 0 % of 5 | 0 (0) | – | – | 0, 0, 0 |",
        "No measure is cheaper than `exact` for any of them.",
    ),
    "seconds above the diagonal, operations below": (
        profiles_part,
        "| `semismooth` |  | 2.00 (7) |",
        "| `lcp` | 0.50 (7) |  |",
    ),
}


@pytest.mark.parametrize("what", LINES)
def test_pages_say_of_the_sweep(store: Store, what: str) -> None:
    part, *lines = LINES[what]
    text = part(store).text
    assert [line for line in lines if line not in text] == []


def test_too_few_problems_make_no_ranking_on_a_page(tmp_path: Path) -> None:
    """Four problems of one scene: nothing is ranked and no ratio is printed."""
    few = store_of(tmp_path, cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS))
    text = profiles_part(few).text + contacts_part(few).text
    assert unfounded(text) == []
    assert " > " not in text
    assert "contact: not ranked: problems in common: 4." in text


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
    assert bare_columns(tuple(c for c in PAIR_COLUMNS if c != "both")) == ["ratio"]
    assert bare_columns(tuple(c for c in SUMMARY_COLUMNS if "solved" not in c)) == ["seconds_ratio", "operations_ratio"]
