"""Scales of a contact problem, against their formulas written out; and travels far below the size of a body."""

import math
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.newton.step import NewtonRun
from contact.obstacles.cleat import Profile, cleat
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactProblem, ContactSolution, Outcome, without_contact
from contact.scales import Stiffness, length, motion
from contact.verify import judge
from support.problems.contact_problems import EXACT, linear_mechanics, random_quadratic

EPS = np.finfo(float).eps
X, Y, Z = np.eye(3)


def test_stiffness_is_that_of_each_candidate_by_its_own_unknowns(rng) -> None:
    data = random_quadratic(rng, "inclined")
    problem, u = data.problem(), np.zeros(len(data.f))
    k = [1 / sum(g**2 / data.K[j, j] for j, g in enumerate(row) if g) for row in data.G]
    actual = Stiffness.of(problem, problem.linearise(u, None), u)
    assert actual.most == pytest.approx(max(k))
    assert actual.per_area == pytest.approx(float(np.median(np.array(k) / data.w)))


def test_a_force_moves_a_candidate_by_no_less_than_it_over_the_stiffness(rng) -> None:
    """All else held, which everything else only makes softer: G K^-1 G^T is not below 1/k."""
    for seed in range(5):
        data = random_quadratic(np.random.default_rng(seed), "definite")
        problem, u = data.problem(), np.zeros(len(data.f))
        most = Stiffness.of(problem, problem.linearise(u, None), u).most
        assert np.all(np.diag(data.G @ np.linalg.solve(data.K, data.G.T)) >= 1 / most)


def test_a_large_gap_is_the_motion_or_what_the_forces_would_move(rng) -> None:
    data = random_quadratic(rng, "inclined")
    problem, u = data.problem(), rng.normal(size=len(data.f))
    assert motion(problem, u) == pytest.approx(max(np.abs(data.G) @ np.abs(u)))
    stiffness = Stiffness.of(problem, problem.linearise(u, None), u)
    assert length(problem, stiffness, u, 0.0) == motion(problem, u)
    assert length(problem, stiffness, 0 * u, 3.0) == 3.0 / stiffness.most


def test_nothing_to_touch_and_nothing_that_holds_have_no_stiffness(rng) -> None:
    data = random_quadratic(rng, "definite")
    K, n = linear_mechanics(data.K, data.f), len(data.f)
    nothing = without_contact(K, n)
    assert Stiffness.of(nothing, K(np.zeros(n), None), np.zeros(n)) == Stiffness()
    loose = linear_mechanics(0 * data.K, data.f)
    assert Stiffness.of(data.problem(), loose(np.zeros(n), None), np.zeros(n)) == Stiffness()


def test_the_size_of_a_gap_is_that_of_the_foundation_wherever_it_is() -> None:
    for at in (0.0, 1e6):
        by = at * Z
        assert RigidPlane(Z, 2.0).moved(by).size == 2.0 + at
        assert Drum(3 * Z, Y, 5.0).moved(by).size == max(5.0, 3.0 + at)
        assert Sphere(-7 * X, 5.0).moved(by).size == max(7.0, at)
        foot = 10 + 10 / math.tan(math.pi / 3) + 4 * math.tan(math.pi / 6)  # where the rounding begins
        assert Profile(Z, 0.0, X, 0.0, cleat(10.0, 20.0, 60.0, 4.0)).moved(by).size == pytest.approx(max(at, foot))


def test_rounding_of_a_curved_gap_is_within_that_of_its_size(rng) -> None:
    """Points on the surface by construction, to rounding: their gaps are not zero, and no larger than a few digits."""
    for foundation in (Sphere(-7e5 * X, 7e5), Drum(-7e5 * X, Y, 7e5)):
        angle = rng.uniform(-1e-3, 1e-3, 200)
        x = foundation.centre + foundation.radius * np.column_stack([np.cos(angle), 0 * angle, np.sin(angle)])
        size = foundation.size + np.max(np.abs(x))
        assert 0.01 * EPS * size < np.max(np.abs(foundation.gap(x))) <= 10 * EPS * size


def row_of_masses(travel: float, at: float) -> tuple[ContactProblem, np.ndarray, np.ndarray]:
    """Springs in a row below a plane that has come by ``travel``, everything ``at`` a height; K and areas."""
    m = 5
    K = 3 * np.eye(m) - np.eye(m, k=1) - np.eye(m, k=-1)
    operator = sparse.csr_matrix((np.ones(m), (3 * np.arange(m) + 2, np.arange(m))), shape=(3 * m, m))
    x = np.column_stack([np.arange(m), np.zeros(m), np.full(m, at)])
    areas = np.linspace(0.5, 1.5, m)
    return (
        against(linear_mechanics(K, np.zeros(m)), Candidates(x, operator, areas), RigidPlane(Z, at - travel)),
        K,
        areas,
    )


def test_any_travel_of_a_plane_is_pressed_alike() -> None:
    """All gaps closed: p = K d/w, for a travel d from 1e-301 mm on."""
    for name, exponent in product(EXACT, range(-1000, 1, 200)):
        d = 2.0**exponent
        problem, K, areas = row_of_masses(d, 0.0)
        solution = ALGORITHMS[name](epsilon=math.inf).solve(problem, ContactSolution.at_rest(5, 5))
        assert solution.outcome is Outcome.CONVERGED
        np.testing.assert_allclose(solution.pressure, K @ np.full(5, d) / areas, rtol=1e-9)
        assert judge(problem, solution.u, solution.pressure).failures() == []


def test_a_travel_below_the_last_digits_of_the_points_has_all_of_its_own() -> None:
    """A metre up, where a point is known to 1e-13 mm, and the plane comes by three of those: solved as if at zero."""
    for name in EXACT:
        ulp = np.spacing(1000.0)
        problem, K, areas = row_of_masses(3 * ulp, 1000.0)
        solution = ALGORITHMS[name](epsilon=math.inf).solve(problem, ContactSolution.at_rest(5, 5))
        np.testing.assert_allclose(solution.pressure, K @ np.full(5, 3 * ulp) / areas, rtol=1e-9)
        assert judge(problem, solution.u, solution.pressure).failures() == []
        assert "penetration" in judge(problem, 0.99 * solution.u, solution.pressure).failures()


def stretched(touch: float) -> ContactProblem:
    """Two springs: one is pulled by 1 N and touches nothing, the other is pushed into the plane by ``touch`` N."""
    operator = sparse.csr_matrix((np.ones(2), ([2, 5], [0, 1])), shape=(6, 2))
    x = np.array([[0.0, 0.0, -10.0], [1.0, 0.0, 0.0]])
    mechanics = linear_mechanics(np.diag([2.0, 3.0]), np.array([1.0, touch]))
    return against(mechanics, Candidates(x, operator, np.ones(2)), RigidPlane(Z, 0.0))


def test_a_force_that_is_next_to_nothing_of_all_is_judged_by_itself() -> None:
    """Half of it or twice is noticed, as long as it is more than rounding of the others."""
    for touch in (1.0, 1e-6, 1e-10, 1e-13):
        problem, u = stretched(touch), np.array([0.5, 0.0])
        right = np.array([0.0, touch])
        assert judge(problem, u, right).failures() == []
        for factor in (0.5, 0.99, 1.01, 2.0):
            assert "equilibrium" in judge(problem, u, factor * right).failures()


def test_a_start_has_no_size_from_pressures_that_balance_nothing(rng) -> None:
    """Stiff springs into which the foundation has been pushed would make every later gap a small one."""
    data = random_quadratic(rng, "inclined")
    problem, u = data.problem(), rng.normal(size=len(data.f))
    run, m = NewtonRun(problem), len(data.w)
    lin = run.linearise(u, None)
    values = [run.at(lin, u, p, p > 0).length for p in (np.zeros(m), np.full(m, 1e12))]
    assert values[0] == values[1] == length(problem, Stiffness.of(problem, lin, u), u, lin.scale)
