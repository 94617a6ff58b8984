"""The convergence page: orders, limits and error parts of a made-up store whose every order is two."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.shells.convergence import comparisons, convergence_page, sequences
from reports.formats import quantity as words
from reports.store.tables import load_store
from studies.analysis.cells.answers import Answers
from studies.analysis.cells.collect import collect
from studies.analysis.comparisons.ladders import BEYOND, NO_LIMIT, WITHIN, convergence
from studies.analysis.verify import verified
from studies.campaigns.ladder_cells import LADDERS
from studies.store.atomic import write_json
from support.stores.made_up import analysed_again

WOBBLE = (0.3, -0.2, 0.1, 0.05)


def change_values(root: Path, prefix: str, change: Callable[[float, int], float | None], *, again: bool = True) -> None:
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
    if again:
        analysed_again(root)


def rows(text: str, ladder: str) -> list[list[str]]:
    return [[word.strip() for word in line.split("|")[1:-1]] for line in text.splitlines() if f"| {ladder} |" in line]


def planted(size: float, value: float, i: int) -> float:
    """Something beside the second order, mesh by mesh."""
    return value * (1 + size * WOBBLE[i % len(WOBBLE)])


def comparisons_of(root: Path) -> pd.DataFrame:
    store = load_store(root)
    return comparisons(store, sequences(store))


def test_every_quantity_of_every_ladder_has_the_order_it_was_made_with(store: Path) -> None:
    data = sequences(load_store(store))
    assert data["sequence"].nunique() == sum(len(ladder.quantities) for ladder in LADDERS)
    assert set(data["verdict"]) == {"asymptotic"}
    for _, own in data.groupby("sequence"):
        assert list(own["order"])[2:] == pytest.approx([2.0] * (len(own) - 2), abs=1e-6), own["ladder"].iloc[0]


def test_page_shows_values_orders_limits_and_parts(store: Path) -> None:
    text = convergence_page(load_store(store)).text
    values, raw, *parts, choice, _, _ = rows(text, "scordelis-lo")  # the last two are of the shares
    assert values[1:] == [
        "edge deflection [mm]",
        "asymptotic",
        *("64x64", "0.301928", "2.00", "0.3024", "0.195 %"),
    ]
    assert raw[2:] == [
        "`edge_deflection_mm`",
        "8x8: 0.27216, 16x16: 0.29484, 32x32: 0.30051, 64x64: 0.301928",
        "2.00, 2.00",
    ]
    assert [part[4] for part in parts] == ["0.3024", "0.30202", "0.3006"]
    both = [f"{error} / {error}" for error in ("-10.00 %", "-2.50 %")]
    assert choice[2:] == ["equal", "8x8, 16x16", *both, "640 / 640", "9 / 9"]
    assert parts[0][3:] == [WITHIN, "0.3024", "-0.156 %", "0.000 %", "0.195 %", "1.000 %"]
    assert parts[2][6] == "+0.599 %"
    assert parts[2][3] == BEYOND
    assert "scordelis-lo, edge deflection [mm], read: +0.60 %" in text
    (every,) = [line for line in text.splitlines() if line.startswith("| all | ")]
    assert every.split(" | ")[2:5] == [str(n) for n in (34, 64, 64)]


def test_parts_add_up_to_the_difference(store: Path) -> None:
    found = comparisons_of(store)
    assert len(found) > 30
    np.testing.assert_allclose(found["mesh_part"] + found["model_part"], found["error"], atol=1e-12)


@pytest.mark.slow
def test_a_planted_model_error_is_told_from_that_of_the_mesh(own_store: Path) -> None:
    change_values(own_store, "convergence pagano-S100 ", lambda value, i: 1.02 * value)
    (found,) = comparisons_of(own_store).query("ladder == 'pagano-S100' and quantity == 'w_bar'").to_dict("records")
    assert found["model_part"] == pytest.approx(0.02, abs=1e-6)
    assert found["mesh_part"] == pytest.approx(-0.1 / 64 * 1.02, abs=1e-6)
    assert found["verdict"] == BEYOND


def test_references_apply_only_to_what_was_solved(store: Path) -> None:
    found = comparisons_of(store).groupby(["ladder", "quantity"])["value"].agg(list)
    assert found["tyre-isotropic", "force_N"] == [pytest.approx(523.8, abs=0.1)]  # the solid at 10 mm
    assert found["tyre", "force_N"] == [1877.3]  # its own refined grids
    assert ("tyre", "half_length_mm") not in found  # that solid is isotropic
    assert found["pagano-S10", "w_bar"] != found["pagano-S100", "w_bar"]
    assert len(found["pressurised-cylinder-open", "stretch"]) == 1


@pytest.mark.slow
def test_one_ladder_has_one_verdict_everywhere(own_store: Path) -> None:
    """Orders near every threshold: the sequences of cells, however they are grouped, and the verified cells agree."""
    for k, ladder in enumerate(LADDERS):
        size = 10.0 ** -(k % 8)
        own = partial(planted, size)
        change_values(own_store, f"convergence {ladder.name} ", own, again=False)
    table = collect(own_store, "report")
    data, _ = convergence(Answers.of(own_store, "report"), table)
    split = verified(table)
    said = (
        data[data["at"] == ""]
        .groupby(["sequence", "quantity"])
        .agg({"label": tuple, "verdict": "first", "limit": "first"})
    )
    for (labels, quantity), own in said.reset_index().groupby(["label", "quantity"]):
        assert own["verdict"].nunique() == own["limit"].nunique(dropna=False) == 1, (labels, quantity)
        told = split[split["label"].isin(labels) & (split["quantity"] == quantity)]
        if own["sequence"].size > 1:  # the planned ladder is all there is of its request
            asymptotic = own["verdict"].iloc[0].startswith(("asymptotic", "same"))
            assert set(told["asymptotic"]) == {asymptotic}, (labels, quantity)
    assert said["verdict"].nunique() >= 4
    assert said.reset_index().duplicated(["label", "quantity"]).sum() > 20


@pytest.mark.slow
def test_a_sequence_that_is_not_monotone_has_no_order_and_no_limit(own_store: Path) -> None:
    change_values(own_store, "convergence roof-a ", lambda value, i: 1 + 0.01 * (-1) ** i)
    page = convergence_page(load_store(own_store))
    values, _, raw, _, *parts = rows(page.text, "roof-a")
    assert values[2] == "not asymptotic: no order"
    assert values[-3:] == ["–", "–", "–"]
    assert set(raw[-1].split(", ")) == {"–"}
    assert parts[0][3] == NO_LIMIT
    assert parts[0][5:8] == ["–", "–", "–"]


@pytest.mark.slow
def test_a_mesh_that_was_not_solved_is_a_dash(own_store: Path) -> None:
    change_values(own_store, "convergence pagano-S10 ", lambda value, i: None if i == 1 else value)
    values, _, raw, *_ = rows(convergence_page(load_store(own_store)).text, "pagano-S10")
    assert "not solved on every mesh" in values
    assert raw[3].split(", ")[1].endswith(": –")


@pytest.mark.slow
def test_a_sequence_that_is_not_asymptotic_says_why(own_store: Path) -> None:
    """0.99, 1.01, 0.99 on the last three meshes: 2.02 % of the last one apart, and no order."""
    change_values(own_store, "convergence plate-contact ", lambda value, i: 1 + 0.01 * (-1) ** i)
    (ladder,) = (ladder for ladder in LADDERS if ladder.name == "plate-contact")
    told = {
        quantity: line
        for line in convergence_page(load_store(own_store)).text.splitlines()
        for quantity in ladder.quantities
        if line.startswith(f"- plate-contact, {words(quantity)}: ")
    }
    assert set(told) == set(ladder.quantities)
    assert ladder.causes["contact_radius"] in told["contact_radius"]
    assert "the cause is not known" in told["contact_force"]
    assert all("orders – and –" in line and "2.02 % apart" in line for line in told.values())
