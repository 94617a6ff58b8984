"""The GRECO plate: without friction, with mu = 1, and at both ends of the coefficient."""

import math
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.coulomb import State
from contact.interchange.linearised_step import freeze
from contact.interchange.oracle import confirm
from contact.problem import ContactSolution, Outcome, linear_mechanics
from contact.verify import judge
from studies.experiments.friction.greco import (
    ELEMENTS,
    EXACT,
    LOADS,
    PLACES,
    SIDE,
    SLIPS,
    TOP,
    GrecoPlate,
    friction_table,
    greco_table,
    slip,
    tied,
    tied_table,
)

ROUNDING = 1e-10
SOLVED = 1e-8  # pressure at the smallest weights, where algorithms end at residuals of 1e-9 of the load


@pytest.mark.parametrize("element", ELEMENTS)
def test_uniform_load_is_carried_uniformly_by_every_exact_algorithm(element: str) -> None:
    """The slip in closed form is two fifths more than with mu = 1, the mean of six codes, 0.0286 mm."""
    plate = GrecoPlate(element, 4)
    assert plate.forces.sum() == pytest.approx((150 - TOP) * SIDE, rel=ROUNDING)
    for name in EXACT:
        solution = plate.solve(ALGORITHMS[name](epsilon=math.inf))
        assert solution.outcome is Outcome.CONVERGED, name
        np.testing.assert_allclose(solution.pressure, TOP, rtol=ROUNDING, err_msg=name)
        np.testing.assert_allclose(plate.along @ solution.u, slip(plate.x), atol=ROUNDING, err_msg=name)
        assert judge(plate.problem(), solution.u, solution.pressure).equilibrium < ROUNDING
    assert slip(0.0) == pytest.approx(1.1e8 * 1.2 / 1.3e11 * 40)
    assert slip(0.0) / 0.0286 == pytest.approx(1.42, abs=0.01)


@pytest.mark.parametrize("element", ELEMENTS)
def test_other_loads_have_other_references(element: str) -> None:
    """Pressed, the plate with its image below has no contact and no plane, and moves in the same way. Lifted, set,
    forces and displacements are those of Clarabel on the same quadratic programme.
    """
    plate, both = GrecoPlate(element, 6, "rising"), GrecoPlate(element, 6, "rising", mirrored=True)
    solution, free = plate.solve(Semismooth()), spsolve(both.stiffness, both.forces[both.free])
    assert solution.active.all()
    np.testing.assert_allclose(both.across @ free, 0, atol=ROUNDING * slip(0.0))
    np.testing.assert_allclose(plate.along @ solution.u, both.along @ free, rtol=ROUNDING)
    plate = GrecoPlate(element, 8, "lifting")
    solution = plate.solve(Semismooth())
    assert 0 < np.sum(~solution.active) < len(plate.x)
    step = freeze(plate.problem(), np.zeros(len(plate.free)), np.zeros(len(plate.x)), {"scene": "greco-plate"})
    assert confirm(step, solution.u, solution.pressure).agrees
    held = spsolve(plate.stiffness + 1e9 * plate.across.T @ plate.across, plate.forces[plate.free])
    assert not confirm(step, held, solution.pressure).agrees


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_nobody_has_to_say_how_large_a_gap_is_where_nothing_lifts_off(scale: float) -> None:
    """The multiplier method knows it from the forces: gaps measured by themselves would be rounding of rounding."""
    plate = GrecoPlate("Q1", 8)
    problem, rest = plate.problem(), ContactSolution.at_rest(len(plate.free), len(plate.x))
    assert problem.gap_size == 0
    loaded = replace(problem, linearise=linear_mechanics(plate.stiffness, scale * plate.forces[plate.free]))
    solution = ALGORITHMS["augmented-lagrangian"](epsilon=math.inf).solve(loaded, rest)
    assert solution.outcome is Outcome.CONVERGED
    assert solution.counters["newton_iterations"] < 10
    np.testing.assert_allclose(solution.pressure, scale * TOP, rtol=ROUNDING)
    assert judge(loaded, solution.u, solution.pressure).failures() == []


@pytest.mark.slow
def test_all_algorithms_agree_and_the_lifted_corner_converges() -> None:
    table = greco_table()
    assert (table["outcome"] == "converged").all()
    assert table["apart"].max() < ROUNDING
    assert table["pressure_error"].max() < SOLVED
    assert set(table["load"]) == set(LOADS)
    lifting = table[(table["load"] == "lifting") & (table["algorithm"] == "semismooth")]
    slips = {element: rows["slip_mm"].to_numpy() for element, rows in lifting.groupby("element")}
    errors = np.abs(slips["Q1"] - slips["Q2"][-1])
    orders = [math.log2(coarse / fine) for coarse, fine in pairwise(errors)]
    np.testing.assert_allclose(orders, 2, atol=0.2)
    assert abs(slips["Q2"][-1] - slips["Q2"][-2]) < 0.1 * errors[-1]  # the limit is known well enough for that


@pytest.mark.slow
@pytest.mark.parametrize(("n", "friction_off"), [(16, 5e-4), (32, 5e-4), (64, 1e-4)])
def test_the_greco_plate_with_friction(n: int, friction_off: float) -> None:
    """5e-4 of the slips on every mesh; the naive set cycles; lcp and qp are one step. Semismooth is the cheapest: that
    the body stands by itself costs lcp and qp a factorisation more.

    Friction is that of graded meshes of 9-node quadrilaterals, 64x64 and 96x96 alike.
    """
    table = friction_table([n]).set_index("algorithm")
    assert set(table.index) == set(ALGORITHMS)
    assert table["outcome"][table["outcome"] != "converged"].to_dict() == {"trial-and-error": "cycling"}
    own = table.loc["semismooth"]
    np.testing.assert_allclose([own[f"slip_{place:g}"] for place in PLACES], SLIPS, rtol=5e-4)
    assert own["error"] < 5e-4
    assert own["friction_N"] == pytest.approx(-1405.3, rel=friction_off)
    assert table.loc["lcp", "newton_iterations"] == table.loc["qp", "newton_iterations"] == 1
    assert table["operations"].idxmin() == "semismooth"


TIED_ROUNDING = 1e-12
# friction_of in contact.newton.friction_states multiplies an infinite bound by no slip, and drops what comes of it
UNBOUNDED = pytest.mark.filterwarnings("ignore:invalid value encountered in multiply:RuntimeWarning")


def test_without_friction_the_plate_is_that_of_the_frictionless_algorithm() -> None:
    """But for rounding, as both eliminate in other orders."""
    for element, load in product(ELEMENTS, LOADS):
        plate = GrecoPlate(element, 8, load)
        alone, actual = plate.solve(Semismooth()), plate.solve(Semismooth(), 0.0)
        assert actual.outcome.converged
        assert np.array_equal(actual.rubbed.state != State.OPEN, alone.active)
        assert not actual.rubbed.force.any()
        assert actual.counters["newton_iterations"] == alone.counters["newton_iterations"]
        for value, known in ((actual.u, alone.u), (actual.pressure, alone.pressure)):
            assert np.max(np.abs(value - known)) < TIED_ROUNDING * np.max(np.abs(known))


@UNBOUNDED
def test_with_an_infinite_coefficient_it_is_tied_or_has_no_answer() -> None:
    """Wherever there is one, it is found; where no set of nodes will do, the solve does not claim any."""
    table = tied_table((("Q1", 4), ("Q2", 4)))
    assert set(table["answers"]) == {0, 1}
    alone = table[table["answers"] == 1]
    assert (alone["outcome"] == "converged").all()
    assert (alone["otherwise"] == 0).all()
    assert (alone["difference"] < TIED_ROUNDING).all()
    assert (table.loc[table["answers"] == 0, "outcome"] == "cycling").all()


def test_a_tied_answer_is_one_of_the_whole_plate_and_of_a_large_coefficient() -> None:
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
    solution = plate.solve(Semismooth(), 1e6)
    assert np.array_equal(solution.rubbed.state == State.STICK, holds)
    np.testing.assert_allclose(solution.u, u, rtol=0, atol=1e-12 * np.max(np.abs(u)))
