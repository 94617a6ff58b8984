"""The page of cost: parts of the tyre that are the whole, and one that is not."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

from reports.chapters.trade.cost import STEP, cost_page
from reports.tables import load_store
from studies.campaigns.report_cells import MODELS
from studies.store.atomic import write_json, write_table
from support.made_up import analysed_again


def place(root: Path, label: str) -> Path:
    index = json.loads((root / "campaigns" / "report.json").read_text())
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == label)


def row(text: str, start: str) -> list[str]:
    return [word.strip() for line in text.splitlines() if line.startswith(start) for word in line.split("|")[1:-1]]


def test_parts_that_are_the_whole(store: Path) -> None:
    text = cost_page(load_store(store)).text
    assert f"{len(MODELS)} of {len(MODELS)} models give the force" in text
    assert row(text, "| isotropic | `quarter` | 10 ")[2:] == ["10", "9", "9", "under 1e-09", "under 1e-09"]
    assert row(text, "| isotropic | `quarter` | 1.25 ")[-1] == "100 %"


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
    assert row(text, "| angle plies | `half` | 10 ")[-2:] == ["3.0e-08", "under 1e-09"]
    assert row(text, "| isotropic | `mirror` | 10 ")[-1] == "inf"


def test_grids_that_reach_one_per_cent(store: Path) -> None:
    text = cost_page(load_store(store)).text
    assert row(text, "| `paper` | `uniform` |")[2:6] == ["4001x1", "4001", "2020.0", "+1.00 %"]
    assert row(text, "| `paper` | `adapted` |")[2:4] == ["1001x1", "1001"]
    assert row(text, "| `paper` | `patch` |")[2:] == ["–"] * 4
    assert row(text, "| `paper` | `uniform` |")[6:] == ["`paper`", "`uniform`", "0.10", "0.20"]
    assert "element `paper`: 25 % of the unknowns of a uniform grid; element `refined`: 25 %" in text


def test_scaling_is_shown_where_it_was_measured(own_store: Path) -> None:
    assert "Not measured here" in cost_page(load_store(own_store)).text
    n = [1000, 10_000, 100_000]
    times = {f"{part}_s": [1e-6 * k for k in n] for part in (*STEP, "assembly", "same_matrix", "gemm", "copy")}
    times["factorisation_s"] = [1e-9 * k**1.5 for k in n]
    sizes = {"mesh": ["a", "b", "c"], "dofs": n, "elements": n, "peak_GiB": [1.0] * 3, "repeats": [3] * 3}
    write_table(own_store / "tables" / "scaling.csv", pd.DataFrame({**sizes, **times}))
    analysed_again(own_store)
    text = cost_page(load_store(own_store)).text
    assert row(text, "| exponent |")[2:6] == ["1.00", "1.00", "1.50", "1.00"]
    assert row(text, "| c |")[1:3] == ["100000", "100.0"]


def test_peers_are_shown_where_they_were_measured(own_store: Path) -> None:
    assert "with the extra peers" in cost_page(load_store(own_store)).text
    columns = ["program", "elements", "unknowns", "force_N", "seconds", "error", "ratio"]
    rows = [("footprint", "36x34", 1836, 524.3, 0.16, 0.001, 1.0), ("ngsolve", "8x8", 7500, 524.57, 3.2, 0.0016, 20.0)]
    write_table(own_store / "tables" / "peers.csv", pd.DataFrame(rows, columns=columns))
    text = cost_page(load_store(own_store)).text
    assert row(text, "| ngsolve |")[1:] == ["8x8", "7500", "524.57", "+0.16 %", "3.20", "20.0"]
