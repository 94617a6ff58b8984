"""The page of cost: parts of the tyre that are the whole, and one that is not."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.trade.cost import cost_page
from reports.chapters.trade.scaling import STEP
from reports.store.tables import load_store
from studies.campaigns.report_cells import MODELS
from studies.store.atomic import write_json, write_table
from support.stores.made_up import analysed_again


def place(root: Path, label: str) -> Path:
    index = json.loads((root / "campaigns" / "report.json").read_text())
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == label)


def row(text: str, start: str) -> list[str]:
    return [word.strip() for line in text.splitlines() if line.startswith(start) for word in line.split("|")[1:-1]]


def test_parts_that_are_the_whole(store: Path) -> None:
    text = cost_page(load_store(store)).text
    assert f"{len(MODELS)} of {len(MODELS)} models give the force" in text
    assert row(text, "| isotropic | `quarter` | 10080 ")[2:] == ["10080", "9", "9", "under 1e-09", "under 1e-09"]
    assert row(text, "| isotropic | `quarter` | 1.25 ")[-1] == "100 %"


@pytest.mark.slow
def test_a_part_that_is_not_is_counted(own_store: Path) -> None:
    path = place(own_store, "model half angle plies").with_suffix(".json")
    result = json.loads(path.read_text())
    result["steps"][0]["force_N"] *= 1 + 3e-8
    write_json(path, result)
    contact = place(own_store, "model mirror isotropic") / "contact.csv"
    table = pd.read_csv(contact)
    table.loc[table.index[0], "active"] = 1 - table.loc[table.index[0], "active"]
    write_table(contact, table)
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    assert f"{len(MODELS) - 2} of {len(MODELS)} models give the force" in text
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
    ahead = "`extrapolated` 500, `local` 2001, `adapted` 8001 unknowns"  # the fewest first
    assert f"- 0.2 %, element `paper`: {ahead}; none of `uniform`, `patch`\n" in text
    assert "2000.0 N: they are 0.01 % apart, and the mean is known to 0.15 %, grey below that. A force" in text


REACHED = r"^- (\S+) %, element `(\w+)`: (.*?) ?(unknowns|CPU seconds)?(?:(?:; )?none of (.*))?$"


def stated(text: str, unit: str) -> dict[tuple[float, str, str], str]:
    """What the page says of each error, element and family, as text; nothing for none."""
    found = {}
    for within, element, reached, of, never in re.findall(REACHED, text, re.MULTILINE):
        if of in ("", unit):
            amounts = dict(re.findall(r"`(\w+)` ([\d.]+)", reached))
            names = dict.fromkeys(re.findall(r"`(\w+)`", never), "")
            found |= {(float(within) / 100, element, family): amount for family, amount in (amounts | names).items()}
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_the_sentences_say_what_the_grids_did(own_store: Path, seed: int) -> None:
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
            good = [
                grid
                for grid in own.itertuples()
                if all(abs(each.error) <= within for each in own.itertuples() if each.unknowns >= grid.unknowns)
            ]
            first = min(good, key=lambda grid: grid.unknowns, default=None)
            unknowns[within, *of] = "" if first is None else f"{first.unknowns}"
            seconds[within, *of] = "" if first is None else f"{first.total_s:.2f}"
    assert {*unknowns.values()} > {""}
    text = cost_page(load_store(own_store)).text
    assert stated(text, "unknowns") == unknowns
    assert stated(text, "CPU seconds") == seconds


@pytest.mark.parametrize(("known", "said"), [(0.003, "reaches 0.2 %, which"), (0.02, "reaches 1 % or 0.2 %, which")])
def test_what_the_reference_is_not_good_enough_for_is_said(own_store: Path, known: float, said: str) -> None:
    path = own_store / "tables" / "work_precision.csv"
    write_table(path, pd.read_csv(path).assign(known=known))
    text = cost_page(load_store(own_store)).text
    assert f"known to {100 * known:.2f} %, grey below that. Whether a grid {said} is less, is not decided." in text


@pytest.mark.slow
def test_scaling_is_shown_where_it_was_measured(own_store: Path) -> None:
    assert "Not measured here" in cost_page(load_store(own_store)).text
    n = [1000, 10_000, 100_000]
    parts = (*STEP, "assembly", "analysis", "superlu", "core", "gemm", "copy")
    times = {f"{part}_s": [1e-6 * k for k in n] for part in parts} | {"backward_error": [1e-16, 3e-16, 2e-16]}
    times["factorisation_s"] = [1e-9 * k**1.5 for k in n]
    times["superlu_s"] = [4e-9 * n[0] ** 1.5, 2e-9 * n[1] ** 1.5, math.nan]
    times["core_s"] = [0.5e-9 * k**1.5 for k in n]
    sizes = {"mesh": ["a", "b", "c"], "dofs": n, "elements": n, "peak_GiB": [1.0] * 3, "repeats": [3] * 3}
    write_table(own_store / "tables" / "scaling.csv", pd.DataFrame({**sizes, **times}))
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    assert row(text, "| exponent |")[2:6] == ["1.00", "1.00", "1.50", "1.00"]
    assert row(text, "| c |")[1:3] == ["100000", "100.0"]
    assert [row(text, f"| {mesh} |")[8] for mesh in "abc"] == ["0.25", "0.50", "–"]
    said = " ".join(text.split())
    assert "takes [0.25, 0.50] of the time of SuperLU" in said
    assert "[2.0, 2.0] times what its operations take" in said
    assert "a backward error of 3.0e-16 or less" in said
    assert "A step with 100,000 unknowns takes 0.1 s and 1.0 GiB" in said


@pytest.mark.slow
def test_peers_are_shown_where_they_were_measured(own_store: Path) -> None:
    assert "with the extra peers" in cost_page(load_store(own_store)).text
    shell = ("hemisphere", "footprint", "default", "16x16", 1665, 8.1, 8, 0.2, 0.02, 0.1, 0.04, 3, 1.0)
    peer = ("hemisphere", "kratos", "thick", "20x20", 2646, 8.15, 50, 8.0, 0.1, 5.0, 2.0, 3, 40.0)
    columns = ["problem", "program", "family", "mesh", "unknowns", "value", "iterations", "seconds"]
    columns += ["start", "assembly", "factorisation", "runs", "units"]
    never = ("hemisphere", "kratos", "thin", "8x8", 486, 7.0, 50, 1.0, 0.1, 0.5, 0.2, 3, 5.0)
    measured = pd.DataFrame([shell, peer, never], columns=columns)
    judged = measured.assign(within=0.01, bar=50.0, uncertainty=0.002, error=measured["value"] / 8.178 - 1)
    write_table(own_store / "tables" / "peers.csv", judged)
    assert "with the extra peers" in cost_page(load_store(own_store)).text  # not analysed yet
    analysed_again(own_store)
    page = cost_page(load_store(own_store))
    assert (
        "`kratos` (thick, 20x20) takes 40.0 times the time of `footprint` (default, 16x16); the bar of 50 is"
        in page.text
    )
    found = row(page.text, "| hemisphere | `kratos` | thick | 1 % |")
    assert found[4:] == ["20x20", "2646", "-0.34 %", "8.00", "40.0", "40.0", "+0.62 %"]
    assert row(page.text, "| hemisphere | `kratos` | thin | 1 % |")[4:10] == ["–"] * 6
    assert "hemisphere" in page.pictures["cost-peers.svg"]()
