"""Shells whose faces meet: a patch test, rings against the elastica and the plate, both sides as master, algorithms."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.verify import PAIR
from studies.ask.request import UsageError
from studies.output.vtu import read_vtu
from studies.scenes.complete import complete
from studies.scenes.faces.face_patch import RADIUS, SIDE, H, lame_between
from studies.scenes.faces.model import Facing
from studies.scenes.walk import walk
from studies.solving.result import APART, UNTOUCHED, Result
from studies.solving.solve import solve, stages_of
from support.problems.differences import fitted_order

LAST_DIGITS = 1e-12
RIM = {"lines": "rim", "delta_mm": "50"}


def solved(scene: str, mesh: str, measure: str = "exact", contact: str = "semismooth", **settings: Any) -> Result:
    result = solve(*complete(scene, settings, mesh, measure=measure, contact=contact))
    assert result.outcome.converged, result.reason
    for step in result.steps:
        record = {name: size for name, size in step["balances"].items() if name.startswith("pair_")}
        assert set(record) == {"pair_force"} | ({"pair_moment"} if settings.get("faces") != "curved" else set())
        assert max(record.values()) <= PAIR
    return result


@pytest.mark.parametrize("slave", ["first", "second"])
@pytest.mark.parametrize("measure", ["exact", "linear"])
def test_a_uniform_pressure_passes_between_flat_faces_to_the_last_digit(slave: str, measure: str) -> None:
    actual = solved("face-patch", "4x8", measure, slave=slave).quantities
    assert abs(actual["pressure_ratio"] - 1) <= LAST_DIGITS
    assert actual["pressure_error"] <= LAST_DIGITS


def test_nodes_alone_do_not_pass_it() -> None:
    """One step of them, so linear that nothing else could fail."""
    scene, request = complete("face-patch", {"pairing": "nodes", "pressure_MPa": "1e-6"}, "4x8", measure="linear")
    model = scene.build(request)
    (pair,) = model.pairs_at(1e-6)
    u = np.zeros(model.n_unknowns)
    on_master = pair.forces(u, pair.weights)[model.shell.discretisation.grid.n_nodes :, 2]
    mortar = solved("face-patch", "4x8", "linear").model
    (exact,) = mortar.pairs_at(1.0)
    right = exact.forces(u, exact.weights)[model.shell.discretisation.grid.n_nodes :, 2]
    assert np.max(np.abs(on_master - right)) > 0.1 * np.max(np.abs(right))


def test_the_judge_sees_the_elements_of_both_bodies_turned_inside_out() -> None:
    """Those of finite strains: the second ring is turned through its wall, the faces in each other's places."""
    model = solved("two-rings", "1x16", delta_mm="1").model
    bodies, problem = model.bodies_at(1.0), model.problem_at(1.0)
    first, second = (len(part.shell.discretisation.grid.elements) for part in bodies.parts)
    inside_out = [np.zeros(part.n_free) for part in bodies.parts]
    body = bodies.parts[1].shell.discretisation
    faces = np.zeros((body.grid.n_nodes, 6))
    faces[:, 4:] = body.laminate.thickness * np.array([1.0, -1.0])
    inside_out[1] = body.map.restrict(faces)
    ratios = problem.volume_ratios(np.concatenate(inside_out))
    assert ratios[:first] == pytest.approx(np.ones(first))
    assert ratios[first:] == pytest.approx(-np.ones(second), rel=0.1)  # but for what is held there
    linear = solved("two-rings", "1x16", "linear", delta_mm="0.1").model
    assert len(linear.problem_at(0.1).volume_ratios(np.zeros(linear.n_unknowns))) == 0


@pytest.mark.slow
def test_the_force_between_curved_faces_converges_with_order_two() -> None:
    """To Lame's, but for the wall of the shell, which is thin to (h/R)^2."""
    meshes, exact = ("4x8", "8x16"), lame_between(RADIUS - H, RADIUS + H)
    settings = {"shape": "curved"}
    errors = [
        abs(solved("face-patch", mesh, "linear", **settings).quantities["pressure_ratio"] / exact - 1)
        for mesh in meshes
    ]
    assert errors[-1] <= 1e-2
    assert 1.8 <= fitted_order([1 / 8, 1 / 16], errors) <= 2.2


@pytest.mark.parametrize("slave", ["first", pytest.param("second", marks=pytest.mark.slow)])
def test_the_pressure_between_curved_faces_is_uniform_with_order_two(slave: str) -> None:
    """On facets it has no order: they lie in each other by more than the walls are compressed between them."""
    curved, facets = (
        [
            solved("face-patch", mesh, "linear", shape="curved", faces=faces, slave=slave).quantities["pressure_error"]
            for mesh in ("4x4", "8x8")
        ]
        for faces in ("curved", "facets")
    )
    assert curved[-1] <= 1e-3
    assert fitted_order([2.0, 1.0], curved) >= 1.8
    assert facets[-1] > max(facets[0], 0.02)


@pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])
def test_equal_rings_meet_as_each_meets_a_plate(pairing: str) -> None:
    plate = solve(*complete("ring", RIM, "1x20")).quantities
    rings = solved("two-rings", "1x20", pairing=pairing, other_elements=100, **RIM).quantities
    bound = 1e-6 if pairing == "nodes" else 2e-3  # of means over patches the rim is another one
    for name in ("P_R2_over_EI", "flat_half_length"):
        assert rings[name] == pytest.approx(plate[name], rel=bound)


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
def test_rings_whose_meshes_do_not_match_converge_to_the_elastica_whoever_is_the_master(pairing: str) -> None:
    by_name = {
        slave: [
            solved("two-rings", mesh, pairing=pairing, slave=slave, **RIM).quantities["P_H2_over_EI"]
            for mesh in ("1x20", "1x40")
        ]
        for slave in ("first", "second")
    }
    for values in by_name.values():
        errors = [abs(value / 5.742160 - 1) for value in values]
        assert errors[1] < errors[0] / 3
        assert errors[1] <= 3e-3
    bias = np.abs(np.array(by_name["first"]) / by_name["second"] - 1)
    assert np.all(bias <= np.abs(np.array(by_name["first"]) / 5.742160 - 1))
    assert bias[1] <= 1e-4


@pytest.mark.slow
@pytest.mark.parametrize(("pairing", "other"), [("nodes", 100), ("mortar", 100), ("mortar", 75)])
def test_a_ring_that_touches_itself_is_a_quarter_on_a_plane_in_the_limit(pairing: str, other: int) -> None:
    """Facets beside the plane of symmetry are not at right angles to the force, by the square of their size."""
    load = {"F_R2_over_EI": "8"}
    off = []
    for mesh in ("1x24", "1x48"):
        plane = solve(*complete("pinched-ring", {**load, "against": "plane"}, mesh)).quantities
        itself = solved("pinched-ring", mesh, pairing=pairing, other_elements=other, **load).quantities
        assert itself["spread_over_R"] == pytest.approx(plane["spread_over_R"], rel=1e-3)
        off.append(abs(itself["contact_R2_over_EI"] - plane["contact_R2_over_EI"]))
    assert off[0] <= (1e-3 if pairing == "nodes" else 0.03)
    assert off[1] <= off[0] / 3


def test_a_ring_that_does_not_touch_itself_is_two_quarters() -> None:
    load = {"F_R2_over_EI": "4", "other_elements": 100}
    meeting = solved("pinched-ring", "1x12", **load)
    on_plane = solve(*complete("pinched-ring", {**load, "against": "plane"}, "1x12"))
    assert meeting.notes[0] == APART
    assert on_plane.notes[0] == UNTOUCHED
    itself, plane = meeting.quantities, on_plane.quantities
    assert itself["contact_R2_over_EI"] == plane["contact_R2_over_EI"] == 0
    assert itself["spread_over_R"] == pytest.approx(plane["spread_over_R"], rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
def test_rings_in_a_row_share_their_shortening(pairing: str) -> None:
    """Each is the one between plates, which travel by a quarter of what the outer middle planes approach."""
    plate = solve(*complete("ring", RIM, "1x20")).quantities
    row = solved("stack", "1x20", pairing=pairing, other_elements=100, **RIM)
    bound = 1e-5 if pairing == "nodes" else 2e-3  # of means over patches the rim is another one
    for name in ("P_R2_over_EI", "flat_half_length"):
        assert row.quantities[name] == pytest.approx(plate[name], rel=bound)
    assert row.quantities["second_over_first"] == pytest.approx(1.0, abs=bound)
    assert len(row.model.pairs) == 2


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
def test_rings_in_a_row_whose_meshes_do_not_match_converge_to_the_elastica(pairing: str) -> None:
    errors = []
    for mesh in ("1x20", "1x40"):
        actual = solved("stack", mesh, pairing=pairing, **RIM).quantities
        assert actual["second_over_first"] == pytest.approx(1.0, abs=1e-2)
        errors.append(abs(actual["P_R2_over_EI"] / 5.742160 - 1))
    assert errors[1] < errors[0] / 3
    assert errors[1] <= 3e-3


def test_both_faces_of_the_middle_ring_are_in_one_file(tmp_path) -> None:
    result = solved("stack", "1x20", delta_mm="35", lines="rim", pairing="nodes")
    result.model.write_fields(tmp_path / "fields.vtu", result.last)
    fields = read_vtu(tmp_path / "fields.vtu")
    at = fields.points + fields.data["displacement"]
    bodies = [at[np.unique(fields.cells[fields.data["body"] == number])] for number in (0, 1, 2)]
    for below, above in pairwise(bodies):
        assert abs(np.min(above[:, 0]) - np.max(below[:, 0])) < 0.1
    candidate, _ = result.model.candidate_of_point
    shown = np.flatnonzero(candidate >= 0)
    assert sorted(candidate[shown].tolist()) == list(range(len(result.last.pressure)))
    np.testing.assert_array_equal(fields.data["pressure"][shown], result.last.pressure[candidate[shown]])
    assert not fields.data["pressure"][candidate < 0].any()


def test_fields_have_both_bodies_where_they_are(tmp_path) -> None:
    result = solved("two-rings", "1x20", delta_mm="20")
    result.model.write_fields(tmp_path / "fields.vtu", result.last)
    fields = read_vtu(tmp_path / "fields.vtu")
    at = fields.points + fields.data["displacement"]
    body = fields.data["body"]
    first, second = (at[np.unique(fields.cells[body == number])] for number in (0, 1))
    assert abs(np.min(second[:, 0]) - np.max(first[:, 0])) < 0.1  # the sagitta of an element is 0.08 mm
    assert np.ptp(first[:, 2]) == pytest.approx(np.ptp(second[:, 2]))
    assert np.max(fields.data["pressure"]) == pytest.approx(np.max(result.last.pressure))
    assert math.isclose(np.min(first[:, 0]), 0.0, abs_tol=1e-9)


def test_friction_on_a_curved_patch_has_no_moment_about_its_axis_of_symmetry() -> None:
    """Its planes of symmetry are at right angles to no facet; without friction in them, one candidate would slip."""
    (actual,) = solved("face-patch", "4x4", shape="curved", mu=0.3).steps
    assert actual["sticking"] == actual["contact_nodes"]
    assert abs(actual["moment_N_mm"]) <= 1e-9 * actual["moment_bound_N_mm"]
    assert actual["friction_N"] > 0.1 * actual["bound_N"]


PULLED = {"mu": 0.3, "drag_mm": (0.01, 1.0, 12.0, 8.0)}


@pytest.mark.parametrize("other", [75, pytest.param(100, marks=pytest.mark.slow)])
def test_a_plate_that_is_dragged_sticks_and_then_pulls_by_mu_times_its_weight(other: int) -> None:
    """Across patches of a longer plate and back; nodes against patches chatter where these fold along the drag."""
    result = solved("face-patch", "4x4", other_elements=other, **PULLED)
    assert result.verdict == "converged"
    pressed, sticks, slides, far, back = result.steps
    weight = 0.3 * SIDE**2 * 1.0
    assert all(not step["failures"] for step in result.steps)
    assert all(step["bound_N"] == pytest.approx(weight, rel=1e-4) for step in result.steps)  # of the area as it is
    assert pressed["friction_N"] < 1e-4 * weight
    assert sticks["slipping"] == 0
    assert 0.1 * weight < sticks["friction_N"] < 0.5 * weight
    for step in (slides, far, back):
        assert step["sticking"] == 0
        assert step["friction_N"] == pytest.approx(step["bound_N"], rel=1e-5)
        assert step["newton_iterations"] <= 8
    lost = [step["dissipation_N_mm"] for step in result.steps]
    assert abs(lost[1]) <= 1e-9
    assert lost[3] - lost[2] == pytest.approx(weight * 11.0, rel=1e-3)
    assert weight * 3.5 < lost[4] - lost[3] < weight * 4.0  # what the plates first spring back by is no slip


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
def test_a_stack_whose_middle_ring_is_the_master_of_both_rubs_alike_in_both_contacts(pairing: str) -> None:
    """To the last digits; as slave of the one pair it is another answer, by as much as faces and steps are coarse."""
    asked = {"mu": 0.2, "h_mm": 1.0, "other_h_mm": 1.5, "delta_mm": tuple(np.linspace(2.5, 35.0, 14).tolist())}
    scene, request = complete("stack", {**asked, "pairing": pairing}, "1x16")
    model = scene.build(request)
    first, second = model.pairs
    mirrored = replace(model, pairs=(first, Facing(second.master, second.slave, first.nodes)))
    totals = []
    for each in (mirrored, model):
        points = list(walk(stages_of(each, request), ALGORITHMS["semismooth"](epsilon=math.inf)))
        assert all(point.converged for point in points)
        state, problem = points[-1].state, points[-1].problem
        normal, pull = problem.nodal_forces(state.pressure), np.linalg.norm(state.rubbed.force, axis=1)
        own = each.pair_of_candidate == 0
        both = [np.array([normal[which].sum(), pull[which].sum()]) for which in (own, ~own)]
        assert pull.sum() > 1.0
        assert state.rubbed.dissipation > 0.01
        totals.append(both)
    np.testing.assert_allclose(*totals[0], rtol=1e-10)
    np.testing.assert_allclose(totals[1][0][0], totals[0][0][0], rtol=2e-3)


def test_a_coefficient_of_zero_is_no_friction_to_the_last_digit() -> None:
    plain, zero = (solved("face-patch", "4x4", **settings).last for settings in ({}, {"mu": 0}))
    assert np.array_equal(plain.u, zero.u)


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"shape": "curved"}, "drag_mm needs shape=flat"),
        ({"slave": "second"}, "drag_mm needs slave=first"),
        ({"mu": 0}, "drag_mm needs a coefficient of friction"),
    ],
)
def test_a_drag_that_cannot_be_says_why(settings: dict[str, Any], why: str) -> None:
    with pytest.raises(UsageError, match=why):
        solve(*complete("face-patch", {**PULLED, **settings}, "4x4"))


@pytest.mark.slow
def test_rings_of_two_walls_that_rub_do_so_whoever_is_the_master() -> None:
    """Walls that are not alike slip on each other as they flatten; the bound is mu times the force."""
    asked = {"mu": 0.2, "other_h_mm": 1.2, "h_mm": 1.0, "delta_mm": tuple(np.linspace(4.0, 40.0, 10).tolist())}
    plain = solved("two-rings", "1x40", **{**asked, "mu": 0}).quantities["P_H2_over_EI"]
    values = [solved("two-rings", "1x40", slave=slave, **asked) for slave in ("first", "second")]
    first, second = (each.quantities["P_H2_over_EI"] for each in values)
    assert first == pytest.approx(second, rel=2e-3)
    assert min(first, second) > plain * 1.0005
    assert all(not step["failures"] for each in values for step in each.steps)
    assert all(each.steps[-1]["dissipation_N_mm"] > 0.1 for each in values)
