"""Sentences from choices: limits of meshes, and not settled where an interval is wider than the difference."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from studies.analysis.statements.choices import REQUEST, finest_trials
from studies.experiments.choices import measure_limits
from support.sentences import said
from support.stores.answers import choices


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return choices()


def filled(name: str, **tables: pd.DataFrame) -> str:
    """The one sentence of this name."""
    (found,) = said(name, **tables)
    return found.text.format(**found.values)


def test_a_measure_is_within_beyond_or_not_settled() -> None:
    rows = [("close", 0.01, 0.01), ("close", 0.04, 0.009), ("far", 0.2, 0.1), ("far", 0.01, 0.0)]
    rows += [("wide", 0.04, 0.02), ("lost", np.nan, np.nan), ("linear", 0.3, 0.0)]
    table = pd.DataFrame(rows, columns=["name", "formulation_error", "within"])
    elsewhere = table.assign(formulation_error=0.5, regime="small rotations")
    limits = pd.concat([elsewhere, table.assign(regime="contact")]).assign(scene="ring", settings="")
    (found,) = said("measures-contact", measure_limits=limits)
    told = {name: found.values[name] for name in ("within", "beyond", "open")}
    assert told == {"within": "`close`", "beyond": "`far` 1", "open": "`wide`, `lost`"}


def test_a_regime_says_what_is_not_settled(table: pd.DataFrame) -> None:
    limits = measure_limits(table)
    contact = filled("measures-contact", measure_limits=limits)
    assert (
        "within 5% of the exact measure on all: none; beyond it on one at least: `donnell` 2; undecided: `san"
        in contact
    )
    assert "Linear strains err by 40.0% to 40.0%" in contact
    assert all(said(f"measures-{regime}", measure_limits=limits) for regime in ("small", "large"))
    tyre = filled("tyre-measure", measure_limits=limits)
    assert "`linear` (+40.0% ± 0.1%)" in tyre
    assert "undecided: `sanders`" in tyre


def test_operations_are_compared_of_the_same_request() -> None:
    """A pair differs in its measure alone: another mesh, or what did not converge, is none; nor is a linear one."""
    names = dict.fromkeys(REQUEST, "x")
    rows = [("exact", "8x8", 100), ("donnell", "8x8", 200), ("linear", "8x8", 50), ("linear", "16x16", 9)]
    table = pd.DataFrame([{**names, "measure": m, "mesh": n, "operations": k} for m, n, k in rows])
    cells = table.assign(label="sweep x", outcome="converged")
    lost = cells.iloc[:1].assign(mesh="16x16", outcome="not-converged")
    (found,) = said("measures-cost", data_cells=pd.concat([cells, lost], ignore_index=True))
    assert (found.values["high"], found.values["linear"], found.values["both"]) == (2.0, 0.5, 1.0)
    assert "takes 2.00 times the operations" in found.text.format(**found.values)
    assert said("measures-cost", data_cells=cells.drop(columns="operations")) == []


def test_what_one_per_cent_costs_is_that_of_what_is_recommended(table: pd.DataFrame) -> None:
    measure = filled("cheapest-measure", choices=table)
    assert measure.startswith("Of 10 questions, a problem to 5 % or 1 % each, 10 are answered; the cheapest")
    (price,) = said("one-per-cent", choices=table)
    assert price.values["middle"] == pytest.approx(5.0)
    none = table.assign(mesh=table["mesh"].where(table["row"] != "offer"))
    assert [*said("cheapest-measure", choices=none), *said("one-per-cent", choices=none)] == []


def test_an_algorithm_with_another_answer_is_counted_apart(table: pd.DataFrame) -> None:
    row = {"algorithm": "semismooth", "default": "semismooth", "solved_share": 1.0, "problems": 9, "path_ends": 0}
    summary = pd.DataFrame([{**row, "scenes": 2, "refused": 0}])
    found = filled("which-algorithm", contact_summary=summary, choices=table)
    assert "Take `semismooth`: it converges on 100%" in found
    assert "`lcp` 2 of 2 at 0.90 times; `qp` 0 of 2" in found
    other = table.assign(agrees=table["agrees"].where(table["name"] != "lcp", False))
    trials = finest_trials(other).drop_duplicates("name").set_index("name")
    assert trials["other"].to_dict() == {"semismooth": False, "lcp": True, "qp": False}
    assert trials["over"].isna().to_dict() == {"semismooth": False, "lcp": False, "qp": True}
    told = filled("which-algorithm", contact_summary=summary, choices=other)
    assert "`lcp` 2 of 2 at 0.90 times, 2 with the penetration of its springs" in told
