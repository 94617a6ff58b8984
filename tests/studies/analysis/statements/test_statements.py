"""Sentences of conclusion: their numbers are those of the tables, and without a table nothing is said."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from inspect import signature
from pathlib import Path

import pandas as pd
import pytest

import studies
from reports.store.statements import of_page, sentence, statements
from reports.store.tables import Store
from studies.analysis.everything import written
from studies.analysis.statements.laws import experiment, fuzz
from studies.analysis.statements.record import ANSWERS, OPENING, Evidence, Statement, as_tables
from studies.analysis.statements.shells.tyre import printed
from studies.analysis.statements.tables import MAKERS
from studies.analysis.statements.trade.cost import grids
from studies.arena.solver_run import FIELDS

CAMPAIGN = "made"


def comparison() -> pd.DataFrame:
    """Two travels: at the second one the core is nearer to print."""
    row = {"phi_per_label": 0.5, "printed_sum_N": 2000.0, "centre_MPa": 0.1, "printed_centre_MPa": 0.2}
    row |= {"outside": 7, "printed_nodes": 20}
    rows = [
        {**row, "delta_mm": 20.0, "force_N": 1500.0, "core_rms": 0.2, "best": False},
        {**row, "delta_mm": 23.0, "force_N": 1900.0, "core_rms": 0.05, "best": True},
    ]
    return pd.DataFrame(rows)


def store_of(path: Path, found: list[Statement]) -> Store:
    written(path, CAMPAIGN, as_tables(found))
    return Store(path, CAMPAIGN, ())


def test_the_printed_table_is_told_with_the_numbers_of_its_table(tmp_path: Path) -> None:
    store = store_of(tmp_path, list(printed(comparison())))
    said = sentence(store, "printed-table")
    assert "at 20 mm the force is -25 % off" in said
    assert "differ by 20.0 % (rms)" in said
    assert "fits best at 23 mm, with -5 % and 5.0 %" in said
    (opening,) = (each for each in statements(store) if each.role == OPENING)
    assert (opening.page, opening.problems) == ("tyre", 2)
    assert opening.values["off"] == -0.25
    assert of_page(store, "tyre") == said


def test_a_store_that_was_not_analysed_says_nothing(tmp_path: Path) -> None:
    assert statements(Store(tmp_path, CAMPAIGN, ())) == ()
    assert sentence(Store(tmp_path, CAMPAIGN, ()), "printed-table") == ""
    store = store_of(tmp_path, list(printed(comparison())))
    assert sentence(Store(store.path, "another", ()), "printed-table") == ""


def test_a_maker_without_one_of_its_tables_says_nothing(tmp_path: Path) -> None:
    evidence = Evidence(tmp_path, CAMPAIGN)
    table = [maker for maker in MAKERS if "answers" not in maker.__code__.co_varnames[: maker.__code__.co_argcount]]
    assert [each for maker in table for each in evidence.said_by(maker)] == []
    written(tmp_path, "another", {"tyre_comparison": comparison()})
    assert list(Evidence(tmp_path, CAMPAIGN).said_by(printed)) == []
    assert len(list(Evidence(tmp_path, "another").said_by(printed))) == 2


def test_a_conclusion_in_words_stands_only_where_its_numbers_bear_it() -> None:
    bodies = {"solid hencky": 99.0, "solid svk": 90.0, "shell exact": 91.0}
    row = [{"body": body, "delta_mm": 1.0, "measured_N": 100.0, "limit_N": force} for body, force in bodies.items()]
    (said,) = experiment(pd.DataFrame(row))
    assert "the law is missed by more than the shell is" in said.text
    row[0]["limit_N"] = 80.0
    (said,) = experiment(pd.DataFrame(row))
    assert "the law is missed" not in said.text


def test_a_graded_grid_that_gets_there_is_not_said_to_fail() -> None:
    families = {"uniform": 1000.0, "adapted": 200.0, "local": 250.0, "patch": float("nan")}
    row = [{"within": 0.01, "element": "refined", "family": name, "unknowns": n} for name, n in families.items()]
    precision = pd.DataFrame({"family": ["patch"], "unknowns": [9000]})
    (said,) = grids(pd.DataFrame(row), precision)
    assert (said.values["adapted"], said.values["share"]) == (200.0, 0.2)
    assert "does not get there with {largest:.0f}" in said.text
    row[3]["unknowns"] = 900.0
    (said,) = grids(pd.DataFrame(row), precision)
    assert "does not get there" not in said.text


def test_a_field_without_a_value_is_an_error(tmp_path: Path) -> None:
    def unfilled() -> Iterator[Statement]:
        yield Statement("x", "tyre", "{there:.1f} of {missing:.1f}", {"there": 1.0}, 1, "")

    with pytest.raises((KeyError, AttributeError)):
        statements(store_of(tmp_path, list(unfilled())))


def test_broken_laws_are_counted() -> None:
    verdicts = pd.DataFrame({"verdict": ["agrees", "broken", "broken", "explained"]})
    (said,) = fuzz(verdicts, pd.DataFrame({"cases": [0, 9, 4]}))
    assert said.values == {"cases": 4, "broken": 2, "explained": 1, "faults": 3, "found": 2, "latest": 9}
    assert isinstance(said, Statement)


def test_every_table_that_a_maker_reads_is_written_by_somebody() -> None:
    """A table with another name would make its sentences vanish without a word."""
    read = {name for maker in MAKERS for name in signature(maker).parameters} - {ANSWERS}
    assert len(read) > 40
    words: set[str] = set()
    for path in Path(studies.__file__).parent.rglob("*.py"):
        if "statements" not in path.parts:
            nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            words |= {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    assert not read - words - {f"{field}_{word}" for field in FIELDS for word in words}
