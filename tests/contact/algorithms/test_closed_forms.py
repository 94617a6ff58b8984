"""Every contact algorithm on small mechanical problems with closed forms, or with all sets tried one by one.

Iterations on meshes of 64 to 1024 elements: the rim of contact is not let go of one element an iteration.
"""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import root

from contact.catalogue import ALGORITHMS
from contact.obstacles.foundation import Candidates, RigidPlane, against_plane
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from contact.verify import judge
from studies.scenes.complete import complete
from studies.solving.solve import solve
from support.problems.contact_problems import (
    Quadratic,
    applicable,
    dual_by_nnls,
    linear_mechanics,
    random_quadratic,
    solve_from_rest,
)

ORACLE = 1e-7  # agreement with the independent solutions, all quantities are of the order one
TOUCH = 1e-9  # a pressure or penetration above this is one
ROUNDING = 1e-10
STRING = 2e-3  # relative error of the pressure inside the contact of the string
RIM = 0.05  # error of its reaction, in nodal loads
EPSILONS = (math.inf, 1e4)

each_pair = pytest.mark.parametrize(("name", "epsilon"), applicable(*EPSILONS))


@each_pair
def test_body_on_a_plane_presses_uniformly(name, epsilon) -> None:
    """Contact patch test: equal columns under a dead pressure, every candidate in contact, pressure = load."""
    k, load, start = 3.0, 0.7, 0.02
    areas = np.array([0.5, 1.0, 1.5, 0.7])
    K, f = sparse.csc_matrix(np.diag(k * areas)), load * areas + k * areas * start
    candidates = Candidates(np.zeros((4, 3)), sparse.csr_matrix(np.kron(np.eye(4), [[0], [0], [1]])), areas)
    linearise = linear_mechanics(K, f)
    problem = against_plane(linearise, candidates, RigidPlane(np.array([0.0, 0.0, 1.0]), start))
    solution = solve_from_rest(name, problem, 4, epsilon)
    assert solution.outcome is Outcome.CONVERGED
    exact = load / (1 + k / epsilon)
    np.testing.assert_allclose(solution.pressure, exact, rtol=ROUNDING)
    np.testing.assert_allclose(solution.u, start + exact / epsilon, rtol=ROUNDING)


STRING_DATA = 2.0, 1.3, 9.0, 0.25  # length, tension, load, gap


def string(n: int):
    """A string of n elements before a flat obstacle: an M-matrix, which active sets approach from one side."""
    L, T, q, g = STRING_DATA
    h = L / n
    K = T / h * (2 * np.eye(n - 1) - np.eye(n - 1, k=1) - np.eye(n - 1, k=-1))
    return Quadratic(K, np.full(n - 1, q * h), -np.eye(n - 1), np.full(n - 1, g), np.full(n - 1, h))


@each_pair
def test_string_over_an_obstacle(name, epsilon) -> None:
    """Free length l = sqrt(2 T g/q) on three meshes; pressure q under the contact; reaction q (L - 2 l)."""
    L, T, q, g = STRING_DATA
    free_length = math.sqrt(2 * T * g / q)
    for n in (24, 48, 96):
        h = L / n
        solution = solve_from_rest(name, string(n).problem(), n - 1, epsilon)
        assert solution.outcome is Outcome.CONVERGED
        touching = np.flatnonzero(solution.active)
        assert abs(h * (touching[0] + 1) - free_length) <= h
        assert abs(L - h * (touching[-1] + 1) - free_length) <= h
        layer = 3 * math.sqrt(T / epsilon)  # over which a finite epsilon blurs the rim
        inside = touching[3 + math.ceil(layer / h) : -3 - math.ceil(layer / h)]
        np.testing.assert_allclose(solution.pressure[inside], q, rtol=STRING)
        assert abs(h * solution.pressure.sum() - q * (L - 2 * free_length)) <= RIM * q * h


@pytest.mark.parametrize(("n", "fewest"), [(384, 41), pytest.param(768, 82, marks=pytest.mark.slow)])
def test_iterations_that_only_release_do_not_count(n, fewest) -> None:
    """The first step closes every node, the others open one on either side: more of them than Newton has iterations.

    That is the textbook's method. A finite epsilon lets the rim move by more than a node, and by default what is left
    is settled on one linearisation: the mesh no longer matters.
    """
    data = string(n)
    exact, soft = (solve_from_rest("semismooth", data.problem(), n - 1, epsilon, settle=1) for epsilon in EPSILONS)
    settled = solve_from_rest("semismooth", data.problem(), n - 1)
    assert exact.outcome is soft.outcome is settled.outcome is Outcome.CONVERGED
    assert np.array_equal(settled.active, exact.active)
    assert settled.counters["newton_iterations"] <= 4
    assert judge(data.problem(), exact.u, exact.pressure).failures() == []
    assert fewest <= exact.counters["newton_iterations"] <= n / 2
    assert soft.counters["newton_iterations"] <= 12
    for row in exact.history[2:]:
        assert (row["added"], row["removed"]) in ((0, 2), (0, 0))
    # what counts: the free step, and the set that it closes
    enough, short = (solve_from_rest("semismooth", data.problem(), n - 1, settle=1, max_iterations=k) for k in (2, 1))
    assert (enough.outcome, short.outcome) == (Outcome.CONVERGED, Outcome.ITERATION_LIMIT)


def test_sets_that_only_release_do_not_count_in_trial_and_error() -> None:
    """Begun with every node held, it opens one on either side after the other: as many sets as rows."""
    n = 64
    start = replace(ContactSolution.at_rest(n - 1, n - 1), active=np.ones(n - 1, bool))
    algorithm = ALGORITHMS["trial-and-error"](epsilon=math.inf, max_sets=2)
    solution = algorithm.solve(string(n).problem(), start)
    assert solution.outcome is Outcome.CONVERGED
    assert 5 < solution.counters["set_changes"] <= n / 2
    assert judge(string(n).problem(), solution.u, solution.pressure).failures() == []


@each_pair
@pytest.mark.parametrize("normal", [(1.0, 0.0, 0.0), (0.6, 0.0, -0.8), (2 / 7, 3 / 7, 6 / 7)])
def test_inclined_plane(rng, name, epsilon, normal) -> None:
    """Three unknowns in each gap row, through the foundation; the same as the dual with G = -n."""
    m, normal = 5, np.array(normal)
    x = rng.normal(size=(m, 3))
    data = Quadratic(
        random_quadratic(rng, "definite", 3 * m - 2).K,
        rng.normal(size=3 * m),
        -np.kron(np.eye(m), normal),
        0.1 - x @ normal,
        rng.uniform(0.5, 2, m),
    )
    candidates = Candidates(x, sparse.eye_array(3 * m, format="csr"), data.w)
    problem = against_plane(linear_mechanics(sparse.csc_matrix(data.K), data.f), candidates, RigidPlane(normal, 0.1))
    solution = solve_from_rest(name, problem, 3 * m, epsilon)
    assert solution.outcome is Outcome.CONVERGED
    u, pressure = dual_by_nnls(data, epsilon)
    assert 0 < np.sum(pressure > TOUCH) < m
    np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE)
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=ORACLE)


@each_pair
def test_chain_of_hardening_springs(name, epsilon) -> None:
    """Springs k e + c e^3 in a row, walls before some nodes: the only consistent one of all 2^m sets, by scipy."""
    n, k, c = 6, 2.0, 5.0
    f = np.array([0.5, 1.2, -0.8, 1.5, -0.4, 1.0])
    places, walls, weights = np.array([0, 2, 5]), np.array([0.3, 0.9, 0.6]), np.array([0.5, 1.0, 2.0])
    B = np.eye(n) - np.eye(n, k=-1)  # elongations e = B u, held at the left end
    G = sparse.csr_matrix(-np.eye(n)[places])

    def internal(u):
        e = B @ u
        return B.T @ (k * e + c * e**3)

    def linearise(u, memory):
        tangent = sparse.csc_matrix(B.T @ np.diag(k + 3 * c * (B @ u) ** 2) @ B)
        return Linearisation(internal(u) - f, tangent, max(np.linalg.norm(internal(u)), np.linalg.norm(f)))

    problem = ContactProblem(linearise, lambda u: walls + G @ u, lambda u: G, weights)
    consistent = []
    for members in itertools.product([False, True], repeat=3):
        a = np.array(members)

        def equations(z, a=a):
            u, p = z[:n], z[n:]
            closed = np.where(a, walls + G @ u + p / epsilon, p)
            return np.concatenate([internal(u) - f - G.T @ (weights * p), closed])

        actual = root(equations, np.zeros(n + 3), tol=1e-13)
        u, p = actual.x[:n], actual.x[n:]
        assert np.max(np.abs(equations(actual.x))) <= TOUCH
        if np.all(p >= -TOUCH) and np.all((walls + G @ u >= -TOUCH) | a):
            consistent.append((u, p, a))
    assert len(consistent) == 1
    u, p, a = consistent[0]
    assert 0 < a.sum() < 3
    solution = solve_from_rest(name, problem, n, epsilon)
    assert solution.outcome is Outcome.CONVERGED
    np.testing.assert_array_equal(solution.active, a)
    np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE)
    np.testing.assert_allclose(solution.pressure, p, rtol=0, atol=ORACLE)


@each_pair
def test_particle_on_a_round_obstacle(name, epsilon) -> None:
    """A spring pulls a particle into a ball: it rests above the anchor; the gap is curved and its curvature counts."""
    k, weight, radius = 2.0, 0.8, 1.5
    centre, anchor = np.array([0.2, -0.1, 0.3]), np.array([0.9, 0.4, -0.3])

    def gap_vector(u):
        return anchor + u - centre  # rest at the anchor, inside the ball

    def gap_jacobian(u):
        r = gap_vector(u)
        return sparse.csr_matrix(r[None, :] / np.linalg.norm(r))

    def gap_curvature(u, force):
        r = gap_vector(u)
        n, length = r / np.linalg.norm(r), np.linalg.norm(r)
        return sparse.csc_matrix(force[0] * (np.eye(3) - np.outer(n, n)) / length)

    problem = ContactProblem(
        linear_mechanics(sparse.csc_matrix(k * np.eye(3)), np.zeros(3)),
        lambda u: np.array([np.linalg.norm(gap_vector(u)) - radius]),
        gap_jacobian,
        np.array([weight]),
        gap_curvature=gap_curvature,
    )
    algorithm = ALGORITHMS[name](epsilon=epsilon)
    assert algorithm.supports(problem) is None
    off = np.array([0.3, -0.5, 0.4])  # start away from the normal through the anchor
    start = ContactSolution(off, np.zeros(1), np.zeros(1, bool), Outcome.CONVERGED)
    solution = algorithm.solve(problem, start)
    assert solution.outcome is Outcome.CONVERGED
    depth = np.linalg.norm(anchor - centre)
    distance = radius if math.isinf(epsilon) else (k * depth + weight * epsilon * radius) / (k + weight * epsilon)
    np.testing.assert_allclose(gap_vector(solution.u), distance / depth * (anchor - centre), rtol=0, atol=ORACLE)
    np.testing.assert_allclose(solution.pressure, k * (distance - depth) / weight, rtol=0, atol=ORACLE)
    # 18 without the curvature of the gap; the outer loop adds those in which it notices that it is done
    assert solution.counters["newton_iterations"] <= (10 if name == "augmented-lagrangian" else 8)


FACTOR = 2  # between the fewest and the most iterations to one load
SCENES = {
    "plate-contact": ("{n}x1", {}),
    "strip-contact": ("{n}x1", {}),
    "ring": ("1x{n}", {"delta_mm": "37"}),
}


def iterations(scene: str, n: int) -> np.ndarray:
    """Of each load, reached in one step."""
    mesh, settings = SCENES[scene]
    result = solve(*complete(scene, settings, mesh.format(n=n)))
    assert result.outcome.converged
    assert all(not load.certificate["failures"] and load.counters["substeps"] == 1 for load in result.loads)
    return np.array([load.counters["newton_iterations"] for load in result.loads])


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_iterations_of_semismooth_do_not_grow_with_the_mesh(scene: str) -> None:
    """Every load, and the whole path."""
    actual = np.array([iterations(scene, n) for n in (24, 96, 384)])
    for each in (*actual.T, actual.sum(axis=1)):
        assert each.max() <= FACTOR * each.min(), actual


def test_the_rim_of_a_strip_is_settled_on_one_linearisation() -> None:
    """The quick end of the same: 23 iterations where each lets go of one row of elements."""
    coarse, fine = iterations("strip-contact", 16), iterations("strip-contact", 64)
    assert np.all(fine <= FACTOR * coarse)
