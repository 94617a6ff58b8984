"""The GRECO plate at both ends of the coefficient: against the frictionless algorithm, and against all tied sets."""

from __future__ import annotations

import numpy as np
import pytest

from contact.friction.problem import State
from studies.experiments.friction.greco import ELEMENTS, LOADS, GrecoPlate, tied, tied_table

ROUNDING = 1e-12
# friction_of in contact.friction.newton.laws multiplies an infinite bound by no slip, and drops what comes of it
UNBOUNDED = pytest.mark.filterwarnings("ignore:invalid value encountered in multiply:RuntimeWarning")


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("element", ELEMENTS)
def test_without_friction_the_plate_is_that_of_the_frictionless_algorithm(element: str, load: str) -> None:
    """But for rounding, as both eliminate in other orders."""
    plate = GrecoPlate(element, 8, load)
    alone, found = plate.solve("semismooth"), plate.solve_rubbed(mu=0.0)
    assert found.outcome.converged
    assert np.array_equal(found.state != State.OPEN, alone.active)
    assert not found.friction.any()
    assert found.counters["newton_iterations"] == alone.counters["newton_iterations"]
    for value, known in ((found.u, alone.u), (found.normal, plate.weights * alone.pressure)):
        assert np.max(np.abs(value - known)) < ROUNDING * np.max(np.abs(known))


@UNBOUNDED
def test_with_an_infinite_coefficient_it_is_tied_or_has_no_answer() -> None:
    """Wherever there is one, it is found; where no set of nodes will do, the solve does not claim any."""
    table = tied_table((("Q1", 4), ("Q1", 6), ("Q2", 4)))
    assert set(table["answers"]) == {0, 1}
    alone = table[table["answers"] == 1]
    assert (alone["outcome"] == "converged").all()
    assert (alone["otherwise"] == 0).all()
    assert (alone["difference"] < ROUNDING).all()
    assert (table.loc[table["answers"] == 0, "outcome"] == "cycling").all()


def test_a_tied_answer_is_one_of_the_whole_plate() -> None:
    """Condensed and put back: balanced where nothing holds, pressed where it is held, off the plane elsewhere."""
    plate = GrecoPlate("Q1", 6)
    ((u, holds),) = tied(plate)
    left = plate.stiffness @ u - plate.forces[plate.free]
    normals, tangents = plate.across.indices, plate.along.indices
    held = np.concatenate([normals[holds], tangents[holds]])
    assert np.all(u[held] == 0)
    assert np.all(left[normals[holds]] > 0)
    assert np.all(u[normals[~holds]] > 0)
    np.testing.assert_allclose(np.delete(left, held), 0, atol=1e-9 * np.max(np.abs(left)))


def test_a_large_coefficient_ties_the_same_nodes() -> None:
    plate = GrecoPlate("Q1", 6)
    ((u, holds),) = tied(plate)
    found = plate.solve_rubbed(mu=1e6)
    assert np.array_equal(found.state == State.STICK, holds)
    np.testing.assert_allclose(found.u, u, rtol=0, atol=1e-12 * np.max(np.abs(u)))
