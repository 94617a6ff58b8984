"""What the page of convergence says of the shares of the thickness strain, from tables that are made up."""

from __future__ import annotations

import json
import math
from collections.abc import Set
from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.shells.thickness_share import SHARES, said, thickness_share_part
from reports.store.tables import load_store
from studies.store.atomic import write_json
from support.stores.made_up import analysed_again


def scene(
    name: str, coarse: Set[str], fine: Set[str], wrong: Set[str] = frozenset(), last: Set[str] = frozenset()
) -> list[dict[str, object]]:
    """The shares that are nearest on both meshes; those that end where the finer mesh goes on, and where that ends."""
    rows: list[dict[str, object]] = []
    for half, near in ((False, fine), (True, coarse)):
        for share in SHARES:
            end = 0.7 if share in (wrong if half else last) else math.nan
            row = {"ladder": name, "share": share, "coarse": half, "nearest": share in near, "turns_at": end}
            rows.append(row | {"confirmed": share not in wrong if half else None})
    return rows


EVERYONE = frozenset(SHARES)


def test_the_sentence_counts_scenes_by_mesh_and_names_where_paths_end() -> None:
    found = [
        *scene("flat", EVERYONE, EVERYONE),
        *scene("curved", {"balanced"}, {"balanced", "nodal"}),
        *scene("folded", {"nodal"}, {"balanced"}, wrong={"nodal", "projected"}, last={"nodal"}),
        *scene("rolled", {"nodal"}, EVERYONE, wrong={"nodal"}),
        *scene("lost", set(), {"projected", "balanced"}),
    ]
    assert said(pd.DataFrame(found)) == (
        "On half of the default mesh all are equal in 1 of 5 scenes; best in others: `projected` in 0 (0 alone), "
        "`balanced` in 1 (1 alone), `nodal` in 2 (2 alone). On the default mesh all are equal in 2 of 5 scenes; best "
        "in others: `projected` in 1 (0 alone), `balanced` in 3 (1 alone), `nodal` in 1 (0 alone). Limit points that "
        "the default mesh does not confirm: `projected` in folded; `balanced` in none; `nodal` in folded, rolled. "
        "That mesh itself ends at one: `projected` in none; `balanced` in none; `nodal` in folded."
    )


def rows(store: Path, ladder: str) -> list[list[str]]:
    lines = thickness_share_part(load_store(store)).text.splitlines()
    return [[word.strip() for word in line.split("|")[1:-1]] for line in lines if line.startswith(f"| {ladder} |")]


def test_made_up_errors_are_shown_as_they_were_made(store: Path) -> None:
    """Second order, and the same with every share."""
    coarse, fine = rows(store, "scordelis-lo")
    assert coarse[:5] == ["scordelis-lo", "edge deflection [mm]", "8x8", "equal", "–"]
    assert coarse[5:] == [*["-10.00 %"] * 3, "9 / 9 / 9"]
    assert fine[2:8] == ["16x16", "equal", "–", *["-2.50 %"] * 3]


@pytest.mark.slow
def test_a_share_that_ends_early_is_not_confirmed_by_a_mesh_that_goes_on(own_store: Path) -> None:
    index = json.loads((own_store / "campaigns" / "report.json").read_text())
    (row,) = (row for row in index["cells"] if row["label"] == "share semicylinder 16x16 nodal")
    path = own_store / "cells" / f"{row['id']}.json"
    ended = {"outcome": "step-limit", "steps": [], "quantities": {"load_limit_point": 0.68}}
    write_json(path, json.loads(path.read_text()) | ended)
    analysed_again(own_store)
    coarse, fine = rows(own_store, "semicylinder")
    assert coarse[3:5] == ["projected, balanced", "– / – / 0.68 (not confirmed)"]
    assert coarse[7] == "–"
    assert fine[3:5] == ["equal", "–"]
    assert "`nodal` in semicylinder. That mesh" in thickness_share_part(load_store(own_store)).text
