"""The page of cost: parts of the tyre that are the whole, and one that is not."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from reports.page_cost import cost_page
from reports.schema import load_store
from studies.campaign import MODELS
from studies.store import write_json, write_table

pytestmark = pytest.mark.usefixtures("undrawn")


def place(root: Path, label: str) -> Path:
    index = json.loads((root / "campaign.json").read_text())
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == label)


def row(text: str, start: str) -> list[str]:
    return [word.strip() for line in text.splitlines() if line.startswith(start) for word in line.split("|")[1:-1]]


def test_parts_that_are_the_whole(store: Path) -> None:
    text = cost_page(load_store(store)).text
    assert f"{len(MODELS)} of {len(MODELS)} models give the force" in text
    assert row(text, "| isotropic | `quarter` | 10 ")[2:] == ["10", "9", "9", "under 1e-09", "under 1e-09"]
    assert row(text, "| isotropic | `quarter` | 1.25 ")[-1] == "100 %"


def test_a_part_that_is_not_is_counted(own_store: Path) -> None:
    path = place(own_store, "model half angle plies") / "result.json"
    result = json.loads(path.read_text())
    result["steps"][0]["force_N"] *= 1 + 3e-8
    write_json(path, result)
    contact = place(own_store, "model mirror isotropic") / "contact.csv"
    table = pd.read_csv(contact)
    table.loc[table.index[0], "active"] = 1 - table.loc[table.index[0], "active"]
    write_table(contact, table)
    text = cost_page(load_store(own_store)).text
    assert f"{len(MODELS) - 2} of {len(MODELS)} models give the force" in text
    assert row(text, "| angle plies | `half` | 10 ")[-2:] == ["3.0e-08", "under 1e-09"]
    assert row(text, "| isotropic | `mirror` | 10 ")[-1] == "inf"
