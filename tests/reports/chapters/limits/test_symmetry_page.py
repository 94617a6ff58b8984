"""The page of symmetry: counts of a made-up table, its accidents, and the mirror beside the printed value."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from reports.chapters.limits.symmetry import accidents, symmetry_page
from reports.store.tables import load_store
from studies.store.atomic import write_table


def change(root: Path, name: str, **columns: object) -> None:
    """Give the first row of a table other values."""
    path = root / "tables" / f"{name}.csv"
    table = pd.read_csv(path)
    for column, value in columns.items():
        table.loc[0, column] = value
    write_table(path, table)


def test_nothing_is_broken_by_accident(store: Path) -> None:
    loaded = load_store(store)
    text = symmetry_page(loaded).text
    assert accidents(loaded) == (0, 12)
    assert "12 checks, of which 0 are broken by accident and 2 by design" in text
    assert "| axes exchanged | 0 | 4 | 0 | 0 | 0 | 0 | 1.0e-15 |" in text
    assert "| plate moved and turned | `donnell` | declares E11 = -0.001 | 0.2 | 0.2 |" in text
    assert "Broken by accident**" not in text


def test_an_accident_is_shown_with_its_reason(own_store: Path) -> None:
    change(own_store, "symmetry", **{"class": "broken by accident", "deviation": 0.25, "reason": "nothing explains it"})
    loaded = load_store(own_store)
    text = symmetry_page(loaded).text
    assert accidents(loaded) == (1, 12)
    assert "12 checks, of which 1 are broken by accident" in text
    assert "| axes exchanged | exact | semismooth | 2.5e-01 | nothing explains it |" in text


def test_the_mirror_stands_beside_the_printed_value(store: Path) -> None:
    text = symmetry_page(load_store(store)).text
    assert "the printed table differs from its mirror image by 0.039 MPa" in text
    assert "ours, on the paper's mesh, by 0.030 MPa, and by 0.060 MPa" in text
    assert "The largest among stable states is 0.050 MPa at 61.8°" in text
    assert "negative eigenvalues at 85°, 90°" in text
    assert "| `exact` | 0 | 0.0300 | 0 | 0.0500 | 61.8 | 4 of 7 |" in text
    assert "solve 61.8" in text
