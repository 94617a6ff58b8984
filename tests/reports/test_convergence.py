"""The convergence page: orders, limits and error parts of a made-up store whose every order is two."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from reports.chapters.shells.convergence import BEYOND, WITHIN, convergence_page, split
from reports.ladders import read_ladders
from reports.tables import load_store
from studies.campaigns.ladder_cells import LADDERS
from studies.store.atomic import write_json

pytestmark = pytest.mark.usefixtures("undrawn")


def change_values(root: Path, prefix: str, change: Callable[[float, int], float | None]) -> None:
    """Replace every quantity of the cells of a ladder, mesh by mesh; None: the cell was not solved."""
    index = json.loads((root / "campaigns" / "report.json").read_text())
    paths = [root / "cells" / f"{row['id']}.json" for row in index["cells"] if row["label"].startswith(prefix)]
    assert paths
    for i, path in enumerate(paths):
        result = json.loads(path.read_text())
        new = {name: change(value, i) for name, value in result["quantities"].items()}
        if None in new.values():
            result |= {"outcome": "diverged", "reason": "it diverged", "steps": [], "quantities": {}}
        else:
            result["quantities"] = new
        write_json(path, result)


def rows(text: str, ladder: str) -> list[list[str]]:
    return [[word.strip() for word in line.split("|")[1:-1]] for line in text.splitlines() if f"| {ladder} |" in line]


def test_every_quantity_of_every_ladder_has_the_order_it_was_made_with(store: Path) -> None:
    rungs = read_ladders(load_store(store))
    assert len(rungs) == sum(len(ladder.quantities) for ladder in LADDERS)
    for rung in rungs:
        assert rung.sequence.orders == pytest.approx([2.0] * (len(rung.meshes) - 2), abs=1e-6), rung.ladder
        assert rung.sequence.verdict == "asymptotic"


def test_page_shows_values_orders_limits_and_parts(store: Path) -> None:
    text = convergence_page(load_store(store)).text
    values, *parts, choice = rows(text, "scordelis-lo")
    assert values[1:3] == ["`edge_deflection_mm`", "8x8, 16x16, 32x32, 64x64"]
    assert values[3:] == [
        "0.27216",
        "0.29484",
        "0.30051",
        "0.301928",
        "2.00",
        "2.00",
        "asymptotic",
        "0.3024",
        "0.195 %",
    ]
    assert [part[3] for part in parts] == ["0.3024", "0.30202", "0.3006"]
    both = [f"{error} / {error}" for error in ("-10.00 %", "-2.50 %", "-0.62 %")]
    assert choice[2:] == ["equal", "8x8, 16x16, 32x32", *both, "640 / 640", "9 / 9"]
    assert parts[0][4:] == ["-0.156 %", "-0.156 %", "0.000 %", "0.195 %", "1.000 %", WITHIN]
    assert parts[2][6] == "+0.599 %"
    assert parts[2][-1] == BEYOND
    assert "`edge_deflection_mm`, read: +0.60 %" in text


def test_parts_add_up_to_the_difference(store: Path) -> None:
    pairs = [(rung, reference) for rung in read_ladders(load_store(store)) for reference in rung.references]
    assert len(pairs) > 30
    for rung, reference in pairs:
        s = split(rung, reference)
        assert s.mesh is not None
        assert s.model is not None
        assert s.mesh + s.model == pytest.approx(s.difference, abs=1e-12)


def test_a_planted_model_error_is_told_from_that_of_the_mesh(own_store: Path) -> None:
    change_values(own_store, "convergence pagano-S100 ", lambda value, i: 1.02 * value)
    rung = next(rung for rung in read_ladders(load_store(own_store)) if rung.ladder == "pagano-S100")
    (reference,) = rung.references
    found = split(rung, reference)
    assert found.model == pytest.approx(0.02, abs=1e-6)
    assert found.mesh == pytest.approx(-0.1 / 64 * 1.02, abs=1e-6)
    assert found.verdict == BEYOND


def test_references_apply_only_to_what_was_solved(store: Path) -> None:
    found = {(r.ladder, r.quantity): [ref["value"] for ref in r.references] for r in read_ladders(load_store(store))}
    assert found["tyre-isotropic", "force_N"] == [pytest.approx(523.8, abs=0.1)]  # the solid at 10 mm
    assert found["tyre", "force_N"] == []  # that solid is isotropic
    assert found["pagano-S10", "w_bar"] != found["pagano-S100", "w_bar"]
    assert len(found["pressurised-cylinder-open", "stretch"]) == 1


def test_a_sequence_that_is_not_monotone_has_no_order_and_no_limit(own_store: Path) -> None:
    change_values(own_store, "convergence roof-a ", lambda value, i: 1 + 0.01 * (-1) ** i)
    page = convergence_page(load_store(own_store))
    values, _, *parts = rows(page.text, "roof-a")
    assert values[-5:] == ["–", "–", "not asymptotic: no order", "–", "–"]
    assert parts[0][-1] == "no limit"
    assert parts[0][5:8] == ["–", "–", "–"]


def test_a_mesh_that_was_not_solved_is_a_dash(own_store: Path) -> None:
    change_values(own_store, "convergence hemisphere ", lambda value, i: None if i == 1 else value)
    values = rows(convergence_page(load_store(own_store)).text, "hemisphere")[0]
    assert values[4] == "–"
    assert "not solved on every mesh" in values
