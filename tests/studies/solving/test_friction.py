"""Friction as an option of scenes: settings, stages, what is read off, and what the judge sees of it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from contact.coulomb import State
from contact.interchange.linearised_step import FrozenFrictionalStep
from contact.interchange.oracle import Confirmation
from contact.problem import ContactProblem
from studies.arena.replay import algorithm_of, read_step, resolve_step
from studies.ask.request import UsageError
from studies.ask.settings import configured
from studies.exchange.of_scene import problem_of
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.friction_readings import FRICTION, in_space
from studies.scenes.walk import walk
from studies.solving.branching import branches_of
from studies.solving.certificate import certificate
from studies.solving.friction_stages import Slide, Stages
from studies.solving.result import Result
from studies.solving.solve import solve

MESH = "10x10"
TURN = 10  # deg, of a step


def tyre(mu: object, **settings: object) -> Result:
    """A tyre pressed by 8 mm."""
    options = {"model": "full"} if "drag_mm" in settings or "turn_deg" in settings else {}
    return solve(*complete("tyre", {"delta_mm": 8.0, "mu": mu, **settings}, MESH, **options))


@pytest.fixture(scope="module")
def dragged() -> Result:
    return tyre(0.5, drag_mm=(1.0, 8.0, 64.0, 256.0, 64.0, -256.0), drag_deg=90.0)


@pytest.fixture(scope="module")
def turned() -> Result:
    return tyre(0.5, turn_deg=(0.5, *range(TURN, 9 * TURN, TURN)))


def last_problem(result: Result) -> ContactProblem:
    return result.end.problem


def test_no_friction_asks_for_what_was_asked_for_before() -> None:
    _, plain = complete("tyre", {}, MESH)
    _, zero = complete("tyre", {"mu": 0}, MESH)
    assert zero == plain
    assert "mu" not in zero.settings


@pytest.mark.parametrize(
    ("scene", "settings", "said"),
    [
        ("tyre", {"mu": -0.1}, "mu = -0.1 must be"),
        ("tyre", {"drag_mm": 1.0}, "drag_mm needs a coefficient of friction"),
        ("tyre", {"mu": 0.5, "drag_mm": "1,1"}, "no two successive equal"),
        ("tyre", {"mu": 0.5, "turn_deg": "0,1"}, "no two successive equal"),
        ("ring", {"mu": 0.5, "drag_mm": 1.0}, "has no setting 'drag_mm'"),
        ("scordelis-lo", {"mu": 0.5}, "has no setting 'mu'"),
    ],
)
def test_what_cannot_be_asked_for_is_named(scene: str, settings: dict[str, object], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        complete(scene, settings, MESH)


@pytest.mark.parametrize(
    ("contact", "key", "value"),
    [("lcp", "method", "nnls"), ("lcp", "system", "full"), ("semismooth", "c", 7.0), ("qp", "system", "full")],
)
def test_a_setting_of_an_algorithm_that_has_none_of_it_with_friction_is_refused(
    contact: str, key: str, value: object
) -> None:
    with pytest.raises(UsageError, match=f"{key} = {value}: with friction {contact} has epsilon, tolerance, solver"):
        complete("panel", {"mu": 0.3, key: value}, contact=contact)
    _, plain = complete("panel", {key: value, "mu": 0}, contact=contact)
    assert plain.settings[key] == value
    _, rubbed = complete("panel", {"mu": 0.3}, contact=contact)
    assert key not in rubbed.settings


def test_walks_of_the_same_stages_know_nothing_of_each_other() -> None:
    scene, request = complete("panel", {"shape": "plate", "mu": 0.2, "drag_mm": 0.2}, "4x4")
    stages = Stages(list(scene.build(request).stages()), request.settings)
    other = iter(stages)
    next(other)
    *_, last = walk(stages, configured(request.contact, request.settings))
    assert last.stage.name == "drag"
    with pytest.raises(UsageError, match="nothing that friction could act on"):  # its own press has not begun
        list(other)


def test_a_part_of_a_tyre_is_not_dragged() -> None:
    with pytest.raises(UsageError, match="full"):
        complete("tyre", {"mu": 0.5, "drag_mm": 1.0}, MESH, model="half")
    _, request = complete("tyre", {"mu": 0.5, "drag_mm": 1.0}, MESH)
    assert request.model == "full"


@pytest.mark.parametrize(
    ("foundation", "length", "stress"),
    [
        ("plane", 1e3, 7.0),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in (
                ("plane", 1e-3, 1.0),
                ("plane", 0.03, 1e6),
                ("ball", 1e-3, 1.0),
                ("ball", 0.03, 1e6),
                ("ball", 1e3, 7.0),
            )
        ),
    ],
)
def test_a_panel_with_friction_is_the_same_in_other_units(foundation: str, length: float, stress: float) -> None:
    """Settings and results are in mm, N and MPa, whatever the units of the problem; so is the drag."""
    way = (
        {"drag_mm": (0.2, 0.5)}
        if foundation == "plane"
        else {"ball_mm": 400.0, "delta_mm": 2.0, "turn_deg": (0.5, 5.0)}
    )
    asked = {"shape": "plate", "mu": 0.2, "delta_mm": 0.5, "foundation": foundation, "tolerance": 1e-11, **way}
    one = solve(*complete("panel", asked, "6x6"))
    other = solve(*complete("panel", {**asked, "length_unit": length, "stress_unit": stress}, "6x6"))
    assert one.verdict == other.verdict == "converged"
    assert max(step["slipping"] for step in one.steps) > 0
    for mine, theirs in zip(one.loads, other.loads, strict=True):
        assert mine.load == theirs.load
        for name, value in mine.quantities.items():
            size = 1e-7 * mine.quantities["moment_bound_N_mm" if name.endswith("N_mm") else "bound_N"]
            assert theirs.quantities[name] == pytest.approx(value, rel=1e-7, abs=size), name
    tables = [result.table(FRICTION).frame() for result in (one, other)]
    np.testing.assert_allclose(tables[1], tables[0], rtol=1e-6, atol=1e-8)


def test_a_foundation_that_does_not_slide_along_itself_is_refused() -> None:
    ball = {"mu": 0.5, "foundation": "ball", "shape": "plate"}
    with pytest.raises(UsageError, match="does not slide along itself"):
        solve(*complete("panel", {**ball, "drag_mm": 1.0}))
    assert solve(*complete("panel", {**ball, "turn_deg": 1.0})).verdict == "converged"


def test_a_drum_slides_along_its_axis_alone() -> None:
    drum = {"foundation": "drum", "delta_mm": 5.0, "mu": 0.5, "drag_mm": (2.0, 20.0)}
    along = solve(*complete("tyre", {**drum, "drag_deg": 90.0}, MESH))
    assert along.verdict == "converged"
    assert along.steps[-1]["friction_N"] == pytest.approx(along.steps[-1]["bound_N"], rel=1e-4)
    with pytest.raises(UsageError, match="does not slide along itself"):
        solve(*complete("tyre", drum, MESH))


def test_friction_has_no_path_by_arc_length() -> None:
    with pytest.raises(UsageError, match="arc length"):
        solve(*complete("tyre", {"mu": 0.5, "path": "arc"}, MESH, model="full"))


def test_consistent_coupling_is_refused() -> None:
    result = tyre(0.5, coupling="consistent")
    assert result.verdict == "unsupported"
    assert "lumped" in result.unsupported


def test_a_dragged_tyre_pulls_by_mu_times_its_force(dragged: Result) -> None:
    """|F_t| = mu F_n once all slip alike; the first stops are short of it, and who reverses pulls the other way."""
    assert dragged.verdict == "converged"
    assert all(not step["failures"] for step in dragged.steps)
    pressed, first, _, _, far, _, back = dragged.steps
    assert pressed["friction_N"] < 1e-9 * pressed["force_N"]  # the plies are centrally symmetric
    assert first["friction_N"] < 0.9 * first["bound_N"]
    for step in (far, back):
        assert step["sticking"] == 0
        assert step["bound_N"] == pytest.approx(0.5 * step["force_N"], rel=1e-12)
        assert step["friction_N"] == pytest.approx(step["bound_N"], rel=1e-9)


def test_a_turned_tyre_resists_by_mu_p_r(turned: Result) -> None:
    """M = mu sum f r cos(step/2) once all slip around the middle: slip is the chord of the arc of its step."""
    assert turned.verdict == "converged"
    assert abs(turned.steps[1]["moment_N_mm"]) < 0.95 * turned.steps[1]["moment_bound_N_mm"]
    last = turned.steps[-1]
    chord = math.cos(math.radians(TURN / 2))
    assert abs(last["moment_N_mm"]) == pytest.approx(chord * last["moment_bound_N_mm"], rel=1e-9)


def test_dissipation_never_falls(dragged: Result, turned: Result) -> None:
    for result in (dragged, turned):
        lost = [step["dissipation_N_mm"] for step in result.steps]
        assert np.all(np.diff([0.0, *lost]) > 0)


def test_a_symmetric_programme_keeps_central_symmetry(turned: Result) -> None:
    nodes = turned.tables[FRICTION][-1].frame()
    place = nodes[["y_mm", "z_mm"]].to_numpy()
    image = np.argmin(np.linalg.norm(place[:, None] + place[None], axis=2), axis=1)
    pull = nodes[["friction_y_N", "friction_z_N"]].to_numpy()
    assert np.max(np.abs(pull + pull[image])) < 1e-10 * np.max(np.abs(pull))


def test_an_infinite_coefficient_ties_who_touches() -> None:
    """Nobody slips, and where a candidate has come to touch it stays on the moving foundation."""
    result = tyre("inf", drag_mm=(0.5, 1.0), drag_deg=90.0)
    assert result.verdict == "converged"
    assert [step["slipping"] for step in result.steps] == [0, 0, 0]
    _, first, last = (table.frame().set_index("candidate") for table in result.tables[FRICTION])
    both = first.index.intersection(last.index)
    way = last.loc[both, ["y_mm", "z_mm"]].to_numpy() - first.loc[both, ["y_mm", "z_mm"]].to_numpy()
    np.testing.assert_allclose(np.linalg.norm(way, axis=1), 0.5, rtol=1e-12)


def test_mu_towards_zero_comes_to_the_press_without_friction() -> None:
    scene, request = complete("tyre", {"delta_mm": 8.0}, MESH, model="full")
    plain = solve(scene, request).steps[-1]["force_N"]
    off = [abs(tyre(mu, drag_mm=1e-3).steps[0]["force_N"] / plain - 1) for mu in (1e-2, 1e-4)]
    assert off[1] == pytest.approx(0.01 * off[0], rel=0.05)  # by as much as mu is


def test_few_candidates_give_the_answer_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Who is left out of a step changes nothing."""
    few = tyre(0.5, drag_mm=(1.0,))
    monkeypatch.setattr("contact.continuation.load_stepping.solve_within_reach", lambda by, *args: by.solve(*args))
    whole = tyre(0.5, drag_mm=(1.0,))
    for name in ("force_N", "friction_N", "dissipation_N_mm"):
        assert few.steps[-1][name] == pytest.approx(whole.steps[-1][name], rel=1e-9)


def test_who_is_taken_in_on_the_first_step_slips_from_where_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not from where the attempt without it has brought it: the judge counts from the start of the step.

    Gaps are closed at rest to the last digit, which decided who is left out: nobody is in the first attempt here.
    """
    monkeypatch.setattr("contact.continuation.candidates.REACH", -2.0)
    monkeypatch.setattr("contact.continuation.candidates._slid", lambda *_: 1e-12)
    result = solve(*complete("manufactured-contact", {"mu": 0.3, "radius": 0.3}, "4x4"))
    assert any("taken in" in str(row.get("event", "")) for row in result.history)
    assert [step["failures"] for step in result.steps] == [[]]


@pytest.mark.parametrize("spoil", ["sign", "twice", "open", "since", "untold", "short"])
def test_the_judge_of_a_scene_sees_a_spoilt_answer(dragged: Result, spoil: str) -> None:
    visited, state = dragged.end, dragged.end.point.solution
    assert state.friction is not None
    stated = state.friction
    spoilt = {
        "sign": replace(stated, force=-stated.force),
        "twice": replace(stated, force=2 * stated.force),
        "open": replace(stated, force=stated.force + np.where(stated.state == State.OPEN, 1.0, 0.0)[:, None]),
        "since": replace(stated, since=stated.anchors),
        "untold": None,
        "short": replace(stated, force=0.99 * stated.force),
    }[spoil]
    good = certificate(visited.problem, state, before=visited.last_accepted)
    assert not good["failures"]
    bad = certificate(visited.problem, replace(state, friction=spoilt), before=visited.last_accepted)
    # the anchors that an answer tells are not what it is judged by
    assert bool(bad["failures"]) == (spoil != "since")


def test_friction_is_across_the_normal(dragged: Result) -> None:
    problem = last_problem(dragged)
    pull = in_space(problem, dragged.end.point.solution)
    assert problem.directions is not None
    normal = problem.directions(dragged.end.point.solution.u)
    assert np.max(np.abs(np.sum(pull * normal, axis=1))) < 1e-12 * np.max(np.abs(pull))


def test_a_frozen_step_is_solved_again_with_its_friction(dragged: Result, tmp_path: Path) -> None:
    """At the solution the linearised step moves nothing and has its forces; the oracle has them, too."""
    assert dragged.frozen is not None
    file = tmp_path / "step.npz"
    dragged.frozen().write(file)
    step = read_step(file)
    assert isinstance(step, FrozenFrictionalStep)
    again = resolve_step(step, algorithm_of("semismooth"), ask_oracle=True)
    assert again.sound
    assert isinstance(again.oracle, Confirmation)
    assert (step.weights @ again.solution.pressure) == pytest.approx(dragged.steps[-1]["force_N"], rel=1e-6)
    pull = float(np.linalg.norm(again.solution.rubbed.force.sum(axis=0)))
    assert pull == pytest.approx(dragged.steps[-1]["friction_N"], rel=1e-6)


def test_friction_is_neither_exported_nor_branched(dragged: Result) -> None:
    with pytest.raises(UsageError, match="cannot be exported"):
        problem_of("tyre", {"mu": 0.5})
    with pytest.raises(UsageError, match="friction has none"):
        branches_of(dragged)


def test_friction_is_switched_on_along_a_path_and_read_off() -> None:
    """A scene from outside wraps a body without friction, then has it; it sees the forces of friction in space."""
    _, request = complete("panel", {"shape": "plate", "mu": 0.3, "delta_mm": 0.5}, "6x6")
    model, seen = SCENES["panel"].build(request), list[Touch]()
    assert isinstance(model, ContactModel)

    def measured(t: float, touch: Touch) -> dict[str, float]:
        seen.append(touch)
        return {"force_N": float(touch.force.sum())}

    rubbed = replace(model, targets=(0.5, 1.0), rubs=lambda t: float(t > 0.5), measure_at=measured)
    algorithm = configured(request.contact, request.settings)
    free, held = walk(Stages(rubbed.stages(), request.settings), algorithm)
    for visited in (free, held):
        visited.stage.observe(visited.problem, visited.point.solution, visited.point.requested)
    without, touch = seen
    plain = next(iter(walk(replace(rubbed, targets=(0.5,)).stages(), configured("semismooth", {}))))
    assert without.u == pytest.approx(plain.point.solution.u, abs=1e-9)
    assert np.all(without.friction == 0)
    assert free.point.solution.friction.dissipation == 0
    size = np.linalg.norm(touch.friction, axis=1)
    assert 0 < size.max() <= 0.3 * touch.force.max() * (1 + 1e-9)
    assert np.all(size <= 0.3 * np.maximum(touch.force, 0.0) + 1e-9 * touch.force.max())
    judged = certificate(held.problem, held.point.solution, math.inf, 1e-9, held.passed, held.last_accepted)
    assert not judged["failures"]


def test_a_path_may_begin_at_rest() -> None:
    """The first load asked for is none: nothing has slipped there, and the next one is as without it."""
    settings = {"mu": "0.3", "lam_over_a": "0.04"}
    both, alone = (
        solve(*complete("strip-contact", {**settings, "load_fraction": loads}, "16x1")) for loads in ("0,1", "1")
    )
    assert (both.verdict, alone.verdict) == ("converged", "converged")
    rest, pressed = both.steps
    assert (rest["load_fraction"], rest["failures"]) == (0, [])
    assert pressed["bound_N"] == pytest.approx(alone.steps[-1]["bound_N"], rel=1e-12)


@pytest.mark.parametrize("contact", ["trial-and-error", "semismooth", "regularised"])
def test_a_loose_tolerance_leaves_friction_opposite_to_its_slip(contact: str) -> None:
    """Springs, too, slip along the whole of their stretch, whatever friction the last linear step had."""
    settings = {"mu": "0.131", "drag_mm": "-0.5315,0", "length_unit": "0.2825", "tolerance": "0.1"}
    solution = solve(*complete("panel", {**settings, "epsilon": "1e4"}, "3x2", contact=contact))
    assert solution.verdict == "converged", solution.reason


def test_soft_springs_slip_however_little_they_carry() -> None:
    """Their friction, 1e-7 N, is less than the rounding of the forces in balance, 27 N, but its bound is known."""
    result = solve(*complete("heavy-strip", {"mu": "0.0525", "epsilon": "1e-9"}, "4x1"))
    assert result.verdict == "converged"
    assert result.loads[-1].seen["slipping"] > 0


def test_a_foundation_is_dragged_and_then_turned_about_the_origin() -> None:
    """What lies at the origin is dragged along the first axis, and turned onto the second one with the foundation."""
    x, y, z = np.eye(3)
    np.testing.assert_allclose(Slide(z, x).motion(2.0, 90.0).out(np.zeros((1, 3))), [2 * y], rtol=0, atol=1e-15)
