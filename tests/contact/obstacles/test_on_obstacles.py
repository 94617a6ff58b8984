"""The rigid plane: unit normal, sign of the gap, gap row and force on the body.

Contact problems against drums, cleats and steps: ropes in space with discrete closed forms, and Newton's rate.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.obstacles.cleat import Profile, cleat, rounded
from contact.obstacles.drum_sphere import Drum
from contact.obstacles.foundation import Candidates, Foundation, RigidPlane, against, against_plane
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome
from contact.verify import judge
from support.problems.contact_problems import linear_mechanics

ROUNDING = 1e-13
NORMALS = [np.array([1.0, 0, 0]), np.array([0, 0.6, -0.8]), np.array([2, 3, 6]) / 7]


def test_the_normal_must_be_a_unit_vector() -> None:
    for normal in ((1.0, 1e-5, 0), (0.0, 0, 0), (2.0, 0, 0), (math.nan, 0, 0), (0.5, 0.5, 0.5)):
        with pytest.raises(ValueError, match="unit vector"):
            RigidPlane(np.array(normal), 0.0)


@pytest.mark.parametrize("normal", NORMALS)
def test_gap_is_the_distance_positive_when_open(normal, rng) -> None:
    """A point is reached from the plane by going the gap against the normal, whatever lies sideways."""
    plane, offset = RigidPlane(normal, 0.7), np.array([0.3, 0.0, -0.2])
    sideways = np.cross(normal, rng.normal(size=3))
    x = 0.7 * normal - offset[:, None] * normal + sideways
    np.testing.assert_allclose(plane.gap(x), offset, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("normal", NORMALS)
@pytest.mark.parametrize("coupling", [False, True])
def test_problem_against_a_plane(rng, normal, coupling) -> None:
    """Gap of the moved points, its derivative by differences, and a force W p against the normal on every point."""
    m, n = 3, 7
    operator, x, w = rng.normal(size=(3 * m, n)), rng.normal(size=(m, 3)), rng.uniform(0.5, 2, m)
    W = np.diag(w) + (0.1 if coupling else 0.0) * np.ones((m, m))
    candidates = Candidates(x, sparse.csr_matrix(operator), w, sparse.csr_matrix(W) if coupling else None)
    problem = against_plane(linear_mechanics(np.eye(n), np.zeros(n)), candidates, RigidPlane(normal, 0.4))
    u, du, p = rng.normal(size=n), rng.normal(size=n), rng.uniform(0, 1, m)
    moved = x + (operator @ u).reshape(m, 3)
    np.testing.assert_allclose(problem.gap(u), 0.4 - moved @ normal, rtol=0, atol=10 * ROUNDING)
    change = (problem.gap(u + du) - problem.gap(u - du)) / 2  # exact for a gap that is linear in u
    np.testing.assert_allclose(problem.gap_jacobian(u) @ du, change, rtol=0, atol=10 * ROUNDING)
    work = problem.contact_force(u, p) @ du
    assert work == pytest.approx(-(W @ p) @ ((operator @ du).reshape(m, 3) @ normal), rel=1e-11)
    assert problem.gap_curvature is None


class Rope:
    """Linear springs in a row between two supports, at full geometry: tension k (l - l0), a dead load along z."""

    def __init__(self, ends: np.ndarray, n: int, k: float, l0: float, lift: float = 0.0) -> None:
        self.n, self.k, self.l0, self.lift = n, k, l0, lift
        self.rest = ends[0] + np.linspace(0, 1, n + 1)[:, None] * (ends[1] - ends[0])

    def positions(self, u: np.ndarray) -> np.ndarray:
        x = self.rest.copy()
        x[1:-1] += u.reshape(-1, 3)
        return x

    def linearise(self, u: np.ndarray, memory: object):
        d = np.diff(self.positions(u), axis=0)
        length = np.linalg.norm(d, axis=1)
        e, force = d / length[:, None], self.k * (length - self.l0)
        r, K = np.zeros((self.n + 1, 3)), np.zeros((3 * self.n + 3, 3 * self.n + 3))
        r[1:] += force[:, None] * e
        r[:-1] -= force[:, None] * e
        for i in range(self.n):
            nn = np.outer(e[i], e[i])
            block = self.k * nn + force[i] / length[i] * (np.eye(3) - nn)
            own = slice(3 * i, 3 * i + 6)
            K[own, own] += np.kron([[1, -1], [-1, 1]], block)
        inner = slice(3, -3)
        r[:, 2] -= self.lift
        return Linearisation(r[1:-1].ravel(), sparse.csc_matrix(K[inner, inner]), self.k * self.l0)

    def candidates(self, weights: np.ndarray) -> Candidates:
        return Candidates(self.rest[1:-1], sparse.csr_matrix(np.eye(3 * self.n - 3)), weights)


def solve_path(problems: list[ContactProblem], n: int) -> ContactSolution:
    """Semismooth steps; every one converges and is judged."""
    solution = ContactSolution.at_rest(n, len(problems[0].weights))
    for problem in problems:
        solution = ALGORITHMS["semismooth"]().solve(problem, solution)
        assert solution.outcome is Outcome.CONVERGED
        assert solution.counters["newton_iterations"] <= 16
        assert judge(problem, solution.u, solution.pressure).failures() == []
    return solution


def turning(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inclination of the chords and by how much each node turns them, in the plane of x and z."""
    d = np.diff(x, axis=0)
    angle = np.arctan2(d[:, 2], d[:, 0])
    return angle, -np.diff(angle)


def resultant(candidates: Candidates, foundation: Foundation, solution: ContactSolution) -> np.ndarray:
    """Sum (3,) of the contact forces."""
    f = candidates.weights * solution.pressure
    return f @ foundation.gradient(candidates.positions(solution.u))


def test_rope_over_a_drum_has_one_tension() -> None:
    """Chords on the drum turn by b, have one tension T and press with 2 T sin(b/2): the discrete form of p = T/R.

    At the rim the drum pushes along its radius: what the free chord and the first on the drum pull sideways is equal.
    """
    R, n, w = 2.0, 40, 0.7
    rope = Rope(np.array([[-3.0, 0, 0], [3.0, 0, 0]]), n, 10.0 * n / 6, 0.8 * 6 / n)
    drums = [Drum(np.array([0, 0, z - R]), np.array([0, 1.0, 0]), R) for z in np.linspace(0.1, 1.3, 8)]
    candidates = rope.candidates(np.full(n - 1, w))
    solution = solve_path([against(rope.linearise, candidates, drum) for drum in drums], 3 * n - 3)
    x, drum = rope.positions(solution.u), drums[-1]
    tension = rope.k * (np.linalg.norm(np.diff(x, axis=0), axis=1) - rope.l0)
    touching = 1 + np.flatnonzero(solution.active)
    first, last = touching[0], touching[-1]
    assert 8 < len(touching) == last - first + 1 < n - 10
    np.testing.assert_allclose(np.linalg.norm(x[touching] - drum.centre, axis=1), R, rtol=0, atol=1e-12)
    T = tension[first]
    np.testing.assert_allclose(tension[first:last], T, rtol=1e-9)
    np.testing.assert_allclose(tension[[*range(first), *range(last, n)]], tension[0], rtol=1e-9)
    angle, turn = turning(x)
    b = abs(turn[first])  # of the second node on the drum
    inner = w * solution.pressure[first : last - 2]
    np.testing.assert_allclose(inner, 2 * T * math.sin(b / 2), rtol=1e-8)
    outer = abs(turn[first - 1]) - b / 2
    assert tension[0] * math.cos(outer) == pytest.approx(T * math.cos(b / 2), rel=1e-9)
    up = resultant(candidates, drum, solution)
    np.testing.assert_allclose(up, [0, 0, -2 * tension[0] * math.sin(angle[-1])], rtol=0, atol=1e-9)


@pytest.mark.parametrize("hollow", [False, True])
def test_the_curvature_makes_newton_quadratic(hollow, rng) -> None:
    """From a state pushed aside on the same set: residuals fall quadratically, and linearly without the curvature."""
    m, k, R = 6, 1.0, 1.5
    x = np.column_stack([np.linspace(-0.4, 0.4, m), rng.normal(size=m), np.full(m, 1.4 if not hollow else -1.6)])
    candidates = Candidates(x, sparse.csr_matrix(np.eye(3 * m)), np.ones(m))
    problem = against(
        linear_mechanics(k * np.eye(3 * m), np.zeros(3 * m)),
        candidates,
        Drum(np.zeros(3), np.array([0, 1.0, 0]), R, hollow),
    )
    start = replace(ContactSolution.at_rest(3 * m, m), u=np.tile([0.3, 0.2, 0.0], m), active=np.ones(m, bool))
    runs = [ALGORITHMS["semismooth"]().solve(each, start) for each in (problem, replace(problem, gap_curvature=None))]
    assert all(run.outcome is Outcome.CONVERGED and run.active.all() for run in runs)
    exact = x / np.linalg.norm(x[:, [0, 2]], axis=1)[:, None] * R  # back to the nearest point of the drum
    for run in runs:
        actual = candidates.positions(run.u)
        np.testing.assert_allclose(actual[:, [0, 2]], exact[:, [0, 2]], rtol=0, atol=1e-8)
    quadratic, linear = (run.counters["newton_iterations"] for run in runs)
    assert quadratic <= 4
    assert linear >= 8


@pytest.mark.slow
def test_rope_lifted_into_a_hollow_drum() -> None:
    """A dead load P a node lifts it against the concave wall: p = P cos(theta) - T b there; off it by h^2.

    Without friction T^2/(2 k) + l0 T + P z stays the same all along, on the wall and off it.
    """
    R, errors = 2.0, []
    for n in (24, 48):
        P, w = 24.0 / n, 1.3
        rope = Rope(np.array([[-1.0, 0, 0], [1.0, 0, 0]]), n, 10.0 * n / 2, 1.6 / n, lift=P)
        candidates = rope.candidates(np.full(n - 1, w))
        tops = [Drum(np.array([0, 0, z - R]), np.array([0, 1.0, 0]), R, hollow=True) for z in np.linspace(0.8, 0.4, 6)]
        solution = solve_path([against(rope.linearise, candidates, top) for top in tops], 3 * n - 3)
        assert n / 4 < solution.active.sum() < n - 4
        x = rope.positions(solution.u)
        T = rope.k * (np.linalg.norm(np.diff(x, axis=0), axis=1) - rope.l0)
        kept = T**2 / (2 * rope.k) + rope.l0 * T + P * (x[1:, 2] + x[:-1, 2]) / 2
        angle, turn = turning(x)
        inner = np.flatnonzero(solution.active)[1:-1]
        law = P * np.cos((angle[1:] + angle[:-1]) / 2) - (T[1:] + T[:-1]) / 2 * turn
        errors.append([np.ptp(kept) / np.ptp(P * x[:, 2]), np.max(np.abs(w * solution.pressure - law)[inner]) / P])
        assert resultant(candidates, tops[-1], solution)[2] < -P
    ratio = np.array(errors[0]) / errors[1]
    assert np.all(np.array(errors[1]) < 2e-3)
    assert np.all(ratio > 3.0)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["cleat", "step"])
def test_rope_over_an_obstacle_on_a_plane(kind) -> None:
    """Only the rounded edges turn it and carry; on the level top it lies with no pressure, its tension the same."""
    n, w, high = 80, 0.5, 0.4 if kind == "cleat" else 0.75
    rope = Rope(np.array([[-2.0, 0, 0.4], [2.0, 0, high]]), n, 10.0 * n / 4, 0.8 * 4 / n)
    pieces = cleat(0.3, 0.8, 60.0, 0.1) if kind == "cleat" else rounded([(0.0, 0.0), (0.3 / math.sqrt(3.0), 0.3)], 0.1)
    down, along = np.array([0, 0, -1.0]), np.array([1.0, 0, 0])
    grounds = [Profile(down, -z, along, 0.0, pieces) for z in np.linspace(0.12, 0.36, 9)]
    candidates = rope.candidates(np.full(n - 1, w))
    solution = solve_path([against(rope.linearise, candidates, ground) for ground in grounds], 3 * n - 3)
    x, ground = rope.positions(solution.u), grounds[-1]
    T = rope.k * (np.linalg.norm(np.diff(x, axis=0), axis=1) - rope.l0)
    angle, turn = turning(x)
    carrying = w * solution.pressure > 1e-6
    assert carrying.any()
    if kind == "cleat":  # the nodes in the middle of its top lie there without pressure
        assert np.max(np.abs(ground.gap(x[1:-1])[np.abs(x[1:-1, 0]) < 0.4 - 0.1])) < 1e-9
        assert not np.any(carrying[np.abs(x[1:-1, 0]) < 0.4 - 0.1])
    np.testing.assert_allclose(turn[~carrying], 0, rtol=0, atol=1e-5)
    assert np.all(turn[carrying] > 1e-3)
    bent = ground.curvature(x[1:-1]).any(axis=(1, 2))
    assert not np.any(carrying & ~(bent | np.roll(bent, 1) | np.roll(bent, -1)))
    np.testing.assert_allclose(T, T[0], rtol=2e-2)  # exact in the limit: a chord cuts the corner by its angle squared
    pull = T[0] * np.array([-math.cos(angle[0]), 0, -math.sin(angle[0])])
    pull += T[-1] * np.array([math.cos(angle[-1]), 0, math.sin(angle[-1])])
    np.testing.assert_allclose(resultant(candidates, ground, solution) + pull, 0, rtol=0, atol=1e-8)
