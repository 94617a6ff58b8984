"""The block on a quarter circle: its equation against a closed form, and load steps of first order."""

from __future__ import annotations

import math

import numpy as np
import pytest

from studies.experiments.friction.path_error import BLOCKS, MU, NORMAL, RADIUS, STIFF, WAY, path_table
from support.problems.differences import orders

ERRORS = ("end_error", "work_error")


def lag(way: float) -> float:
    """Angle from the spring to the drag where both springs are alike and slip: a' = 1/R - sin a/r, r = mu N/k.

    With T = tan(a/2) and b = sqrt(1/r^2 - 1/R^2), (T - T1)/(T - T2) ~ exp(-b way), T1 and T2 = R (1/r -+ b).
    """
    r = MU * NORMAL / STIFF
    first = 2 * math.asin(r / (2 * RADIUS))  # the chord of the drag is r: there it begins to slip, a half behind
    b = math.sqrt(1 / r**2 - 1 / RADIUS**2)
    low, high = RADIUS * (1 / r - b), RADIUS * (1 / r + b)
    at = math.tan(first / 4)
    ratio = (at - low) / (at - high) * math.exp(-b * (way - RADIUS * first))
    return 2 * math.atan((low - ratio * high) / (1 - ratio))


def test_the_reference_of_springs_alike_has_a_closed_form() -> None:
    """The end, and the dissipation by the work of the drag: mu N int cos a, as the length of the springs stays."""
    u, work = BLOCKS["springs alike"].reference()
    r, angle = MU * NORMAL / STIFF, WAY / RADIUS - lag(WAY)
    np.testing.assert_allclose(u, r * np.array([math.cos(angle), math.sin(angle)]), rtol=1e-10)
    ways = np.linspace(RADIUS * 2 * math.asin(r / (2 * RADIUS)), WAY, 4001)
    driven = MU * NORMAL * np.trapezoid([math.cos(lag(way)) for way in ways], ways)
    assert work == pytest.approx(driven, rel=1e-7)


def test_the_normal_force_is_part_of_the_reference() -> None:
    """|k u| = mu N at the end, where N is what it was at first; and its derivative."""
    block = BLOCKS["normal force swells"]
    u, _ = block.reference()
    assert np.linalg.norm(block.stiffness * u) == pytest.approx(MU * NORMAL, rel=1e-9)
    difference = (block.normal(3.0 + 1e-5) - block.normal(3.0 - 1e-5)) / 2e-5
    assert block.normal_rate(3.0) == pytest.approx(difference, rel=1e-8)


def test_load_steps_of_first_order_with_springs_alike() -> None:
    table = path_table((8, 16, 32), ("springs alike",))
    assert table["converged"].all()
    assert (table["work_error"] < 0).all()
    found = orders(table, ["case"], "steps", ERRORS)
    np.testing.assert_allclose(found[list(ERRORS)].to_numpy(float), 1, atol=0.07)


@pytest.mark.slow
def test_load_steps_are_of_first_order() -> None:
    """Six numbers of steps, the order from the last four."""
    table = path_table()
    assert table["converged"].all()
    for _, own in table.groupby("case"):
        assert (np.diff(own["end_error"]) < 0).all()
        assert (own["iterations"] >= own["steps"]).all()
    found = orders(table[table["steps"] >= 16], ["case"], "steps", ERRORS)
    np.testing.assert_allclose(found[list(ERRORS)].to_numpy(float), 1, atol=0.05)
