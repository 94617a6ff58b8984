"""The page of cost: parts of the tyre that are the whole, and one that is not."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.cost import cost_page
from reports.store import load_store
from studies.analysis.tyre import BEHIND
from studies.output.atomic import write_table
from studies.run.campaigns.report_cells import MODELS
from support.pages.changed import edit_json, edit_table, place
from support.stores.made_up import analysed_again


def row(text: str, start: str) -> list[str]:
    return [word.strip() for line in text.splitlines() if line.startswith(start) for word in line.split("|")[1:-1]]


PARTS = sum(cell.options["model"] != "full" for cell in MODELS)


def test_parts_that_are_the_whole(store: Path) -> None:
    text = cost_page(load_store(store)).text
    assert f"{PARTS} of {PARTS} parts give the force" in text
    assert row(text, "| isotropic | `quarter` | 10080 ")[2:] == ["10080", "9", "9", "–", *["under 1e-09"] * 2]


@pytest.mark.slow
def test_a_part_that_is_not_is_counted(own_store: Path) -> None:
    path = place(own_store, "model half angle plies").with_suffix(".json")
    edit_json(path, lambda result: result["steps"][0].update(force_N=result["steps"][0]["force_N"] * (1 + 3e-8)))
    contact = place(own_store, "model mirror isotropic") / "contact.csv"
    table = pd.read_csv(contact)
    table.loc[table.index[0], "active"] = 1 - table.loc[table.index[0], "active"]
    write_table(contact, table)
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    assert f"{PARTS - 2} of {PARTS} parts give the force" in text
    assert row(text, "| angle plies | `half` | 10080 ")[-2:] == ["3.0e-08", "under 1e-09"]
    assert row(text, "| isotropic | `mirror` | 10080 ")[-1] == "inf"


def test_grids_that_reach_an_error(store: Path) -> None:
    text = cost_page(load_store(store)).text
    uniform = "| `paper` | `uniform` |"
    assert row(text, f"| 1 % {uniform}")[3:8] == ["4001x1", "4001", "100 %", "2020.0", "+1.00 %"]
    assert row(text, f"| 0.2 % {uniform}")[3:8] == ["–"] * 5
    assert row(text, "| 1 % | `paper` | `adapted` |")[3:6] == ["1001x1", "1001", "25 %"]
    assert row(text, "| 0.2 % | `paper` | `adapted` |")[3:8] == ["8001x1", "8001", "–", "2002.5", "+0.12 %"]
    assert row(text, "| 0.2 % | `paper` | `adapted` |")[8:] == ["0.2 %", "`paper`", "`adapted`", "8.00", "10.00"]
    assert row(text, "| 1 % | `paper` | `patch` |")[3:] == ["–"] * 5
    assert "2000.0 N: they are 0.01 % apart, and the mean is known to 0.15 %, grey below that. A force" in text


REACHED = r"^\| (\S+) % \| `(\w+)` \| `(\w+)` \| (.*) \|$"
COLUMNS = {8: 1, 5: 1}  # of a line with so many entries, where behind the family the unknowns stand, or all seconds


def stated(text: str, entries: int) -> dict[tuple[float, str, str], str]:
    """What a table with so many columns says of each error, element and family, as text; a dash for none."""
    found = {}
    for within, element, family, rest in re.findall(REACHED, text, re.MULTILINE):
        amounts = rest.split(" | ")
        if len(amounts) + 3 == entries:
            found[float(within) / 100, element, family] = amounts[COLUMNS[entries]]
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_the_tables_say_what_the_grids_did(own_store: Path, seed: int) -> None:
    """Errors at random around both bounds: every grid is looked at beside all that are finer."""
    random = np.random.default_rng(seed)
    path = own_store / "tables" / "work_precision.csv"
    grids = pd.read_csv(path)
    grids["error"] = 10 ** random.uniform(-4, -1.5, len(grids)) * random.choice([-1, 1], len(grids))
    grids["total_s"] = random.uniform(0.1, 99.0, len(grids)).round(2)
    write_table(path, grids.sample(frac=1.0, random_state=seed))
    analysed_again(own_store)
    unknowns, seconds = {}, {}
    for within in (0.01, 0.002):
        for of, own in grids.groupby(["element", "family"]):
            finer = {
                grid: [each for each in own.itertuples() if each.unknowns > grid.unknowns] for grid in own.itertuples()
            }
            good = [
                grid
                for grid, behind in finer.items()
                if len(behind) >= BEHIND and all(abs(each.error) <= within for each in (grid, *behind))
            ]
            first = min(good, key=lambda grid: grid.unknowns, default=None)
            unknowns[within, *of] = "–" if first is None else f"{first.unknowns}"
            if first is not None:
                seconds[within, *of] = f"{first.total_s:.2f}"
    assert {*unknowns.values()} > {"–"}
    text = cost_page(load_store(own_store)).text
    assert stated(text, 8) == unknowns
    assert stated(text, 5) == seconds


@pytest.mark.parametrize(("known", "said"), [(0.003, "reaches 0.2 %, which"), (0.02, "reaches 1 % or 0.2 %, which")])
def test_what_the_reference_is_not_good_enough_for_is_said(own_store: Path, known: float, said: str) -> None:
    edit_table(own_store, "work_precision", lambda grids: grids.assign(known=known))
    text = cost_page(load_store(own_store)).text
    assert f"known to {100 * known:.2f} %, grey below that. Whether a grid {said} is less, is not decided." in text
