"""The pages of the trade and of advice, from a small campaign that is really solved and analysed."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.trade import advice, tradeoff
from reports.files import write_texts
from reports.site import check_pages, compare_pages, rendered
from reports.store.reading import StoreError
from reports.store.tables import Store, load_store
from studies.analysis.everything import analyse
from studies.campaigns.file import read
from studies.campaigns.run import run
from support.pages.medians import unfounded

ANYWHERE = ("questions.md", "findings.md", "glossary.md", "outcomes.md", "data.md")  # pages of any campaign
ANALYSIS = {each.file: each for each in (tradeoff.CHAPTER, advice.CHAPTER)}


def analysis_pages(store: Store) -> list[str]:
    return [name for name, each in ANALYSIS.items() if each.applies(store)]


CAMPAIGN = """
title = "small"
[[cross]]
name = "small"
measures = ["exact", "linear"]
contacts = ["semismooth", "trial-and-error", "regularised"]
tolerances = [1e-3, 1e-9]
[cross.scenes.cantilever]
meshes = ["4x1", "8x1", "16x1"]
set = { load_fraction = "0.25" }
[cross.scenes.strip-contact]
meshes = ["8x1", "16x1", "32x1"]
set = { load_fraction = "5" }
"""


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("analysed")
    (folder / "small.toml").write_text(CAMPAIGN)
    run(read(folder / "small.toml"), folder / "store")
    for path in (folder / "store" / "cells").glob("*.json"):  # milliseconds would be ranked by chance
        record = json.loads(path.read_text())
        record["timing_s"]["cpu"] = 1e-9 * record["counters"]["operations"]
        path.write_text(json.dumps(record))
    analyse(folder / "store", "small")
    return folder / "store"


@pytest.fixture(scope="module")
def files(solved: Path) -> dict[str, str]:
    return rendered(load_store(solved), draw=False)


@pytest.fixture
def store(solved: Path, tmp_path: Path) -> Path:
    """A copy, to be broken."""
    return Path(shutil.copytree(solved, tmp_path / "store"))


@pytest.mark.slow
def test_both_pages_are_the_same_again(solved: Path) -> None:
    assert rendered(load_store(solved)) == rendered(load_store(solved))


def test_both_pages_are_made_with_their_pictures(files: dict[str, str]) -> None:
    assert {"index.md", *ANALYSIS, *ANYWHERE} == {name for name in files if name.endswith(".md")}
    shown = {name for text in files.values() for name in re.findall(r"\]\((figures/\S+\.svg)\)", text)}
    assert shown == {name for name in files if name.endswith(".svg")}
    assert len(shown) == 5
    assert "[Cost and accuracy](tradeoff.md)" in files["index.md"]
    assert "[Advice](advice.md)" in files["tradeoff.md"]


def test_links_lead_somewhere(files: dict[str, str]) -> None:
    for name, text in files.items():
        if name.endswith(".md"):
            assert set(re.findall(r"\]\(([a-z-]+\.md)\)", text)) <= set(files)


def test_the_trade(solved: Path, files: dict[str, str]) -> None:
    text = files["tradeoff.md"]
    for title in (
        *("Largest part of the error", "Fronts per scene", "Fronts per family", "Pairs, seconds"),
        *("By contact algorithm: solved of put", "Solved, and the cost over the default where both solve"),
        *("Shares of the variance", "Walls of measures that approximate"),
    ):
        assert f"**{title}**" in text
    assert "| `cantilever` | `exact` | `semismooth` | 8x1 |" in text
    assert "footprint solve cantilever --measure exact --contact semismooth --mesh 8x1" in text
    flips = load_store(solved).analysis("flips")
    (whole,) = flips[(flips["cost"] == "seconds") & (flips["axis"] == "contact") & (flips["removed"] == "")]["ranking"]
    assert sorted(whole.split(" > ")) == ["regularised", "semismooth", "trial-and-error"]
    assert re.search(rf"- contact, \d+ problems: {re.escape(whole)}; ", text)
    assert "| `lcp` |" not in text
    assert re.search(r"\| `trial-and-error` \| (\d+) \| 100.0 % of \1 \| 0 \|", text)
    assert "tip_deflection_mm by linear | 10.483 % | formulation |" in text
    assert "nan" not in text
    assert {name: unfounded(page) for name, page in files.items() if unfounded(page)} == {}


def test_advice(files: dict[str, str]) -> None:
    text = files["advice.md"]
    (line,) = [line for line in text.splitlines() if line.startswith("| `cantilever` | `tip_deflection_mm` |")]
    assert line.count("|") == 10
    assert re.search(r"\| [\d.e-]+ \(\d+\) \|", line)  # seconds and unknowns
    assert "**Advice on scenes left out**" in text
    assert "nan" not in text


@pytest.mark.slow
def test_what_depends_on_the_clock_is_not_compared(store: Path, files: dict[str, str], tmp_path: Path) -> None:
    """Other times, other fronts and other advice: the pages still agree, and their words have changed."""
    write_texts(tmp_path / "pages", files)
    rng = np.random.default_rng(3)
    for path in (store / "cells").glob("*.json"):
        record = json.loads(path.read_text())
        record["timing_s"] = {name: float(rng.lognormal(0, 2)) for name in record["timing_s"]}
        path.write_text(json.dumps(record))
    analyse(store, "small")
    again = rendered(load_store(store), draw=False)
    assert again["tradeoff.md"] != files["tradeoff.md"]
    assert again["advice.md"] != files["advice.md"]
    assert compare_pages(again, tmp_path / "pages") == []
    assert check_pages(store, tmp_path / "pages") == []


def test_too_few_problems_are_said_and_not_ranked(store: Path) -> None:
    for name in ("flips", "pairs", "solved"):
        path = store / "tables" / f"{name}.csv"
        table = pd.read_csv(path)
        few = {"problems": 1, "ranking": "", "flips": "", "removed": "", "ratio": np.nan, "asked": 1, "solved": 1}
        table.assign(**{key: value for key, value in few.items() if key in table}).to_csv(path, index=False)
    files = rendered(load_store(store), draw=False)
    assert "- contact: not ranked: problems in common: 1." in files["tradeoff.md"]
    assert "No pair has enough problems in common (seconds)." in files["tradeoff.md"]


def test_without_its_tables_there_is_no_page(store: Path) -> None:
    (store / "tables" / "flips.csv").unlink()
    assert set(analysis_pages(load_store(store))) == {"advice.md"}
    shutil.rmtree(store / "tables")
    files = rendered(load_store(store))
    assert set(files) == {"index.md", "glossary.md", "outcomes.md", "report.html"}
    assert "tradeoff.md" not in files["index.md"]


def test_tables_of_another_campaign_are_not_mixed_in(store: Path) -> None:
    path = store / "tables" / "fronts.csv"
    pd.read_csv(path).assign(campaign="other").to_csv(path, index=False)
    assert set(analysis_pages(load_store(store))) == {"advice.md"}
    with pytest.raises(StoreError, match=r"fronts\.csv: not of campaign 'small'"):
        load_store(store).analysis("fronts")


def test_a_damaged_table_is_one_line(store: Path) -> None:
    path = store / "tables" / "advice.csv"
    pd.read_csv(path).drop(columns="bound").to_csv(path, index=False)
    with pytest.raises(StoreError, match=r"advice\.md lacks 'bound', of advice"):
        rendered(load_store(store), draw=False)
