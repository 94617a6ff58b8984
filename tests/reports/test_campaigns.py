"""The pages of any campaign: one that is really solved, one that is made up with a cell of each class, and the data."""

from __future__ import annotations

import importlib
import json
import pkgutil
import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import studies.analysis
from reports.chapters.cost import advice_part
from reports.chapters.index import campaign_page
from reports.files import StoreError, write_texts
from reports.origin import completeness_line, summary_table
from reports.site import check_pages, compare_pages, place_of, rendered
from reports.store import Store, load_store
from studies.analysis.everything import analyse, written
from studies.analysis.outcomes import SUMMARY_COLUMNS, contact_summary, outcomes
from studies.ask.request import Request
from studies.cli import main
from studies.output.atomic import SCHEMA, write_json, write_table, write_text
from studies.run.campaign import read
from studies.run.plan import Row
from studies.run.running import run
from studies.scenes.complete import Cell
from support.pages import bare_columns, edit_json, unfounded
from support.stores.campaigns import analysed_again
from support.stores.convergence import cells

ROOT = Path(__file__).parents[2]

# --- a campaign that is solved --------------------------------------------------------------------------------------

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


def with_times(store: Path, seconds: Any) -> None:
    """Milliseconds would be ranked by chance."""
    for path in (store / "cells").glob("*.json"):
        edit_json(path, lambda record: record["timing_s"].update(seconds(record)))
    analyse(store, "small")


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("analysed")
    (folder / "small.toml").write_text(CAMPAIGN)
    run(read(folder / "small.toml"), folder / "store")
    with_times(folder / "store", lambda record: {"cpu": 1e-9 * record["counters"]["operations"]})
    return folder / "store"


@pytest.fixture(scope="module")
def pages(solved: Path) -> dict[str, str]:
    return rendered(load_store(solved), draw=False)


@pytest.fixture
def own(solved: Path, tmp_path: Path) -> Path:
    """A copy, to be broken."""
    return Path(shutil.copytree(solved, tmp_path / "store"))


def test_pages_have_their_pictures_their_links_and_what_medians_rest_on(pages: dict[str, str]) -> None:
    assert {"index.md", "data.md"} == {name for name in pages if name.endswith(".md")}
    shown = {name for text in pages.values() for name in re.findall(r"\]\((figures/\S+\.svg)\)", text)}
    assert shown == {name for name in pages if name.endswith(".svg")}
    for name in ("index.md", "data.md"):
        assert set(re.findall(r"\]\(([a-z-]+\.md)\)", pages[name])) <= set(pages)
        assert unfounded(pages[name]) == []
    assert re.search(r"\| `trial-and-error` \| (\d+) \| \1 \| 100.0 % \| 0 \| 0 \|", pages["data.md"])
    assert "| `lcp` |" not in pages["data.md"]


@pytest.mark.slow
def test_what_depends_on_the_clock_is_not_compared(own: Path, pages: dict[str, str], tmp_path: Path) -> None:
    """Other times, other fronts and other advice: the pages still agree, and their words have changed."""
    write_texts(tmp_path / "pages", pages)
    rng = np.random.default_rng(3)
    with_times(own, lambda record: {name: float(rng.lognormal(0, 2)) for name in record["timing_s"]})
    again = rendered(load_store(own), draw=False)
    assert again["data.md"] != pages["data.md"]
    assert compare_pages(again, tmp_path / "pages") == []
    assert check_pages(own, tmp_path / "pages") == []


def test_advice_is_told_where_its_tables_are_of_this_campaign_and_whole(own: Path) -> None:
    text = advice_part(load_store(own)).text
    assert re.search(r"the tolerance is met in [\d.]+ % of the \d+ with advice", text)
    assert "nan" not in text
    path = own / "tables" / "held_out.csv"
    pd.read_csv(path).assign(campaign="other").to_csv(path, index=False)
    assert advice_part(load_store(own)).text == ""
    with pytest.raises(StoreError, match=r"held_out\.csv: not of campaign 'small'"):
        load_store(own).table("held_out")
    path.unlink()
    assert advice_part(load_store(own)).text == ""
    path = own / "tables" / "contact_summary.csv"
    pd.read_csv(path).drop(columns="both").to_csv(path, index=False)
    with pytest.raises(StoreError, match=r"data\.md lacks 'both'"):
        rendered(load_store(own), draw=False)
    shutil.rmtree(own / "tables")
    assert set(rendered(load_store(own))) == {"index.md", "report.html"}


@pytest.mark.slow
def test_a_campaign_of_one_configuration_is_analysed_and_reported(tmp_path: Path) -> None:
    """Neither measure, algorithm, iteration nor element varies."""
    campaign, store = tmp_path / "t.toml", str(tmp_path / "store")
    campaign.write_text('title = "t"\n[[cross]]\nname = "t"\n[cross.scenes.panel]\nmeshes = ["2x2"]\n')
    assert main(["run", str(campaign), "--store", store]) == 0
    assert main(["analyse", "t", "--store", store]) == 0
    assert main(["report", "--store", store, "--out", str(tmp_path / "pages")]) == 0
    assert "# Appendix" in (tmp_path / "pages" / "data.md").read_text(encoding="utf-8")


# --- one with a cell of each class ----------------------------------------------------------------------------------

REQUEST = {"scene": "cantilever", "measure": "exact", "contact": "semismooth", "newton": "mixed", "model": "full"}
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
EXACT = 6.69964  # mm, the tip deflection that the scene knows
LIMIT, ORDER = 1.01 * EXACT, 2.0
CLASSES = ("converged",) * 3 + ("wrong", "not-converged", "cap-hit", "time", "memory", "crash", "missing")


def record(cell_id: str, n: int, ended: str = "converged", **more: Any) -> dict[str, Any]:
    value = LIMIT + 5.0 * n**-ORDER
    step = {"load_fraction": 1.0, "kkt": KKT, "failures": [], "rounding": 0.0, "newton_iterations": 1, "substeps": 1}
    counters = {"newton_iterations": 7, "factorisations": 8, "assemblies": 9, "operations": 1000}
    ending = {"outcome": ended, "class": ended, "reason": f"{ended} because"}
    answer = {"quantities": {"tip_deflection_mm": value}, "steps": [step], "cuts": [], "counters": counters}
    asked = {**REQUEST, "mesh": f"{n}x1", "settings": {"tolerance": 1e-9}}
    about = {"schema": SCHEMA, "id": cell_id, "timing_s": {}, "provenance": {}, "files": []}
    return {**about, **asked, **ending, **answer, **more}


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """Three meshes, and one cell of each class beside them."""
    rows = []
    for i, ended in enumerate(CLASSES):
        n, cell_id = 2 ** (i + 3), f"{i:x}"
        request = Request.of({**REQUEST, "mesh": [n, 1], "settings": {"tolerance": 1e-9}, "steps": 1})
        rows.append(Row(Cell(f"cell {n}", "cantilever", {}, {}, artefacts=False), cell_id, request).as_json())
        if ended in ("time", "memory", "crash"):
            stated = {"schema": SCHEMA, "id": cell_id, "class": ended, "reason": f"{ended} because"}
            write_json(tmp_path / "failures" / f"{cell_id}.json", stated)
        elif ended != "missing":
            write_json(tmp_path / "cells" / f"{cell_id}.json", record(cell_id, n, ended))
    odd = Cell("odd", "cantilever", {"contact": "qp"}, artefacts=False)
    rows.append(Row(odd, None, None, "no contact").as_json())
    at = {"load_fraction": 1.0, "measure": "exact"}
    reference = {"scene": "cantilever", "quantity": "tip_deflection_mm", "value": EXACT, "at": at, "kind": "exact"}
    reference |= {"source": "here", "uncertainty": 0.0}
    write_json(tmp_path / "references.json", {"schema": SCHEMA, "references": [reference]})
    stated = {"schema": SCHEMA, "campaign": "made-up", "title": "Made up", "pages": "", "cells": rows}
    write_json(tmp_path / "campaigns" / "made-up.json", stated)
    return tmp_path


def test_every_class_is_counted_and_counters_are_sums_over_what_has_converged(small: Path) -> None:
    loaded = load_store(small)
    text = campaign_page(loaded, "").text
    classes = ", ".join(f"{3 if each == 'converged' else 1} {each}" for each in dict.fromkeys(CLASSES[:-1]))
    assert completeness_line(loaded) == f"made-up: 11 cells planned: {classes}, 1 unsupported, 1 missing"
    assert text.index("## Completeness") > text.index("## Orders")
    assert "| cantilever | 11 | 3 | 1 | 1 | 1 | 1 | 1 | 1 | 1 | 1 |" in text
    assert "| cell 512 | time | time because |" in text
    assert "| cantilever | no contact | 1 |" in text
    assert "| cantilever | `semismooth` | 1e-09 | 9 | 3 | 6 | 21 | 24 | 27 | 3.00e+03 |" in text
    assert place_of(small)[0] == "made-up"
    assert list(rendered(loaded)) == ["index.md", "report.html"]


def test_orders_limits_and_errors_are_those_that_were_put_in(small: Path) -> None:
    analysed_again(small, "made-up")
    text = campaign_page(load_store(small), "").text
    line = next(line for line in text.splitlines() if line.startswith("| cantilever | exact | tip_deflection_mm |"))
    words = [word.strip() for word in line.split("|")[1:-1]]
    assert words[3] == "8x1, 16x1, 32x1"  # those that are wrong or did not converge are no part of it
    assert words[5:] == ["2.00", "6.76664", "6.69964", "exact", "+1.00 %"]


@pytest.mark.parametrize(
    ("path", "text", "says"),
    [
        ("cells/0.json", "{", "cells/0.json: cannot be read"),
        ("cells/0.json", "[]", "cells/0.json: expected a record"),
        ("cells/0.json", '{"schema": 1}', "cells/0.json: schema 1, but this program reads 2"),
        ("cells/0.json", '{"schema": 2}', "cells/0.json: lacks id"),
        ("cells/0.json", json.dumps(record("0", 8, steps=[{}])), "cells/0.json: lacks kkt"),
        ("cells/0.json", json.dumps(record("1", 16)), "of cell '1' of cantilever, not of 'cell 8'"),
        ("failures/6.json", "", "failures/6.json: cannot be read"),
        ("campaigns/made-up.json", '{"schema": 1}', "made-up.json: schema 1, but this program reads 2"),
        ("campaigns/another.json", "{}", "has the campaigns another, made-up; choose one by --campaign"),
        ("campaigns/made-up.json", None, ": no campaign"),
    ],
)
def test_what_is_wrong_with_a_store_is_one_line(small: Path, path: str, text: str | None, says: str) -> None:
    if text is None:
        (small / path).unlink()
    else:
        write_text(small / path, text)
    with pytest.raises(StoreError) as caught:
        load_store(small)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_where_the_numbers_were_made_is_told_of_all_cells(small: Path) -> None:
    """A record of old does not say whether the files were modified."""
    made = {"version": "1.0", "commit": "abc", "packages": {"numpy": "2"}, "machine": {"cores": 2}}
    for n, more in enumerate(({}, {"modified": False}, {"modified": True})):
        stated = record(f"{n:x}", 2 ** (n + 3), provenance={**made, **more}, timing_s={"total": 2.0, "cpu": 1.5})
        write_json(small / "cells" / f"{n:x}.json", stated)
    text = campaign_page(load_store(small), "").text
    assert "| commit | abc: 2 cells; abc (modified): 1 cells |" in text
    assert "| time on the clock, processor time of all cells [s] | 6.00, 4.50 |" in text
    assert text.index("<!-- machine -->\n\n**Where the numbers were made**") > text.index("## Machine")


# --- medians --------------------------------------------------------------------------------------------------------

CONTACTS = {"semismooth": 1.0, "lcp": 0.5}


def sweep() -> pd.DataFrame:
    """Two algorithms on two scenes, on one of which lcp loses the finest mesh."""
    strip = cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS)
    heavy = cells("heavy-strip", "lift_force", 1.0, contacts=CONTACTS)
    table = pd.concat([strip, heavy], ignore_index=True).assign(path_end="", reason="")
    lost = (table["scene"] == "heavy-strip") & (table["contact"] == "lcp") & (table["n1"] == 64)
    table.loc[lost, ["outcome", "reason"]] = ["cap-hit", "200 iterations"]
    return table


def summary_of(path: Path, table: pd.DataFrame) -> str:
    written(path, "made", {"outcomes": outcomes(table), "contact_summary": contact_summary(table)})
    return str(summary_table(Store(path, "made", ())))


def test_a_cost_is_that_of_what_both_solve_and_too_few_problems_make_no_ratio(tmp_path: Path) -> None:
    text = summary_of(tmp_path / "two", sweep())
    assert unfounded(text) == []
    assert "| `lcp` | 7 | 8 | 87.5 % | 1 | 0 | 0.50 [0.50, 0.50] | 7 (2) |" in text
    few = cells("strip-contact", "half_force", 2.0, "load_fraction=5", contacts=CONTACTS)  # four of one scene
    assert unfounded(summary_of(tmp_path / "one", few)) == []


def test_which_algorithm_is_faster_moves_nothing_outside_of_what_is_of_the_machine(edited: Store) -> None:
    """Rows stand in the order of their seconds, which another machine may have in another order."""
    here, path = str(summary_table(edited)), edited.path / "tables" / "contact_summary.csv"
    write_table(path, pd.read_csv(path)[::-1])
    there = str(summary_table(replace(edited)))
    assert here != there
    assert compare_pages({"page.md": here}, write_texts(edited.path / "pages", {"page.md": there})[0].parent) == []


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
    (actual,) = unfounded(text)
    assert said in actual


def declared() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every tuple of columns that a module of the analysis declares."""
    for each in pkgutil.walk_packages(studies.analysis.__path__, "studies.analysis."):
        for name, value in vars(importlib.import_module(each.name)).items():
            if name.endswith("COLUMNS") and isinstance(value, tuple):
                yield f"{each.name}.{name}", value


def test_tables_declare_both_count_and_solved_share_beside_their_medians() -> None:
    known = dict(declared())
    assert SUMMARY_COLUMNS in known.values()
    whole = {name: columns for name, columns in known.items() if not name.endswith(".RATIO_COLUMNS")}
    assert {name: bare_columns(columns) for name, columns in whole.items() if bare_columns(columns)} == {}
    assert bare_columns(tuple(c for c in SUMMARY_COLUMNS if "solved" not in c)) == ["seconds_ratio", "operations_ratio"]


# --- the data beside the pages --------------------------------------------------------------------------------------


def test_the_data_have_every_planned_cell_and_their_columns(files: dict[str, str], loaded: Store) -> None:
    """As many cells as every foot says, and of each class."""
    names = ("cells.csv.gz", "answers.csv.gz", "columns.csv")
    planned, answers, columns = (pd.read_csv(StringIO(files[f"data/{name}"])) for name in names)
    assert list(planned["label"].sort_values()) == sorted(each.label for each in loaded.planned)
    counts = planned["outcome"].value_counts().to_dict()
    stated = re.search(r"\*report: (\d+) cells planned: (.*?);", files["tyre.md"])
    assert int(stated[1]) == len(planned)
    assert {name: int(n) for n, name in (part.split(" ", 1) for part in stated[2].split(", "))} == counts
    for name, table in (("cells", planned), ("answers", answers)):
        assert list(table) == list(columns.loc[columns["table"] == name, "column"])
    assert columns["description"].notna().all()


def test_the_example_of_the_page_runs(files: dict[str, str], tmp_path: Path, monkeypatch, capsys) -> None:
    write_texts(tmp_path, {name: text for name, text in files.items() if name.startswith("data/")})
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", files["data.md"], re.DOTALL)
    exec(code, {})
    assert "exact" in capsys.readouterr().out


def test_what_is_committed_stays_small() -> None:
    paths = (ROOT / "reports" / "pages").rglob("data/*")
    assert sum(path.stat().st_size for path in paths) < 2_000_000
