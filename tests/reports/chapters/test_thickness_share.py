"""What the page of convergence says of the shares of the thickness strain, from tables that are made up."""

from __future__ import annotations

import json
from collections.abc import Set
from pathlib import Path

import pandas as pd

from reports.chapters.shells.thickness_share import SHARES, said, thickness_share_part
from reports.tables import load_store
from studies.store.atomic import write_json
from support.made_up import analysed_again

COARSE, FINE = "8x8", "16x16"


def scene(name: str, coarse: Set[str], fine: Set[str], wrong: Set[str] = frozenset()) -> list[dict[str, object]]:
    """The shares that are nearest on both meshes, and those that end where the finer mesh goes on."""
    rows = []
    for mesh, near in ((FINE, fine), (COARSE, coarse)):
        for share in SHARES:
            told = None if mesh == FINE else share not in wrong
            rows.append({"ladder": name, "share": share, "mesh": mesh, "nearest": share in near, "confirmed": told})
    return rows


def test_the_sentence_counts_scenes_by_mesh_and_names_where_limit_points_are_not_confirmed() -> None:
    everyone = set(SHARES)
    found = pd.DataFrame(
        [
            *scene("flat", everyone, everyone),
            *scene("curved", {"balanced"}, {"balanced", "nodal"}),
            *scene("folded", {"nodal"}, {"balanced"}, wrong={"nodal", "projected"}),
            *scene("rolled", {"nodal"}, everyone, wrong={"nodal"}),
        ]
    )
    assert said(found) == (
        "On half of the default mesh, of 4 scenes, best are: `projected` in 1, alone in 0; `balanced` in 2, "
        "alone in 1; `nodal` in 3, alone in 2. On the default mesh, of 4 scenes, best are: `projected` in 2, "
        "alone in 0; `balanced` in 4, alone in 1; `nodal` in 3, alone in 0. Limit points that the default mesh does "
        "not confirm: `projected` in folded; `balanced` in none; `nodal` in folded, rolled."
    )


def test_without_any_such_limit_point_the_sentence_says_so() -> None:
    told = "; ".join(f"`{name}` in none" for name in SHARES)
    assert said(pd.DataFrame(scene("flat", {"nodal"}, {"nodal"}))).endswith(f"does not confirm: {told}.")


def rows(store: Path, ladder: str) -> list[list[str]]:
    lines = thickness_share_part(load_store(store)).text.splitlines()
    return [[word.strip() for word in line.split("|")[1:-1]] for line in lines if line.startswith(f"| {ladder} |")]


def test_made_up_errors_are_shown_as_they_were_made(store: Path) -> None:
    """Second order, and the same with every share."""
    coarse, fine = rows(store, "scordelis-lo")
    assert coarse == ["scordelis-lo", "`edge_deflection_mm`", "8x8", *["-10.00 %"] * 3, "equal", "–", "9 / 9 / 9"]
    assert fine[2:7] == ["16x16", *["-2.50 %"] * 3, "equal"]


def test_a_share_that_ends_early_is_not_confirmed_by_a_mesh_that_goes_on(own_store: Path) -> None:
    index = json.loads((own_store / "campaigns" / "report.json").read_text())
    (row,) = (row for row in index["cells"] if row["label"] == "share semicylinder 16x16 nodal")
    path = own_store / "cells" / f"{row['id']}.json"
    ended = {"outcome": "step-limit", "steps": [], "quantities": {"load_limit_point": 0.68}}
    write_json(path, json.loads(path.read_text()) | ended)
    analysed_again(own_store)
    coarse, fine = rows(own_store, "semicylinder")
    assert coarse[5:8] == ["–", "projected, balanced", "– / – / 0.68 (not confirmed)"]
    assert fine[6:8] == ["equal", "–"]
    assert "`nodal` in semicylinder." in thickness_share_part(load_store(own_store)).text
