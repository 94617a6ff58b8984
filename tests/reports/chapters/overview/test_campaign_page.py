"""The page of any campaign, from records made up here: orders that are known, classes that are counted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from reports.chapters.index import campaign_page
from reports.origin import completeness_line
from reports.reading import StoreError
from reports.site import place_of, rendered
from reports.store import load_store
from studies.output.atomic import SCHEMA, write_json, write_text
from studies.run.campaigns.plan import Row
from studies.scenes.complete import Cell
from support.stores.made_up import analysed_again

REQUEST = {"scene": "cantilever", "measure": "exact", "contact": "semismooth", "newton": "mixed", "model": "full"}
KKT = {"equilibrium": 1e-12, "penetration": 0.0, "tension": 0.0, "complementarity": 0.0}
EXACT = 6.69964  # mm, the tip deflection that the scene knows
LIMIT, ORDER = 1.01 * EXACT, 2.0


def record(cell_id: str, n: int, ended: str = "converged") -> dict[str, Any]:
    value = LIMIT + 5.0 * n**-ORDER
    step = {"load_fraction": 1.0, "kkt": KKT, "failures": [], "rounding": 0.0, "newton_iterations": 1, "substeps": 1}
    counters = {"newton_iterations": 7, "factorisations": 8, "assemblies": 9, "operations": 1000}
    return {
        **{"schema": SCHEMA, "id": cell_id, **REQUEST, "mesh": f"{n}x1", "outcome": ended, "class": ended},
        **{"settings": {"tolerance": 1e-9}, "reason": f"{ended} because", "quantities": {"tip_deflection_mm": value}},
        **{"steps": [step], "cuts": [], "counters": counters, "timing_s": {}, "provenance": {}, "files": []},
    }


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """Three meshes, and one cell of each class beside them."""
    rows = []
    classes = ["converged"] * 3 + ["wrong", "not-converged", "cap-hit", "time", "memory", "crash", "missing"]
    for i, ended in enumerate(classes):
        n, cell_id = 2 ** (i + 3), f"{i:x}"
        request = {**REQUEST, "mesh": [n, 1], "settings": {"tolerance": 1e-9}, "steps": 1}
        rows.append(Row(Cell(f"cell {n}", "cantilever", {}, {}, artefacts=False), cell_id, request).as_json())
        if ended in ("time", "memory", "crash"):
            told = {"schema": SCHEMA, "id": cell_id, "class": ended, "reason": f"{ended} because"}
            write_json(tmp_path / "failures" / f"{cell_id}.json", told)
        elif ended != "missing":
            write_json(tmp_path / "cells" / f"{cell_id}.json", record(cell_id, n, ended))
    odd = Cell("odd", "cantilever", {"contact": "qp"}, artefacts=False)
    rows.append(Row(odd, None, None, "no contact").as_json())
    at = {"load_fraction": 1.0, "measure": "exact"}
    reference = {"scene": "cantilever", "quantity": "tip_deflection_mm", "value": EXACT, "at": at, "kind": "exact"}
    reference |= {"source": "here", "uncertainty": 0.0}
    write_json(tmp_path / "references.json", {"schema": SCHEMA, "references": [reference]})
    told = {"schema": SCHEMA, "campaign": "made-up", "title": "Made up", "pages": "", "cells": rows}
    write_json(tmp_path / "campaigns" / "made-up.json", told)
    return tmp_path


def test_completeness_comes_last_and_counts_every_class(store: Path) -> None:
    loaded = load_store(store)
    assert completeness_line(loaded) == (
        "made-up: 11 cells planned: 3 converged, 1 wrong, 1 not-converged, 1 cap-hit, 1 time, 1 memory, 1 crash, "
        "1 unsupported, 1 missing"
    )
    text = campaign_page(loaded).text
    assert text.index("## Completeness") > text.index("## Orders")
    assert "| cantilever | 11 | 3 | 1 | 1 | 1 | 1 | 1 | 1 | 1 | 1 |" in text
    assert "| cell 512 | time | time because |" in text
    assert "| cantilever | no contact | 1 |" in text
    assert place_of(store)[0] == "made-up"
    assert list(rendered(loaded)) == ["index.md", "report.html"]


def test_orders_limits_and_errors_are_those_that_were_put_in(store: Path) -> None:
    analysed_again(store, "made-up")
    text = campaign_page(load_store(store)).text
    row = next(line for line in text.splitlines() if line.startswith("| cantilever | exact | tip_deflection_mm |"))
    cells = [word.strip() for word in row.split("|")[1:-1]]
    assert cells[3] == "8x1, 16x1, 32x1"  # those that are wrong or did not converge are no part of it
    assert cells[5:] == ["2.00", "6.76664", "6.69964", "exact", "+1.00 %"]


def test_counters_are_sums_over_what_has_converged(store: Path) -> None:
    text = campaign_page(load_store(store)).text
    assert "| cantilever | `semismooth` | 1e-09 | 9 | 3 | 6 | 21 | 24 | 27 | 3.00e+03 |" in text


@pytest.mark.parametrize(
    ("path", "text", "says"),
    [
        ("cells/0.json", "{", "cells/0.json: cannot be read"),
        ("cells/0.json", '{"schema": 1}', "cells/0.json: schema 1, but this program reads 2"),
        ("cells/0.json", '{"schema": 2}', "cells/0.json: lacks id"),
        ("failures/6.json", "", "failures/6.json: cannot be read"),
        ("campaigns/made-up.json", '{"schema": 1}', "made-up.json: schema 1, but this program reads 2"),
        ("campaigns/another.json", "{}", "has the campaigns another, made-up; choose one by --campaign"),
    ],
)
def test_what_is_wrong_with_a_store_is_one_line(store: Path, path: str, text: str, says: str) -> None:
    write_text(store / path, text)
    with pytest.raises(StoreError) as caught:
        load_store(store)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_record_of_another_cell_is_not_taken_for_it(store: Path) -> None:
    write_json(store / "cells" / "0.json", record("1", 16))
    with pytest.raises(StoreError, match="of cell '1' of cantilever, not of 'cell 8'"):
        load_store(store)


def test_where_the_numbers_were_made_is_told_of_all_cells(store: Path) -> None:
    """A record of old does not say whether the files were modified."""
    made = {"version": "1.0", "commit": "abc", "packages": {"numpy": "2"}, "machine": {"cores": 2}}
    for n, more in ((0, {}), (1, {"modified": False}), (2, {"modified": True})):
        told = {
            **record(f"{n:x}", 2 ** (n + 3)),
            "provenance": {**made, **more},
            "timing_s": {"total": 2.0, "cpu": 1.5},
        }
        write_json(store / "cells" / f"{n:x}.json", told)
    text = campaign_page(load_store(store)).text
    assert "| commit | abc: 2 cells; abc (modified): 1 cells |" in text
    assert "| time on the clock, processor time of all cells [s] | 6.00, 4.50 |" in text
    assert text.index("<!-- machine -->\n\n**Where the numbers were made**") > text.index("## Machine")
