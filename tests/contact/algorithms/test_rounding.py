"""Very stiff problems: rounding that moves nothing is not an obstacle, rounding that moves something is an outcome."""

import math

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.problem import ContactProblem, Linearisation, Outcome
from contact.verify import NEGLIGIBLE, ROUNDING_ALONE, judge
from support.problems.contact_problems import EXACT, random_quadratic, solve_from_rest

STIFF = 1e12  # of a pair of faces, over the stiffness 1 of everything else: S |u| eps is 1e-4 of the load
PAIRS = 8
MOST = dict.fromkeys(ALGORITHMS, 10) | {"augmented-lagrangian": 14}  # without an end to it, 40 and more are spent

each_exact_one = pytest.mark.parametrize("name", EXACT)
each_kind = pytest.mark.parametrize("wall", [math.inf, 0.5], ids=["free", "pressed"])


class Faces:
    """Pairs of faces (v-, v+) with a stiff spring between them, the unknowns of a very thin shell; soft ground.

    ``by_pairs``: the spring force is computed once and acts on both, as in an element; else K u is a matrix product,
    whose rounding is in balance with nothing.
    """

    def __init__(self, rng, by_pairs: bool, stiff: float = STIFF) -> None:
        self.ground, self.load = rng.uniform(0.5, 2, 2 * PAIRS), rng.uniform(0.2, 1, 2 * PAIRS)
        self.stiff = stiff
        spring = np.kron(np.eye(PAIRS), stiff * np.array([[1.0, -1.0], [-1.0, 1.0]]))
        self.K, self.by_pairs = np.diag(self.ground) + spring, by_pairs

    def linearise(self, u, memory):
        internal = self.K @ u
        if self.by_pairs:
            spring = self.stiff * (u[1::2] - u[0::2])
            internal = self.ground * u + np.stack([-spring, spring], axis=1).ravel()
        scale = max(np.linalg.norm(internal), np.linalg.norm(self.load))
        return Linearisation(internal - self.load, sparse.csc_matrix(self.K), scale)

    def problem(self, wall: float) -> ContactProblem:
        """One wall before the outer face of each pair; at infinity there is none."""
        G = sparse.csr_matrix(-np.eye(2 * PAIRS)[1::2] if math.isfinite(wall) else np.zeros((0, 2 * PAIRS)))
        return ContactProblem(
            self.linearise, lambda u: np.full(G.shape[0], wall) + G @ u, lambda u: G, np.ones(G.shape[0])
        )

    def exact(self, wall: float) -> np.ndarray:
        """The faces of a pair move together: load over ground, no further than the wall."""
        mean = (self.load[0::2] + self.load[1::2]) / (self.ground[0::2] + self.ground[1::2])
        return np.minimum(np.repeat(mean, 2), wall)


@each_exact_one
@each_kind
@pytest.mark.parametrize("stiff", [STIFF, 1e14])
def test_forces_that_move_nothing_are_no_obstacle(rng, name, wall, stiff) -> None:
    faces = Faces(rng, True, stiff)
    problem = faces.problem(wall)
    solution = solve_from_rest(name, problem, 2 * PAIRS)
    assert solution.outcome is Outcome.CONVERGED
    assert solution.counters["newton_iterations"] <= MOST[name]
    verdict = judge(problem, solution.u, solution.pressure)
    assert ROUNDING_ALONE < verdict.equilibrium <= verdict.rounding  # the premise
    assert verdict.correction <= NEGLIGIBLE
    assert verdict.failures() == []
    np.testing.assert_allclose(solution.u, faces.exact(wall), rtol=1e-11)
    if math.isfinite(wall):
        assert 0 < solution.active.sum() < PAIRS


@each_exact_one
@each_kind
def test_forces_that_do_move_are_an_outcome(rng, name, wall) -> None:
    problem = Faces(rng, by_pairs=False).problem(wall)
    solution = solve_from_rest(name, problem, 2 * PAIRS)
    assert solution.outcome is Outcome.ROUNDING
    assert solution.counters["newton_iterations"] <= MOST[name]
    verdict = judge(problem, solution.u, solution.pressure)
    assert ROUNDING_ALONE < verdict.equilibrium <= verdict.rounding
    assert verdict.correction > NEGLIGIBLE
    assert "equilibrium" in verdict.failures()


def test_correction_is_the_displacement_still_asked_for(rng) -> None:
    """Against a dense solve for the two directions that matter: each pair as one, the pressed ones held."""
    faces = Faces(rng, by_pairs=False)
    problem, u = faces.problem(0.5), np.repeat(rng.uniform(0.3, 0.5, PAIRS), 2)
    u[1::2] += 1e-5 / STIFF
    pressure = np.where(np.arange(PAIRS) < 3, 0.1, 0.0)
    # the load that leaves 1e-5 of itself out of balance on every pair
    imbalance = 1e-5 * rng.uniform(0.5, 1, 2 * PAIRS)
    faces.load = faces.K @ u - problem.gap_jacobian(u).T @ pressure - imbalance
    verdict = judge(problem, u, pressure)
    assert ROUNDING_ALONE < verdict.equilibrium <= verdict.rounding
    ground = faces.ground[0::2] + faces.ground[1::2]
    mean = np.where(pressure > 0, 0.0, -(imbalance[0::2] + imbalance[1::2]) / ground)
    assert verdict.correction == pytest.approx(np.linalg.norm(np.repeat(mean, 2)) / np.linalg.norm(u), rel=1e-2)


def test_nothing_is_solved_where_nothing_is_to_be_decided(rng) -> None:
    data = random_quadratic(rng, "definite")
    u = np.linalg.solve(data.K, data.f)
    for state in (u, 1.001 * u):
        assert math.isinf(judge(data.problem(), state, np.zeros(6)).correction)
