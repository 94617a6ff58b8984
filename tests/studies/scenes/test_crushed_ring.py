"""The crushed ring: the solid against another program, the shell against the solid, both against the experiment."""

import numpy as np
import pytest

from studies.ask.request import UsageError
from studies.scenes.complete import complete as resolve
from studies.scenes.contact import crushed_ring_solid
from studies.scenes.contact.crushed_ring import FILE
from studies.scenes.contact.crushed_ring_solid import COLUMNS
from studies.scenes.data import read_reference
from studies.solving.result import Result
from studies.solving.solve import solve

TABLE = read_reference(FILE)
DIGITS = 3e-4  # of the other program on the same mesh, relative: it prints three decimals
FIRST, END = {"delta_mm": "5.5625"}, {"delta_mm": "22.25"}


def solved(scene: str, mesh: str, measure: str = "exact", **settings: str) -> Result:
    result = solve(*resolve(scene, settings, mesh, measure=measure))
    assert result.verdict == "converged"
    return result


def forces(*args: str, **settings: str) -> np.ndarray:
    return np.array([step["force_N"] for step in solved(*args, **settings).steps])


def test_a_coarse_solid_is_near_another_programs_and_nothing_is_inverted() -> None:
    (step,) = solved("crushed-ring-solid", "1x12", law="svk", per_ply="2", **FIRST).steps
    assert step["force_N"] == pytest.approx(TABLE["svk_N"][0], rel=0.025)
    assert 0.5 < step["least_stretch"] < 1 < step["largest_stretch"] < 1.5


@pytest.mark.slow
@pytest.mark.parametrize("column", COLUMNS)
def test_solid_is_another_programs(column) -> None:
    law, state = COLUMNS[column]
    found = forces("crushed-ring-solid", "1x24", law=law, state=state)
    assert found == pytest.approx(TABLE[column], rel=DIGITS)
    others = [other for other in COLUMNS if other != column]
    assert all(abs(found[-1] / TABLE[other].iloc[-1] - 1) > 0.1 for other in others)  # and no other's


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
