"""The brush against its closed forms, and a block on a quarter circle: second order in rings, first in load steps."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from contact.continuation.friction_path import PathState
from contact.coulomb import Motion, State
from studies.experiments.friction.brush import (
    BLOCKS,
    DISC,
    MU,
    NORMAL,
    PRESSURES,
    RADIUS,
    SPRING,
    STIFF,
    WAY,
    Brush,
    Parking,
    parking_table,
    path_table,
    uneven,
)
from support.problems.differences import orders

EXACT = 1e-9
ERRORS = ("moment_error", "loop_error")


def dragged(angle: float) -> tuple[Brush, PathState]:
    """The uneven patch dragged so far in a direction [rad] that everything slides."""
    way = np.array([math.cos(angle), math.sin(angle), 0.0])
    brush = replace(uneven(), moved=lambda load: Motion(load * way, np.zeros(3), np.zeros(3)))
    return brush, all_sliding(brush.follow([100.0, 200.0, 300.0]))


def all_sliding(states: list[PathState]) -> PathState:
    """The last state, in which every point slides."""
    assert states[-1].solution.outcome.converged
    assert np.all(states[-1].solution.rubbed.state == State.SLIP)
    return states[-1]


def test_a_dragged_patch_carries_its_bound_in_every_direction() -> None:
    """Its pressures are uneven and depend on friction, else the bound were the same number in every direction."""
    normal = []
    for angle in (0.0, 1.2, 2.5):
        brush, state = dragged(angle)
        force = np.linalg.norm(brush.friction(state).sum(axis=0))
        assert force == pytest.approx(MU * brush.areas @ state.solution.pressure, rel=EXACT)
        normal.append(state.solution.pressure.sum())
    assert np.ptp(normal) > 0.05 * min(normal)
    pressed = uneven().follow([0.0])[-1].solution.pressure
    assert pressed.max() / pressed.min() > 2


def test_a_spun_patch_carries_its_bound_but_for_the_chord_of_a_step() -> None:
    steps, errors = (0.1, 0.4), []
    for step in steps:
        brush = uneven()
        state = all_sliding(brush.follow([step * k for k in range(1, 13)]))  # steady by then
        r = np.linalg.norm(brush.candidates.positions(state.solution.u)[:, :2], axis=1)
        errors.append(brush.moment(state) / (MU * float((brush.areas * state.solution.pressure) @ r)) - 1)
    np.testing.assert_allclose(errors, np.cos(np.array(steps) / 2) - 1, rtol=0, atol=EXACT)
    assert uneven(mu=0.0).moment(uneven(mu=0.0).follow([0.1])[-1]) == 0.0


@pytest.mark.parametrize("pressure", PRESSURES)
def test_the_closed_forms_of_parking_by_quadrature(pressure: str) -> None:
    """Spring by spring: friction min(k phi r, mu p), slip what is left of phi r."""
    disc, p = Parking(pressure, 0.8), PRESSURES[pressure]

    def friction(r: float) -> float:
        return 2 * math.pi * r**2 * min(STIFF * disc.phi * r, MU * p(r))

    def lost(r: float) -> float:
        return 2 * math.pi * r * 4 * MU * p(r) * max(disc.phi * r - MU * p(r) / STIFF, 0.0)

    moment, loop = (quad(integrand, 0, DISC, points=[disc.c])[0] for integrand in (friction, lost))
    assert (disc.moment, disc.loop) == pytest.approx((moment, loop), rel=1e-10)


def test_a_turn_on_the_spot() -> None:
    table = parking_table((10,), (1 / 3,))
    assert (table["outcome"] == "converged").all()
    own = table.set_index("pressure")
    np.testing.assert_allclose(own.loc["uniform", "core_error"], 0, atol=1e-8)  # phi^2/24 of a finite turn
    assert (table[["core_error", "moment_error"]].abs() < 0.01).all(axis=None)


@pytest.mark.slow
def test_a_turn_on_the_spot_is_of_second_order_in_the_rings() -> None:
    table = parking_table()
    actual = orders(table, ["pressure", "core"], "rings", ERRORS)
    np.testing.assert_allclose(actual[list(ERRORS)].to_numpy(float), 2, atol=0.1)
    parabolic = table[table["pressure"] == "parabolic"]
    np.testing.assert_allclose(orders(parabolic, ["core"], "rings", ["core_error"])["core_error"], 2, atol=0.1)
    finest = table[table["rings"] == table["rings"].max()]
    assert (finest[["core_error", "moment_error", "loop_error"]].abs() < 1e-3).all(axis=None)


PATH_ERRORS = ("end_error", "work_error")


def lag(way: float) -> float:
    """Angle from the spring to the drag where both springs are alike and slip: a' = 1/R - sin a/r, r = mu N/k.

    With T = tan(a/2) and b = sqrt(1/r^2 - 1/R^2), (T - T1)/(T - T2) ~ exp(-b way), T1 and T2 = R (1/r -+ b).
    """
    r = MU * NORMAL / SPRING
    first = 2 * math.asin(r / (2 * RADIUS))  # the chord of the drag is r: there it begins to slip, a half behind
    b = math.sqrt(1 / r**2 - 1 / RADIUS**2)
    low, high = RADIUS * (1 / r - b), RADIUS * (1 / r + b)
    at = math.tan(first / 4)
    ratio = (at - low) / (at - high) * math.exp(-b * (way - RADIUS * first))
    return 2 * math.atan((low - ratio * high) / (1 - ratio))


def test_the_reference_of_springs_alike_has_a_closed_form() -> None:
    """The end, and the dissipation by the work of the drag: mu N int cos a, as the length of the springs stays."""
    u, work = BLOCKS["springs alike"].reference()
    r, angle = MU * NORMAL / SPRING, WAY / RADIUS - lag(WAY)
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
    assert (table["outcome"] == "converged").all()
    assert (table["work_error"] < 0).all()
    actual = orders(table, ["case"], "steps", PATH_ERRORS)
    np.testing.assert_allclose(actual[list(PATH_ERRORS)].to_numpy(float), 1, atol=0.07)


@pytest.mark.slow
def test_load_steps_are_of_first_order() -> None:
    """Six numbers of steps, the order from the last four."""
    table = path_table()
    assert (table["outcome"] == "converged").all()
    for _, own in table.groupby("case"):
        assert (np.diff(own["end_error"]) < 0).all()
    actual = orders(table[table["steps"] >= 16], ["case"], "steps", PATH_ERRORS)
    np.testing.assert_allclose(actual[list(PATH_ERRORS)].to_numpy(float), 1, atol=0.05)
