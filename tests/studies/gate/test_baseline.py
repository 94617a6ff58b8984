"""The committed baseline: its bounds cover it, its updates are signed, and its cheapest rows hold here and now."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from studies.gate.baseline import BASELINE, COMMAND, OUTCOME, TOLERANCES, UPDATES, bound_of, read_baseline, read_bounds
from studies.gate.compare import Finding, compared, failures, measured
from studies.run.answers import ORDER
from studies.run.campaign import Campaign, find
from studies.run.collect import collect
from studies.run.running import run
from studies.scenes.complete import Cell

FEW = 8


def cheapest() -> list[Cell]:
    """The solved cells of the baseline with the fewest operations."""
    values = read_baseline(BASELINE).pivot_table(index="label", columns="column", values="value", aggfunc="first")
    operations = values.loc[values[OUTCOME] == "converged", "c.operations"].astype(float)
    return [cell for cell in find("quick").cells if cell.label in operations.nsmallest(FEW).index]


def loss(table: pd.DataFrame) -> list[Finding]:
    """What some cells have lost; orders, which take a ladder, do not count."""
    before, now = (
        values[~values["column"].str.startswith(ORDER)] for values in (read_baseline(BASELINE), measured(table))
    )
    return failures(
        compared(before[before["label"].isin(set(table["label"]))], now, read_bounds(BASELINE.parent / TOLERANCES))
    )


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> pd.DataFrame:
    store = tmp_path_factory.mktemp("baseline")
    run(Campaign("cheapest", "", tuple(cheapest())), store)
    return collect(store, "cheapest")


def test_the_cheapest_rows_of_the_baseline_hold(table: pd.DataFrame) -> None:
    assert len(table) >= FEW
    assert loss(table) == []


def test_a_loss_in_one_of_its_rows_is_seen(table: pd.DataFrame) -> None:
    worse = table.head(1).assign(**{"c.operations": 1.1 * table["c.operations"].iloc[0]})
    (actual,) = loss(worse)
    assert (actual.column, actual.what) == ("c.operations", "worse")


def test_the_baseline_is_of_the_campaign_as_it_is() -> None:
    commands = read_baseline(BASELINE).query("column == @COMMAND").set_index("label")["value"]
    assert dict(commands) == {cell.label: cell.command for cell in find("quick").cells}


def test_every_value_has_a_bound_and_every_update_a_name() -> None:
    bounds = read_bounds(Path(BASELINE.parent / TOLERANCES))
    for row in read_baseline(BASELINE).itertuples(index=False):
        assert row.column in (OUTCOME, COMMAND) or bound_of(bounds, str(row.label), str(row.column))
    log = pd.read_csv(BASELINE.parent / UPDATES, dtype=str, keep_default_na=False)
    assert len(log)
    assert (log[["date", "owner", "reason", "changed"]] != "").all(axis=None)
