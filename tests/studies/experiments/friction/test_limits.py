"""The GRECO plate at both ends of the coefficient: against the frictionless algorithm, and against all tied sets."""

from __future__ import annotations

import numpy as np
import pytest

from contact.coulomb import State
from studies.experiments.friction.discrete.greco import solve
from studies.experiments.friction.discrete.limits import frictionless_table, tied, tied_table
from studies.experiments.solids.greco_plate import GrecoPlate

ROUNDING = 1e-12
# friction_of in contact.friction.laws multiplies an infinite bound by no slip, and drops what comes of it
UNBOUNDED = pytest.mark.filterwarnings("ignore:invalid value encountered in multiply:RuntimeWarning")


def test_without_friction_the_plate_is_that_of_the_frictionless_algorithm() -> None:
    table = frictionless_table(meshes=(8,))
    assert (table["outcome"] == "converged").all()
    assert (table["otherwise"] == 0).all()
    assert (table["friction_N"] == 0).all()
    assert (table["iterations"] == table["iterations_without"]).all()
    assert (table[["difference", "force_difference"]] < ROUNDING).all(axis=None)


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
    found = solve(plate, mu=1e6)
    assert np.array_equal(found.rubbed.state == State.STICK, holds)
    np.testing.assert_allclose(found.u, u, rtol=0, atol=1e-12 * np.max(np.abs(u)))
