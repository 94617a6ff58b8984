"""Two faces against each other: gaps, rows and curvature by differences, balance, weights, and both searches."""

import math
from dataclasses import replace

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.faces.measured import distances
from contact.faces.pair import between
from contact.faces.sampling import OWN, PAIRINGS, clipped, joined, mortar
from contact.faces.search import nearest
from contact.interchange.linearised_step import freeze
from contact.interchange.oracle import minimise
from contact.problem import ContactSolution
from contact.verify import PAIR, judge
from support.problems.contact_problems import linear_mechanics
from support.problems.nets import are_derivatives, pair, sheet

ROUNDING = 1e-13
STEP = 1e-5
BY_DIFFERENCES = 2e-8  # of the size: central ones with that step
each_pairing = pytest.mark.parametrize("pairing", PAIRINGS)


@each_pairing
def test_rows_and_curvature_are_derivatives(pairing: str) -> None:
    """Above patches, above edges and above corners."""
    rng = np.random.default_rng(2)
    one = pair(pairing, side=0.9)
    u = 0.01 * rng.normal(size=one.operator.shape[1])
    at, force = one.at(u), rng.uniform(0.5, 1.0, len(one.weights))
    assert {0, 1, 2} == set(at.near.free.sum(axis=1).tolist())
    are_derivatives(one, u, force, rng.normal(size=(8, len(u))), STEP, BY_DIFFERENCES)


@each_pairing
def test_a_pair_has_no_resultant_and_no_moment(pairing: str) -> None:
    rng = np.random.default_rng(3)
    one = pair(pairing)
    u = 0.02 * rng.normal(size=one.operator.shape[1])
    forces, x = one.forces(u, rng.uniform(0.5, 1.0, len(one.weights))), one.positions(u)
    assert np.max(np.abs(forces)) > 0.1
    np.testing.assert_allclose(forces.sum(axis=0), 0, atol=ROUNDING)
    np.testing.assert_allclose(np.cross(x, forces).sum(axis=0), 0, atol=ROUNDING)


@each_pairing
def test_faces_that_lie_on_each_other_have_no_gap(pairing: str) -> None:
    """Far from the origin, where gaps of points are rounding: a set that begins closed is left closed."""
    one = pair(pairing, bent=0.0, noise=0.0, apart=0.0)
    one = replace(one, reference=one.reference + 1 / 3)
    at = one.at(np.zeros(one.operator.shape[1]))
    assert np.any(at.near.gap)
    assert not np.any(at.gap)


def test_both_searches_find_the_same_distances() -> None:
    """In front of a bent face, behind it, and beside its rim."""
    x, quads = sheet(6, 5, 1.0, 0.0, 0.3, up=True)
    points = np.random.default_rng(4).uniform(-1.5, 1.5, (300, 3)) * [1.0, 1.0, 0.4]
    actual, anew = nearest(points, x, quads), distances(points, x, quads)
    assert np.min(anew) < -0.1
    assert np.sum(~actual.free.all(axis=1)) > 50
    np.testing.assert_allclose(actual.gap, anew, rtol=0, atol=10 * ROUNDING)


@pytest.mark.parametrize("turn", [0, 1])
def test_both_searches_find_a_long_patch_beside_a_small_one(turn: int) -> None:
    """Between its ends and its middle, from where the small one is ten times as far as it."""
    x = np.array([[-6, 0, 0], [6, 0, 0], [6, 0.2, 0], [-6, 0.2, 0], [2.5, 1, 0], [3.5, 1, 0], [3.5, 2, 0], [2.5, 2, 0]])
    quads = np.stack([np.roll([0, 1, 2, 3], turn), np.array([4, 5, 6, 7])])
    point = np.array([[3.0, 0.1, 0.1]])
    np.testing.assert_allclose(distances(point, x, quads), 0.1, atol=1e-12)
    np.testing.assert_allclose(nearest(point, x, quads).gap, 0.1, atol=1e-12)


def test_a_point_at_a_corner_of_patches_that_are_turned_is_found() -> None:
    """No box is left out by the rounding of its turn."""
    x, quads = sheet(6, 5, 1.0, 0.0, 0.3, up=True)
    x += 100.0
    actual = nearest(x, x, quads)
    np.testing.assert_allclose(actual.gap, 0.0, atol=1e4 * ROUNDING)
    assert np.all([corner in quads[quad] for corner, quad in enumerate(actual.quad)])


def test_a_search_that_is_wrong_is_seen_by_the_judge() -> None:
    """One that looks at half of the master leaves gaps open that are not."""
    one = pair("nodes", bent=0.0, noise=0.0)
    n, m = one.operator.shape[1], len(one.weights)
    problem = between(linear_mechanics(np.eye(n), np.zeros(n)), replace(one, master=one.master[: len(one.master) // 2]))
    lowered = np.zeros((n // 3, 3))
    lowered[:m, 2] = np.where(one.reference[:m, 0] > 0.5, -0.11, 0.0)
    assert np.min(problem.gap(lowered.ravel())) > 0
    verdict = judge(replace(problem, faces=one), lowered.ravel(), np.zeros(m))
    assert verdict.penetration == pytest.approx(0.01)
    assert "penetration" in verdict.failures()


def test_pieces_of_flat_faces_have_all_of_their_area_and_the_loads_of_both() -> None:
    """The forces of a uniform pressure on the master: int N_l dA over what the slave covers, by brute force."""
    one = pair("mortar", bent=0.0, noise=0.0)
    u = np.zeros(one.operator.shape[1])
    np.testing.assert_allclose(one.sampling.average.sum(axis=1), 1.0, atol=ROUNDING)
    np.testing.assert_allclose(one.at(u).gap, 0.1, atol=ROUNDING)
    on_master = one.forces(u, one.weights)[len(one.weights) :, 2]
    t = (np.arange(4000) + 0.5) / 2000 - 1

    def shares(n: int) -> np.ndarray:
        lines = np.linspace(-1.2, 1.2, n + 1)
        return np.array([np.interp(t, lines, row).mean() * 2 for row in np.eye(n + 1)])

    np.testing.assert_allclose(on_master, -np.outer(shares(5), shares(3)).ravel(), atol=1e-7)


def test_what_lies_beyond_the_rim_of_the_master_is_no_part_of_an_area() -> None:
    """A slave that overhangs by a tenth on all sides: its weights are what is before the master."""
    one = pair("mortar", bent=0.0, noise=0.0, side=0.9)
    np.testing.assert_allclose(one.sampling.average.sum(axis=1), 1.0, atol=ROUNDING)
    assert one.weights.sum() == pytest.approx(1.8**2, rel=ROUNDING)
    np.testing.assert_allclose(one.at(np.zeros(one.operator.shape[1])).gap, 0.1, atol=ROUNDING)


def test_candidates_that_move_alike_are_one_with_their_mean_gap_and_the_sum_of_their_areas() -> None:
    one = pair("mortar")
    couples, u = joined(one.sampling, 2), np.zeros(one.operator.shape[1])
    areas, gaps = (each.reshape(-1, 2) for each in (one.weights, one.at(u).gap))
    np.testing.assert_allclose(couples.weights, areas.sum(axis=1), rtol=ROUNDING)
    actual = replace(one, sampling=couples).at(u).gap
    np.testing.assert_allclose(actual, (areas * gaps).sum(axis=1) / areas.sum(axis=1), rtol=1e-12)
    assert np.ptp(gaps, axis=1).max() > 1e-3
    assert couples.nodes.tolist() == one.nodes[::2].tolist()


def test_a_patch_that_turns_away_from_the_master_at_rest_has_points_all_over() -> None:
    """One upright sheet beside a flat one, which it may be laid on later."""
    above, below = sheet(2, 2, 1.0, 0.0, 0.0, up=False), sheet(3, 3, 1.0, 0.0, 0.0, up=True)
    turned = above[0] @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) + np.array([0.0, 0.0, 5.0])
    actual = mortar(np.vstack([turned, below[0]]), above[1], below[1] + len(turned), np.arange(len(turned)))
    assert actual.points.shape[0] == OWN**2 * len(above[1])
    assert actual.weights.sum() == pytest.approx(4.0, rel=ROUNDING)


def test_polygons_are_cut_by_polygons() -> None:
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    turned = 1.2 * square @ np.array([[1.0, 1.0], [-1.0, 1.0]]) / math.sqrt(2)
    polygon, count = clipped(np.stack([turned, square + np.array([1.5, 0.5]), square + 5.0]), np.stack([square] * 3))
    corners = [each[:n] for each, n in zip(polygon, count, strict=True)]
    areas = [abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2 for x, y in (c.T for c in corners)]
    np.testing.assert_allclose(areas, [4 - 2 * (2 - 1.2 * math.sqrt(2)) ** 2, 0.75, 0.0], atol=1e-12)


@each_pairing
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in ("semismooth", "lcp") else pytest.mark.slow)
        for name in ALGORITHMS
        if name != "regularised"
    ],
)
def test_algorithms_and_the_oracle_agree_on_two_nets(pairing: str, name: str) -> None:
    """Springs hold every point, those of the master stiffer: nodes alone do not settle where it folds under them."""
    one = pair(pairing, apart=0.05)
    n, m = one.operator.shape[1], len(one.weights)
    load = np.zeros((n // 3, 3))
    load[:m, 2] = -2.0 * one.weights
    K = np.eye(n) + 0.2 * np.diag(np.ones(n - 3), 3) + 0.2 * np.diag(np.ones(n - 3), -3)
    stiff = np.where(np.arange(n) < 3 * m, 1.0, 5.0 if pairing == "mortar" else 100.0)
    K *= np.sqrt(np.outer(stiff, stiff))
    problem = between(linear_mechanics(K, load.ravel()), one)
    solution = ALGORITHMS[name](epsilon=math.inf).solve(problem, ContactSolution.at_rest(n, m))
    assert solution.outcome.converged
    verdict = judge(problem, solution.u, solution.pressure)
    assert not verdict.failures()
    assert max(verdict.balances["pair_force"], verdict.balances["pair_moment"]) <= PAIR
    assert 3 < solution.active.sum() < m
    _, pressure = minimise(freeze(problem, solution.u, solution.pressure, {}))
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=1e-8 * np.max(pressure))
