"""The page of verification: orders, limits and error parts of a made-up store whose every order is two, and locking."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Set
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from reports.chapters.convergence import (
    SHARES,
    convergence_page,
    counted,
    elements_part,
    manufactured_part,
    sequences,
)
from reports.chapters.locking import distortion_part, excess, rates
from reports.formats import quantity as words
from reports.store import Store, load_store
from studies.analysis.ladders import BEYOND, NO_LIMIT, WITHIN, convergence
from studies.experiments.locking import MESHES, THINNESS
from studies.output.atomic import write_json, write_table
from studies.run.answers import Answers
from studies.run.collect import collect
from studies.run.lists import LADDERS
from support.pages import edit_json, place
from support.sentences import sentence
from support.stores.campaigns import analysed_again
from support.stores.convergence import made_up_manufactured, made_up_statements

WOBBLE = (0.3, -0.2, 0.1, 0.05)


def change_values(root: Path, prefix: str, change: Callable[[float, int], float]) -> None:
    """Replace every quantity of the cells of a ladder, mesh by mesh."""
    index = json.loads((root / "campaigns" / "report.json").read_text())
    paths = [root / "cells" / f"{row['id']}.json" for row in index["cells"] if row["label"].startswith(prefix)]
    assert paths
    for i, path in enumerate(paths):
        result = json.loads(path.read_text())
        write_json(path, {**result, "quantities": {n: change(v, i) for n, v in result["quantities"].items()}})


def planted(size: float, value: float, i: int) -> float:
    """Something beside the second order, mesh by mesh."""
    return value * (1 + size * WOBBLE[i % len(WOBBLE)])


def rows(text: str, start: str) -> list[list[str]]:
    """The entries behind the first of the lines of tables that begin with a word."""
    lines = (line for line in text.splitlines() if line.startswith(f"| {start} |"))
    return [[word.strip() for word in line.split("|")[2:-1]] for line in lines]


def comparisons_of(store: Store) -> pd.DataFrame:
    table = store.table("convergence_errors")
    return table[table["sequence"].isin(sequences(store)["sequence"])]


def test_every_quantity_of_every_ladder_has_the_order_it_was_made_with(loaded: Store) -> None:
    data = sequences(loaded)
    assert data["sequence"].nunique() == sum(len(ladder.quantities) for ladder in LADDERS)
    assert set(data["verdict"]) == {"asymptotic"}
    for _, own in data.groupby("sequence"):
        assert list(own["order"])[2:] == pytest.approx([2.0] * (len(own) - 2), abs=1e-6), own["ladder"].iloc[0]


def test_agreement_is_counted_once_of_exact_and_of_linear_strains(loaded: Store) -> None:
    """The opening says what the table says; limits of our own grids do not count."""
    table = loaded.table("convergence_summary").set_index("group")
    whole = table.loc[["exact strains", "linear strains"]].sum()
    assert whole["sequences"] == sum(len(ladder.quantities) for ladder in LADDERS)
    every = comparisons_of(loaded)
    judged = every[every["kind"] != "refined"]
    assert whole["comparisons"] == len(judged) < len(every)
    assert whole["agree"] == (judged["verdict"] == WITHIN).sum() < len(judged)
    row = table.loc["exact strains"]
    said = f"With exact strains {row['agree']} of {row['comparisons']} comparisons of limits with references agree"
    assert said in sentence(loaded, "convergence")


def test_references_apply_only_to_what_was_solved(loaded: Store) -> None:
    actual = comparisons_of(loaded).groupby(["ladder", "quantity"])["value"].agg(list)
    assert actual["tyre-isotropic", "force_N"] == [pytest.approx(523.8, abs=0.1)]  # the solid at 10 mm
    assert actual["tyre", "force_N"] == [1877.3]  # its own refined grids
    assert ("tyre", "half_length_mm") not in actual  # that solid is isotropic
    assert actual["pagano-S10", "w_bar"] != actual["pagano-S100", "w_bar"]
    assert len(actual["pressurised-cylinder-open", "stretch"]) == 1


@pytest.mark.slow
def test_a_model_error_and_sequences_without_an_order_are_told(own_store: Path) -> None:
    """A model error is told from that of the mesh; what is not monotone has no order and no limit, and says why."""
    change_values(own_store, "convergence pagano-S100 ", lambda value, i: 1.02 * value)
    for name in ("roof-a", "plate-contact"):
        change_values(own_store, f"convergence {name} ", lambda value, i: 1 + 0.01 * (-1) ** i)
    analysed_again(own_store)
    store = load_store(own_store)
    actual = comparisons_of(store)
    (pagano,) = actual.query("ladder == 'pagano-S100' and quantity == 'w_bar'").to_dict("records")
    assert pagano["model_part"] == pytest.approx(0.02, abs=1e-6)
    assert pagano["error"] - pagano["model_part"] == pytest.approx(-0.1 / 64 * 1.02, abs=1e-6)
    assert pagano["verdict"] == BEYOND
    assert set(actual.query("ladder == 'roof-a'")["verdict"]) == {NO_LIMIT}
    text = convergence_page(store).text
    roof, _ = rows(text, "roof-a")
    assert roof[3:6] == ["(–)", "–", "–"]
    assert roof[-1] == "–"
    (ladder,) = (ladder for ladder in LADDERS if ladder.name == "plate-contact")
    messages = [line for line in text.splitlines() if line.startswith("- ") and "plate-contact (" in line]
    assert len(messages) == len(ladder.quantities)
    assert any(ladder.causes["contact_radius"] in line and words("contact_radius") in line for line in messages)
    assert any("the cause is not known" in line and words("contact_force") in line for line in messages)


@pytest.mark.slow
def test_one_ladder_has_one_verdict_everywhere(own_store: Path) -> None:
    """Orders near every threshold: the sequences of cells agree, however they are grouped."""
    for k, ladder in enumerate(LADDERS):
        change_values(own_store, f"convergence {ladder.name} ", partial(planted, 10.0 ** -(k % 8)))
    table = collect(own_store, "report")
    data, _ = convergence(Answers.of(own_store, "report"), table)
    groups = data[data["at"] == ""].groupby(["sequence", "quantity"])
    said = groups.agg({"label": tuple, "verdict": "first", "limit": "first"})
    for (labels, quantity), own in said.reset_index().groupby(["label", "quantity"]):
        assert own["verdict"].nunique() == own["limit"].nunique(dropna=False) == 1, (labels, quantity)
    assert said["verdict"].nunique() >= 4
    assert said.reset_index().duplicated(["label", "quantity"]).sum() > 20


@pytest.mark.slow
def test_a_state_that_is_not_certified_is_counted_and_named(own_store: Path, files: dict[str, str]) -> None:
    count = int(files["convergence.md"].partition("of each of the ")[2].split()[0])
    assert f"certifies {count} of them" in files["convergence.md"]
    assert "Not certified" not in files["convergence.md"]
    path = place(own_store, "hemisphere 16").with_suffix(".json")
    edit_json(path, lambda result: result["steps"][-1].update(failures=["energy"]))
    text = convergence_page(load_store(own_store)).text
    assert f"certifies {count - 1} of them" in text
    assert "Not certified, for energy: states of hemisphere." in text


# --- options of the element -----------------------------------------------------------------------------------------


def scene(name: str, coarse: Set[str], fine: Set[str], wrong: Set[str] = frozenset()) -> list[dict[str, object]]:
    """The shares that are nearest on both meshes, and those that end where the finer mesh goes on."""
    values: list[dict[str, object]] = []
    for half, near in ((False, fine), (True, coarse)):
        for share in SHARES:
            end = 0.7 if half and share in wrong else math.nan
            row = {"ladder": name, "share": share, "coarse": half, "nearest": share in near, "turns_at": end}
            values.append(row | {"confirmed": share not in wrong if half else None})
    return values


EVERYONE = frozenset(SHARES)


def test_shares_are_counted_by_mesh_and_early_ends_are_named() -> None:
    scenes = [
        *scene("flat", EVERYONE, EVERYONE),
        *scene("curved", {"balanced"}, {"balanced", "nodal"}),
        *scene("folded", {"nodal"}, {"balanced"}, wrong={"nodal", "projected"}),
        *scene("rolled", {"nodal"}, EVERYONE, wrong={"nodal"}),
        *scene("lost", set(), {"projected", "balanced"}),
    ]
    table = pd.DataFrame(scenes)
    assert list(counted(table, "projected").values()) == ["projected", 1, 0, 3, 0, 1, "folded"]
    assert list(counted(table, "balanced").values()) == ["balanced", 2, 1, 5, 1, 0, "none"]
    assert list(counted(table, "nodal").values()) == ["nodal", 3, 2, 3, 0, 2, "folded, rolled"]


@pytest.mark.slow
def test_an_early_end_a_lost_order_and_a_wrong_coefficient_are_said(own_store: Path) -> None:
    """An early end is not confirmed by a mesh that goes on."""
    ended = {"outcome": "step-limit", "steps": [], "quantities": {"load_limit_point": 0.68}}
    edit_json(place(own_store, "share semicylinder 16x16 nodal").with_suffix(".json"), lambda r: r.update(ended))
    wrong = made_up_statements("E11-: coefficient of l1- is 0.9, stated 1")
    write_table(own_store / "tables/manufactured.csv", made_up_manufactured(1.5))
    write_table(own_store / "tables/manufactured_statements.csv", wrong)
    analysed_again(own_store)
    store = load_store(own_store)
    (line,) = (line for line in elements_part(store).text.splitlines() if "| `nodal` |" in line)
    assert line.endswith("| 1 | semicylinder |")
    text = " ".join(manufactured_part(store).text.split())
    assert "orders of the displacement 1 lie further from 2 than 0.1." in text
    assert "| `exact` | E11-: coefficient of l1- is 0.9, stated 1 |" in text


# --- locking --------------------------------------------------------------------------------------------------------


def test_every_kind_of_locking_has_its_lines(files: dict[str, str]) -> None:
    text = files["convergence.md"]
    stiff, remedy = rows(text, "Poisson thickness")
    assert stiff[2:] == ["ν = 0", "1.000", "ν = 0.45", "3.025"]
    assert remedy[2:] == ["ν = 0", "1.000", "ν = 0.45", "1.000"]
    (shear,) = rows(text, "shear")
    assert shear[3] == shear[5] == "0.996"
    assert len(rows(text, "curved beam")) == len(MESHES)
    membrane = rows(text, "membrane")
    assert len(membrane) == 4 * len(MESHES)
    free = [row for row in membrane if row[0] == "hyperboloid, free ends: energy"]
    assert [row[4] for row in free] == [f"h/R = {min(THINNESS):g}"] * len(MESHES)
    assert float(free[0][5]) < 0.5 < float(free[0][3])
    assert all(row[3] == row[5] for row in membrane if row[0] == "hyperboloid, clamped ends: energy")


def test_left_over_locking_has_the_rates_it_was_made_with(loaded: Store) -> None:
    data = loaded.table("membrane_locking")
    actual = excess(data, "relaxed")
    assert list(actual.columns) == list(MESHES)
    np.testing.assert_allclose(actual.loc[1e-5] / actual.loc[1e-4], 101, rtol=0.02)  # less what is there at 1e-3
    np.testing.assert_allclose(actual[8] / actual[16], 64, rtol=1e-6)
    assert rates(data) == ("101", "64")
    assert rates(data[data["elements"] > min(MESHES)])[1] == "–"  # an excess of rounding


def test_distorted_meshes_lose_what_they_were_made_to_lose(loaded: Store) -> None:
    text = str(distortion_part(loaded))
    (exact,) = rows(text, "`exact`")
    assert exact[1] == "2.00"
    assert exact[2:] == 3 * ["1.20", "2.00"]
    (beam,) = rows(text, "cantilever")
    assert beam == ["8x8", *3 * ["-0.40 %"], "16x8", *3 * ["-0.10 %"]]
    assert rows(text, "`nodal`")[0] == ["`compatible`", *3 * ["0.15 %", "0.20 %"]]
    assert sentence(loaded, "distorted-shells").startswith("Moving the nodes by 0.2 of the element size changes")
