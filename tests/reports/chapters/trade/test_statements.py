"""The part of stated errors, from tables that are made up."""

from __future__ import annotations

import inspect
from pathlib import Path

import pandas as pd
import pytest

from reports.chapters.cost import errors_stated, statements_part
from reports.store import load_store
from studies.output.atomic import write_table
from support.stores.made_up import analysed_again


def coverage(wrong: bool) -> pd.DataFrame:
    """Uncertainties twice what limits are off; with one that is not inside, and one that was not reached."""
    rows = []
    for k, asked in enumerate((0.05, 0.01, 0.002)):
        row = {"scene": "cantilever", "settings": "", "quantity": "w", "asked": asked, "reached": True, "reason": ""}
        row |= {"stated": 1.0, "uncertainty": asked, "low": 0.0, "high": 3 * asked, "unknowns": 100 * k, "cost": 1.5}
        row |= {"true": 1.0, "known": 1e-5, "decided": True, "inside": True, "off": asked / 2}
        row |= {"value_error": asked, "value_decided": True, "value_inside": True}
        rows.append(row)
    if wrong:
        rows.append({**rows[0], "quantity": "N", "value_error": 0.2, "value_inside": False, "cost": 5.0})
        rows.append(
            {**rows[0], "quantity": "M", "reached": False, "reason": "no grid is enough", "value_decided": False}
        )
    return pd.DataFrame(rows)


def page(store: Path, table: pd.DataFrame) -> str:
    write_table(store / "tables" / "error_coverage.csv", table)
    analysed_again(store)
    return statements_part(load_store(store)).text


def test_a_store_without_the_table_has_no_such_part(store: Path) -> None:
    assert statements_part(load_store(store)).text == ""


@pytest.mark.slow
def test_what_holds_is_counted(own_store: Path) -> None:
    text = page(own_store, coverage(wrong=False))
    assert "Of 3 different statements on 1 scenes" in text
    assert "3 contain it" in text
    assert "3.0 times as wide as the error" in text
    assert "in 3 of 3; the uncertainty is 2.0 times its error" in text
    assert "more than 4 times in 0 of 3" in text
    assert "do not hold" not in text
    assert "not reached" not in text


@pytest.mark.slow
def test_what_does_not_hold_is_listed(own_store: Path) -> None:
    text = page(own_store, coverage(wrong=True))
    assert "Of 4 different statements" in text
    assert "3 contain it" in text
    assert "more than 4 times in 1 of 4" in text
    outside, missed = text.split("do not hold")[1].split("not reached")
    assert "| `cantilever` | – | `N` | 5.0 % | 20.00 % | 0.00 % to 15.00 % | 2.50 % | 5.00 % |" in outside
    assert "no grid is enough" in missed


def test_every_decided_limit_is_a_point() -> None:
    (axes,) = inspect.unwrap(errors_stated)(coverage(wrong=True)).axes
    points = [line for line in axes.lines if line.get_linestyle() == "None"]
    assert sum(len(line.get_xdata()) for line in points) == 4
