"""The crushed ring: the solid against another program, the shell against the solid, both against the experiment.

The rubber roller against a plane solid of the same law, and Hertz.

A curved panel of angle plies pressed on a plane: quadrilaterals of any shape have the force of its own lines.
"""

from functools import cache

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.continuation.load_stepping import follow
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactSolution
from formulations.geometry.grid import graded_lines
from formulations.geometry.surfaces import cylinder
from formulations.section.laminate import Laminate, Ply
from formulations.section.laws import LAWS
from formulations.solid import SolidDiscretisation, SolidModel
from formulations.solid_mesh import SolidMesh
from studies.ask.request import UsageError
from studies.scenes.complete import complete
from studies.scenes.complete import complete as resolve
from studies.scenes.contact import crushed_ring_solid
from studies.scenes.contact.crushed_ring import FILE
from studies.scenes.contact.crushed_ring_solid import COLUMNS
from studies.scenes.contact.roller import AWAY, BORE, NU, OUTER, PATCH, SLICE, SOLID, WIDTH, E, contact_width, hertz
from studies.scenes.data import read_reference
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.solved import read, solved

TABLE = read_reference(FILE)
DIGITS = 3e-4  # of the other program on the same mesh, relative: it prints three decimals
FIRST, END = {"delta_mm": "5.5625"}, {"delta_mm": "22.25"}


def crushed(scene: str, mesh: str, measure: str = "exact", **settings: str) -> Result:
    result = solve(*resolve(scene, settings, mesh, measure=measure))
    assert result.verdict == "converged"
    return result


def forces(*args: str, **settings: str) -> np.ndarray:
    return np.array([step["force_N"] for step in crushed(*args, **settings).steps])


def test_a_coarse_solid_is_near_another_programs_and_nothing_is_inverted() -> None:
    (step,) = crushed("crushed-ring-solid", "1x12", law="svk", per_ply="2", **FIRST).steps
    assert step["force_N"] == pytest.approx(TABLE["svk_N"][0], rel=0.025)
    assert 0.5 < step["least_stretch"] < 1 < step["largest_stretch"] < 1.5


@pytest.mark.slow
@pytest.mark.parametrize("column", COLUMNS)
def test_solid_is_another_programs(column) -> None:
    law, state = COLUMNS[column]
    actual = forces("crushed-ring-solid", "1x24", law=law, state=state)
    assert actual == pytest.approx(TABLE[column], rel=DIGITS)
    others = [other for other in COLUMNS if other != column]
    assert all(abs(actual[-1] / TABLE[other].iloc[-1] - 1) > 0.1 for other in others)  # and no other's


@pytest.mark.slow
def test_hencky_solid_is_within_three_percent_of_the_test_after_its_first_travel() -> None:
    off = forces("crushed-ring-solid", "1x24", law="hencky") / TABLE["measured_N"] - 1
    assert np.all(np.abs(off[1:]) <= 0.03)
    assert off[0] > 0.05  # the first reading lies on the straight line of all four, the curve does not


def test_shell_is_within_a_percent_and_a_half_of_the_solid_of_its_law() -> None:
    assert forces("crushed-ring", "1x64", **END)[-1] == pytest.approx(TABLE["svk_N"].iloc[-1], rel=0.015)


@pytest.mark.slow
def test_shell_with_equivalent_constants_is_the_published_one() -> None:
    """nu = 0 with E/(1 - nu^2), the plane-strain modulus: another way to plane strain, with another wall normal."""
    plane = {"nu": "0", "E_MPa": repr(4.07 / (1 - 0.48**2))}
    assert forces("crushed-ring", "1x64", **plane) == pytest.approx([9.05, 16.12, 22.31, 29.07], abs=5.1e-3)
    karman = forces("crushed-ring", "1x64", "von-karman", **plane)
    assert karman == pytest.approx([9.22, 16.71, 23.96, 33.79], abs=5.1e-3)


def test_four_readings_are_one() -> None:
    """They lie on a line through the origin to their last digit: its slope is all that was read."""
    slope = TABLE["measured_N"].iloc[-1] / TABLE["delta_mm"].iloc[-1]
    assert np.max(np.abs(TABLE["measured_N"] - slope * TABLE["delta_mm"])) < 1e-3
    assert np.max(np.abs(TABLE["aster_N"] - slope * TABLE["delta_mm"])) > 0.4  # no computed curve does


@pytest.mark.slow
def test_a_thinner_slice_is_the_same_plane_stress(monkeypatch) -> None:
    asked = {"law": "hencky", "state": "plane-stress", "per_ply": "2", **END}
    whole = forces("crushed-ring-solid", "1x12", **asked)
    halves = dict(crushed_ring_solid.HALVES)
    monkeypatch.setattr(crushed_ring_solid, "HALVES", halves | {"plane-stress": halves["plane-stress"] / 2})
    assert forces("crushed-ring-solid", "1x12", **asked) == pytest.approx(whole, rel=1e-4)


@pytest.mark.slow
def test_a_ring_as_wide_as_its_wall_is_half_thick_is_nearly_in_plane_stress() -> None:
    def force(mesh: str, state: str) -> float:
        return float(forces("crushed-ring-solid", mesh, law="hencky", state=state, per_ply="2", **FIRST)[-1])

    stress, strain, free = force("1x12", "plane-stress"), force("1x12", "plane-strain"), force("2x12", "3d")
    assert stress < free < stress + 0.02 * (strain - stress)


@pytest.mark.parametrize(
    ("scene", "settings", "options", "message"),
    [
        ("crushed-ring-solid", {"law": "steel"}, {}, "svk, hencky, neo-hooke"),
        ("crushed-ring-solid", {}, {"measure": "linear"}, "a solid has none"),
    ],
)
def test_wrong_use_is_refused(scene, settings, options, message) -> None:
    with pytest.raises(UsageError, match=message):
        resolve(scene, settings, **options)


def test_a_ring_without_a_wall_is_refused() -> None:
    scene, request = resolve("crushed-ring", {"inner_mm": "64"})
    with pytest.raises(UsageError, match="smaller than outer_mm"):
        scene.build(request)


TRAVELS = ",".join(map(repr, SOLID))


def plane_solid(law: str, around: int, through: int) -> np.ndarray:
    """Force [N], width [mm] and pressure [MPa] at the travels of the references."""
    wall = Laminate.single(Ply.isotropic(E, NU, OUTER - BORE))
    lines = np.array([0.0, SLICE]), graded_lines([0.0, PATCH, np.pi], [around // 2, around // 2])
    mesh = SolidMesh.build(cylinder((OUTER + BORE) / 2), *lines, wall, per_ply=through)
    fixed = np.zeros((len(mesh.x), 3), bool)
    fixed[:, 2] = True
    fixed[np.append(mesh.on(1, 0.0), mesh.on(1, np.pi)), 1] = True
    fixed[mesh.on(2, wall.d_minus)] = True
    body = SolidDiscretisation.build(mesh, wall, fixed, LAWS[law])
    nodes = np.setdiff1d(np.unique(mesh.outer), mesh.on(1, np.pi))
    outer = Candidates(mesh.x[nodes], body.displacement_operator(nodes), mesh.face_areas(mesh.outer)[nodes])
    line = np.flatnonzero(np.isclose(mesh.parameter[nodes, 0], 0.0))
    line = line[np.argsort(mesh.parameter[nodes[line], 1])]
    values = []
    for point in follow(
        lambda delta: against(SolidModel(body).linearise, outer, RigidPlane(AWAY, OUTER - delta)),
        0.0,
        tuple(SOLID),
        Semismooth(),
        ContactSolution.at_rest(body.n_free, len(nodes)),
    ):
        assert point.outcome.converged
        state = point.solution
        force = 2 * WIDTH / SLICE * float(outer.weights @ state.pressure)
        width = contact_width(outer.positions(state.u)[line, 1], state.active[line], state.pressure[line])
        values.append((force, width, state.pressure[line[0]]))
    return np.array(values)


def of_shell(**settings: str) -> np.ndarray:
    result = solved("roller", delta_mm=TRAVELS, **settings)
    assert all(step["stability"]["negative"] == 0 for step in result.steps)
    return np.array([read(result, name) for name in ("force_N", "width_mm", "pressure_MPa")]).T


@pytest.mark.slow
def test_five_surfaces_have_the_forces_and_pressures_of_the_solid() -> None:
    solid = np.array(list(SOLID.values()))
    assert of_shell()[:, 0] == pytest.approx(solid[:, 0], rel=1e-3)
    assert of_shell(surfaces="7")[:, ::2] == pytest.approx(solid, rel=3e-3)
    assert of_shell(surfaces="3")[:, 0] == pytest.approx(solid[:, 0], rel=1.2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["svk", "neo-hooke"])
def test_a_solid_of_any_law_has_the_contact_of_the_shell(law) -> None:
    """Half as fine along the wall as that of the references; widths are known to a share of an element."""
    solid, shell = plane_solid(law, 32, 8), of_shell(law=law)
    if law == "neo-hooke":
        assert solid[:, ::2] == pytest.approx(np.array(list(SOLID.values())), rel=0.013)
    assert shell[:, 0] == pytest.approx(solid[:, 0], rel=2e-3)
    assert shell[:, 1] == pytest.approx(solid[:, 1], rel=2e-2)


def test_hertz_is_that_of_the_thread_and_rubber_on_a_bore_is_harder() -> None:
    """26 mm and 0.66 MPa at 380 N."""
    assert hertz(380.0, E, NU) == pytest.approx((26.1, 0.662), rel=2e-3)
    actual = solved("roller", delta_mm="1,2,2.568").quantities
    assert actual["force_N"] == pytest.approx(380.0, rel=1e-3)
    width, pressure = hertz(actual["force_N"], E, NU)
    assert actual["width_over_hertz"] == pytest.approx(actual["width_mm"] / width)
    assert actual["pressure_over_hertz"] == pytest.approx(actual["pressure_MPa"] / pressure)
    assert actual["width_over_hertz"] < 0.9 < 1.2 < actual["pressure_over_hertz"]


def test_an_odd_number_of_elements_around_is_refused() -> None:
    scene, request = complete("roller", {}, "1x33")
    with pytest.raises(UsageError, match="1x33: the second number must be even"):
        scene.build(request)


KINDS = ("random", "trapezoid", "skew")


@cache
def force(mesh: str, kind: str = "", mu: str = "") -> float:
    """At 2 mm of travel [N], where the panel is flattened; on its own lines unless a kind of distortion is given."""
    moved = {"distort": "0.2", "distortion": kind} if kind else {"element": "refined"}
    return solved("pressed-panel", mesh, delta_mm="2", **moved, **({"mu": mu} if mu else {})).quantities["force_N"]


def test_moved_nodes_have_the_force_of_lines_of_curvature() -> None:
    assert force("24x24", "random") == pytest.approx(force("24x24"), rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("mesh", "mu", "within"), [("64x64", "", 2e-4), ("32x32", "0.3", 2e-3)])
def test_the_limit_is_one_whatever_the_mesh(mesh: str, mu: str, within: float) -> None:
    for kind in KINDS:
        assert force(mesh, kind, mu) == pytest.approx(force(mesh, "", mu), rel=within)
