"""The pages of contact: how solves that differ, refuse or end early are told, and what the pictures show."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from reports.chapters.algorithms import algorithms_page
from reports.chapters.arena import NAMED, agreement_part, arena_part, shown_by_name
from reports.chapters.friction import CHAPTER, friction_page
from reports.figures.friction import _cell, _title, filmstrip, shown_stops
from reports.store import Store, load_store
from studies.analysis.everything import written
from studies.analysis.powers import epsilon_laws
from studies.arena.solvers.catalogue import SOLVERS
from studies.output.atomic import write_table
from studies.run.lists import agreement, enforcements
from support.pages import edit_json, place, row
from support.stores.campaigns import analysed_again
from support.stores.friction import patch

CASE, OTHER = "trial-and-error follower nonsymmetric exact", "trial-and-error dead constant-s33 exact"
LINE = "| `trial-and-error` | 4 |"


def directory(root: Path, label: str) -> Path:
    return place(root, f"agreement {label}")


def change(root: Path, label: str, **new: object) -> None:
    edit_json(directory(root, label).with_suffix(".json"), lambda result: result.update(new))


def steps_of(root: Path, label: str) -> list[dict[str, float]]:
    return json.loads(directory(root, label).with_suffix(".json").read_text())["steps"]


def test_every_algorithm_meets_every_case_exactly_and_as_it_is_by_default() -> None:
    assert enforcements(np.inf) == (("exact", "inf"),)
    assert enforcements(1e4) == (("exact", "inf"), ("epsilon", "10000"))
    asked = {(c.options["contact"], c.settings["load"], c.settings["section"]) for c in agreement()}
    assert len(asked) == 4 * len(ALGORITHMS)
    assert len({cell.label for cell in agreement()}) == len(agreement())


@pytest.mark.slow
def test_a_node_or_a_force_that_differs_is_seen(own_store: Path) -> None:
    path = directory(own_store, CASE) / "contact.csv"
    contact = pd.read_csv(path)
    contact.loc[contact.index[(contact["delta_mm"] == 15) & (contact["active"] == 1)][0], "active"] = 0
    write_table(path, contact)
    steps = steps_of(own_store, OTHER)
    steps[1]["force_N"] *= 1 + 2e-7
    change(own_store, OTHER, steps=steps)
    analysed_again(own_store)
    text = agreement_part(load_store(own_store)).text
    assert row(text, LINE)[2:] == ["2 of 4", "2.0e-07", "1", "–"]
    odd = text[text.index("Solves that do not agree") :]
    assert "| `trial-and-error` | follower | nonsymmetric | converged |" in odd
    assert "| `trial-and-error` | dead | constant-s33 | converged |" in odd


@pytest.mark.slow
def test_a_path_that_ends_early_does_not_agree(own_store: Path) -> None:
    ended = {"outcome": "cycling", "reason": "the contact set repeats itself"}
    change(own_store, CASE, **ended, steps=steps_of(own_store, CASE)[:2])
    analysed_again(own_store)
    text = agreement_part(load_store(own_store)).text
    assert row(text, LINE)[2] == "3 of 4"
    assert "| cycling | the contact set repeats itself |" in text


@pytest.mark.slow
def test_a_refusal_is_told_with_its_reason(own_store: Path) -> None:
    """As a campaign leaves it: no step and no tables."""
    empty = {"steps": [], "quantities": {}, "counters": {"dofs": 10}, "timing_s": {"total": 0.1, "build": 0.1}}
    change(own_store, CASE, outcome="unsupported", reason="trial-and-error does not apply: not symmetric", **empty)
    for name in ("contact.csv", "profile.csv"):
        (directory(own_store, CASE) / name).unlink()
    analysed_again(own_store)
    text = algorithms_page(load_store(own_store)).text
    assert "- `trial-and-error` refuses 1: not symmetric." in text
    assert row(text, LINE)[2:] == ["3 of 3", "0", "0", "1"]
    assert "and 1 requests were refused" in text


def test_a_tolerance_that_is_never_reached_is_said(edited: Store) -> None:
    data = edited.table("epsilon")
    data.loc[data["form"] == "displacement", "outcome"] = "rounding"
    write_table(edited.path / "tables" / "epsilon.csv", data)
    written(edited.path, "report", {"epsilon_laws": epsilon_laws(data)})
    assert row(algorithms_page(replace(edited)).text, "| tyre | 106.3 |")[-1] == "any ε"


# --- the arena ------------------------------------------------------------------------------------------------------


def test_neither_the_winner_nor_osqp_is_grey(loaded: Store) -> None:
    names = [f"s{n}" for n in range(20)] + ["OSQP"]
    shares = pd.DataFrame({"solver": names, "share": [n / 20 for n in range(20)] + [0.01]})
    shown = shown_by_name(shares)
    assert (shown[0], shown[-1], len(shown)) == ("s19", "OSQP", NAMED + 1)
    drawn = arena_part(loaded).pictures["arena-profiles.svg"]()
    assert drawn.startswith("<?xml")
    assert drawn.count("<svg") == 1


def test_the_entry_on_the_page_enters(files: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Its lines are run; ``my_method`` is whoever reads them."""
    monkeypatch.setattr("studies.arena.solvers.catalogue.SOLVERS", dict(SOLVERS))
    lines = files["algorithms.md"].partition("```python\n")[2].partition("```")[0]
    given = {"my_method": lambda step, tolerance: (np.zeros(2), np.zeros(1), False, 3)}
    exec(lines, given)
    actual = given["SOLVERS"]["mine"].answer(None, 1e-6)
    assert (actual.claimed, actual.iterations) == (False, 3)


# --- friction -------------------------------------------------------------------------------------------------------


def test_without_a_table_that_it_needs_there_is_no_page(edited: Store) -> None:
    assert CHAPTER.applies(edited)
    (edited.path / "tables" / "friction_greco.csv").unlink()
    assert not CHAPTER.applies(replace(edited))


def test_a_cell_of_the_patch_has_the_area_of_its_candidate() -> None:
    """Neighbours are 5 mm apart across, and an area of 50 mm² is 10 mm wide; the same with both axes exchanged."""
    data = patch()[lambda t: t["stop"] == 0]
    assert _cell(data) == (10.0, 5.0)
    assert _cell(data.rename(columns={"y_mm": "z_mm", "z_mm": "y_mm"})) == (5.0, 10.0)


def test_three_stops_are_shown_of_any_number() -> None:
    """The first of the drag, the farthest, the last; what comes after the farthest is on its way back."""
    stops = pd.DataFrame({"stop": range(6), "drag_mm": [0.0, 0.5, 1.0, 4.0, 2.0, 0.0]})
    shown = shown_stops(stops)
    assert shown["stop"].tolist() == [1, 3, 5]
    messages = [_title(own, stops, 4.0) for _, own in shown.groupby("stop")]
    assert messages == ["plane at 0.5 mm", "plane at 4 mm", "plane back at 0 mm"]
    assert shown_stops(stops[:1])["stop"].tolist() == [0]


@pytest.mark.slow
def test_pictures_of_friction_are_drawn(loaded: Store, drawn: dict[str, str]) -> None:
    pictures = friction_page(loaded).pictures
    assert len(pictures) == 4
    assert all(drawn[f"figures/{name}"].count("<svg") == 1 for name in pictures)
    assert filmstrip(patch().assign(friction_z_N=0.0))().startswith("<?xml")
