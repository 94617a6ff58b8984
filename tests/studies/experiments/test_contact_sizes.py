"""The contact algorithms on one tyre after another: prices, and their ratio to the default's."""

from __future__ import annotations

import pandas as pd
import pytest

from studies.experiments.contact_sizes import COLUMNS, ROUNDS, contact_sizes


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return contact_sizes({"6x6": 1}, ("semismooth", "lcp", "trial-and-error"))


def test_every_algorithm_has_its_prices_on_every_grid(table: pd.DataFrame) -> None:
    assert list(table.columns) == list(COLUMNS)
    assert list(table["algorithm"]) == ["semismooth", "lcp", "trial-and-error"]
    assert (table["outcome"] == "converged").all()
    assert (table[["seconds", "operations", "force_N"]] > 0).all(axis=None)
    assert table["unknowns"].nunique() == 1
    assert table["force_N"].to_numpy() == pytest.approx(table["force_N"].iloc[0], rel=1e-3)


def test_ratios_are_to_the_default_on_the_same_grid(table: pd.DataFrame) -> None:
    default, other, penalty = table.to_dict("records")
    assert default["seconds_over_default"] == default["operations_over_default"] == 1.0
    for row in (other, penalty):
        assert row["seconds_over_default"] == row["seconds"] / default["seconds"]
        assert row["operations_over_default"] == row["operations"] / default["operations"]


def test_sizes_go_from_two_to_forty_thousand_unknowns() -> None:
    unknowns = [6 * (int(n) - 1) * int(m) for n, m in (mesh.split("x") for mesh in ROUNDS)]
    assert min(unknowns) < 2200
    assert max(unknowns) > 39_000
