"""The wheel between two plates: its hub comes half as far as the upper plate, and it turns as it must."""

from __future__ import annotations

import math

import numpy as np
import pytest

from studies.experiments.friction.rolling import RADIUS, SQUEEZE, Wheel, rolling_path, rolling_table

ROUNDING = 1e-11  # mm


def test_the_hub_comes_half_as_far_and_no_node_slips() -> None:
    path = rolling_path(Wheel(24, 0.5, SQUEEZE), 3.0, 18.0)
    assert len(path) == 8
    assert (path["outcome"] == "converged").all()
    assert (path[["hub_error_mm", "middle_error_mm"]].abs() < ROUNDING).all(axis=None)
    assert (path["slipping"] == 0).all()
    assert (path["dissipation_N_mm"].abs() < ROUNDING).all()
    assert (path["press_N"] > 0).all()
    assert path["turn_rad"].iloc[-1] == pytest.approx(9.0 / RADIUS, rel=0.01)


def test_without_friction_nothing_would_roll_it() -> None:
    """One that is free to slide, but for a thousandth, stays behind the rolling one and turns less."""
    path = rolling_path(Wheel(24, 1e-3, SQUEEZE), 3.0, 6.0)
    assert (path["slipping"].iloc[2:] > 0).all()
    assert path["turn_rad"].iloc[-1] < 0.9 * 3.0 / RADIUS


def test_a_rigid_wheel_rolled_on_has_its_nodes_where_they_were_seen_from_the_hub(rng: np.random.Generator) -> None:
    wheel = Wheel(8, 0.5, SQUEEZE)
    u = 0.1 * rng.normal(size=wheel.truss.nodes.size)
    before, after = (wheel.truss.nodes + v.reshape(-1, 3) for v in (u, wheel.rolled(u, 4.0)))
    np.testing.assert_allclose(after[-1] - before[-1], [2.0, 0.0, 0.0], rtol=0, atol=1e-12)
    angle = 2.0 / RADIUS
    turned = np.array([[math.cos(angle), 0, math.sin(angle)], [0, 1, 0], [-math.sin(angle), 0, math.cos(angle)]])
    np.testing.assert_allclose(after[:-1] - after[-1], (before[:-1] - before[-1]) @ turned.T, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_the_wheel_rolls_with_the_radius_of_its_bars() -> None:
    table = rolling_table(coefficients=(0.5,), steps=(1.0, 0.5))
    assert (table["outcome"] == "converged").all()
    assert (table["slips"] == 0).all()
    assert (table[["hub_error_mm", "middle_error_mm"]] < ROUNDING).all(axis=None)
    assert (table["radius_error"].abs() < 1e-5).all()
