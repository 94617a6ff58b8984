"""Sentences of conclusion: their numbers are those of the tables, and without a table nothing is said.

Sentences from choices: limits of meshes, and not settled where an interval is wider than the difference.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from inspect import signature
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import studies
from reports.chapter import OPENING, of_page, statements
from reports.store import Store
from studies.analysis.everything import DECLARED, written
from studies.analysis.evidence import ANSWERS, Evidence
from studies.analysis.statements.choices import REQUEST, finest_trials
from studies.analysis.statements.record import Statement, as_tables
from studies.analysis.statements.tables import maker_of, read_claims, read_sentences
from studies.analysis.statements.tables import statements as all_said
from studies.arena.solver_run import FIELDS
from studies.experiments.choices import measure_limits
from studies.output.atomic import SCHEMA, write_json
from studies.run.lists import MAKERS
from support.sentences import said, sentence, tables_of
from support.sentences import said as said_of
from support.stores.answers import choices

CAMPAIGN = "made"


def readings() -> pd.DataFrame:
    """Exact strains fit at 23 mm, sanders nearly so, linear ones nowhere; a thinner ply moves the best travel."""
    names = ("reading", "delta_mm", "force_N", "core_rms", "in_one_only", "best", "kind")
    rows = [
        ("as stated", 20.0, 1500.0, 0.2, 60, False, "model"),
        ("as stated", 23.0, 1900.0, 0.05, 10, True, "model"),
        ("as stated", 25.0, 2100.0, 0.07, 10, False, "model"),
        ("sanders", 20.0, 1500.0, 0.15, 50, False, "model"),
        ("sanders", 22.0, 1700.0, 0.055, 12, True, "model"),
        ("linear strains", 20.0, 2010.0, 0.4, 70, False, "model"),
        ("linear strains", 18.0, 1200.0, 0.35, 90, True, "model"),
        ("ply", 24.0, 1950.0, 0.05, 1, True, "data"),
    ]
    actual = pd.DataFrame(rows, columns=list(names))
    return actual.assign(stated=actual["delta_mm"] == 20.0, printed_sum_N=2000.0)


def printed_table() -> list[Statement]:
    names = ("printed-table", "printed-excluded", "origin-of-travel")
    return [each for name in names for each in said_of(name, tyre_readings=readings())]


def store_of(path: Path, found: list[Statement]) -> Store:
    written(path, CAMPAIGN, as_tables(found))
    return Store(path, CAMPAIGN, ())


def test_the_printed_table_is_told_with_the_numbers_of_its_table(tmp_path: Path) -> None:
    store = store_of(tmp_path, printed_table())
    said = sentence(store, "printed-table")
    assert "is not reproduced at the stated travel of 20 mm" in said
    assert "2 of 3 readings fit about equally, at 22 to 23 mm" in said
    assert "5.0 % to 5.5 % (rms)" in said
    assert "10 to 12 nodes" in said
    assert said.endswith("of the two patches: as stated; sanders. The longest travel tried fits best for: sanders.")
    opening = [each for each in statements(store) if each.role == OPENING]
    assert [(each.page, each.name) for each in opening] == [("tyre", "printed-table"), ("tyre", "printed-excluded")]
    assert of_page(store, "tyre").startswith(said)


def test_a_force_that_agrees_by_chance_is_excluded_with_its_numbers(tmp_path: Path) -> None:
    store = store_of(tmp_path, printed_table())
    said = sentence(store, "printed-excluded")
    assert "no reading fits better than 15.0 % (rms) with 50 nodes in only one patch (sanders)" in said
    assert "2010 N on the paper's mesh, is within 0.5 % of the sum of the printed pressures, 2000 N, by chance" in said
    assert "differ by 40 %, with 70 nodes in only one patch, and by 35 % at the best" in said
    unknown = sentence(store, "origin-of-travel")
    assert "between 24 and 24 mm" in unknown


def test_a_store_that_was_not_analysed_says_nothing(tmp_path: Path) -> None:
    assert statements(Store(tmp_path, CAMPAIGN, ())) == ()
    assert sentence(Store(tmp_path, CAMPAIGN, ()), "printed-table") == ""
    store = store_of(tmp_path, printed_table())
    assert sentence(Store(store.path, "another", ()), "printed-table") == ""


def test_a_sentence_without_one_of_its_tables_is_not_said(tmp_path: Path) -> None:
    write_json(tmp_path / "campaigns" / "made.json", {"schema": SCHEMA, "campaign": CAMPAIGN, "cells": []})
    assert all_said(tmp_path, CAMPAIGN) == []
    written(tmp_path, "another", {"tyre_readings": readings()})
    assert Evidence(tmp_path, CAMPAIGN).table("tyre_readings") is None
    assert Evidence(tmp_path, "another").table("tyre_readings") is not None


def test_a_conclusion_in_words_stands_only_where_its_numbers_bear_it() -> None:
    bodies = {"solid hencky": 99.0, "solid svk": 90.0, "shell exact": 91.0}
    row = [{"body": body, "delta_mm": 1.0, "measured_N": 100.0, "limit_N": force} for body, force in bodies.items()]
    row[0] |= {"friction": -0.6, "remainder": 0.5}
    (said,) = said_of("experiment", ring_budget=pd.DataFrame(row))
    assert "the error of the law is larger than that of the shell" in said.text
    assert "an unexplained remainder, {remainder:+.2f} N, cancel" in said.text
    row[0] |= {"limit_N": 80.0, "remainder": -0.5}
    (said,) = said_of("experiment", ring_budget=pd.DataFrame(row))
    assert "the error of the law" not in said.text
    assert "cancel" not in said.text


def test_a_graded_grid_that_gets_there_is_not_said_to_fail() -> None:
    families = {"uniform": 1000.0, "adapted": 200.0, "local": 250.0, "patch": float("nan")}
    row = [
        {"within": 0.01, "element": "refined", "family": name, "unknowns": n, "total_s": 2.0}
        for name, n in families.items()
    ]
    precision = pd.DataFrame({"family": ["patch"], "unknowns": [9000]})
    (said,) = said_of("grids-of-the-tyre", grids_reaching=pd.DataFrame(row), work_precision=precision)
    assert (said.values["adapted"], said.values["share"]) == (200.0, 0.2)
    assert "is not within it at {largest:.0f}" in said.text
    row[3]["unknowns"] = 900.0
    (said,) = said_of("grids-of-the-tyre", grids_reaching=pd.DataFrame(row), work_precision=precision)
    assert "is not within it" not in said.text


def test_a_field_without_a_value_is_an_error(tmp_path: Path) -> None:
    def unfilled() -> Iterator[Statement]:
        yield Statement("x", "tyre", "{there:.1f} of {missing:.1f}", {"there": 1.0}, 1, "")

    with pytest.raises((KeyError, AttributeError)):
        statements(store_of(tmp_path, list(unfilled())))


def test_broken_laws_are_counted() -> None:
    verdicts = pd.DataFrame({"verdict": ["agrees", "broken", "broken", "explained"]})
    (said,) = said_of("random-cases", fuzz=verdicts)
    assert said.values == {"cases": 4, "broken": 2, "explained": 1}
    assert isinstance(said, Statement)


def test_the_mirror_is_that_of_the_paper_s_cords_beside_the_printed_one() -> None:
    angles = pd.DataFrame({"gamma_deg": [10.0, 52.0, 85.0], "mirror_both_MPa": [0.08, 0.03, 0.09], "peak_MPa": 0.3})
    angles = angles.assign(outcome="converged", negative=[0, 0, 2], measure="exact", mesh="42x40", central_MPa=0.0)
    assert said_of("mirror", mirror=angles) == []
    printed = pd.DataFrame({"who": ["printed"], "image": ["mirror, psi"], "both_touch_MPa": [0.04]})
    (said,) = said_of("mirror", mirror=angles, tyre_symmetry=printed)
    assert said.values["pressure"] == 0.03
    assert said.values["share"] == pytest.approx(0.1)
    assert said.values["printed"] == 0.04
    assert (said.values["angle"], said.values["most"], said.values["angles"]) == (10.0, 0.08, 2)
    assert said_of("mirror", mirror=angles[angles["gamma_deg"] != 52.0], tyre_symmetry=printed) == []


def test_every_table_that_is_read_is_written_by_somebody() -> None:
    """A table with another name would make a sentence vanish without a word, and leave a claim untested for ever."""
    declared = [*read_sentences(), *read_claims().values()]
    finders = [maker_of(each) for each in declared if "maker" in each]
    read = {name for finder in finders for name in signature(finder).parameters} - {ANSWERS}
    read |= {name for each in declared for name in tables_of(each)}
    assert len(read) > 40
    sources = [path for path in Path(studies.__file__).parent.rglob("*.py") if "statements" not in path.parts]
    words = {word for path in sources for word in re.findall(r'"([a-z0-9_]+)"', path.read_text(encoding="utf-8"))}
    words |= {*DECLARED["fitted"], *MAKERS}
    assert not read - words - {f"{field}_{word}" for field in FIELDS for word in words}


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return choices()


def filled(name: str, **tables: pd.DataFrame) -> str:
    """The one sentence of this name."""
    (actual,) = said(name, **tables)
    return actual.text.format(**actual.values)


def test_a_measure_is_within_beyond_or_not_settled() -> None:
    rows = [("close", 0.01, 0.01), ("close", 0.04, 0.009), ("far", 0.2, 0.1), ("far", 0.01, 0.0)]
    rows += [("wide", 0.04, 0.02), ("lost", np.nan, np.nan), ("linear", 0.3, 0.0)]
    table = pd.DataFrame(rows, columns=["name", "formulation_error", "within"])
    elsewhere = table.assign(formulation_error=0.5, regime="small rotations")
    limits = pd.concat([elsewhere, table.assign(regime="contact")]).assign(scene="ring", settings="")
    (actual,) = said("measures-contact", measure_limits=limits)
    record = {name: actual.values[name] for name in ("within", "beyond", "open")}
    assert record == {"within": "`close`", "beyond": "`far` 1", "open": "`wide`, `lost`"}


def test_a_regime_says_what_is_not_settled(table: pd.DataFrame) -> None:
    limits = measure_limits(table)
    contact = filled("measures-contact", measure_limits=limits)
    assert (
        "within 5% of the exact measure on all: none; outside it on at least one: `donnell` 2; undecided: `san"
        in contact
    )
    assert "Linear strains have errors of 40.0% to 40.0%" in contact
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
    (actual,) = said("measures-cost", data_cells=pd.concat([cells, lost], ignore_index=True))
    assert (actual.values["high"], actual.values["linear"], actual.values["both"]) == (2.0, 0.5, 1.0)
    assert "takes 2.00 times the operations" in actual.text.format(**actual.values)
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
    actual = filled("which-algorithm", contact_summary=summary, choices=table)
    assert "Take `semismooth`: it converges on 100.0%" in actual
    assert "`lcp` 2 of 2 at 0.90 times; `qp` 0 of 2" in actual
    other = table.assign(agrees=table["agrees"].where(table["name"] != "lcp", False))
    trials = finest_trials(other).drop_duplicates("name").set_index("name")
    assert trials["other"].to_dict() == {"semismooth": False, "lcp": True, "qp": False}
    assert trials["over"].isna().to_dict() == {"semismooth": False, "lcp": False, "qp": True}
    stated = filled("which-algorithm", contact_summary=summary, choices=other)
    assert "`lcp` 2 of 2 at 0.90 times, 2 of them with another answer; " in stated
    springs = other.assign(name=other["name"].replace("lcp", "regularised"))
    stated = filled("which-algorithm", contact_summary=summary, choices=springs)
    assert "2 of them with another answer, that of a finite ε; " in stated
