"""Bars with friction: the strip against closed forms of the bar and of its model, the drum against the capstan."""

import numpy as np
import pandas as pd
import pytest

from studies.experiments.friction.bars import DRUM_END, MESHES, TAU, Bar, capstan_table, drum_table, front, strip_table
from support.problems.differences import orders

ROUNDING = 1e-9


def exact_but_for_the_mesh(table: pd.DataFrame) -> None:
    """What holds on any mesh: the reading of the front, and the closed form of the model."""
    assert (table["outcome"] == "converged").all()
    assert (table["least_N_mm"] >= 0).all()
    np.testing.assert_allclose(table["front_mm"], 40.0, rtol=ROUNDING)
    for name in ("end", "loop"):
        np.testing.assert_allclose(table[f"{name}_error"], table[f"discrete_{name}_error"], rtol=0, atol=ROUNDING)


@pytest.mark.slow
def test_the_error_of_the_strip_follows_from_where_its_front_lies() -> None:
    """And load steps of one sense change nothing."""
    table = strip_table((10, 13, 16), (1,))
    exact_but_for_the_mesh(table)
    q, offset = 0.4 * table["elements"], np.array([0.0, 0.2, 0.4])
    np.testing.assert_allclose(table["offset"], offset, atol=ROUNDING)
    np.testing.assert_allclose(table["counted_error"], -(offset + 0.5) / q, rtol=1e-6)
    np.testing.assert_allclose(table["end_error"], -((offset / q) ** 2), atol=ROUNDING)
    steps = strip_table((8,), (1, 2)).drop(columns=["steps", "iterations", "outcome", "least_N_mm"])
    np.testing.assert_allclose(steps.iloc[1], steps.iloc[0], rtol=1e-8, atol=ROUNDING)


def test_the_front_is_read_where_a_parabola_has_its_vertex() -> None:
    """Also off the nodes, where slip ends at its root before it; and under any uniform friction."""
    bar = Bar(20, 100.0, 1.0, press=TAU)
    x = 5.0 * np.arange(21)
    for zone in (40.0, 43.3, 46.0):
        slip = np.maximum((x - 100 + zone) ** 2 - 1.7, 0.0) * (x > 100 - zone)
        assert front(bar, slip) == pytest.approx(zone)
        assert front(bar, -3 * slip) == pytest.approx(zone)


@pytest.mark.slow
def test_drum_and_capstan() -> None:
    """Partial slip within a thousandth. In gross slip the ratio is that of its own recursion, (1 + a/2)/(1 - a/2) a
    node with a = mu theta/n, by both readings.
    """
    assert pytest.approx(0.03151163, abs=5e-9) == DRUM_END
    drum = drum_table((18,))
    assert (drum["outcome"] == "converged").all()
    assert (drum["end_error"].abs() < 1e-3).all()
    assert (drum["slip_error"].abs() < 5e-3).all()
    table = capstan_table(meshes=(10,))
    assert set(table["side"]) == {"on", "inside"}
    assert (table["outcome"] == "converged").all()
    assert (table["slipping"] == 11).all()
    assert (table["error"].abs() < 0.01).all()
    np.testing.assert_allclose(table["at_spring"], table["ratio"], rtol=1e-6)
    half = (table["mu"] * table["theta_rad"] / table["elements"] / 2).to_numpy(float)
    np.testing.assert_allclose(table["ratio"], ((1 + half) / (1 - half)) ** 10, rtol=1e-9)


@pytest.mark.slow
def test_errors_are_of_second_order() -> None:
    """On meshes on which the front lies alike; where it lies is what the strip's other errors follow from."""
    strip, drum = strip_table(MESHES, (1,)), drum_table(sides=("on",))
    exact_but_for_the_mesh(strip)
    assert (strip[["end_error", "loop_error"]].abs() < [0.005, 0.01]).all(axis=None)
    assert (drum["end_error"].abs() < 1e-3).all()
    found = (
        orders(strip, ["steps"], "elements", ["back_error"]),
        orders(drum, ["side"], "elements", ["end_error", "slip_error"]),
    )
    np.testing.assert_allclose(found[0].to_numpy(float), 2, atol=0.01)
    np.testing.assert_allclose(found[1].to_numpy(float), 2, atol=0.05)
