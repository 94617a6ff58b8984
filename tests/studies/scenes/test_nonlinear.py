"""Nonlinear benchmark scenes against published curves on several meshes: hemisphere, pull-out, pinched cylinders.

Published values are ABAQUS S4R on one mesh, transcribed: they carry its errors. Where ours differ by more than the
tolerance, the test says by how much, and which independent value decides.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from studies.scenes import SCENES
from studies.solving.result import Result
from support.problems.solved import at, distances, ended, extrapolated, read, referenced, solved

OLD = {"interpolation": "curvilinear", "thickness_strain": "nodal", "membrane": "compatible"}
CLOSE = 5e-3  # of a published value, after refinement
AT_QUARTERS = 1e-2  # of a published displacement, on 32x32
CURVE = 1e-2  # largest distance of a published point from our curve, in units of the ranges of load and displacement
LIMIT = "limit_load_fraction"
ENDS = ("outward_mm", "inward_mm")
QUARTERS = "0.05,0.25,0.5,0.75,1"


def hemispheres(**asked: str) -> list[Result]:
    asked = {**OLD, "load_fraction": QUARTERS, **asked}
    return [solved("hemisphere", mesh, **asked) for mesh in ("16x16", "24x24", "32x32")]


@pytest.mark.slow
def test_hemisphere_is_pulled_as_published() -> None:
    """The inward point as published from three quarters of the load on; before, S4R lies 0.6 to 0.9 % above our limit.

    It does so already at a twentieth of the load, where the outward point agrees to 0.2 %; a high-order code confirms
    our limit of both at a hundredth (tests of the linear scenes), and isoparametric elements have it at every load.
    """
    curvilinear = hemispheres()
    isoparametric = hemispheres(interpolation="isoparametric")
    for fraction in (0.05, 0.25, 0.5, 0.75, 1.0):
        values = [at(result, fraction, *ENDS) for result in curvilinear]
        assert np.all(np.diff(values, axis=0) > 0)
        assert np.all(values[2] - values[1] < values[1] - values[0])
        limit = extrapolated(values[1], values[2], 4 / 3)
        others = [at(result, fraction, *ENDS) for result in isoparametric]
        assert extrapolated(others[1], others[2], 4 / 3) == pytest.approx(limit, rel=1.5e-3)
        outward, inward = referenced("hemisphere", "read", *ENDS, load_fraction=fraction) / limit - 1
        assert abs(outward) <= (CLOSE if fraction > 0.25 else 2e-3)
        if fraction >= 0.75:
            assert abs(inward) <= CLOSE
        else:
            assert CLOSE < inward <= 9e-3


@pytest.mark.slow
def test_nodal_thickness_strain_pays_on_the_hemisphere() -> None:
    inward = referenced("hemisphere", "read", "inward_mm", load_fraction=1.0)
    projected, nodal = (
        abs(at(solved("hemisphere", "16x16", **{**OLD, "thickness_strain": option}), 1.0, "inward_mm") / inward - 1)
        for option in ("projected", "nodal")
    )
    assert nodal < 0.5 * projected


POINTS = ("w_A_mm", "u_B_mm", "u_C_mm")


@pytest.mark.slow
def test_pulled_cylinder_before_the_snap() -> None:
    values = [
        at(solved("sze-pullout", mesh, **OLD, load_fraction="0.25"), 0.25, *POINTS)
        for mesh in ("8x12", "12x18", "16x24")
    ]
    printed = referenced("sze-pullout", "read", *POINTS, load_fraction=0.25)
    errors = [np.max(np.abs(value / printed - 1)) for value in values]
    assert errors[0] > errors[1] > errors[2]
    assert extrapolated(values[0], values[2], 2) == pytest.approx(printed, rel=CLOSE)


PULLED = ("12x18", "16x24", "24x36")


@pytest.mark.slow
def test_pulled_cylinder_through_the_snap() -> None:
    """After the snap, A within 0.1 %; B and C up to 0.65 % from S4R on one mesh, 24x36.

    Isoparametric elements have our limits to 0.05 %.
    """
    load = "0.75,1"
    curvilinear = [solved("sze-pullout", mesh, **OLD, load_fraction=load) for mesh in PULLED]
    isoparametric = [
        solved("sze-pullout", mesh, **{**OLD, "interpolation": "isoparametric"}, load_fraction=load) for mesh in PULLED
    ]
    for fraction in (0.75, 1.0):
        actual, others = ([at(r, fraction, *POINTS) for r in results] for results in (curvilinear, isoparametric))
        limit = extrapolated(actual[1], actual[2], 1.5)
        assert extrapolated(others[1], others[2], 1.5) == pytest.approx(limit, rel=5e-4)
        error = np.abs(limit / referenced("sze-pullout", "read", *POINTS, load_fraction=fraction) - 1)
        assert error[0] <= 1e-3
        assert np.max(error) <= 6.5e-3
    # the published table jumps between 0.5 and 0.525; ours passes a maximum there, and a minimum 1 % below it
    snaps = [result.quantities[LIMIT] for result in curvilinear]
    assert snaps[0] < snaps[1] < snaps[2]
    assert 0.5 < snaps[2] < extrapolated(np.array(snaps[1]), np.array(snaps[2]), 1.5) < 0.525
    assert [result.quantities["limit_points"] for result in curvilinear] == [2, 2, 2]


def published(scene: str, quantity: str) -> np.ndarray:
    """Load fraction and displacement (n, 2)."""
    known = [each for each in SCENES[scene].references if (each.kind, each.quantity) == ("read", quantity)]
    return np.array([(each.at["load_fraction"], each.value) for each in known])


def through(scene: str, mesh: str, between: int = 0) -> Result:
    """Through every published load, with so many more between two of them."""
    loads = np.append(0.0, published(scene, "w_A_mm")[:, 0])
    steps = np.concatenate([np.linspace(*ends, between + 2)[1:] for ends in pairwise(loads)])
    return solved(scene, mesh, load_fraction=",".join(f"{load:.6g}" for load in steps))


def curve(result: Result, quantity: str) -> np.ndarray:
    """Load fraction and displacement (n, 2), from rest."""
    return np.insert(np.stack([read(result, "load_fraction"), read(result, quantity)], axis=1), 0, 0.0, axis=0)


def from_curve(scene: str, result: Result, quantity: str) -> np.ndarray:
    """Distance of each published point from our curve, both in units of the ranges of load and displacement."""
    table, ours = published(scene, quantity), curve(result, quantity)
    return distances(table / np.ptp(table, axis=0), ours / np.ptp(table, axis=0))


# --- the semi-cylinder ------------------------------------------------------------------------------------------------

LAYUPS = ("semicylinder", "semicylinder-0-90-0", "semicylinder-90-0-90")


@pytest.mark.slow
@pytest.mark.parametrize("scene", LAYUPS)
def test_semicylinder_reaches_the_whole_load_as_published(scene: str) -> None:
    result = through(scene, "32x32")
    table, ours = published(scene, "w_A_mm"), curve(result, "w_A_mm")[1:]
    quarters = np.isin(table[:, 0], (0.25, 0.5, 0.75, 1.0))
    assert ours[quarters, 1] == pytest.approx(table[quarters, 1], rel=AT_QUARTERS)
    assert np.max(from_curve(scene, result, "w_A_mm")) <= CURVE


def test_plies_around_make_it_stiffer_as_published() -> None:
    """At a twentieth of the load 0/90/0 gives way twice as far as 90/0/90: 0 is along the generator."""
    isotropic, axial, around = (published(scene, "w_A_mm")[0, 1] for scene in LAYUPS)
    values = [solved(scene, "12x12", load_fraction="0.05").quantities["w_A_mm"] for scene in LAYUPS]
    assert values[1] / values[2] == pytest.approx(axial / around, rel=0.05)
    assert values[2] / values[0] == pytest.approx(around / isotropic, rel=0.05)


# --- the cylinder between diaphragms ----------------------------------------------------------------------------------

OUTSIDE = 2e-2  # of a published displacement outside the snap, on 48x48
INSIDE = {0.15: 3e-2, 0.175: 4e-2}  # of the load at a published displacement inside it


@pytest.mark.slow
def test_pinched_cylinder_goes_the_way_of_the_published_one() -> None:
    """S4R on the same 48x48: w_A at every load, along the load axis where it is steep.

    It snaps 3.5 % of the load before S4R at 0.175; elsewhere w_A is at most 1.9 % farther. u_B ends 1.3 mm farther out.
    """
    result = through("sze-pinched", "48x48", between=1)
    table, ours = published("sze-pinched", "w_A_mm"), curve(result, "w_A_mm")
    assert np.all(np.diff(ours[:, 1]) > 0)
    at_load = PchipInterpolator(*ours.T)(table[:, 0])
    inside = np.isin(table[:, 0], list(INSIDE))
    assert at_load[~inside] == pytest.approx(table[~inside, 1], rel=OUTSIDE)
    at_displacement = PchipInterpolator(*ours.T[::-1])(table[inside, 1])
    assert np.all(np.abs(at_displacement / table[inside, 0] - 1) <= list(INSIDE.values()))
    for quantity, most in (("w_A_mm", CURVE), ("u_B_mm", 3.5e-2)):
        assert np.max(from_curve("sze-pinched", result, quantity)) <= most


@pytest.mark.slow
def test_arcs_bend_coarse_elements_as_far_as_fine_ones() -> None:
    """Beside the elastica, and the limit of the hemisphere, 8.144 of finer grids; chords are 16 and 2.8 % too stiff."""
    tip = referenced("cantilever", "exact", "tip_deflection_mm", load_fraction=1.0)[0]
    for element, mesh, least, most in (("refined", "4x1", -0.17, -0.15), ("arc", "4x1", -5e-3, 0.0)):
        actual = ended("cantilever", mesh, element=element).quantities["tip_deflection_mm"]
        assert least <= actual / tip - 1 <= most
    for element, off in (("refined", -0.028), ("arc", -7.5e-3)):
        actual = ended("hemisphere", "16x16", element=element).quantities["inward_mm"]
        assert actual / 8.144 - 1 == pytest.approx(off, abs=1e-3)
    ring = ended("sze-moment", "8x1", element="arc").quantities
    assert ring["tip_shortening_mm"] == pytest.approx(12.0, rel=5e-3)  # bent into a circle
    assert abs(ring["tip_deflection_mm"]) <= 1e-3


@pytest.mark.slow
def test_arcs_follow_folds_on_meshes_that_chords_follow() -> None:
    """Sze 3.6 and 3.7, to the published loads and without limit points of their own; the same limit."""
    for scene, mesh in (("sze-pinched", "40x40"), ("semicylinder", "20x20"), ("semicylinder", "24x24")):
        arcs, chords = (solved(scene, mesh, element=element).quantities for element in ("arc", "refined"))
        assert arcs["w_A_mm"] == pytest.approx(chords["w_A_mm"], rel=5e-3), (scene, mesh)
