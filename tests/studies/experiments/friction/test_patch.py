"""The brush against its closed forms: dragged and spun to rounding, turned on the spot of second order in the rings."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from contact.coulomb import Motion, State
from contact.friction.path import PathState
from studies.experiments.friction.brush import Brush
from studies.experiments.friction.patch import (
    DISC,
    MU,
    PRESSURES,
    STIFF,
    Parking,
    parking_table,
    uneven,
)
from support.problems.differences import fitted_order, orders

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


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2, 2.5, 4.0])
def test_a_dragged_patch_carries_its_bound_in_every_direction(angle: float) -> None:
    brush, state = dragged(angle)
    force = np.linalg.norm(brush.friction(state).sum(axis=0))
    assert force == pytest.approx(MU * brush.areas @ state.solution.pressure, rel=EXACT)


def test_its_pressures_are_uneven_and_depend_on_friction() -> None:
    """Else the bound would be the same number in every direction, and known before."""
    one, other = (dragged(angle)[1].solution.pressure.sum() for angle in (0.0, 2.5))
    assert abs(other / one - 1) > 0.05
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
    assert fitted_order(steps, np.abs(errors)) == pytest.approx(2, abs=0.01)


def test_less_friction_spins_and_drags_with_less() -> None:
    """The bound is that of the coefficient: a patch without friction asks for nothing."""
    assert uneven(mu=0.0).moment(uneven(mu=0.0).follow([0.1])[-1]) == 0.0


@pytest.mark.parametrize("pressure", PRESSURES)
@pytest.mark.parametrize("core", [1 / 3, 0.8])
def test_the_closed_forms_of_parking_by_quadrature(pressure: str, core: float) -> None:
    """Spring by spring: friction min(k phi r, mu p), slip what is left of phi r."""
    disc, p = Parking(pressure, core), PRESSURES[pressure]

    def friction(r: float) -> float:
        return min(STIFF * disc.phi * r, MU * p(r))

    def lost(r: float) -> float:
        return 4 * MU * p(r) * max(disc.phi * r - MU * p(r) / STIFF, 0.0)

    moment = quad(lambda r: 2 * math.pi * r**2 * friction(r), 0, DISC, points=[disc.c])[0]
    loop = quad(lambda r: 2 * math.pi * r * lost(r), 0, DISC, points=[disc.c])[0]
    assert disc.moment == pytest.approx(moment, rel=1e-10)
    assert disc.loop == pytest.approx(loop, rel=1e-10)


def test_a_turn_on_the_spot() -> None:
    table = parking_table((10,), (1 / 3,))
    assert (table["outcome"] == "converged").all()
    own = table.set_index("pressure")
    np.testing.assert_allclose(own.loc["uniform", "core_error"], 0, atol=1e-8)  # phi^2/24 of a finite turn
    assert (table[["core_error", "moment_error"]].abs() < 0.01).all(axis=None)


@pytest.mark.slow
def test_a_turn_on_the_spot_is_of_second_order_in_the_rings() -> None:
    table = parking_table()
    found = orders(table, ["pressure", "core"], "rings", ERRORS)
    np.testing.assert_allclose(found[list(ERRORS)].to_numpy(float), 2, atol=0.1)
    parabolic = table[table["pressure"] == "parabolic"]
    np.testing.assert_allclose(orders(parabolic, ["core"], "rings", ["core_error"])["core_error"], 2, atol=0.1)
    finest = table[table["rings"] == table["rings"].max()]
    assert (finest[["core_error", "moment_error", "loop_error"]].abs() < 1e-3).all(axis=None)
