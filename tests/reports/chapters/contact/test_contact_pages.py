"""The pages of contact: agreement, costs and refusals of a made-up campaign, and the laws of a made-up epsilon."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from contact.catalogue import ALGORITHMS
from reports.chapters.contact.agreement import agreement_page
from reports.chapters.contact.agreement_cases import entries
from reports.chapters.contact.algorithms import algorithms_page
from reports.chapters.contact.epsilon import epsilon_page
from reports.chapters.overview.solved import outcomes_page
from reports.store.tables import load_store
from studies.analysis.everything import written
from studies.analysis.powers import epsilon_laws
from studies.campaigns.report_cells import agreement, enforcements
from studies.store.atomic import write_json, write_table, write_text

CASE = "trial-and-error follower nonsymmetric exact"


def directory(root: Path, label: str) -> Path:
    index = json.loads((root / "campaigns" / "report.json").read_text())
    return root / "cells" / next(row["id"] for row in index["cells"] if row["label"] == f"agreement {label}")


def change(root: Path, label: str, **new: object) -> None:
    path = directory(root, label).with_suffix(".json")
    write_json(path, json.loads(path.read_text()) | new)


def row(text: str, *words: str) -> list[str]:
    found = [line for line in text.splitlines() if all(word in line for word in words)]
    return [word.strip() for word in found[0].split("|")[1:-1]]


def test_further_answers_to_a_problem_are_on_the_page_with_their_reason(own_store: Path) -> None:
    """Which, by how much and why; without a table there is no section, with an empty one no list."""
    assert "more than one answer" not in agreement_page(load_store(own_store)).text
    told = {"label": "a", "contact": "qp", "model": "half", "steps": 1, "substeps": 1, "outcome": "converged"}
    told |= {"value": 10.0, "cells": 5, "command": "solve a"}
    other = {f"other_{name}": value for name, value in {**told, "value": 11.5, "substeps": 7, "contact": "lcp"}.items()}
    row_ = {"scene": "plate-contact", "mesh": "64x1", "quantity": "force_N", "difference": 0.13, "why": "load steps"}
    table = pd.DataFrame([{**row_, **told, **other}])
    written(own_store, "report", {"disagreements": table})
    text = agreement_page(load_store(own_store)).text
    written(own_store, "report", {"disagreements": table.iloc[:0]})
    without = agreement_page(load_store(own_store)).text
    assert "1 further answers differ" in text
    assert row(text, "`plate-contact`", "`lcp`")[3:] == [
        *("10", "`qp`, half", "1", "11.5", "`lcp`, half", "7", "1.3e-01", "load steps")
    ]
    assert "0 further answers differ" in without
    assert "`plate-contact`" not in without


# --- cells ------------------------------------------------------------------------------------------------------


def test_every_algorithm_meets_every_case_exactly_and_as_it_is_by_default() -> None:
    assert enforcements(np.inf) == (("exact", "inf"),)
    assert enforcements(1e4) == (("exact", "inf"), ("epsilon", "10000"))
    asked = {(c.options["contact"], c.settings["load"], c.settings["section"]) for c in agreement()}
    assert len(asked) == 4 * len(ALGORITHMS)
    assert len({cell.label for cell in agreement()}) == len(agreement())


# --- agreement --------------------------------------------------------------------------------------------------


def test_all_agree_where_all_are_the_same(store: Path) -> None:
    text = agreement_page(load_store(store)).text
    exact = [cell for cell in agreement() if cell.label.endswith("exact")]
    others = [cell for cell in exact if not cell.label.startswith("agreement semismooth ")]
    assert f"That holds for {len(others)} of {len(others)} other solves" in text
    assert "No solve with the exact condition disagrees." in text
    assert "No algorithm refuses any of the cases." in text
    assert row(text, "| `trial-and-error` | follower | nonsymmetric |")[3:] == ["0", "0", "yes"]


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
    text = agreement_page(load_store(own_store)).text
    assert row(text, "| `trial-and-error` | follower | nonsymmetric |")[3:] == ["1", "0", "no"]
    assert row(text, "| `trial-and-error` | dead | constant-s33 |")[3:] == ["0", "2.0e-07", "no"]
    assert "| `trial-and-error` | dead | constant-s33 | converged | converged |" in text


@pytest.mark.slow
def test_a_path_that_ends_early_does_not_agree(own_store: Path) -> None:
    steps = json.loads(directory(own_store, CASE).with_suffix(".json").read_text())["steps"]
    change(own_store, CASE, outcome="cycling", reason="the contact set repeats itself", steps=steps[:2])
    found = next(entry for entry in entries(load_store(own_store)) if entry.cell.label.endswith(CASE))
    assert not found.agrees
    assert np.isnan(found.largest_difference)
    text = agreement_page(load_store(own_store)).text
    assert row(text, "| `trial-and-error` | follower | nonsymmetric |")[3:] == ["–", "–", "no"]
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
    for page in (agreement_page, algorithms_page):
        text = page(store).text
        refused = row(text[text.index("**Refused**") :], "| `trial-and-error` |")
        assert refused == [
            "`trial-and-error`",
            "follower",
            "nonsymmetric",
            "trial-and-error does not apply: not symmetric",
        ]
    assert "1 of" in agreement_page(store).text
    outcomes = outcomes_page(store).text
    overview = row(outcomes[outcomes.index("**Cells behind the pages**") :], "| tyre |")
    assert overview[-2:] == ["1", "0"]
    assert "does not apply" not in outcomes[: outcomes.index("Why cells were refused")]


# --- costs ------------------------------------------------------------------------------------------------------


def test_costs_of_all_algorithms(store: Path) -> None:
    text = algorithms_page(load_store(store)).text
    for name in ALGORITHMS:
        assert row(text, f"| `{name}` | dead | nonsymmetric |")[3:] == ["converged", "9", "9", "9", "2"]
    times = text[text.index("**Wall time") :]
    assert row(times, "| `semismooth` | follower | constant-s33 |")[3:] == ["1.25", "40 %", "40 %", "8 %", "4 %"]


# --- far from the solution --------------------------------------------------------------------------------------


def of(root: Path, label: str) -> Path:
    index = json.loads((root / "campaigns" / "report.json").read_text())
    return root / "cells" / next(f"{row['id']}.json" for row in index["cells"] if row["label"] == label)


def test_growth_of_iterations_and_a_step_that_is_cut(own_store: Path) -> None:
    path = of(own_store, "one step semismooth 84x80")
    result = json.loads(path.read_text())
    result["steps"][-1]["newton_iterations"] = 8
    write_json(path, result)
    text = algorithms_page(load_store(own_store)).text
    assert "`semismooth` from 5 to 8; `semismooth`, settle 1 diverges" in text
    assert row(text, "| `semismooth`, settle 1 | 84x80 |")[-1] == "1"
    assert row(text, "| `semismooth` | 84x80 |")[2:4] == ["converged", "8"]


def test_the_end_of_the_path_is_told_with_its_reason(own_store: Path) -> None:
    path = of(own_store, "far")
    result = json.loads(path.read_text())
    assert "The path reached all that was asked." in algorithms_page(load_store(own_store)).text
    write_json(path, result | {"outcome": "step-limit", "reason": "limit point", "steps": result["steps"][:-1]})
    text = algorithms_page(load_store(own_store)).text
    assert "The end: limit point." in text
    assert row(text, "| 35 |")[0] == "35"
    assert "| 40 |" not in text


def test_cycles_and_false_claims_are_counted(store: Path) -> None:
    text = algorithms_page(load_store(store)).text
    assert row(text, "| 3x3 |")[1:4] == ["cycles, period 3", "converged, cycle detected", "iteration-limit"]
    assert row(text, "| mild |")[1] == "settles"
    assert "Of our own 18 claims 0 are false." in text
    assert "False by ours: osqp alone, defaults: 3 of 5, 1 by its own tolerance." in text
    case = "osqp alone, defaults on stiff, off by 50 %, wrong in equilibrium"
    assert "Versions: osqp 1.1." in text
    assert f"Not even what was asked for is kept by: {case}." in text
    assert row(text, "| lcp |")[1:] == ["1e-10", "1e-08", "9 of 9", "0", "0", "under 1e-09", "mild"]
    assert row(text, "| osqp alone, defaults |")[3:] == ["5 of 9", "1", "3", "5e-01", "stiff"]


# --- epsilon ----------------------------------------------------------------------------------------------------


def test_page_of_epsilon_judges_the_papers_value(store: Path) -> None:
    text = epsilon_page(load_store(store)).text
    assert row(text, "| tyre | 20x20 |")[2:] == ["from 1e+10 on", "from 1e+10 to below 1e+06"]
    assert "solve tyre 10000\n" in text
    assert row(text, "| tyre | -1.000 |")[5:] == ["0.1", "1e+10"]
    assert row(text, "| tyre | 1e+06 |") == ["tyre", "1e+06", "2.0e-08", "100000"]
    judged = next(line for line in text.splitlines() if line.startswith("- the tyre at 20 mm"))
    assert "off by 2.0e-07 of itself, penetration 1.0e-05 mm" in judged
    assert "1e+02 times the condition" in judged
    assert "- the tyre at 20 mm: the break-down is 2 decades away" in text


def test_a_form_that_never_breaks_down_is_a_dash(own_store: Path) -> None:
    path = own_store / "tables" / "epsilon.csv"
    data = pd.read_csv(path)
    data["outcome"] = "converged"
    write_table(path, data)
    written(own_store, "report", {"epsilon_laws": epsilon_laws(data)})
    text = epsilon_page(load_store(own_store)).text
    broken = text[text.index("**Break-down") :]
    assert row(broken, "| tyre |")[1] == "–"
    assert "- the tyre at 20 mm: every tested ε converges" in text
    data.loc[data["form"].eq("displacement") & data["epsilon"].ge(1e4), "outcome"] = "rounding"
    write_table(path, data)
    written(own_store, "report", {"epsilon_laws": epsilon_laws(data)})
    assert "- the tyre at 20 mm: this ε does not converge any more" in epsilon_page(load_store(own_store)).text


def test_missing_table_is_one_line(own_store: Path) -> None:
    shutil.rmtree(own_store / "tables")
    with pytest.raises(ValueError, match=r"epsilon\.csv: missing"):
        epsilon_page(load_store(own_store))
