"""The strip on a drum and in one: partial and gross slip against the capstan."""

from __future__ import annotations

import numpy as np
import pytest

from studies.experiments.friction.bars import DRUM_END, capstan_table, drum_table
from support.problems.differences import orders


@pytest.mark.parametrize("side", ["on", "inside"])
def test_partial_slip_within_a_thousandth(side: str) -> None:
    assert pytest.approx(0.03151163, abs=5e-9) == DRUM_END
    row = drum_table((18,), (side,)).iloc[0]
    assert row["outcome"] == "converged"
    assert abs(row["end_error"]) < 1e-3
    assert abs(row["slip_error"]) < 5e-3


@pytest.mark.parametrize("side", ["on", "inside"])
def test_the_capstan_by_both_readings(side: str) -> None:
    """Every node slips; the ratio is that of its own recursion, (1 + a/2)/(1 - a/2) a node with a = mu theta/n."""
    table = capstan_table(meshes=(10,), sides=(side,))
    assert (table["outcome"] == "converged").all()
    assert (table["slipping"] == 11).all()
    assert (table["error"].abs() < 0.01).all()
    np.testing.assert_allclose(table["at_spring"], table["ratio"], rtol=1e-6)
    half = (table["mu"] * table["theta_rad"] / table["elements"] / 2).to_numpy(float)
    np.testing.assert_allclose(table["ratio"], ((1 + half) / (1 - half)) ** 10, rtol=1e-9)


@pytest.mark.slow
def test_the_orders_of_both() -> None:
    slips = drum_table(sides=("on",))
    assert (slips["end_error"].abs() < 1e-3).all()
    found = orders(slips, ["side"], "elements", ["end_error", "slip_error"])
    np.testing.assert_allclose(found[["end_error", "slip_error"]].to_numpy(float), 2, atol=0.05)
    ratios = capstan_table(((0.3, 2.0), (0.5, 4.0)), sides=("inside",))
    assert (ratios["error"].abs() < 0.01).all()
    np.testing.assert_allclose(
        orders(ratios, ["side", "mu", "theta_rad"], "elements", ["error"])["error"], 2, atol=0.05
    )
