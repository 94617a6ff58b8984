"""The page of manufactured solutions, from errors that are made up: it says what they say, a fault included."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.convergence import manufactured_part
from reports.store import load_store
from studies.output.atomic import write_table
from support.stores.made_up import analysed_again
from support.stores.manufactured import made_up_manufactured, made_up_statements


def page(store: Path, **tables: pd.DataFrame) -> str:
    for name, table in tables.items():
        write_table(store / "tables" / f"{name}.csv", table)
    if tables:
        analysed_again(store)
    return " ".join(manufactured_part(load_store(store)).text.split())


def test_the_page_says_what_the_tables_say(store: Path) -> None:
    text = page(store)
    assert "orders of the displacement none lies further from 2 than 0.1." in text
    assert "The tables of all 2 quadratic measures are what the measures state" in text
    assert "Of 1 measures none failed on a mesh" in text
    assert "displacement 2.0 (2.0 to 2.0), pressure 1.0 (1.0 to 1.0), edge 1.0 (1.0 to 1.0); the lowest" in text
    assert "its error is 0.4 to 0.4 elements" in text
    assert "of the 0 orders of means below 1.95, 0 are higher" in text


@pytest.mark.slow
def test_a_lost_order_and_a_wrong_coefficient_are_said(own_store: Path) -> None:
    wrong = made_up_statements("E11-: coefficient of l1- is 0.9, stated 1")
    text = page(own_store, manufactured=made_up_manufactured(1.5), manufactured_statements=wrong)
    assert "orders of the displacement 1 lie further from 2 than 0.1." in text
    assert "| `exact` | E11-: coefficient of l1- is 0.9, stated 1 |" in text
