"""The page of contact algorithms: agreement, refusals, costs and claims of a made-up campaign, and its penalties."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from reports.chapter import of_page
from reports.chapters.agreement import entries
from reports.chapters.algorithms import algorithms_page
from reports.store import load_store
from studies.analysis.everything import written
from studies.analysis.powers import epsilon_laws
from studies.output.atomic import write_table, write_text
from studies.run.campaigns.report_cells import agreement, enforcements
from support.pages.changed import edit_json, place
from support.pages.rows import row

CASE = "trial-and-error follower nonsymmetric exact"


def directory(root: Path, label: str) -> Path:
    return place(root, f"agreement {label}")


def change(root: Path, label: str, **new: object) -> None:
    edit_json(directory(root, label).with_suffix(".json"), lambda result: result.update(new))


# --- cells ------------------------------------------------------------------------------------------------------


def test_every_algorithm_meets_every_case_exactly_and_as_it_is_by_default() -> None:
    assert enforcements(np.inf) == (("exact", "inf"),)
    assert enforcements(1e4) == (("exact", "inf"), ("epsilon", "10000"))
    asked = {(c.options["contact"], c.settings["load"], c.settings["section"]) for c in agreement()}
    assert len(asked) == 4 * len(ALGORITHMS)
    assert len({cell.label for cell in agreement()}) == len(agreement())


# --- agreement --------------------------------------------------------------------------------------------------


def test_all_agree_where_all_are_the_same(store: Path) -> None:
    text = algorithms_page(load_store(store)).text
    exact = [cell for cell in agreement() if cell.label.endswith("exact")]
    others = [cell for cell in exact if not cell.label.startswith("agreement semismooth ")]
    assert f"{len(others)} of {len(others)} do, and 0 requests were refused" in text
    assert "Solves that do not agree" not in text
    assert "No request is refused." in text
    assert row(text, "| `trial-and-error` |")[1:] == ["4", "4 of 4", "0", "0", "–"]
    assert "A finite ε of 10000 MPa/mm is another problem" in text


@pytest.mark.slow
def test_a_node_or_a_force_that_differs_is_seen(own_store: Path) -> None:
    path = directory(own_store, CASE) / "contact.csv"
    contact = pd.read_csv(path)
    at = contact.index[(contact["delta_mm"] == 15) & (contact["active"] == 1)][0]
    contact.loc[at, "active"] = 0
    write_table(path, contact)
    other = "trial-and-error dead constant-s33 exact"
    result = json.loads(directory(own_store, other).with_suffix(".json").read_text())
    result["steps"][1]["force_N"] *= 1 + 2e-7
    change(own_store, other, steps=result["steps"])
    text = algorithms_page(load_store(own_store)).text
    assert row(text, "| `trial-and-error` | 4 |")[2:] == ["2 of 4", "2.0e-07", "1", "–"]
    odd = text[text.index("Solves that do not agree") :]
    assert "| `trial-and-error` | follower | nonsymmetric | converged |" in odd
    assert "| `trial-and-error` | dead | constant-s33 | converged |" in odd


@pytest.mark.slow
def test_a_path_that_ends_early_does_not_agree(own_store: Path) -> None:
    steps = json.loads(directory(own_store, CASE).with_suffix(".json").read_text())["steps"]
    change(own_store, CASE, outcome="cycling", reason="the contact set repeats itself", steps=steps[:2])
    found = next(entry for entry in entries(load_store(own_store)) if entry.cell.label.endswith(CASE))
    assert not found.agrees
    assert np.isnan(found.difference)
    text = algorithms_page(load_store(own_store)).text
    assert row(text, "| `trial-and-error` | 4 |")[2] == "3 of 4"
    assert "| cycling | the contact set repeats itself |" in text


def refuse(root: Path) -> None:
    """As a campaign leaves it: no step, no table of contact, an empty history."""
    empty = {"steps": [], "quantities": {}, "counters": {"dofs": 10}, "timing_s": {"total": 0.1, "build": 0.1}}
    change(root, CASE, outcome="unsupported", reason="trial-and-error does not apply: not symmetric", **empty)
    place = directory(root, CASE)
    columns = pd.read_csv(place / "history.csv").columns
    write_text(place / "history.csv", ",".join(columns) + "\n")
    (place / "contact.csv").unlink()
    (place / "profile.csv").unlink()


@pytest.mark.slow
def test_a_refusal_is_told_with_its_reason_on_every_page(own_store: Path) -> None:
    refuse(own_store)
    store = load_store(own_store)
    text = algorithms_page(store).text
    assert "- `trial-and-error` refuses 1: not symmetric." in text
    assert row(text, "| `trial-and-error` | 4 |")[2:] == ["3 of 3", "0", "0", "1"]
    assert "and 1 requests were refused" in text


def test_further_answers_to_a_problem_are_counted_by_their_reason(own_store: Path) -> None:
    """Without a table nothing is said, with an empty one there is no list."""
    assert "no law" not in algorithms_page(load_store(own_store)).text
    told = {"label": "a", "contact": "qp", "model": "half", "steps": 1, "substeps": 1, "outcome": "converged"}
    told |= {"value": 10.0, "cells": 5, "command": "solve a"}
    other = {f"other_{name}": value for name, value in {**told, "value": 11.5, "substeps": 7, "contact": "lcp"}.items()}
    row_ = {"scene": "plate-contact", "mesh": "64x1", "quantity": "force_N", "difference": 0.13, "why": "load steps"}
    table = pd.DataFrame([{**row_, **told, **other}] * 2).assign(difference=[0.13, 0.02])
    written(own_store, "report", {"disagreements": table})
    text = algorithms_page(load_store(own_store)).text
    written(own_store, "report", {"disagreements": table.iloc[:0]})
    without = algorithms_page(load_store(own_store)).text
    assert "2 answers differ" in text
    assert row(text, "`plate-contact`") == ["load steps", "2", "`plate-contact`", "1.3e-01"]
    assert "0 answers differ" in without
    assert "`plate-contact`" not in without


# --- costs and claims -------------------------------------------------------------------------------------------


def test_seconds_and_iterations_of_every_algorithm(store: Path) -> None:
    text = algorithms_page(load_store(store)).text
    assert "| problem | mesh | `semismooth` | `lcp` | `qp` |" in text
    assert row(text, "| `tyre` at delta_mm=20: force_N |")[1:] == ["16x16", "1.0 (9)", "0.90 (9)", "refused"]


def test_cycles_and_false_claims_are_counted(store: Path) -> None:
    loaded = load_store(store)
    text = algorithms_page(loaded).text
    assert row(text, "| 3x3 |")[1:4] == ["cycles, period 3", "converged, cycle detected", "iteration-limit"]
    assert row(text, "| mild |")[1] == "converged"
    assert "2 algorithms and settings (`lcp`; `regularised`) make 18 claims, of which 0 are false" in text
    assert "Versions: osqp 1.1." in text
    claims = row(text, "| osqp alone, defaults |")
    assert claims[1:] == ["1e-03", "5 of 9", "1", "3", "5e-01", "stiff", "equilibrium"]
    opening = of_page(loaded, "algorithms")
    assert "By its own criterion 4 of these answers are right, yet 3 fail the judge at 1e-08" in opening
    assert "errors of up to 50 %" in opening
    assert "of 3 claims of `semismooth` to 1e-08" not in text  # all kinds are counted
    assert "of 4 claims of `semismooth` to 1e-08 on 4 problems there 0 are false" in text


# --- epsilon ----------------------------------------------------------------------------------------------------


def test_the_penalty_is_that_of_the_wall(store: Path) -> None:
    """E/h of the tyre is 510.45/4.8; the made-up error is 2e-3 over it, and its condition 1e3 times it over 1e5."""
    loaded = load_store(store)
    text = algorithms_page(loaded).text
    assert row(text, "| tyre | 106.3 |") == ["tyre", "106.3", "2.3", "1.9e-05", "1.06", "10.6", "9.4e+03 E/h"]
    assert "solve tyre 10000\n" in text
    assert "is 94 E/h on its tyre: the force at 20 mm differs from exact contact by 2.0e-07 on a mesh of 20x20" in text
    assert "exact contact takes no more iterations than the paper's ε in 2 of 2 problems" in text
    assert "with ε = E/h" in of_page(loaded, "algorithms")


def test_a_tolerance_that_is_never_reached_is_said(own_store: Path) -> None:
    data = load_store(own_store).table("epsilon")
    data.loc[data["form"] == "displacement", "outcome"] = "rounding"
    write_table(own_store / "tables" / "epsilon.csv", data)
    written(own_store, "report", {"epsilon_laws": epsilon_laws(data)})
    assert row(algorithms_page(load_store(own_store)).text, "| tyre | 106.3 |")[-1] == "any ε"


def test_missing_table_is_one_line(own_store: Path) -> None:
    shutil.rmtree(own_store / "tables")
    with pytest.raises(ValueError, match=r"\.csv: missing"):
        algorithms_page(load_store(own_store))
