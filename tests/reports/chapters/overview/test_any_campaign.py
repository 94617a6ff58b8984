"""The pages of any campaign, from a small one that is really solved and analysed."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.cost import advice_part
from reports.files import write_texts
from reports.reading import StoreError
from reports.site import check_pages, compare_pages, rendered
from reports.store import load_store
from studies.analysis.everything import analyse
from studies.run.campaigns.file import read
from studies.run.campaigns.run import run
from support.pages.medians import unfounded

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
def test_pages_are_the_same_again(solved: Path) -> None:
    assert rendered(load_store(solved)) == rendered(load_store(solved))


def test_pages_are_made_with_their_pictures(files: dict[str, str]) -> None:
    assert {"index.md", "data.md"} == {name for name in files if name.endswith(".md")}
    shown = {name for text in files.values() for name in re.findall(r"\]\((figures/\S+\.svg)\)", text)}
    assert shown == {name for name in files if name.endswith(".svg")}


def test_links_lead_somewhere(files: dict[str, str]) -> None:
    for name, text in files.items():
        if name.endswith(".md"):
            assert set(re.findall(r"\]\(([a-z-]+\.md)\)", text)) <= set(files)


def test_outcomes(files: dict[str, str]) -> None:
    text = files["data.md"]
    assert re.search(r"\| `trial-and-error` \| (\d+) \| \1 \| 100.0 % \| 0 \| 0 \|", text)
    assert "| `lcp` |" not in text
    assert {name: unfounded(page) for name, page in files.items() if unfounded(page)} == {}


def test_advice(solved: Path) -> None:
    text = advice_part(load_store(solved)).text
    assert re.search(r"the tolerance is met in [\d.]+ % of the \d+ that were advised", text)
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
    assert again["data.md"] != files["data.md"]
    assert compare_pages(again, tmp_path / "pages") == []
    assert check_pages(store, tmp_path / "pages") == []


def test_without_its_tables_there_is_no_page(store: Path) -> None:
    (store / "tables" / "held_out.csv").unlink()
    assert advice_part(load_store(store)).text == ""
    shutil.rmtree(store / "tables")
    assert set(rendered(load_store(store))) == {"index.md", "report.html"}


def test_tables_of_another_campaign_are_not_mixed_in(store: Path) -> None:
    path = store / "tables" / "held_out.csv"
    pd.read_csv(path).assign(campaign="other").to_csv(path, index=False)
    assert advice_part(load_store(store)).text == ""
    with pytest.raises(StoreError, match=r"held_out\.csv: not of campaign 'small'"):
        load_store(store).table("held_out")


def test_a_damaged_table_is_one_line(store: Path) -> None:
    path = store / "tables" / "contact_summary.csv"
    pd.read_csv(path).drop(columns="both").to_csv(path, index=False)
    with pytest.raises(StoreError, match=r"data\.md lacks 'both'"):
        rendered(load_store(store), draw=False)
