"""What the page of verification says of the options of the element, from tables that are made up."""

from __future__ import annotations

import math
from collections.abc import Set
from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.convergence import SHARES, counted, elements_part
from reports.store import load_store
from support.pages.changed import edit_json, place
from support.stores.made_up import analysed_again


def scene(name: str, coarse: Set[str], fine: Set[str], wrong: Set[str] = frozenset()) -> list[dict[str, object]]:
    """The shares that are nearest on both meshes, and those that end where the finer mesh goes on."""
    rows: list[dict[str, object]] = []
    for half, near in ((False, fine), (True, coarse)):
        for share in SHARES:
            end = 0.7 if half and share in wrong else math.nan
            row = {"ladder": name, "share": share, "coarse": half, "nearest": share in near, "turns_at": end}
            rows.append(row | {"confirmed": share not in wrong if half else None})
    return rows


EVERYONE = frozenset(SHARES)


def test_shares_are_counted_by_mesh_and_early_ends_are_named() -> None:
    found = pd.DataFrame(
        [
            *scene("flat", EVERYONE, EVERYONE),
            *scene("curved", {"balanced"}, {"balanced", "nodal"}),
            *scene("folded", {"nodal"}, {"balanced"}, wrong={"nodal", "projected"}),
            *scene("rolled", {"nodal"}, EVERYONE, wrong={"nodal"}),
            *scene("lost", set(), {"projected", "balanced"}),
        ]
    )
    assert list(counted(found, "projected").values()) == ["projected", 1, 0, 3, 0, 1, "folded"]
    assert list(counted(found, "balanced").values()) == ["balanced", 2, 1, 5, 1, 0, "none"]
    assert list(counted(found, "nodal").values()) == ["nodal", 3, 2, 3, 0, 2, "folded, rolled"]


@pytest.mark.slow
def test_a_share_that_ends_early_is_not_confirmed_by_a_mesh_that_goes_on(own_store: Path) -> None:
    ended = {"outcome": "step-limit", "steps": [], "quantities": {"load_limit_point": 0.68}}
    path = place(own_store, "share semicylinder 16x16 nodal").with_suffix(".json")
    edit_json(path, lambda result: result.update(ended))
    analysed_again(own_store)
    (line,) = (line for line in elements_part(load_store(own_store)).text.splitlines() if "| `nodal` |" in line)
    assert line.endswith("| 1 | semicylinder |")
