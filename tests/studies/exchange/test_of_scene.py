"""Problems of scenes against the scenes: bodies, supports, loads and planes."""

from __future__ import annotations

import numpy as np
import pytest

from studies.ask.request import UsageError
from studies.exchange.of_scene import problem_of
from studies.exchange.problem import INNER, Problem, isotropic
from studies.scenes.benchmarks import cantilever, hemisphere, pressurised
from studies.scenes.benchmarks.obstacle_course import ScordelisLo

SMALL = {"tyre": "8x8", "tyre-solid": "6x8", "crushed-ring-solid": "1x8"}
REFUSED = {
    "sze-moment": "couples",
    "heavy-strip": "given displacements",
    "manufactured": "cannot be exported",
    "manufactured-contact": "must be a plane",
    "wrapped-cylinder": "a shell of two faces with the linear law",
}
EXPORTED = ("hemisphere", "semicylinder-0-90-0", "pagano", "free-hyperboloid", "shallow-cap")
BEFORE_PLANES = ("strip-contact", "ring", "panel", "crushed-ring", "crushed-ring-solid", "tyre")


def asked(name: str, mesh: str | None = None, **given: object) -> Problem:
    return problem_of(name, given, mesh or SMALL.get(name, "4x4"))


@pytest.mark.parametrize("name", [*EXPORTED, *BEFORE_PLANES])
def test_supports_and_plane_leave_no_rigid_motion_and_plies_are_whole(name: str) -> None:
    problem = asked(name)
    supports, x = problem.supports, problem.bricks.x
    assert len(np.unique(supports.nodes)) == len(supports.nodes)
    rows = []
    for node, axes, held in zip(supports.nodes, supports.axes, supports.held, strict=True):
        at = x[node] - x.mean(axis=0)
        rows += [np.concatenate([axis, np.cross(at, axis)]) for axis in axes[held]]
    assert (problem.plane is not None) is (name in BEFORE_PLANES)
    if problem.plane is not None:
        rows.append(np.concatenate([problem.plane.normal, np.zeros(3)]))
        assert problem.plane.start >= float(np.max(x @ problem.plane.normal)) - 1e-9
        offsets = [step.offset for step in problem.steps if step.offset is not None]
        assert offsets == sorted(offsets, reverse=True)  # it touches or comes nearer
        assert len(offsets) == len(problem.steps)
    size = np.concatenate([np.ones(3), np.full(3, 1 / np.ptp(x, axis=0).max())])
    assert np.linalg.matrix_rank(np.array(rows) * size, tol=1e-6) == 6
    counts = np.bincount(problem.bricks.ply, minlength=len(problem.materials))
    assert len(set(counts)) == 1
    assert counts.sum() == len(problem.bricks.elements)


def test_what_cannot_be_exported_says_why() -> None:
    for name, why in REFUSED.items():
        with pytest.raises(UsageError, match=why):
            asked(name)
    for through in (0, 17):
        with pytest.raises(UsageError, match=rf"through = {through} must be a whole number in \[1, 16\]"):
            problem_of("cantilever", {}, "4x1", through)


def test_a_solid_keeps_its_own_bricks() -> None:
    with pytest.raises(UsageError, match="through = 2 does not apply to tyre-solid"):
        problem_of("tyre-solid", {}, "6x8", through=2)
    bricks = problem_of("tyre-solid", {"per_ply": "2"}, "6x8").bricks
    assert len(bricks.elements) == 2 * len(bricks.inner)


def test_point_and_end_forces_are_those_of_their_scenes() -> None:
    problem = asked("cantilever", "8x2")
    *_, last = problem.steps
    np.testing.assert_allclose(last.forces.sum(axis=0), [0, 0, cantilever.P_MAX], atol=1e-12)
    np.testing.assert_allclose(problem.bricks.x[last.forces.any(axis=1)][:, 0], cantilever.L)
    for step in asked("hemisphere").steps:
        assert step.load is not None
        force = 0.5 * step.load * hemisphere.P_MAX
        np.testing.assert_allclose(step.forces.sum(axis=0), [force, -force, 0], atol=1e-9 * force)


def test_the_weight_of_the_roof_does_its_work() -> None:
    """On the fall a1, zero where the diaphragm holds: int w a1 dA = w R angle (L/2)^2/2, and its lever about z."""
    within = 2e-3
    problem = asked("scordelis-lo", "4x4")
    x, (step,) = problem.bricks.x, problem.steps
    half = ScordelisLo.LENGTH / 2
    weight = ScordelisLo.WEIGHT * ScordelisLo.RADIUS * half**2 / 2
    down = -step.forces[:, 0]
    assert np.sum(down * x[:, 2]) == pytest.approx(weight * ScordelisLo.HALF_ANGLE, rel=within)
    lever = weight * ScordelisLo.RADIUS * (1 - np.cos(ScordelisLo.HALF_ANGLE))
    assert np.sum(down * x[:, 2] * x[:, 1]) == pytest.approx(lever, rel=5 * within)


def test_the_pressure_in_the_cylinder_is_that_on_its_area() -> None:
    """Radial sum p A with the area of the middle surface or of the inner face."""
    for area in ("mid", "face"):
        problem = asked("pressurised-cylinder", pressure_area=area, h_mm=5.0)
        radius = pressurised.RADIUS - (0.0 if area == "mid" else 2.5)
        value = pressurised.fixed_cylinder_load(pressurised.LARGEST) * pressurised.E * 5.0 / pressurised.RADIUS
        forces = problem.bricks.pressure_forces(problem.steps[-1].pressure)
        e3 = problem.bricks.x * [1.0, 1.0, 0.0]
        radial = np.sum(forces * e3) / (pressurised.RADIUS - 2.5)
        assert radial == pytest.approx(value * radius * pressurised.SECTOR * pressurised.RADIUS / 2, rel=1e-4)


def test_a_dead_pressure_on_a_whole_tyre_adds_up_to_nothing_and_pushes_outwards() -> None:
    problem = asked("tyre", delta_mm=5.0)
    step, x = problem.steps[0], problem.bricks.x
    size = float(np.abs(step.forces).sum())
    np.testing.assert_allclose(step.forces.sum(axis=0) / size, 0, atol=1e-12)
    inner = problem.bricks.face_nodes(INNER)
    assert np.sum(step.forces[inner] * x[inner] * [1, 1, 0]) > 0
    assert not np.delete(step.forces, inner, axis=0).any()


def test_a_follower_pressure_turns_with_its_face() -> None:
    problem = asked("tyre-solid", delta_mm=5.0)
    angle = 0.3
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    pressure, x = problem.steps[0].pressure, problem.bricks.x
    turned = problem.bricks.pressure_forces(pressure, x @ turn.T - x)
    np.testing.assert_allclose(turned, problem.bricks.pressure_forces(pressure) @ turn.T, atol=1e-9)


def test_angle_plies_ask_for_the_whole_tyre_and_no_travel_is_inflation_alone() -> None:
    for walls, model, copies in (({}, "full", 1), ({"E_MPa": 20.0, "nu": 0.45}, "quarter", 4)):
        problem = asked("tyre", delta_mm=0.0, load="follower", pressure_area="face", **walls)
        assert (problem.request.model, problem.copies) == (model, copies)
        assert problem.plane is None
        (step,) = problem.steps
        assert (step.load, step.offset) == (0.0, None)
        assert np.all(step.pressure == problem.request.settings["p0_MPa"])
        assert problem.crown is not None
        np.testing.assert_allclose(problem.bricks.x[problem.crown, 1:], 0, atol=1e-9)


def test_a_shear_correction_is_one_of_the_ply() -> None:
    (ply,) = asked("pinched-cylinder", shear_correction=1000.0).materials
    assert ply.shears[1] == pytest.approx(1000 * ply.shears[0])
    assert not isotropic(ply)
    (plain,) = asked("pinched-cylinder").materials
    assert isotropic(plain)


def test_nodes_of_the_shell_are_nodes_of_the_bricks() -> None:
    problem = asked("tyre", delta_mm=5.0)
    assert problem.shell is not None
    assert len(np.unique(problem.shell)) == problem.shell.size
    inner, outer = (problem.bricks.x[problem.shell[:, face]] for face in (0, 1))
    np.testing.assert_allclose(np.linalg.norm(outer - inner, axis=1), 4.8, rtol=1e-12)
