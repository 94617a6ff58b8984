"""A joint motion of body and foundation leaves friction as it was; the foundation alone does not."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from contact.coulomb import Motion
from studies.experiments.friction.joint_motion import (
    EA,
    FEET,
    ON_FEET,
    TOP,
    joint_motion_table,
    pyramid,
    stage_at,
)
from support.problems.differences import central_difference

ROUNDING = 1e-9  # N, of bars of 500 N/mm whose nodes are 2000 mm away: eps EA/L x = 2e-10


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return joint_motion_table()


def test_friction_is_what_it_was(table: pd.DataFrame) -> None:
    assert (table["outcome"] == "converged").all()
    together = table[table["step"] == "together"]
    assert (together["iterations"] > 0).all()
    assert together["turn_rad"].max() == 3.0
    assert (together[["change_N", "normal_change_N", "bar_change_N"]] < ROUNDING).all(axis=None)
    assert (together["dissipation_N_mm"].abs() < ROUNDING).all()


def test_without_strain_there_is_none(table: pd.DataFrame) -> None:
    pressed = table[(table["load"] == "pressed") & (table["step"] != "alone")]
    assert (pressed["friction_N"] < ROUNDING).all()
    assert (table.loc[table["load"] == "pushed", "friction_N"] > 10).all()


def test_the_foundation_alone_is_felt(table: pd.DataFrame) -> None:
    """Moved by a hundred thousandth of the ways together, friction changes a million times as much."""
    assert (table.loc[table["step"] == "alone", "change_N"] > 1e6 * ROUNDING).all()


def test_the_tangent_of_the_truss(rng: np.random.Generator) -> None:
    truss = pyramid()
    u, du, carried = (rng.normal(size=truss.nodes.size) for _ in range(3))
    difference = central_difference(lambda h: truss.linearise(u + h * du, ON_FEET, carried).residual, 1e-2)
    np.testing.assert_allclose(truss.linearise(u, ON_FEET, carried).tangent @ du, difference, rtol=0, atol=1e-7)


def test_a_turned_truss_is_not_strained(rng: np.random.Generator) -> None:
    truss = pyramid()
    moved = Motion(rng.normal(size=3), 2 * rng.normal(size=3), rng.normal(size=3))
    u = (moved.out(truss.nodes) - truss.nodes).ravel()
    np.testing.assert_allclose(truss.forces(u), 0, atol=1e-10)
    pulled = (1.01 * truss.nodes - truss.nodes).ravel()
    np.testing.assert_allclose(truss.forces(pulled), 0.01 * EA, rtol=1e-12)


def test_its_gaps_and_slips_have_their_derivatives(rng: np.random.Generator) -> None:
    moved = Motion(rng.normal(size=3), rng.normal(size=3), rng.normal(size=3))
    problem = stage_at(pyramid(), ON_FEET, moved, moved, FEET).problem
    u, du = (rng.normal(size=3 * (len(FEET) + len(TOP))) for _ in range(2))
    for value, jacobian in (
        (problem.gap, problem.gap_jacobian(u)),
        (lambda v: problem.coulomb.slip(v).ravel(), problem.coulomb.slip_jacobian(u)),
    ):
        difference = central_difference(lambda h, value=value: value(u + h * du), 1e-2)
        np.testing.assert_allclose(jacobian @ du, difference, rtol=0, atol=1e-10)
