"""Passages through foundations: against roots of line and ball, dense points, and on paths of random obstacles."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest

from contact.algorithms.base import hasty
from contact.catalogue import ALGORITHMS
from contact.continuation import load_stepping
from contact.continuation.equilibrium_curve import ArcPoint
from contact.continuation.load_stepping import PathPoint, follow
from contact.continuation.pressed_curve import PressedCurve
from contact.events import EventKind, events
from contact.obstacles.cleat import Profile, cleat
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import RigidPlane
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.swept import Standing, between_nodes, crossings, crossings_along
from contact.verify import judge
from studies.experiments.obstacles import collection
from support.problems.falling import UP, Net, falling, passing

KINDS = ("ball", "drum", "bar")
EXACT = ("semismooth", "trial-and-error", "lcp")
FEW = [(6, 2, 3, 4, 5), (13, 8, 9, 10, 12), (21, 15, 16, 18, 20), (27, 23, 30, 31, 33)]


def free(foundation) -> Standing:
    """Points that are the unknowns themselves, and the foundation where it is."""
    return Standing(lambda u: u.reshape(-1, 3), foundation.gap, foundation.gradient)


@pytest.mark.parametrize("kind", KINDS)
def test_passages_of_random_segments(kind) -> None:
    """Aimed at the obstacle: up to 1e6 times longer than a ball, 100 times than a drum, along which one may glide."""
    actual = tried = 0
    for seed in range(8):
        rng = np.random.default_rng(seed)
        net = falling(rng, kind)
        centre = np.array([0, 0, 1.0]) if kind == "bar" else net.foundation.centre
        size = 1.0 if kind == "bar" else net.foundation.radius
        longest = {"ball": 6, "drum": 2, "bar": 1}[kind]
        m, way = 40 if kind == "bar" else 200, size * 10.0 ** rng.uniform(0, longest)
        ahead = rng.normal(size=(m, 3))
        ahead *= way / np.linalg.norm(ahead, axis=1)[:, None]
        start = centre + 1.5 * size * rng.uniform(-1, 1, (m, 3)) - rng.uniform(0, 1, (m, 1)) * ahead
        outside = (net.foundation.gap(start) > 0) & (net.foundation.gap(start + ahead) > 0)
        start, ahead = start[outside], ahead[outside]
        surely, perhaps = passing(net, start, start + ahead)
        place = free(net.foundation)
        names = {each.candidate for each in crossings(place, start.ravel(), place, (start + ahead).ravel())}
        assert surely <= names <= perhaps
        actual, tried = actual + len(surely), tried + len(start)
    assert 0.1 * tried < actual < 0.9 * tried


def test_a_chord_along_a_ball_is_a_slide_and_one_across_is_none() -> None:
    """Both ends on the ball: by less than a right angle a slide, whatever the chord cuts off; beyond it a passage."""
    ball = free(Sphere(np.zeros(3), 2.0))
    for angle in np.deg2rad([1, 30, 89, 97, 150, 180]):
        ends = [2.0 * np.array([math.sin(a), 0.0, math.cos(a)]) for a in (0.0, angle)]
        assert bool(crossings(ball, ends[0], ball, ends[1])) == (angle > math.pi / 2)


def test_a_point_that_was_open_may_graze_only() -> None:
    """A straight way at the distance b from the centre turns the normal by 2 acos(b/R)."""
    ball = free(Sphere(np.zeros(3), 1.0))
    for turn in np.deg2rad([0.1, 10, 20, 30, 60, 179]):
        b = math.cos(turn / 2)
        actual = crossings(ball, np.array([b, 0, -3.0]), ball, np.array([b, 0, 3.0]))
        assert bool(actual) == (math.cos(turn) < 0.9)
        if actual:
            half = math.sqrt(1 - b * b)
            assert (actual[0].enters, actual[0].leaves) == pytest.approx(((3 - half) / 6, (3 + half) / 6), abs=1e-8)
            assert "candidate 0 passes through the foundation" in str(actual[0])


def test_the_frame_moves_with_the_foundation() -> None:
    """A ball that comes by 3 radii past a point at rest is what a point sees that goes by 3 radii past a ball."""
    net = Net(Sphere(np.array([0.0, 0.0, 0.5]), 0.4), 3.0)
    ends = [net.problem_at(t).standing for t in (0.0, 1.0)]
    still = net.rest.u
    (actual,) = crossings(ends[0], still, ends[1], still)
    assert actual.candidate == 12  # the middle one of 25
    assert (actual.enters, actual.leaves) == pytest.approx((0.1 / 3, 0.9 / 3), abs=1e-8)
    np.testing.assert_allclose(
        ends[1].positions(still) - ends[0].positions(still), np.tile(3 * UP, (25, 1)), atol=1e-15
    )


def test_no_straight_way_leads_through_a_plane_or_out_of_a_hollow_ball(rng) -> None:
    net = Net(Sphere(np.array([0.0, 0.0, 0.5]), 0.4), 3.0)
    places = rng.normal(size=(400, 3))
    inside = places[np.linalg.norm(places, axis=1) < 1.4]
    hollow = free(Sphere(np.zeros(3), 1.5, hollow=True))
    assert crossings(hollow, inside.ravel(), hollow, inside[::-1].ravel()) == []
    plane = replace(net, foundation=RigidPlane(UP, 0.5)).problem_at(1.0)
    assert plane.standing is None
    assert crossings(plane.standing, net.rest.u, plane.standing, net.rest.u) == []


def test_points_that_glide_cost_little() -> None:
    """On a flat base as on a long drum, where every interval stays open: a bounded number of points is looked at."""
    asked = []

    def gap(y: np.ndarray) -> np.ndarray:
        asked.append(len(y))
        return y[:, 2]

    base = Standing(lambda u: u.reshape(-1, 3), gap, lambda y: np.tile(UP, (len(y), 1)))
    start = np.zeros((50, 3))
    assert crossings(base, start.ravel(), base, (start + np.array([1.0, 0, 0])).ravel()) == []
    assert sum(asked) < 50 * 600


# --- paths ------------------------------------------------------------------------------------------------------------


def path(seed: int) -> tuple[Net, PathPoint]:
    """A random obstacle on a net in one step asked for, or three."""
    rng = np.random.default_rng(seed)
    net = replace(falling(rng, KINDS[seed % 3]), by_arc=seed >= 34 and seed % 2 == 1)
    algorithm = hasty(ALGORITHMS[EXACT[int(rng.integers(len(EXACT)))]]())
    (point,) = follow(net.problem_at, 0.0, [1.0], algorithm, net.rest, int(rng.choice([1, 3])), smallest=2.0**-6)
    return net, point


def through(net: Net, point: PathPoint) -> list[int]:
    """Points that have passed through the foundation somewhere on the path, by means of their own."""
    seen = [net.seen(t, state.u) for t, state in point.way]
    return [i for before, after in pairwise(seen) for i in passing(net, before, after)[0]]


def passed(point: PathPoint) -> list[str]:
    return [str(each) for each in events(point.solution.history, EventKind.PASSED)]


@pytest.mark.parametrize(
    ("seeds", "cut", "arrived"),
    [
        (FEW[0], 1, 5),
        *(pytest.param(seeds, 1, 5, marks=pytest.mark.slow) for seeds in FEW[1:]),
        pytest.param(range(34, 94), 8, 49, marks=pytest.mark.slow),
    ],
    ids=["few", "more", "others", "last", "many"],
)
def test_nothing_passes_through_on_a_path(seeds, cut, arrived) -> None:
    """Of random balls, drums and bars, by means of its own.  cut, arrived: of so many paths, at the least."""
    cuts, ended = 0, []
    for seed in seeds:
        net, point = path(seed)
        assert [point.way[0][0], point.way[-1][0]] == [0.0, point.reached]
        np.testing.assert_array_equal(point.way[-1][1].u, point.solution.u)
        assert through(net, point) == []
        assert crossings_along((net.problem_at(t).standing, state.u) for t, state in point.way) == []
        cuts += bool(passed(point))
        ended.append(point.outcome)
        if not point.outcome.converged:
            assert str(point.solution.history[-1]["event"])
    assert cuts >= cut
    assert ended.count(Outcome.CONVERGED) >= arrived


BALL = Net(Sphere(np.array([0.0, 0.0, 0.31]), 0.3), 1.0)  # in front of the middle point at rest, 0.4 behind it at last


def test_without_the_check_the_ball_is_behind_the_net(monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing touches, which is an equilibrium by every other condition; with it the ball carries the net along."""
    (checked,) = follow(BALL.problem_at, 0.0, [1.0], ALGORITHMS["semismooth"](), BALL.rest)
    assert checked.outcome is Outcome.CONVERGED
    assert checked.solution.active.sum() == 1
    assert checked.solution.u[2 + 3 * 12] == pytest.approx(-0.99, abs=1e-9)
    monkeypatch.setattr(load_stepping, "passed_through", lambda *step: [])
    (blind,) = follow(BALL.problem_at, 0.0, [1.0], ALGORITHMS["semismooth"](), BALL.rest)
    assert blind.outcome is Outcome.CONVERGED
    assert judge(BALL.problem_at(1.0), blind.solution.u, blind.solution.pressure).failures() == []
    assert not blind.solution.active.any()
    assert through(BALL, blind) == [12]
    (actual,) = crossings_along((BALL.problem_at(t).standing, state.u) for t, state in blind.way)
    assert actual.candidate == 12


@dataclass(frozen=True)
class Jumping:
    """Puts the middle point behind the ball, however short the step."""

    name: str = "jumping"
    epsilon: float = math.inf

    def supports(self, problem: ContactProblem) -> str | None:
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        u = start.u.copy()
        u[2 + 3 * 12] = 0.62
        return replace(start, u=u, counters={"newton_iterations": 1})


def test_an_algorithm_that_jumps_is_refused_with_the_reason() -> None:
    (point,) = follow(BALL.problem_at, 0.0, [1.0], Jumping(), BALL.rest)
    assert (point.outcome, point.reached) == (Outcome.STEP_LIMIT, 0.0)
    noted = events(point.solution.history, EventKind.PASSED)
    assert len(noted) == 11
    assert all("candidate 12 passes through the foundation" in str(each) for each in noted)
    assert EventKind.PATH_END & noted[-1].kind


def test_a_point_of_an_arc_behind_the_ball_is_none() -> None:
    """Newton in displacement and travel finds the point in front of the ball; one that jumps is refused."""
    at, rest = replace(BALL, by_arc=True).problem_at, BALL.rest
    start = ArcPoint(rest.u, 0.0, pressure=rest.pressure, active=rest.active)
    ahead, normal = np.append(start.u, 0.2), np.append(np.zeros_like(start.u), 1.0)
    curve = PressedCurve(at, at(0.0).travel(), ALGORITHMS["semismooth"]())
    actual = curve.on_plane(start, ahead, normal, "in front")
    assert (actual.factor, actual.u[2 + 3 * 12]) == pytest.approx((0.2, -0.19), abs=1e-9)
    jumps = replace(curve, algorithm=Jumping())
    assert jumps.on_plane(start, ahead, normal, "behind") is None
    assert "candidate 12 passes through" in str(events(jumps.tally.history, EventKind.PASSED)[-1])


def test_linear_gaps_have_nothing_to_pass_through() -> None:
    """Published problems, at 101 points of every straight way between two admissible states: no gap below its ends."""
    for data in collection():
        problem = data.problem()
        begin = data.begin()
        solution = ALGORITHMS["semismooth"]().solve(problem, begin)
        ways = np.array([problem.gap(begin.u + s * (solution.u - begin.u)) for s in np.linspace(0, 1, 101)])
        assert problem.standing is None
        least = np.minimum(ways[0], ways[-1])
        assert np.all(ways >= least - 1e-12 * np.max(np.abs(ways)))


@pytest.mark.parametrize(
    ("foundation", "radius"),
    [
        (Sphere(np.zeros(3), 0.4), 0.4),
        (Sphere(np.zeros(3), 0.4, hollow=True), math.inf),
        (Drum(np.zeros(3), UP, 0.7), 0.7),
        (Profile(UP, 0.0, np.array([1.0, 0, 0]), 0.0, cleat(1.0, 2.0, 60.0, 0.2)), 0.2),
        (RigidPlane(UP, 0.0), math.inf),
    ],
)
def test_what_passes_between_nodes_is_told(foundation, radius) -> None:
    """Nodes that share 0.5 and 2 mm^2, that is 0.707 and 1.414 mm: those that touch say it, all where none does."""
    assert foundation.least_radius == radius
    place, shares = replace(free(foundation), least_radius=radius), np.array([0.5, 2.0])
    for touching, size in ((np.array([True, False]), 0.5**0.5), (np.array([False, False]), 2**0.5)):
        stated = between_nodes(place, shares, touching)
        assert bool(stated) == (radius < size)
        if stated:
            assert (
                f"{radius:.3g} mm, is below the size of an element there, {size:.3g} mm: only nodes are checked"
                in stated
            )
    assert between_nodes(None, shares, touching) == ""
