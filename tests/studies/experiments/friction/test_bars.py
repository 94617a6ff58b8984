"""Bars with friction: the strip against closed forms, the drum against the capstan."""

import numpy as np
import pytest

from studies.experiments.friction.bars import DRUM_END, MESHES, TAU, Bar, capstan_table, drum_table, front, strip_table
from support.problems.differences import orders

ROUNDING = 1e-9


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
    node with a = mu theta/n.
    """
    assert pytest.approx(0.03151163, abs=5e-9) == DRUM_END
    drum = drum_table((18,))
    assert (drum["outcome"] == "converged").all()
    assert (drum["end_error"].abs() < 1e-3).all()
    assert (drum["slip_error"].abs() < 5e-3).all()
    table = capstan_table(meshes=(10,))
    assert set(table["side"]) == {"on", "inside"}
    assert (table["outcome"] == "converged").all()
    assert (table["error"].abs() < 0.01).all()
    turn = (table["mu"] * table["theta_rad"]).to_numpy(float)
    half = turn / table["elements"].to_numpy(float) / 2
    np.testing.assert_allclose(table["error"], ((1 + half) / (1 - half)) ** 10 / np.exp(turn) - 1, atol=1e-9)


@pytest.mark.slow
def test_errors_are_of_second_order() -> None:
    """On meshes on which the front lies alike; where it lies is what the strip's other errors follow from."""
    strip, drum = strip_table(MESHES, (1,)), drum_table(sides=("on",))
    assert (strip["outcome"] == "converged").all()
    np.testing.assert_allclose(strip["front_error"], 0, atol=ROUNDING)
    assert (strip[["end_error", "loop_error"]].abs() < [0.005, 0.01]).all(axis=None)
    assert (drum["end_error"].abs() < 1e-3).all()
    found = (
        orders(strip, ["steps"], "elements", ["back_error"]),
        orders(drum, ["side"], "elements", ["end_error", "slip_error"]),
    )
    np.testing.assert_allclose(found[0].to_numpy(float), 2, atol=0.01)
    np.testing.assert_allclose(found[1].to_numpy(float), 2, atol=0.05)
