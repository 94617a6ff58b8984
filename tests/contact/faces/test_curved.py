"""Faces that are curved between their points: heights over patches, gaps and their derivatives, balance, the judge."""

from dataclasses import replace

import numpy as np
import pytest

from contact.balances import pair_balance
from contact.faces.bulges import Bulges, blend
from contact.faces.pair import Pair, between
from contact.faces.sampling import PAIRINGS
from support.problems.contact_problems import linear_mechanics
from support.problems.nets import are_derivatives, pair, sheet

ROUNDING = 1e-13
STEP = 3e-6
BY_DIFFERENCES = 3e-8  # of the size: central ones with that step
ALIKE = 1e-12
RADIUS = 5.0
HELD = np.diag([0.0, 1.0, 1.0])
each_pairing = pytest.mark.parametrize("pairing", PAIRINGS)


def curved(pairing: str, side: float = 1.2, mirrored: bool = False) -> Pair:
    """The two sheets, curved; mirrored: supports hold the first rim of both across it."""
    one, patches = pair(pairing, side=side, noise=0.02), sheet(3, 4, 1.0, 0.1, 0.1, up=False)[1]
    free = np.tile(np.eye(3), (len(one.reference), 1, 1))
    if mirrored:
        free[:5] = free[20:24] = HELD
    bulges = Bulges.of(one.reference, np.concatenate([patches, one.master]), free)
    return replace(one, slave=patches, bulges=bulges)


@pytest.mark.parametrize("mirrored", [False, True])
@each_pairing
def test_rows_and_curvature_are_derivatives(pairing: str, mirrored: bool) -> None:
    """Above patches, above edges and above corners, with planes of symmetry and without."""
    rng = np.random.default_rng(2)
    one = curved(pairing, side=0.9, mirrored=mirrored)
    assert len(one.mirrors) == 9 * mirrored
    u = 0.01 * rng.normal(size=one.operator.shape[1])
    at, force = one.at(u), rng.uniform(0.5, 1.0, len(one.weights))
    assert {0, 1, 2} == set(at.near.free.sum(axis=1).tolist())
    assert np.max(np.abs(at.gap - replace(one, bulges=None).at(u).gap)) > 1e-3
    are_derivatives(one, u, force, rng.normal(size=(8, len(u))), STEP, BY_DIFFERENCES)


def test_second_derivatives_of_the_blend() -> None:
    rng = np.random.default_rng(0)
    xi, way = rng.uniform(-1, 1, (2, 20, 2))
    (more, more_by, _), (less, less_by, _) = blend(xi + STEP * way), blend(xi - STEP * way)
    _, first, second = blend(xi)
    np.testing.assert_allclose(np.einsum("pea,pa->pe", first, way), (more - less) / (2 * STEP), atol=1e-9)
    np.testing.assert_allclose(np.einsum("peab,pb->pea", second, way), (more_by - less_by) / (2 * STEP), atol=1e-9)


@pytest.mark.parametrize(("mirrored", "axes"), [(False, 3), (True, 1)])
@each_pairing
def test_forces_balance(pairing: str, mirrored: bool, axes: int) -> None:
    """A plane of symmetry carries moments, but not that about its normal, and no force."""
    rng = np.random.default_rng(3)
    one = curved(pairing, mirrored=mirrored)
    u, nodal = 0.02 * rng.normal(size=one.operator.shape[1]), rng.uniform(0.5, 1.0, len(one.weights))
    forces, x = one.forces(u, nodal), one.positions(u)
    moment = np.cross(x, forces).sum(axis=0)
    np.testing.assert_allclose(forces.sum(axis=0), 0, atol=ROUNDING)
    np.testing.assert_allclose(forces[:20].sum(axis=0), one.resultant(u, nodal), atol=ROUNDING)
    np.testing.assert_allclose(moment[:axes], 0, atol=ROUNDING)
    assert (np.max(np.abs(moment)) > 1e-4) == mirrored
    actual = pair_balance(between(linear_mechanics(np.eye(len(u)), np.zeros(len(u))), one), u, nodal / one.weights)
    assert max(each for each in actual if each is not None) <= ROUNDING


def test_planes_of_symmetry_that_cross_leave_no_moment_to_judge() -> None:
    """Not that it is zero."""
    one = curved("mortar", mirrored=True)
    assert one.bulges is not None
    across = np.vstack([one.mirrors, [0.0, 1.0, 0.0]])
    crossed = replace(one, bulges=replace(one.bulges, across=across))
    u, pressure = np.zeros(one.operator.shape[1]), np.ones(len(one.weights))
    force, moment = pair_balance(between(linear_mechanics(np.eye(len(u)), u), crossed), u, pressure)
    assert force is not None
    assert force <= ROUNDING
    assert moment is None


@each_pairing
def test_the_judge_measures_the_same_gaps(pairing: str) -> None:
    """Normals, heights and feet of perpendiculars by other ways."""
    one = curved(pairing, side=0.9)
    u = 0.02 * np.random.default_rng(5).normal(size=one.operator.shape[1])
    np.testing.assert_allclose(one.measured(u), one.at(u).gap, rtol=0, atol=ALIKE)


@pytest.mark.parametrize(("across", "apart"), [(np.eye(2), 0.02), (np.array([[0.8, 0.6]]), 0.2)])
def test_heights_are_right_to_the_third_order(across: np.ndarray, apart: float) -> None:
    """Of a sphere, and of a cylinder askew; those of distorted patches to a share of them."""
    errors = [_worst_height(count, 0.0, across) for count in (8, 16, 32)]
    assert np.min(np.log2(np.divide(errors[:-1], errors[1:]))) > 3.7
    height = (2 / 32) ** 2 / (8 * RADIUS) * np.sum(across**2)
    assert errors[-1] <= 1e-4 * height
    assert apart / 2 * height <= _worst_height(32, 0.15, across) <= apart * height


def _worst_height(count: int, distorted: float, across: np.ndarray) -> float:
    """Of the points in the middle of patches, away from rims, of a face that curves along the rows of ``across``."""
    points, patches = sheet(count, count, 1.0, 0.0, 0.0, up=True)
    inner = np.max(np.abs(points[:, :2]), axis=1) < 1
    points[inner, :2] += distorted / count * np.random.default_rng(1).uniform(-1, 1, (inner.sum(), 2))
    points[:, 2] = np.sqrt(RADIUS**2 - np.sum((points[:, :2] @ across.T) ** 2, axis=1))
    heights = Bulges.of(points, patches, np.tile(np.eye(3), (len(points), 1, 1))).at(points).k.reshape(-1, 4)
    whole = inner[patches].all(axis=1)
    actual, middle = heights[whole] @ blend(np.zeros((1, 2)))[0][0], points[patches[whole]].mean(axis=1)
    return float(
        np.max(np.abs(actual - RADIUS + np.hypot(np.linalg.norm(middle[:, :2] @ across.T, axis=1), middle[:, 2])))
    )


def test_a_crease_and_a_flat_face_have_no_heights() -> None:
    """A roof of two plane sides of one patch or more, and a plane of patches of any shape."""
    points, patches = sheet(4, 3, 1.0, 0.0, 0.0, up=True)
    points[:, :2] += 0.1 * np.random.default_rng(1).normal(size=(len(points), 2))
    free = np.tile(np.eye(3), (len(points), 1, 1))
    assert np.max(np.abs(Bulges.of(points, patches, free).at(points).k)) <= ROUNDING
    for count in (2, 4):
        roof, patches = sheet(count, 3, 1.0, 0.0, 0.0, up=True)
        roof[:, 2] = -0.6 * np.abs(roof[:, 0])
        free = np.tile(np.eye(3), (len(roof), 1, 1))
        assert np.max(np.abs(Bulges.of(roof, patches, free).at(roof).k)) <= ROUNDING


@pytest.mark.parametrize(
    ("left", "mirrors"),
    [((0, 1, 1), 4), ((1, 0, 1), 0), ((1, 0, 0), 0), ((1, 1, 0), 0), ((0, 0, 0), 0), ((1, 1, 1), 0)],
)
def test_only_what_holds_a_rim_across_itself_is_a_plane_of_symmetry(left: tuple[int, ...], mirrors: int) -> None:
    """Of a rim along y of a sheet that looks along z: not a hard diaphragm, a hinge, a roller or a clamp."""
    points, patches = sheet(4, 3, 1.0, 0.0, 0.1, up=True)
    free = np.tile(np.eye(3), (len(points), 1, 1))
    free[:4] = np.diag(np.array(left, float))
    actual = Bulges.of(points, patches, free)
    assert np.abs(actual.across).tolist() == [[1.0, 0.0, 0.0]] * mirrors
    assert np.sum(np.any(actual.ways != np.eye(3), axis=(1, 2))) == mirrors


@pytest.mark.parametrize("radius", [1.0, 7.3, 100.5])
def test_patches_that_turn_by_thirty_degrees_are_no_crease_by_rounding(radius: float) -> None:
    """Half a tube of six, each with k = 2 sin^2(15) of the radius by the normals at both ends, or the inner one."""
    points, patches = sheet(6, 1, 1.0, 0.0, 0.0, up=True)
    angle = np.pi / 2 * (points[:, 0] + 1)
    points = radius * np.column_stack([-np.cos(angle), points[:, 1] / 3, np.sin(angle)])
    heights = Bulges.of(points, patches, np.tile(np.eye(3), (len(points), 1, 1))).at(points).k.reshape(-1, 4)
    around = heights[:, [0, 2]]
    np.testing.assert_allclose(around, radius * (1 - np.cos(np.pi / 6)), rtol=1e-12)
    np.testing.assert_allclose(heights[:, [1, 3]], 0, atol=ROUNDING * radius)
