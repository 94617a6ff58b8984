"""The brush against its closed forms: dragged and spun to rounding, turned on the spot of second order in the rings."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from studies.experiments.friction.closed_forms.patch import (
    DISC,
    MU,
    PRESSURES,
    STIFF,
    Parking,
    parking_table,
    sliding_table,
    spin_table,
    uneven,
)
from studies.experiments.friction.closed_forms.rates import order, orders

EXACT = 1e-9
ERRORS = ("moment_error", "loop_error")


def test_a_dragged_patch_carries_its_bound_in_every_direction() -> None:
    table = sliding_table()
    assert (table["outcome"] == "converged").all()
    assert (table["sliding"] == table["points"]).all()
    np.testing.assert_allclose(table["error"], 0, atol=EXACT)


def test_its_pressures_are_uneven_and_depend_on_friction() -> None:
    """Else the bound would be the same number in every direction, and known before."""
    bounds = sliding_table((0.0, 2.5))["bound_N"]
    assert abs(bounds[1] / bounds[0] - 1) > 0.05
    pressed = uneven().follow([0.0])[-1].solution.pressure
    assert pressed.max() / pressed.min() > 2


def test_a_spun_patch_carries_its_bound_but_for_the_chord_of_a_step() -> None:
    table = spin_table((0.1, 0.4))
    assert (table["outcome"] == "converged").all()
    assert (table["sliding"] == table["points"]).all()
    np.testing.assert_allclose(table["error"] - table["discrete_error"], 0, atol=EXACT)
    assert -order(table["step_rad"].to_numpy(float), table["error"].to_numpy(float)) == pytest.approx(2, abs=0.01)


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
