"""Two crossing tubes: a series and a published number at a point, a rigid drum, symmetry, both sides as master."""

from functools import cache
from typing import Any

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.obstacles.drum_sphere import Drum
from contact.verify import PAIR
from studies.ask.request import UsageError
from studies.scenes.closed_forms.pinched_tube import pinched_tube
from studies.scenes.complete import complete
from studies.scenes.contact.base import ContactModel, Touch
from studies.scenes.faces.crossed_tubes import LENGTH, NU, POINT, RADIUS, E, H
from studies.scenes.walk import walk
from studies.solving.result import APART, Result
from studies.solving.solve import solve
from support.problems.differences import fitted_order

PUBLISHED = 164.24  # P/(E t): Lindberg, Olson, Cowper (1969), R = 300, L = 600, t = 3, nu = 0.3
RING = (np.pi / 4 - 2 / np.pi) / 2  # half of the shortening of a ring under a pair of forces F, over F R^3/(E I)
OTHER: dict[str, Any] = {"other_radius_mm": 60.0, "other_half_length_mm": 120.0, "other_h_mm": 0.8, "other_E_MPa": 1e5}
ALIKE: dict[str, Any] = {"other_elements": 100}
THIN: dict[str, Any] = {"shear_correction": 1000, "delta_mm": POINT}
PAIRED = pytest.mark.parametrize("pairing", ["nodes", pytest.param("mortar", marks=pytest.mark.slow)])


def solved(mesh: str, measure: str = "exact", **settings: Any) -> Result:
    result = solve(*complete("crossed-tubes", settings, mesh, measure=measure))
    assert result.verdict == "converged", result.reason
    for step in result.steps:
        assert not step["failures"]
        assert max(step["balances"]["pair_force"], step["balances"]["pair_moment"]) <= PAIR
    return result


def test_the_series_is_the_classic_pinched_cylinder() -> None:
    """By a series with other strains of thin shells, within h/R."""
    assert pinched_tube(300.0, 3.0, 600.0, NU, 2) == pytest.approx(PUBLISHED, rel=2e-3)
    short, long = (pinched_tube(300.0, 3.0, 600.0, NU, 1, waves) for waves in (100, 800))
    assert short == pytest.approx(long, rel=5e-5)
    with pytest.raises(ValueError, match="forces = 3"):
        pinched_tube(300.0, 3.0, 600.0, NU, 3)


@pytest.mark.slow
@pytest.mark.parametrize(("layers", "forces"), [("two", 1), ("many", 2)])
def test_both_walls_give_way_as_under_a_force_at_a_point(layers: str, forces: int) -> None:
    """Tubes of two sizes and moduli, thin and without shear, of which one node touches."""
    first = pinched_tube(RADIUS, H, 2 * LENGTH, NU, forces)
    second = pinched_tube(60.0, 0.8, 240.0, NU, forces)
    errors = []
    for mesh in ("8x12", "16x24", "32x48"):
        solution = solved(
            mesh, "linear", layers=layers, pairing="nodes", **{**THIN, "delta_mm": 1e-3}, **OTHER, **ALIKE
        )
        read = solution.quantities
        of_second = read["other_dent_mm"] * OTHER["other_E_MPa"] * OTHER["other_h_mm"] / read["force_N"]
        errors.append([abs(read["dent_Eh_over_F"] / first - 1), abs(of_second / second - 1)])
    assert np.max(errors[-1]) <= 2.5e-3
    for own in np.transpose(errors):
        assert 1.8 <= fitted_order([1 / 8, 1 / 16, 1 / 32], own) <= 2.2


@pytest.mark.parametrize("slave", ["first", pytest.param("second", marks=pytest.mark.slow)])
def test_averaged_gaps_give_way_alike_once_the_mesh_sees_the_contact(slave: str) -> None:
    exact = pinched_tube(RADIUS, H, 2 * LENGTH, NU, 1)
    actual = solved("16x24", "linear", slave=slave, **THIN).quantities
    assert actual["dent_Eh_over_F"] == pytest.approx(exact, rel=1.5e-2)
    assert actual["dent_mm"] + actual["other_dent_mm"] == pytest.approx(POINT, rel=4e-2)  # the rest: in their walls


def test_tubes_with_free_ends_are_rings_but_for_their_dents() -> None:
    """Of inextensible ones the whole length bends alike, as plates do; dents are 164 of E h w/F, of 4062."""
    actual = solved("16x24", "linear", layers="many", ends="free", pairing="nodes", **THIN).quantities
    bent = RING * RADIUS**3 / (H**2 / 12 / (1 - NU**2) * 2 * LENGTH)
    dent = pinched_tube(RADIUS, H, 2 * LENGTH, NU, 2)
    assert bent < actual["dent_Eh_over_F"] < bent + dent


@pytest.mark.slow
@pytest.mark.parametrize("pairing", ["nodes", "mortar"])
def test_exchanged_tubes_give_the_same_answer(pairing: str) -> None:
    """Half a turn about the diagonal exchanges them, and the slave with the master."""
    settings: dict[str, Any] = {"delta_mm": "1,4", "pairing": pairing, **ALIKE}
    mirrored = {key.removeprefix("other_"): value for key, value in OTHER.items()}
    one = solved("8x12", slave="first", **settings, **OTHER).quantities
    two = solved("8x12", slave="second", **settings, **mirrored).quantities
    assert two["force_N"] == pytest.approx(one["force_N"], rel=1e-8)
    for here, there in (("dent_mm", "other_dent_mm"), ("spread_along_mm", "spread_across_mm")):
        assert two[here] == pytest.approx(one[there], rel=1e-7, abs=1e-9)
        assert two[there] == pytest.approx(one[here], rel=1e-7, abs=1e-9)
    assert one["dent_mm"] < 0.5 * one["other_dent_mm"]


def test_equal_tubes_that_touch_at_a_point_deform_alike() -> None:
    result = solved("8x12", pairing="nodes", delta_mm="0.25", **ALIKE)
    first, second = np.split(result.last.u, 2)
    assert np.max(np.abs(first - second)) <= 1e-8 * np.max(np.abs(first))


@PAIRED
def test_the_force_is_what_the_energy_changes_by_along_the_travel(pairing: str) -> None:
    """Of the whole, where a quarter is modelled; forces on both sides of the pair have no sum."""
    step = 0.01
    scene, request = complete("crossed-tubes", {"pairing": pairing, "delta_mm": (4 - step, 4.0, 4 + step)}, "8x12")
    model = scene.build(request)
    states = [each.point.solution for each in walk(model.stages(), ALGORITHMS["semismooth"]())]
    energies = [model.bodies_at(t).energy(each.u) for t, each in zip(model.targets, states, strict=True)]
    force = model._observe(model.problem_at(4.0), states[1], 4.0).quantities["force_N"]
    assert 4 * (energies[2] - energies[0]) / (2 * step) == pytest.approx(force, rel=1e-5)
    (pair,) = model.pairs_at(4.0)
    nodal = model.problem_at(4.0).nodal_forces(states[1].pressure)
    on_master = pair.forces(states[1].u, nodal)[np.unique(pair.master)].sum(axis=0)
    np.testing.assert_allclose(pair.resultant(states[1].u, nodal), -on_master, atol=1e-9 * np.max(np.abs(on_master)))


@cache
def on_a_drum(mesh: str, deltas: tuple[float, ...]) -> list[float]:
    """Forces of the first tube under a rigid cylinder, by the contact with rigid obstacles."""
    scene, request = complete("crossed-tubes", {}, mesh)
    built = scene.build(request)
    radius = RADIUS + H / 2

    def measured(delta: float, touch: Touch) -> dict[str, float]:
        x = touch.candidates.reference + (touch.candidates.operator @ touch.u).reshape(-1, 3)
        return {"force_N": -4 * float(touch.force @ drum(delta).gradient(x)[:, 0])}

    def drum(delta: float) -> Drum:
        return Drum(np.array([2 * radius - delta, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), radius)

    held = np.flatnonzero(built.shell.discretisation.grid.nodes[:, 1] > np.pi / 3)
    model = ContactModel(built.shell, held, deltas, drum, measured, "delta_mm")
    points = list(walk(model.stages(), ALGORITHMS["semismooth"]()))
    assert all(each.converged for each in points)
    ends = [(each.problem, each.point.solution, each.point.requested) for each in points]
    return [model._observe(*end).quantities["force_N"] for end in ends]


@pytest.mark.slow
@pytest.mark.parametrize(("pairing", "apart"), [("nodes", 1e-3), ("mortar", 3e-3)])
def test_a_far_stiffer_tube_is_a_rigid_drum(pairing: str, apart: float) -> None:
    """Facets of the second are no cylinder, by the square of their size; averaged gaps are others."""
    deltas = (1.0, 4.0)
    tube = solved("16x24", pairing=pairing, delta_mm=deltas, other_E_MPa=1e6 * E, other_elements=200)
    forces = [step["force_N"] for step in tube.steps]
    assert forces == pytest.approx(on_a_drum("16x24", deltas), rel=apart)
    assert tube.quantities["other_dent_mm"] < 1e-5 * tube.quantities["dent_mm"]


@pytest.mark.slow
def test_the_force_converges_whoever_is_the_master() -> None:
    by_name = {
        slave: [solved(mesh, slave=slave, delta_mm="1").quantities["force_N"] for mesh in ("8x12", "16x24", "32x48")]
        for slave in ("first", "second")
    }
    for coarse, middle, fine in by_name.values():
        assert abs(fine - middle) <= abs(middle - coarse) / 4
        assert fine == pytest.approx(middle, rel=1e-2)
    bias = np.abs(np.array(by_name["first"]) / by_name["second"] - 1)
    assert bias[2] <= 2e-4


@pytest.mark.slow
def test_equal_tubes_share_the_travel_until_one_gives_way() -> None:
    result = solved("16x24", delta_mm="2,4,10")
    shares = [step["dent_mm"] / step["other_dent_mm"] for step in result.steps]
    assert shares[:2] == pytest.approx([1, 1], abs=3e-2)
    assert shares[2] > 2
    opened = [step["dent_mm"] + step["other_dent_mm"] - step["delta_mm"] for step in result.steps]
    assert np.all(np.diff(opened) > 0)
    assert opened[2] > 0.1  # mm: a ring around the crossing is in contact


@pytest.mark.slow
def test_walls_that_are_not_alike_rub_and_exchanged_as_much() -> None:
    asked: dict[str, Any] = {"delta_mm": (1.0, 2.0, 4.0), "mu": 0.2, **ALIKE}
    one = solved("8x12", slave="first", other_h_mm=1.5, **asked)
    two = solved("8x12", slave="second", h_mm=1.5, **asked)
    lost = [step["dissipation_N_mm"] for step in one.steps]
    assert 0 <= lost[0] < lost[1] < lost[2]
    assert one.steps[-1]["friction_N"] > 10.0
    for name in ("force_N", "friction_N", "dissipation_N_mm"):
        assert two.steps[-1][name] == pytest.approx(one.steps[-1][name], rel=1e-7)


def test_tubes_that_do_not_touch_have_no_dents_and_no_signs() -> None:
    (step,) = solved("4x6", delta_mm="0.01").steps
    assert step["contact_nodes"] == 0
    assert [repr(step[name]) for name in ("force_N", "dent_mm", "other_dent_mm")] == ["0.0"] * 3


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"ends": "free"}, "ends = free: two tubes would not be held; it needs layers=many"),
        ({"other_h_mm": 100}, "other_h_mm = 100 must be below other_radius_mm = 100"),
    ],
)
def test_tubes_that_cannot_be_say_why(settings: dict[str, Any], why: str) -> None:
    scene, request = complete("crossed-tubes", settings, "8x12")
    with pytest.raises(UsageError, match=why):
        scene.build(request)


def test_faces_that_do_not_touch_are_noted() -> None:
    """Averaged gaps of coarse elements are open by the square of their size."""
    result = solve(*complete("crossed-tubes", {"delta_mm": "0.25"}, "4x4"))
    assert result.quantities["force_N"] == 0
    assert APART in result.notes
    assert APART not in solve(*complete("crossed-tubes", {"delta_mm": "0.25", "pairing": "nodes"}, "4x4")).notes
