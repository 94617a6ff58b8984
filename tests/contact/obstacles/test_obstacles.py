"""Drum, sphere, step and cleat: gap by brute force, gradient, curvature and whole tangents by differences."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy import sparse

from contact.obstacles.cleat import Arc, Line, Profile, cleat, rounded
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import Candidates, Foundation, RigidPlane, against
from support.problems.contact_problems import linear_mechanics
from support.problems.differences import central_difference
from support.problems.falling import rounded_height

ROUNDING = 1e-12
BRUTE = 1e-9  # of distances of the order one, by a search that narrows to 1e-6 (an error of its square)
GRADIENT = 1e-9  # central differences of the order 8
CURVATURE = 1e-7
NORMAL, TRAVEL = np.array([2.0, 3.0, 6.0]) / 7, np.array([6.0, 2.0, -3.0]) / 7
AXIS = np.cross(NORMAL, TRAVEL)
CENTRE = np.array([0.3, -0.2, 0.5])
RADIUS, HEIGHT, TOP, FLANK, ROUND = 1.4, 0.5, 0.8, 70.0, 0.2


def step(height: float, flank_deg: float, radius: float) -> tuple[Line | Arc, ...]:
    """A kerb that rises at s = 0 and stays up."""
    return rounded([(0.0, 0.0), (height / math.tan(math.radians(flank_deg)), height)], radius)


FOUNDATIONS: dict[str, Foundation] = {
    "plane": RigidPlane(NORMAL, 0.7),
    "drum": Drum(CENTRE, AXIS, RADIUS),
    "hollow drum": Drum(CENTRE, AXIS, RADIUS, hollow=True),
    "sphere": Sphere(CENTRE, RADIUS),
    "hollow sphere": Sphere(CENTRE, RADIUS, hollow=True),
    "cleat": Profile(NORMAL, 0.1, TRAVEL, 0.2, cleat(HEIGHT, TOP, FLANK, ROUND)),
    "box": Profile(NORMAL, 0.1, TRAVEL, 0.2, cleat(HEIGHT, TOP, 90.0, ROUND)),
    "step": Profile(NORMAL, 0.1, TRAVEL, 0.2, step(HEIGHT, 40.0, 2 * ROUND)),
}
each_foundation = pytest.mark.parametrize("name", FOUNDATIONS)


def profile_corners(name: str) -> tuple[list[tuple[float, float]], float]:
    if name == "step":
        return [(0, 0), (HEIGHT / math.tan(math.radians(40)), HEIGHT)], 2 * ROUND
    foot = TOP / 2 + HEIGHT / math.tan(math.radians(FLANK))
    return [(-foot, 0), (-TOP / 2, HEIGHT), (TOP / 2, HEIGHT), (foot, 0)], ROUND


def surface(name: str) -> tuple[Callable[[np.ndarray, np.ndarray], np.ndarray], tuple[float, float, float, float]]:
    """Points of the surface by two parameters, and their range."""
    if name == "plane":
        return (lambda a, b: 0.7 * NORMAL + a[..., None] * TRAVEL + b[..., None] * AXIS), (-4, 4, -4, 4)
    if "drum" in name:

        def drum(a, b):
            return (
                CENTRE + RADIUS * (np.cos(a)[..., None] * NORMAL + np.sin(a)[..., None] * TRAVEL) + b[..., None] * AXIS
            )

        return drum, (-math.pi, math.pi, -4, 4)
    if "sphere" in name:

        def ball(a, b):
            flat = np.cos(a)[..., None] * NORMAL + np.sin(a)[..., None] * TRAVEL
            return CENTRE + RADIUS * (np.cos(b)[..., None] * flat + np.sin(b)[..., None] * AXIS)

        return ball, (-math.pi, math.pi, -math.pi / 2, math.pi / 2)
    height = rounded_height(*profile_corners(name))

    def prism(a, b):
        t = height(a.ravel()).reshape(a.shape)
        return (0.2 + a)[..., None] * TRAVEL + (0.1 - t)[..., None] * NORMAL + b[..., None] * AXIS

    return prism, (-4, 4, -4, 4)


def brute_distance(name: str, x: np.ndarray) -> float:
    """Least distance of one point: a grid over the surface, then finer ones about its best points."""
    points, (a0, a1, b0, b1) = surface(name)
    a, b = np.meshgrid(np.linspace(a0, a1, 801), np.linspace(b0, b1, 81), indexing="ij")
    d = np.linalg.norm(points(a, b) - x, axis=-1)
    best = np.inf
    nearest = np.argpartition(d, 280, axis=None)[:280]
    starts = nearest[np.argsort(d.ravel()[nearest])][::20]
    for start in starts:
        centre = a.ravel()[start], b.ravel()[start]
        size = (a1 - a0) / 800 * 2, (b1 - b0) / 80 * 2
        for _ in range(10):
            fine = [np.linspace(c - s, c + s, 13) for c, s in zip(centre, size, strict=True)]
            A, B = np.meshgrid(*fine, indexing="ij")
            near = np.linalg.norm(points(A, B) - x, axis=-1)
            k = np.argmin(near)
            centre, size = (A.ravel()[k], B.ravel()[k]), (size[0] / 4, size[1] / 4)
        best = min(best, float(near.ravel()[k]))
    return best


def is_open(name: str, x: np.ndarray) -> bool:
    """Whether a point is outside the material, by what each body is."""
    if name == "plane":
        return bool(x @ NORMAL < 0.7)
    r = x - CENTRE
    if "drum" in name:
        return bool((np.linalg.norm(np.cross(r, AXIS)) > RADIUS) != ("hollow" in name))
    if "sphere" in name:
        return bool((np.linalg.norm(r) > RADIUS) != ("hollow" in name))
    s, t = x @ TRAVEL - 0.2, 0.1 - x @ NORMAL
    return bool(t > rounded_height(*profile_corners(name))(np.array([s]))[0])


@pytest.mark.parametrize("name", [name for name in FOUNDATIONS if name != "box"])
def test_gap_is_the_distance_by_brute_force(name, rng) -> None:
    """Against a search over the surface written down otherwise; points outside and inside the material."""
    x = CENTRE + rng.uniform(-1.3, 1.3, (16, 3))
    signed = [(1 if is_open(name, point) else -1) * brute_distance(name, point) for point in x]
    assert min(signed) < -0.05
    assert max(signed) > 0.05
    np.testing.assert_allclose(FOUNDATIONS[name].gap(x), signed, rtol=0, atol=BRUTE)


def test_gap_of_a_box_by_its_corners() -> None:
    """A cleat with upright sides, at points whose nearest point is plain: sides, top, base, edges and feet."""
    box = FOUNDATIONS["box"]
    edge = ROUND * (math.sqrt(2) - 1)  # from the sharp corner to the arc along the diagonal
    seen = {  # (s, t): distance
        (0.0, 0.9): 0.4,
        (TOP / 2 + 0.07, 0.25): 0.07,
        (-TOP / 2 + 0.1, 0.26): -0.1,
        (3.0, 0.4): 0.4,
        (3.0, -0.4): -0.4,
        (TOP / 2 + 0.3, HEIGHT + 0.3): 0.3 * math.sqrt(2) + edge,
        (TOP / 2 + ROUND, ROUND): ROUND,
        (TOP / 2 + ROUND / 2, ROUND / 2): ROUND * (1 - math.sqrt(0.5)),
        (TOP / 2, 0.0): -edge,
    }
    x = np.array([(s + 0.2) * TRAVEL + (0.1 - t) * NORMAL + 0.4 * AXIS for s, t in seen])
    np.testing.assert_allclose(box.gap(x), list(seen.values()), rtol=0, atol=ROUNDING)


def smooth_points(foundation: Foundation, rng: np.random.Generator) -> np.ndarray:
    """Points near the surface, where the nearest point is unique, and none within a difference of a joint."""
    x = CENTRE + rng.uniform(-1.5, 1.5, (4000, 3))
    x = x[np.abs(foundation.gap(x)) < 0.8 * ROUND]
    ring = 2e-2 * np.concatenate([np.eye(3), -np.eye(3)])
    bends = np.array([foundation.curvature(x + shift) for shift in ring])
    calm = np.max(np.abs(bends - foundation.curvature(x)), axis=(0, 2, 3)) < 0.6
    return x[calm]


@each_foundation
def test_gradient_and_curvature_by_differences(name, rng) -> None:
    foundation = FOUNDATIONS[name]
    x = smooth_points(foundation, rng)
    assert len(x) > 60
    n, H = foundation.gradient(x), foundation.curvature(x)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, rtol=0, atol=ROUNDING)
    for i, e in enumerate(np.eye(3)):
        slope = central_difference(lambda h, e=e: foundation.gap(x + h * e), 2e-3)
        np.testing.assert_allclose(n[:, i], slope, rtol=0, atol=GRADIENT)
        bend = central_difference(lambda h, e=e: foundation.gradient(x + h * e), 2e-3)
        np.testing.assert_allclose(H[:, :, i], bend, rtol=0, atol=CURVATURE)
    curved = {"plane": 0, "drum": 1, "hollow drum": -1, "sphere": 1, "hollow sphere": -1}
    if name in curved:
        assert np.all(np.sign(np.round(np.trace(H, axis1=1, axis2=2), 9)) == curved[name])
    else:
        assert {-1, 0, 1} == set(np.sign(np.round(np.trace(H, axis1=1, axis2=2), 9)))


def test_the_gap_never_changes_faster_than_the_point(rng) -> None:
    """What the choice of candidates rests on, near and far, also where the gradient jumps."""
    for name in FOUNDATIONS:
        foundation = FOUNDATIONS[name]
        x, y = (CENTRE + 3 * rng.normal(size=(4000, 3)) for _ in range(2))
        change = np.abs(foundation.gap(x) - foundation.gap(y))
        assert np.all(change <= np.linalg.norm(x - y, axis=1) + ROUNDING)


def test_a_moved_foundation_sees_the_points_moved_back(rng) -> None:
    for name in FOUNDATIONS:
        foundation, by, x = FOUNDATIONS[name], rng.normal(size=3), CENTRE + rng.normal(size=(50, 3))
        for quantity in ("gap", "gradient", "curvature"):
            there, here = getattr(foundation.moved(by), quantity)(x), getattr(foundation, quantity)(x - by)
            np.testing.assert_allclose(there, here, rtol=0, atol=1e-10)


@pytest.mark.parametrize("hollow", [False, True])
@pytest.mark.parametrize("make", [lambda h: Drum(CENTRE, AXIS, RADIUS, h), lambda h: Sphere(CENTRE, RADIUS, h)])
def test_the_axis_has_a_distance_and_some_direction(make, hollow) -> None:
    foundation, x = make(hollow), CENTRE[None] + 0.0
    assert foundation.gap(x) == pytest.approx(RADIUS if hollow else -RADIUS)
    assert np.linalg.norm(foundation.gradient(x)) == pytest.approx(1)
    assert np.all(foundation.curvature(x) == 0)


IMPOSSIBLE = (
    (lambda: Drum(CENTRE, 2 * AXIS, 1.0), "unit vector"),
    (lambda: Drum(CENTRE, AXIS, 0.0), "radius"),
    (lambda: Sphere(CENTRE, math.nan), "radius"),
    (lambda: Sphere(CENTRE, math.inf), "radius"),
    (lambda: Profile(NORMAL, 0.0, NORMAL, 0.0, step(1, 45, 0.1)), "base plane"),
    (lambda: cleat(0.0, 1.0, 45, 0.1), "height"),
    (lambda: cleat(1.0, 1.0, 100, 0.1), "flank_deg"),
    (lambda: cleat(1.0, -1.0, 45, 0.1), "top"),
    (lambda: cleat(1.0, 1.0, 90, 0.6), "rounding of 0.6"),
    (lambda: cleat(4.0, 0.2, 90, 0.5), "needs 1 mm of a line that has 0.2"),
    (lambda: rounded([(0, 0), (-1, 1)], 0.1), "advance"),
    (lambda: rounded([(0, 0), (1, 0)], 0.1), "turn"),
)


def test_impossible_foundations_are_refused() -> None:
    for make, message in IMPOSSIBLE:
        with pytest.raises(ValueError, match=message):
            make()


def test_pieces_meet_with_one_tangent() -> None:
    for pieces in (cleat(HEIGHT, TOP, FLANK, ROUND), cleat(0.4, 0.4, 90.0, 0.2), step(HEIGHT, 30.0, 0.1)):
        assert [type(piece) for piece in pieces] == [Line, *[Arc, Line] * (len(pieces) // 2)]
        for before, after in pairwise(pieces):
            line, arc, end = (before, after, "high") if isinstance(before, Line) else (after, before, "low")
            joint = np.array(line.start) + getattr(line, end) * np.array(line.direction)
            assert arc.distance(joint[None])[0] <= ROUNDING
            (g_line, n_line, _), (g_arc, n_arc, _) = line.local(joint[None]), arc.local(joint[None])
            np.testing.assert_allclose([g_arc, g_line], 0, rtol=0, atol=ROUNDING)
            np.testing.assert_allclose(n_arc, n_line, rtol=0, atol=ROUNDING)


# --- the contact problem ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "coupling"), [*((name, False) for name in FOUNDATIONS if name != "plane"), ("sphere", True)]
)
def test_tangent_of_a_whole_problem(name, coupling, rng) -> None:
    """d(r - G^T W p)/du = K - gap_curvature(u, W p) at arbitrary pressures, by differences."""
    foundation = FOUNDATIONS[name]
    x = smooth_points(foundation, rng)
    bent = np.any(foundation.curvature(x) != 0, axis=(1, 2))
    x = np.concatenate([x[bent][:9], x[~bent][:3]])
    m = len(x)
    A = sparse.csr_matrix(np.eye(3 * m) + 0.3 * np.eye(3 * m, k=2))
    W = np.diag(rng.uniform(0.5, 2, m)) + (0.2 * np.eye(m, k=1) if coupling else 0)
    candidates = Candidates(x, A, np.diag(W).copy(), sparse.csr_matrix(W) if coupling else None)
    K = rng.normal(size=(3 * m, 3 * m))
    problem = against(linear_mechanics(K, np.zeros(3 * m)), candidates, foundation)
    u, p = np.zeros(3 * m), np.where(np.arange(m) % 4 == 1, 0.0, rng.uniform(0.5, 2, m))
    du = rng.normal(size=3 * m)
    du *= 0.3 / np.linalg.norm(A @ du)

    def imbalance(h: float) -> np.ndarray:
        return problem.linearise(u + h * du, None).residual - problem.contact_force(u + h * du, p)

    tangent = K @ du - problem.gap_curvature(u, problem.nodal_forces(p)) @ du
    np.testing.assert_allclose(tangent, central_difference(imbalance, 5e-3), rtol=0, atol=10 * CURVATURE)
    slope = central_difference(lambda h: problem.gap(u + h * du), 5e-3)
    np.testing.assert_allclose(problem.gap_jacobian(u) @ du, slope, rtol=0, atol=10 * GRADIENT)
    assert np.max(np.abs(problem.gap_curvature(u, problem.nodal_forces(p)) @ du)) > 1e-2  # not a test of nothing
    np.testing.assert_allclose(problem.directions(u), foundation.gradient(candidates.positions(u)))
