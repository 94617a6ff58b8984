"""The convergence page: orders, limits and error parts of a made-up store whose every order is two."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.convergence import comparisons, convergence_page, sequences
from reports.formats import quantity as words
from reports.store import load_store
from studies.analysis.ladders import BEYOND, NO_LIMIT, WITHIN, convergence
from studies.analysis.verify import verified
from studies.output.atomic import write_json
from studies.run.campaigns.ladder_cells import LADDERS
from studies.run.cells.answers import Answers
from studies.run.cells.collect import collect
from support.pages.sentences import sentence
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


def test_page_shows_values_orders_limits_and_references(store: Path) -> None:
    text = convergence_page(load_store(store)).text
    (row,) = rows(text, "scordelis-lo")
    assert row[1:] == [
        *("edge deflection [mm]", "64x64", "0.301928", "2.00", "0.3024", "0.195 %"),
        *("0.3006 ± 0.20 %", "read", "+0.60 %"),  # the most certain of three
    ]
    assert "scordelis-lo, edge deflection [mm], read: +0.60 %" in text


def test_agreement_is_counted_once_of_exact_and_of_linear_strains(store: Path) -> None:
    """The opening says what the table says; limits of our own grids do not count."""
    loaded = load_store(store)
    found = loaded.table("convergence_summary").set_index("group")
    whole = found.loc[["exact strains", "linear strains"]].sum()
    assert whole["sequences"] == sum(len(ladder.quantities) for ladder in LADDERS)
    judged = comparisons_of(store)
    judged = judged[judged["kind"] != "refined"]
    assert whole["comparisons"] == len(judged) < len(comparisons_of(store))
    assert whole["agree"] == (judged["verdict"] == WITHIN).sum() < len(judged)
    row = found.loc["exact strains"]
    said = sentence(loaded, "convergence")
    assert (
        f"With exact strains {row['agree']} of {row['comparisons']} comparisons of limits with references agree" in said
    )
    assert "With linear strains" in said


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
    first, _ = rows(convergence_page(load_store(own_store)).text, "roof-a")
    assert first[4:7] == ["(–)", "–", "–"]
    assert first[-1] == "–"
    found = comparisons_of(own_store).query("ladder == 'roof-a'")
    assert set(found["verdict"]) == {NO_LIMIT}


@pytest.mark.slow
def test_a_sequence_that_is_not_asymptotic_says_why(own_store: Path) -> None:
    change_values(own_store, "convergence plate-contact ", lambda value, i: 1 + 0.01 * (-1) ** i)
    (ladder,) = (ladder for ladder in LADDERS if ladder.name == "plate-contact")
    told = [line for line in convergence_page(load_store(own_store)).text.splitlines() if "- plate-contact (" in line]
    assert len(told) == len(ladder.quantities)
    assert any(ladder.causes["contact_radius"] in line and words("contact_radius") in line for line in told)
    assert any("the cause is not known" in line and words("contact_force") in line for line in told)
