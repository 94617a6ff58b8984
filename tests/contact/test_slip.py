"""The slip on a foundation that moves: a joint motion of body and foundation is none, and its derivative is right."""

import numpy as np
import pytest
from scipy import sparse

from contact.coulomb import Friction, Motion
from contact.obstacles.drum_sphere import Drum, Sphere
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import Linearised
from contact.slip import Slip, stretched, tangents
from support.problems.differences import central_difference

M = 5
EXACT = 1e-12  # of lengths of the order one


def without_mechanics(u: np.ndarray, memory: object) -> Linearised:
    raise TypeError("a slip is asked for, and nothing is solved")


def unit(rng) -> np.ndarray:
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


FOUNDATIONS = {
    "plane": lambda rng: RigidPlane(unit(rng), 0.4),
    "drum": lambda rng: Drum(rng.normal(size=3) + 4, unit(rng), 1.5),
    "sphere": lambda rng: Sphere(rng.normal(size=3) + 4, 1.5),
}


def motion(rng) -> Motion:
    return Motion(rng.normal(size=3), 2 * rng.normal(size=3), rng.normal(size=3))


def slip(rng, which: str, moved: Motion) -> Slip:
    x = rng.normal(size=(M, 3))
    candidates = Candidates(x, sparse.csr_matrix(np.eye(3 * M)), np.ones(M))
    return Slip(candidates, FOUNDATIONS[which](rng), moved, x + 0.1 * rng.normal(size=(M, 3)))


def test_a_joint_motion_of_body_and_foundation_changes_nothing(rng) -> None:
    for which in FOUNDATIONS:
        at_rest, u, moved = slip(rng, which, Motion.none()), 0.2 * rng.normal(size=3 * M), motion(rng)
        x = at_rest.candidates.positions(u)
        carried = (moved.out(x) - at_rest.candidates.reference).ravel()
        there = Slip(at_rest.candidates, at_rest.foundation, moved, at_rest.anchors)
        assert np.max(np.abs(carried - u)) > 0.1
        np.testing.assert_allclose(there(carried), at_rest(u), rtol=0, atol=EXACT)
        np.testing.assert_allclose(there.places(carried), x, rtol=0, atol=EXACT)
        turned = at_rest.jacobian(u).toarray() @ np.kron(np.eye(M), moved.rotation.T)
        np.testing.assert_allclose(there.jacobian(carried).toarray(), turned, rtol=0, atol=EXACT)


def test_what_stays_on_its_anchor_does_not_slip(rng) -> None:
    for which in FOUNDATIONS:
        slips = slip(rng, which, motion(rng))
        carried = (slips.motion.out(slips.anchors) - slips.candidates.reference).ravel()
        np.testing.assert_allclose(slips(carried), 0.0, rtol=0, atol=EXACT)


@pytest.mark.parametrize("which", FOUNDATIONS)
def test_its_derivative_and_its_frame(which, rng) -> None:
    slips, u, du = slip(rng, which, motion(rng)), rng.normal(size=3 * M), rng.normal(size=3 * M)
    difference = central_difference(lambda h: slips(u + h * du).ravel(), 1e-3)
    np.testing.assert_allclose(slips.jacobian(u) @ du, difference, rtol=0, atol=1e-9)
    normals = slips.foundation.gradient(slips.anchors)
    frame = np.concatenate([slips.directions, (normals / np.linalg.norm(normals, axis=1)[:, None])[:, None]], axis=1)
    np.testing.assert_allclose(frame @ np.swapaxes(frame, 1, 2), np.tile(np.eye(3), (M, 1, 1)), rtol=0, atol=EXACT)


def test_a_foundation_that_travels_in_its_plane_is_slip_of_a_body_at_rest() -> None:
    """The body stays, the foundation moves by d along x: the candidate comes -d along it, and not across."""
    x = np.array([[0.3, -0.2, 0.0]])
    candidates = Candidates(x, sparse.csr_matrix(np.eye(3)), np.ones(1))
    travelled = Motion(np.array([0.25, 0.0, 0.0]), np.zeros(3), np.zeros(3))
    slips = Slip(candidates, RigidPlane(np.array([0.0, 0.0, -1.0]), 0.0), travelled, x)
    across = slips.directions[0] @ np.array([1.0, 0.0, 0.0])
    np.testing.assert_allclose(slips(np.zeros(3))[0], -0.25 * across, rtol=0, atol=EXACT)
    assert np.linalg.norm(slips(np.zeros(3))) == pytest.approx(0.25)


def test_tangents_of_any_normal(rng) -> None:
    normals = np.vstack([np.eye(3), -np.eye(3), [unit(rng) for _ in range(20)]])
    frames = np.concatenate([tangents(normals), normals[:, None]], axis=1)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, rtol=0, atol=EXACT)


def test_springs_leave_the_anchors_from_which_they_are_stretched(rng) -> None:
    """Friction -epsilon w s is that of springs stretched by s, and the next step counts the slip s where it begins."""
    slips, u, s = slip(rng, "plane", motion(rng)), rng.normal(size=3 * M), rng.normal(size=(M, 2))
    plane, w = slips.foundation, rng.uniform(0.1, 2.0, M)
    problem = against(without_mechanics, Candidates(slips.candidates.reference, slips.candidates.operator, w), plane)
    np.testing.assert_allclose(stretched(problem, -3.0 * w[:, None] * s, 3.0), s, rtol=1e-14)
    np.testing.assert_allclose(slips.since(slips.left(u, s))(u), s, rtol=0, atol=EXACT * 10)


def test_friction_of_the_chosen_comes_back_in_their_places(rng) -> None:
    whole = Friction(rng.normal(size=(M, 2)), np.ones(M, int), rng.normal(size=(M, 3)), rng.normal(size=(M, 3)), 2.0)
    chosen, now = np.array([True, False, True, True, False]), rng.normal(size=(M, 3))
    actual = whole.only(chosen).of_all(chosen, now)
    for name, other in (("force", 0.0), ("state", 0), ("since", now), ("anchors", now)):
        mine = np.reshape(chosen, (M,) + (1,) * (getattr(whole, name).ndim - 1))
        np.testing.assert_array_equal(getattr(actual, name), np.where(mine, getattr(whole, name), other))
    assert actual.dissipation == 2.0


def test_what_supports_leave_one_way_has_that_way_first_and_no_other(rng) -> None:
    """Along (1, 1, 0) and up: two unknowns, of which the plane sees one way."""
    along = np.array([1.0, 1.0, 0.0]) / np.sqrt(2)
    operator = sparse.csr_matrix(np.column_stack([along, [0.0, 0.0, 1.0]]))
    candidates = Candidates(np.zeros((1, 3)), operator, np.ones(1))
    slips = Slip(candidates, RigidPlane(np.array([0.0, 0.0, -1.0]), 0.0), Motion.none(), np.zeros((1, 3)))
    np.testing.assert_allclose(np.abs(slips.directions[0, 0]), np.abs(along), rtol=0, atol=EXACT)
    np.testing.assert_array_equal(slips.jacobian(np.zeros(2)).toarray()[1], 0.0)
