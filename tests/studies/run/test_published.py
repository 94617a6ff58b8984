"""The tables to be taken away: a row a cell, a row an answer, every column described, numbers rounded."""

from __future__ import annotations

import pandas as pd
import pytest

from studies.run.answers import ASKED, published
from studies.run.collect import COLUMNS
from studies.scenes import SCENES
from studies.scenes.complete import complete as resolve
from studies.solving.solve import KINDS

REFERENCE = SCENES["pinched-cylinder"].references[0]


def collected(*more: dict[str, object]) -> pd.DataFrame:
    """Two cells as collected: one with an answer, a reference to it and a counter of a stranger's, one refused."""
    asked = dict.fromkeys(COLUMNS, "") | {"scene": "pinched-cylinder", "epsilon": float("inf"), "tolerance": 1e-9}
    _, request = resolve("pinched-cylinder", {}, "4x4", measure="linear")
    solved = {**asked, "label": "one", "outcome": "converged", "request": request}
    solved |= {
        f"q.{REFERENCE.quantity}": 1.1 * REFERENCE.value,
        "c.dofs": 10,
        "c.tea_breaks": 2,
        "k.equilibrium": 1e-12,
    }
    solved |= {"t.seconds": 0.123456, "t.seconds_low": 0.12, "t.seconds_high": 0.13, "t.total": 0.5, "t.cpu": 0.4}
    solved |= {"k.equilibrium": 1e-12} | {f"w.{kind}": 7 for kind in KINDS}
    refused = {**asked, "label": "two", "outcome": "unsupported", "reason": "why", "request": request}
    return pd.DataFrame([solved, refused, *more])


def test_every_column_is_described() -> None:
    tables = published(collected())
    columns = tables["data_columns"]
    for name in ("cells", "answers"):
        own = columns[columns["table"] == name]
        assert list(own["column"]) == list(tables[f"data_{name}"])
        assert (own["description"].str.len() > 5).all()
    assert not columns.duplicated(["table", "column"]).any()
    units = columns[columns["table"] == "cells"].set_index("column")["unit"]
    assert (units[[f"operations_{kind}" for kind in KINDS]] == "operations").all()
    assert (units[["seconds", "seconds_low", "seconds_high", "time_total"]] == "s").all()


def test_whatever_is_asked_is_published_but_for_what_the_mesh_and_the_command_say() -> None:
    assert set(COLUMNS) - set(ASKED) == {"n1", "n2", "request"}


def test_a_cell_without_an_answer_is_there_and_an_answer_names_its_cell() -> None:
    tables = published(collected())
    cells, answers = tables["data_cells"], tables["data_answers"]
    assert list(cells["cell"]) == [0, 1]
    assert list(cells["outcome"]) == ["converged", "unsupported"]
    assert list(answers["cell"]) == [0]
    assert answers["error"].iloc[0] == pytest.approx(0.1)
    assert answers["reference"].iloc[0] == pytest.approx(REFERENCE.value)
    assert answers["kind"].iloc[0] == REFERENCE.kind


def test_numbers_are_rounded_and_nothing_else_is_lost() -> None:
    cells = published(collected())["data_cells"]
    assert cells["seconds"].iloc[0] == 0.1235
    assert cells["dofs"].iloc[0] == 10
    assert cells["tea_breaks"].iloc[0] == 2
    assert cells["epsilon"].iloc[0] == float("inf")
    assert cells["residual_equilibrium"].iloc[0] == 1e-12
    assert cells["seconds"].isna().iloc[1]
