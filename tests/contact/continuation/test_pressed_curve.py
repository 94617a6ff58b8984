"""Arc length with contact: trusses pressed by planes, whose curves, tangents and limit points are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import brentq, minimize_scalar

from contact.catalogue import ALGORITHMS
from contact.continuation.arc_length import ArcLength
from contact.continuation.load_stepping import follow
from contact.continuation.pressed_curve import PressedCurve
from contact.continuation.turning_points import by_arc_length
from contact.events import PathEnd
from contact.obstacles.drum_sphere import Sphere
from contact.obstacles.foundation import Candidates, RigidPlane, against, travelling
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome

ON_CURVE = 1e-9
LIMIT = 1e-4  # of a limit point in displacement
SEMISMOOTH = ALGORITHMS["semismooth"]()
H, A, C = 1.0, 2.0, 0.5  # height of the truss, a, spring: C < A H^2, or the plane would take it through
DOWN = np.array([0.0, 0.0, -1.0])


def truss(w):
    """Force on the apex of a shallow truss of energy a/4 ((h + w)^2 - h^2)^2, and its slope."""
    return A * ((H + w) ** 2 - H**2) * (H + w), A * (3 * (H + w) ** 2 - H**2)


def pressed_truss(heights=(0.0,), spring: float = C):
    """problem_at(t) of the apex w under springs that a plane presses down from the first, touched at t = 0.

    heights: of the points of the springs below the plane at t = 0; unknowns w, then a point d each.
    """
    n, gaps = len(heights), np.asarray(heights)

    def linearise(u, memory):
        force, slope = truss(u[0])
        residual = np.append(force + spring * np.sum(u[0] - u[1:]), spring * (u[1:] - u[0]))
        K = spring * np.eye(n + 1)
        K[0, 0], K[0, 1:], K[1:, 0] = slope + n * spring, -spring, -spring
        return Linearisation(residual, sparse.csc_matrix(K), max(1.0, float(np.linalg.norm(residual))))

    places = np.zeros((n, 3))
    places[:, 2] = -gaps
    operator = sparse.csr_matrix((np.ones(n), (3 * np.arange(n) + 2, 1 + np.arange(n))), shape=(3 * n, n + 1))
    candidates = Candidates(places, operator, np.ones(n))
    plane = RigidPlane(-DOWN, 0.0)

    def at(t: float) -> ContactProblem:
        problem = against(linearise, candidates, plane.moved(t * DOWN))
        return replace(problem, travel=lambda: travelling(linearise, candidates, plane, DOWN))

    return at, ContactSolution(np.zeros(n + 1), np.zeros(n), np.zeros(n, bool), Outcome.CONVERGED)


def travel_at(w, spring: float = C):
    """The travel of the plane where one spring holds the apex at w: t = -d, d = w + force/c."""
    return -(w + truss(w)[0] / spring)


W_LIMIT = np.sqrt((H**2 - C / A) / 3) - H
T_LIMIT = travel_at(W_LIMIT)


WAYS = {
    "semismooth": {},
    "qp": {},
    "lcp": {"system": "full", "method": "nnls"},
    "trial-and-error": {},
    "augmented-lagrangian": {},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WAYS)
def test_a_pressed_truss_snaps_back(name) -> None:
    """Behind the turning point the plane goes back with the apex, and comes off it where the truss lies flat.

    Where only symmetric matrices are asked for otherwise, the travel as an unknown is no reason to refuse.
    """
    problem_at, rest = pressed_truss()
    algorithm = ALGORITHMS[name](epsilon=np.inf, **WAYS[name])
    (begun,) = follow(problem_at, 0.0, [0.1], algorithm, rest)
    curve, start = PressedCurve.through(problem_at, 0.1, begun.solution, algorithm)
    trace = ArcLength(0.02, easy=5, max_points=30).along(curve, start, [1.1 * T_LIMIT])
    assert trace.outcome is Outcome.ITERATION_LIMIT
    pressed = [point for point in trace.points if point.active[0]]
    for point in pressed:
        assert point.factor == pytest.approx(travel_at(point.u[0]), abs=ON_CURVE)
        assert point.pressure[0] == pytest.approx(-truss(point.u[0])[0], abs=ON_CURVE)
    assert np.all(np.diff([point.u[0] for point in pressed]) < 0)  # never back on its own trace
    (limit,) = (point for point in trace.points if point.limit)
    assert limit.u[0] == pytest.approx(W_LIMIT, abs=LIMIT)
    assert limit.factor == pytest.approx(T_LIMIT, abs=1e-7)
    others = [point for point in trace.points if not point.limit]
    assert [point.negative for point in others] == [int(point.u[0] < W_LIMIT) for point in others]
    assert len(pressed) < len(trace.points)
    for point in trace.points[len(pressed) :]:
        np.testing.assert_allclose(point.u, [-H, -H], atol=ON_CURVE)
        assert point.factor < H


def springs(w: float, t: float, heights, spring: float) -> float:
    """Force of the springs on the apex: the plane holds each that it has reached at d = height - t."""
    return spring * sum(min(height - t - w, 0.0) for height in heights)


@pytest.mark.slow
@pytest.mark.parametrize("heights", [(0.0, 0.1), tuple(np.linspace(0.0, 0.2, 5))])
def test_the_set_changes_along_the_curve(heights) -> None:
    """Springs are reached one after the other; the largest travel is looked for on the scalar equation for w."""
    spring = C / len(heights)
    problem_at, rest = pressed_truss(heights, spring)
    (begun,) = follow(problem_at, 0.0, [0.05], SEMISMOOTH, rest)
    curve, start = PressedCurve.through(problem_at, 0.05, begun.solution, SEMISMOOTH)
    points = ArcLength(0.02, easy=5, max_points=30).along(curve, start, [9.0]).points
    for point in points:
        w, t = point.u[0], point.factor
        np.testing.assert_array_equal(point.active, [height - t < w for height in heights])
        assert truss(w)[0] == pytest.approx(springs(w, t, heights, spring), abs=ON_CURVE)
    assert len({tuple(point.active) for point in points}) > 1

    def travel(w: float) -> float:
        return float(brentq(lambda t: truss(w)[0] - springs(w, t, heights, spring), -w, 9.0, xtol=1e-13))

    best = minimize_scalar(lambda w: -travel(w), bounds=(-0.8, -0.2), method="bounded", options={"xatol": 1e-9})
    limit = next(point for point in points if point.limit)
    assert limit.factor == pytest.approx(-best.fun, abs=1e-7)
    assert limit.u[0] == pytest.approx(best.x, abs=LIMIT)


def test_the_tangent_against_differences() -> None:
    problem_at, rest = pressed_truss()
    (begun,) = follow(problem_at, 0.0, [0.2], SEMISMOOTH, rest)
    curve, start = PressedCurve.through(problem_at, 0.2, begun.solution, SEMISMOOTH)
    along = np.append(np.zeros(2), 1.0)
    tangent = curve.tangent(start, along)
    errors = []
    for step in (1e-2, 5e-3):
        ends = [curve.on_plane(start, curve.place(start) + s * step * along, along, "") for s in (-1, 1)]
        difference = curve.place(ends[1]) - curve.place(ends[0])
        errors.append(np.linalg.norm(difference / np.linalg.norm(difference) - tangent))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)  # of second order: the curve is smooth there


@pytest.mark.slow
@pytest.mark.parametrize("steps", [1, 4])
def test_a_path_that_turns_back_is_told_in_few_steps(steps) -> None:
    """With the travel the path ends at its limit point; without it the same path is cut down to the smallest step."""
    problem_at, rest = pressed_truss()
    target, spent = 2 * T_LIMIT, {}
    hasty = ALGORITHMS["semismooth"](max_iterations=4)  # a step across the fold would find the far branch
    for known in (True, False):
        at = problem_at if known else lambda t: replace(problem_at(t), travel=None)
        *_, point = follow(at, 0.0, [0.1, target], hasty, rest, steps)
        assert not point.outcome.converged
        spent[known] = point.solution.counters["newton_iterations"]
        if known:
            assert point.outcome is Outcome.LIMIT_POINT
            assert point.cause is Outcome.ITERATION_LIMIT
            assert point.end.kind is PathEnd.LIMIT_POINT
            assert point.end.limit == point.reached == pytest.approx(T_LIMIT, abs=1e-6)
            assert abs(point.end.mode[0]) == pytest.approx(1.0, abs=1e-2)  # the apex moves, the spring is held
            assert str(point.solution.history[-1]["event"]) == point.end.sentence
    bisected = point.reached
    assert point.outcome is Outcome.STEP_LIMIT
    assert bisected == pytest.approx(T_LIMIT, abs=0.005 * target)


def test_a_target_before_the_limit_point_is_reached() -> None:
    problem_at, rest = pressed_truss()
    target = 0.9 * T_LIMIT
    (begun,) = follow(problem_at, 0.0, [0.1], SEMISMOOTH, rest)
    turned = by_arc_length(problem_at, ((0.1, begun.solution),), target, SEMISMOOTH, 0.05)
    assert turned.outcome is Outcome.CONVERGED
    assert (turned.t, turned.end) == (pytest.approx(target, abs=1e-12), None)
    assert turned.solution.u[0] == pytest.approx(brentq(lambda w: travel_at(w) - target, W_LIMIT, 0), abs=1e-8)


def test_a_path_without_a_travel_is_refused() -> None:
    problem_at, rest = pressed_truss()
    with pytest.raises(ValueError, match="no travel"):
        PressedCurve.through(lambda t: replace(problem_at(t), travel=None), 0.0, rest, SEMISMOOTH)


def test_a_moving_foundation_is_the_problem_seen_from_it() -> None:
    """Gap and forces of the travel as unknown are those of the moved sphere; it is pushed by nothing."""
    rng = np.random.default_rng(3)
    n, m, t = 9, 3, 0.3
    candidates = Candidates(rng.normal(size=(m, 3)), sparse.csr_matrix(rng.normal(size=(3 * m, n))), np.ones(m))
    velocity = np.array([0.2, -0.4, 1.0])
    sphere = Sphere(np.array([0.0, 0.0, 9.0]), 5.0)

    def linearise(u, memory):
        return Linearisation(2 * u, sparse.csc_matrix(2 * np.eye(n)), 1.0)

    u, p = 0.1 * rng.normal(size=n), rng.uniform(1, 2, m)
    x = np.append(u, t)
    moving = travelling(linearise, candidates, sphere, velocity)
    there = against(linearise, candidates, sphere.moved(t * velocity))
    np.testing.assert_allclose(moving.gap(x), there.gap(u), atol=1e-12)
    np.testing.assert_allclose(moving.contact_force(x, p), np.append(there.contact_force(u, p), 0.0), atol=1e-12)
    step = 1e-6
    for j in range(n + 1):
        e = np.eye(n + 1)[j] * step
        slope = (moving.gap(x + e) - moving.gap(x - e)) / (2 * step)
        np.testing.assert_allclose(moving.gap_jacobian(x).toarray()[:, j], slope, atol=1e-8)
        turned = (moving.contact_force(x + e, p) - moving.contact_force(x - e, p)) / (2 * step)
        stiff = moving.stiffness(moving.linearise(x, None), x, p) - moving.linearise(x, None).tangent
        np.testing.assert_allclose(-stiff.toarray()[:, j], turned, atol=1e-7)


def cornered(stiffness: float):
    """Two points under a plane, coupled by 1: p1 = 10 t, p2 = -(1 + stiffness)(1 - t)."""
    K = np.array([[9.0, 1.0], [1.0, stiffness]])
    f = np.array([0.0, -(1.0 + stiffness)])

    def linearise(u, memory):
        return Linearisation(K @ u - f, sparse.csc_matrix(K), 1.0)

    operator = sparse.csr_matrix((np.ones(2), ([2, 5], [0, 1])), shape=(6, 2))
    candidates, plane = Candidates(np.zeros((2, 3)), operator, np.ones(2)), RigidPlane(-DOWN, 0.0)

    def at(t: float) -> ContactProblem:
        problem = against(linearise, candidates, plane.moved(t * DOWN))
        return replace(problem, travel=lambda: travelling(linearise, candidates, plane, DOWN))

    def state(t: float) -> ContactSolution:
        u = np.array([-t, -t])
        return ContactSolution(u, f - K @ u, np.ones(2, bool), Outcome.CONVERGED)

    return at, state


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [-2.0, -5.0])
def test_a_path_turns_back_where_a_point_without_stiffness_of_its_own_comes_off(stiffness) -> None:
    """p2 = -(1 + k)(1 - t), with k + 1 < 0, is gone at t = 1; off the plane g2 = -p2/k, positive for t < 1 only."""
    at, state = cornered(stiffness)
    curve, point = PressedCurve.through(at, 0.9, state(0.9), SEMISMOOTH)
    tangent = curve.tangent(point, np.append(np.zeros(2), 1.0))
    assert point.pressure[1] == pytest.approx(-(1 + stiffness) * 0.1)
    travel, behind = curve.corner(point, tangent)
    assert travel == pytest.approx(1.0, abs=1e-12)
    assert behind[-1] < 0
    assert behind[1] / behind[0] == pytest.approx(-1 / stiffness)  # d2 = (f2 - d1)/k
    turned = by_arc_length(at, ((0.0, state(0.0)), (0.5, state(0.5))), 2.0, SEMISMOOTH, 0.1)
    assert turned.outcome is Outcome.LIMIT_POINT
    assert turned.end.limit == pytest.approx(1.0, abs=1e-9)
    assert "turns back where the contact set changes" in turned.end.sentence
