"""A joint motion of body and foundation leaves friction as it was; a wheel between two plates turns as it must."""

import numpy as np
import pytest

from contact.coulomb import Motion
from studies.experiments.friction.trusses import (
    EA,
    FEET,
    ON_FEET,
    RADIUS,
    SQUEEZE,
    Wheel,
    joint_motion_table,
    pyramid,
    rolling_path,
    rolling_table,
    stage_at,
)
from support.problems.differences import central_difference, rotation

ROUNDING = 1e-9  # N, of bars of 500 N/mm whose nodes are 2000 mm away: eps EA/L x = 2e-10


def test_friction_is_what_it_was_and_the_foundation_alone_is_felt() -> None:
    """Moved by a hundred thousandth of the ways together, it changes friction a million times as much."""
    table = joint_motion_table()
    assert (table["outcome"] == "converged").all()
    together, alone = (table[table["step"] == step] for step in ("together", "alone"))
    assert (together["iterations"] > 0).all()
    assert together["turn_rad"].max() == 3.0
    assert (together[["change_N", "normal_change_N", "bar_change_N"]] < ROUNDING).all(axis=None)
    assert (together["dissipation_N_mm"].abs() < ROUNDING).all()
    assert (alone["change_N"] > 1e6 * ROUNDING).all()
    pressed = table[(table["load"] == "pressed") & (table["step"] != "alone")]
    assert (pressed["friction_N"] < ROUNDING).all()
    assert (table.loc[table["load"] == "pushed", "friction_N"] > 10).all()


def test_a_turned_truss_is_not_strained(rng: np.random.Generator) -> None:
    truss = pyramid()
    moved = Motion(rng.normal(size=3), 2 * rng.normal(size=3), rng.normal(size=3))
    u = (moved.out(truss.nodes) - truss.nodes).ravel()
    np.testing.assert_allclose(truss.forces(u), 0, atol=1e-10)
    pulled = (1.01 * truss.nodes - truss.nodes).ravel()
    np.testing.assert_allclose(truss.forces(pulled), 0.01 * EA, rtol=1e-12)


def test_forces_gaps_and_slips_have_their_derivatives(rng: np.random.Generator) -> None:
    truss, moved = pyramid(), Motion(rng.normal(size=3), rng.normal(size=3), rng.normal(size=3))
    problem = stage_at(truss, ON_FEET, moved, moved, FEET).problem
    u, du = (rng.normal(size=truss.nodes.size) for _ in range(2))
    for value, jacobian, within in (
        (lambda v: problem.linearise(v, None).residual, problem.linearise(u, None).tangent, 1e-7),
        (problem.gap, problem.gap_jacobian(u), 1e-10),
        (lambda v: problem.coulomb.slip(v).ravel(), problem.coulomb.slip_jacobian(u), 1e-10),
    ):
        difference = central_difference(lambda h, value=value: value(u + h * du), 1e-2)
        np.testing.assert_allclose(jacobian @ du, difference, rtol=0, atol=within)


PLACED = 1e-11  # mm


def test_the_hub_comes_half_as_far_and_no_node_slips() -> None:
    path = rolling_path(Wheel(24, 0.5, SQUEEZE), 3.0, 18.0)
    assert len(path) == 8
    assert (path["outcome"] == "converged").all()
    assert (path[["hub_error_mm", "middle_error_mm"]].abs() < PLACED).all(axis=None)
    assert (path["slipping"] == 0).all()
    assert (path["dissipation_N_mm"].abs() < PLACED).all()
    assert (path["press_N"] > 0).all()
    assert path["turn_rad"].iloc[-1] == pytest.approx(9.0 / RADIUS, rel=0.01)


def test_without_friction_nothing_would_roll_it() -> None:
    """With five thousandths all its nodes slip: it stays behind the rolling one and turns less."""
    path = rolling_path(Wheel(24, 5e-3, SQUEEZE), 3.0, 6.0)
    assert (path["outcome"] == "converged").all()
    assert (path["slipping"].iloc[2:] > 0).all()
    assert path["turn_rad"].iloc[-1] < 0.9 * 3.0 / RADIUS


def test_a_rigid_wheel_rolled_on_has_its_nodes_where_they_were_seen_from_the_hub(rng: np.random.Generator) -> None:
    wheel = Wheel(8, 0.5, SQUEEZE)
    u = 0.1 * rng.normal(size=wheel.truss.nodes.size)
    before, after = (wheel.truss.nodes + v.reshape(-1, 3) for v in (u, wheel.rolled(u, 4.0)))
    np.testing.assert_allclose(after[-1] - before[-1], [2.0, 0.0, 0.0], rtol=0, atol=1e-12)
    R = rotation(np.array([0.0, 1.0, 0.0]), 2.0 / RADIUS)
    np.testing.assert_allclose(after[:-1] - after[-1], (before[:-1] - before[-1]) @ R.T, rtol=0, atol=1e-12)


@pytest.mark.slow
def test_the_wheel_rolls_with_the_radius_of_its_bars() -> None:
    table = rolling_table(coefficients=(0.5,), steps=(1.0, 0.5))
    assert (table["outcome"] == "converged").all()
    assert (table["slips"] == 0).all()
    assert (table[["hub_error_mm", "middle_error_mm"]] < PLACED).all(axis=None)
    assert (table["radius_error"].abs() < 1e-5).all()
