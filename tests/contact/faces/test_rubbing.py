"""Friction between two faces: the slip and its derivatives, joint motions, anchors, answers of all algorithms."""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import by_the_exact_law
from contact.continuation.candidates import laid
from contact.coulomb import Motion, State
from contact.faces.pair import Pair, between
from contact.faces.rubbing import Rubbing
from contact.faces.rubbings import rubbed
from contact.faces.sampling import at_nodes
from contact.interchange.friction_oracle import confirm
from contact.interchange.linearised_step import FrozenFrictionalStep, freeze
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactProblem, ContactSolution, linear_mechanics
from contact.slip import anchors_left, slip_of, with_friction
from contact.verify import PAIR, judge
from support.problems.differences import central_difference
from support.problems.nets import pair, sheet

ROUNDING = 1e-13
DIGITS = 1e-12  # of positions and forces of the order one, at the end of an iteration
STEP, SLIPS = 1e-4, 1e-10  # of central differences


def rubbing(seed: int, bent: float = 0.2, moved: float = 0.1) -> tuple[Rubbing, np.ndarray]:
    """Sheets that are bent and not even, the upper one beyond the rim of the lower, and where they are next."""
    rng = np.random.default_rng(seed)
    one = pair("nodes", bent=bent, noise=0.03, side=0.9)
    u = 0.02 * rng.normal(size=one.operator.shape[1])
    begun = Rubbing(one, one.nodes, np.zeros((len(one.nodes), 3)))
    return begun.since(begun.places(u)), u + moved * rng.normal(size=len(u))


def test_where_a_candidate_is_it_has_not_slipped() -> None:
    slip, _ = rubbing(0)
    u = 0.02 * np.random.default_rng(0).normal(size=slip.pair.operator.shape[1])
    assert np.any(np.abs(slip.anchors[:, 1:]) > 1)  # beside the rim, on patches that are continued
    np.testing.assert_allclose(slip(u), 0, atol=ROUNDING)


def test_rows_and_curvature_are_derivatives_of_the_slip() -> None:
    slip, u = rubbing(1)
    t = np.random.default_rng(2).normal(size=slip(u).shape)
    assert np.max(np.abs(slip(u))) > 0.2
    for way in np.random.default_rng(3).normal(size=(4, len(u))):
        ds = central_difference(lambda d, way=way: slip(u + d * way).ravel(), STEP)
        np.testing.assert_allclose(slip.jacobian(u) @ way, ds, rtol=0, atol=SLIPS)
        bent = central_difference(lambda d, way=way: slip.jacobian(u + d * way).T @ t.ravel(), STEP)
        assert np.max(np.abs(bent)) > 1.0
        np.testing.assert_allclose(slip.curvature(u, t) @ way, bent, rtol=0, atol=SLIPS * np.max(np.abs(bent)))


def test_the_judge_measures_the_same_slip_another_way() -> None:
    slip, u = rubbing(3)
    np.testing.assert_allclose(slip.measured(u), slip(u), rtol=0, atol=ROUNDING)


def test_a_joint_motion_of_both_bodies_is_no_slip_and_turns_forces_with_them() -> None:
    rng = np.random.default_rng(4)
    slip, u = rubbing(4)
    x, t = slip.pair.positions(u), rng.normal(size=(len(slip.nodes), 2))
    motion = Motion(rng.normal(size=3), 2 * rng.normal(size=3), rng.normal(size=3))
    carried = (motion.out(x) - slip.pair.reference).ravel()
    np.testing.assert_allclose(slip(carried), slip(u), rtol=0, atol=10 * ROUNDING)
    np.testing.assert_allclose(slip.since(slip.places(carried))(u), 0, atol=10 * ROUNDING)
    turned = slip.forces(u, t) @ motion.rotation.T
    np.testing.assert_allclose(slip.forces(carried, t), turned, rtol=0, atol=100 * ROUNDING)


def test_friction_has_no_resultant_and_no_moment_and_its_size_on_the_slave() -> None:
    slip, u = rubbing(5)
    t = np.random.default_rng(5).normal(size=(len(slip.nodes), 2))
    forces, x = slip.forces(u, t), slip.pair.positions(u)
    np.testing.assert_allclose(forces.sum(axis=0), 0, atol=10 * ROUNDING)
    np.testing.assert_allclose(np.cross(x, forces).sum(axis=0), 0, atol=10 * ROUNDING)
    sizes = np.linalg.norm(forces[slip.nodes], axis=1)
    np.testing.assert_allclose(sizes, np.linalg.norm(t, axis=1), rtol=10 * ROUNDING)
    np.testing.assert_allclose(slip.in_space(u, t), forces[slip.nodes], atol=10 * ROUNDING)


def test_anchors_pass_from_patch_to_patch() -> None:
    """Of a flat master the way is the straight one, wherever the edges are, and whatever the patches look like."""
    one = pair("nodes", bent=0.0, noise=0.0, side=3.0)
    slip = Rubbing(one, one.nodes, np.zeros((len(one.nodes), 3)))
    u, way = np.zeros(one.operator.shape[1]), np.array([1.3, -1.7, 0.0])
    steps, total = 4, np.zeros((len(one.nodes), 3))
    for k in range(steps):
        slip = slip.since(slip.places(u))
        u = u.copy()
        u.reshape(-1, 3)[one.nodes] = (k + 1) * way / steps
        total += slip.in_space(u, slip(u))
    first = Rubbing(one, one.nodes, np.zeros((len(one.nodes), 3))).places(np.zeros(len(u)))
    assert np.mean(first[:, 0] != slip.places(u)[:, 0]) > 0.8
    np.testing.assert_allclose(total, np.tile(way, (len(total), 1)), atol=10 * ROUNDING)


def nets(mu: float, master: float = 50.0, pairing: str = "nodes") -> tuple[ContactProblem, Pair, np.ndarray]:
    """The upper net pressed down and pulled aside on the lower one; springs hold every point of both."""
    one = pair(pairing, apart=0.05)
    n, m = one.operator.shape[1], len(one.weights)
    load = np.zeros((n // 3, 3))
    load[:m] = np.array([0.6, 0.25, -2.0]) * one.weights[:, None]
    load[: m // 2, 0] *= 0.2
    K = np.eye(n) + 0.2 * np.diag(np.ones(n - 3), 3) + 0.2 * np.diag(np.ones(n - 3), -3)
    stiff = np.where(np.arange(n) < 3 * m, 1.0, master)
    K *= np.sqrt(np.outer(stiff, stiff))
    return rubbed(between(linear_mechanics(sparse.csc_matrix(K), load.ravel()), one), mu), one, load


@cache
def rubbing_nets(pairing: str = "nodes") -> tuple[ContactProblem, ContactSolution]:
    """Two nets and their answer by semismooth, from rest."""
    problem, _, load = nets(0.3, pairing=pairing)
    rest = ContactSolution.at_rest(load.size, len(problem.weights))
    return problem, by_the_exact_law()["semismooth"].solve(problem, rest)


@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
@pytest.mark.parametrize("name", [name for name in by_the_exact_law() if name != "trial-and-error"])
def test_algorithms_agree_on_two_nets_that_rub(name: str, pairing: str) -> None:
    """All but trial-and-error, whose states go round in a circle here."""
    problem, wanted = rubbing_nets(pairing)
    algorithm = by_the_exact_law(1e6)[name]
    solution = algorithm.solve(problem, ContactSolution.at_rest(len(wanted.u), len(problem.weights)))
    assert solution.outcome.converged
    verdict = judge(problem, solution.u, solution.pressure, solution.rubbed.force, epsilon=algorithm.epsilon)
    assert not verdict.failures()
    assert max(verdict.balances["pair_force"], verdict.balances["pair_moment"]) <= PAIR
    assert {State.OPEN, State.STICK, State.SLIP} == set(solution.rubbed.state.tolist())
    bound = 1e-8 if math.isinf(algorithm.epsilon) else 1e-3
    np.testing.assert_allclose(
        solution.rubbed.force, wanted.rubbed.force, rtol=0, atol=bound * np.max(solution.pressure)
    )
    if name != "augmented-lagrangian":  # rows of averaged gaps leave out how their points move
        assert solution.counters["newton_iterations"] <= (8 if pairing == "nodes" else 12)


def test_the_oracle_agrees() -> None:
    """Tresca programmes of an interior point on the step at its solution."""
    problem, actual = rubbing_nets()
    step = freeze(problem, actual.u, actual.pressure, {})
    assert isinstance(step, FrozenFrictionalStep)
    normal = problem.nodal_forces(actual.pressure)
    assert confirm(step, np.zeros(len(actual.u)), normal, actual.rubbed.force).agrees


SPOILT = {
    "an anchor elsewhere on its patch": ({"direction", "stick"}, lambda anchors: anchors + np.array([0.0, 1e-3, 1e-3])),
    "an anchor on another patch": ({"direction", "stick"}, lambda anchors: np.roll(anchors, 1, axis=0)),
}


@pytest.mark.parametrize("what", list(SPOILT))
def test_the_judge_sees_where_slips_are_counted_from(what: str) -> None:
    problem, actual = rubbing_nets()
    names, spoil = SPOILT[what]
    other = problem.since(spoil(actual.rubbed.since))
    verdict = judge(other, actual.u, actual.pressure, actual.rubbed.force)
    assert names <= set(verdict.failures())


def test_the_judge_does_not_trust_the_slip_of_the_problem() -> None:
    problem, actual = rubbing_nets()
    law = problem.coulomb
    assert not judge(problem, actual.u, actual.pressure, actual.rubbed.force).failures()
    lame = replace(law, slip=lambda u: np.zeros((len(law.mu), 2)))
    wrong = np.where(actual.rubbed.state[:, None] == State.STICK, 0.0, actual.rubbed.force)
    verdict = judge(replace(problem, coulomb=lame), actual.u, actual.pressure, -wrong)
    assert {"direction", "generated"} <= set(verdict.failures())


def path(posed: Callable[[float], ContactProblem], drags: tuple[float, ...]) -> list[ContactSolution]:
    """States on the way, from rest, each judged from the anchors of the one before it."""
    at, before, states = (
        ContactSolution.at_rest(LOAD.size, len(posed(0.0).weights)),
        posed(0.0),
        list[ContactSolution](),
    )
    at = laid(before, at)
    for drag in drags:
        problem = posed(drag)
        solution = by_the_exact_law()["semismooth"].solve(problem, at)
        assert solution.outcome.converged
        judged = problem.since(anchors_left(problem, before, at))
        assert not judge(judged, solution.u, solution.pressure, solution.rubbed.force, since=at.u).failures()
        states.append(solution)
        before, at = problem, solution
    return states


ABOVE = sheet(3, 4, 1.0, 0.05, 0.1, up=False)[0] + 0.02 * np.random.default_rng(6).normal(size=(20, 3))
LOAD = np.tile([0.02, 0.01, -0.12], (20, 1))
NET = sparse.csc_matrix(np.eye(60) + 0.2 * np.diag(np.ones(57), 3) + 0.2 * np.diag(np.ones(57), -3))


@pytest.mark.parametrize("drags", [(0.0, 0.01, 0.3, -0.4), (0.0, 2.0)])
def test_on_a_flat_face_that_is_fixed_all_is_as_on_a_rigid_plane(drags: tuple[float, ...]) -> None:
    """Pressed, dragged and dragged back, over many patches: the same states, forces and work to the last digits."""
    below, quads = sheet(7, 6, 4.0, 0.0, 0.0, up=True)
    linearise, nodes = linear_mechanics(NET, LOAD.ravel()), np.arange(len(ABOVE))
    operator = sparse.csr_matrix(sparse.vstack([sparse.eye_array(60), sparse.csr_matrix((3 * len(below), 60))]))
    way, weights = np.array([0.8, 0.6, 0.0]), np.ones(len(ABOVE))

    def on_face(drag: float) -> ContactProblem:
        reference = np.vstack([ABOVE, below + drag * way])
        one = Pair(reference, operator, quads + len(ABOVE), at_nodes(nodes, len(reference), weights))
        return rubbed(between(linearise, one), 0.4)

    def on_plane(drag: float) -> ContactProblem:
        candidates = Candidates(ABOVE, sparse.csr_matrix(sparse.eye_array(60)), weights)
        problem = against(linearise, candidates, RigidPlane(np.array([0.0, 0.0, -1.0]), 0.0))
        return with_friction(problem, 0.4, Motion(drag * way, np.zeros(3), np.zeros(3)))

    faces, planes = path(on_face, drags), path(on_plane, drags)
    seen = set[int]()
    for drag, face, plane in zip(drags, faces, planes, strict=True):
        assert np.array_equal(face.rubbed.state, plane.rubbed.state)
        np.testing.assert_allclose(face.u, plane.u, rtol=0, atol=DIGITS)
        np.testing.assert_allclose(face.pressure, plane.pressure, rtol=0, atol=DIGITS)
        pulls = [
            slip_of(posed(drag), state.rubbed.since).in_space(state.u, state.rubbed.force)
            for posed, state in ((on_face, face), (on_plane, plane))
        ]
        np.testing.assert_allclose(*pulls, rtol=0, atol=DIGITS)
        assert face.rubbed.dissipation == pytest.approx(plane.rubbed.dissipation, rel=1e-10, abs=DIGITS)
        seen |= set(face.rubbed.state.tolist())
    assert {State.OPEN, State.SLIP} <= seen if len(drags) == 2 else seen == set(State)
    assert faces[-1].rubbed.dissipation > 0.01


def test_springs_leave_anchors_behind_on_the_face() -> None:
    """The end of a spring that sticks is where it was, that of one that slips as far behind as it is stretched."""
    problem, _, load = nets(0.3)
    algorithm = by_the_exact_law(20.0)["regularised"]
    solution = algorithm.solve(problem, ContactSolution.at_rest(load.size, len(problem.weights)))
    assert solution.outcome.converged
    friction, law = solution.rubbed, problem.coulomb
    left = problem.since(friction.anchors)
    stretched = -friction.force / (20.0 * problem.weights[:, None])
    sticks = friction.state == State.STICK
    assert sticks.sum() > 1
    np.testing.assert_allclose(law.slip(solution.u)[sticks], stretched[sticks], atol=1e-10)
    behind, stretch = (np.linalg.norm(each, axis=1) for each in (left.coulomb.slip(solution.u), stretched))
    np.testing.assert_allclose(behind, stretch, rtol=0.02, atol=ROUNDING)
    again = algorithm.solve(problem, solution)
    assert again.outcome.converged
    np.testing.assert_allclose(again.u, solution.u, atol=1e-3)
