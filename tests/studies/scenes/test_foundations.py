"""The tyre on drums, a sphere and a cleat: limits to the plane, order of the forces, what is refused."""

from itertools import pairwise

import numpy as np
import pytest

from studies.ask.scene import UsageError
from studies.scenes.complete import complete as resolve
from studies.scenes.foundations import PARAMETERS, foundation
from studies.solving.result import Result
from studies.solving.solve import solve
from support.problems.differences import fitted_order
from support.problems.solved import read, solved

FIRST_ORDER = 0.02  # half-width of the interval around the exponent -1 of force difference over radius
MIRROR = 0.02  # relative difference of what a drum takes and a hollow one adds


def pressed(foundation: str, mesh: str = "16x16", **given: str) -> Result:
    solution = solved("tyre", mesh, **{"foundation": foundation, "delta_mm": "4,8", "element": "paper", **given})
    for step in solution.steps:
        assert step["diagnosis"] == []
        assert max(step["balances"].values()) <= 1e-10
        assert step["central_asymmetry"] <= 1e-8
    return solution


def forces(found: Result) -> np.ndarray:
    return read(found, "force_N")


@pytest.mark.slow
def test_forces_grow_from_sphere_to_hollow_drum() -> None:
    order = [forces(pressed(name)) for name in ("sphere", "drum", "plane", "hollow-drum")]
    for less, more in pairwise(order):
        assert np.all(more > 1.02 * less)


@pytest.mark.slow
def test_large_drums_become_the_plane() -> None:
    """From both sides alike, with 1/R while the contact set stays: sign and size of the curvature in whole tyres."""
    flat, radii = forces(pressed("plane")), (1e5, 3e5, 1e6)
    outside = [flat - forces(pressed("drum", foundation_radius_mm=f"{R:g}")) for R in radii]
    inside = [forces(pressed("hollow-drum", foundation_radius_mm=f"{R:g}")) - flat for R in radii]
    assert np.all(np.array(outside) > 0)
    for load in range(2):
        assert abs(fitted_order(radii, [d[load] for d in outside]) + 1) <= FIRST_ORDER
    np.testing.assert_allclose(inside, outside, rtol=MIRROR)


@pytest.mark.slow
def test_a_high_and_wide_cleat_is_a_plane() -> None:
    """Its top is all that the tyre sees, to the last digit but rounding."""
    wide = pressed("cleat", cleat_top_mm="2000", cleat_height_mm="500")
    np.testing.assert_allclose(forces(wide), forces(pressed("plane")), rtol=1e-10)


@pytest.mark.slow
def test_a_low_cleat_lets_the_plane_carry() -> None:
    """At a travel of twice its height the tyre lies on both sides of it, too; the contact is in three parts."""
    solution = pressed("cleat", "24x32", cleat_height_mm="2", cleat_top_mm="6", cleat_rounding_mm="1", delta_mm="2,8")
    first, last = solution.steps
    assert 0 < first["contact_nodes"] < last["contact_nodes"]
    rows = solution.table("contact").frame()
    line = rows[(rows["psi_deg"].abs() < 1e-9) & (rows["delta_mm"] == 8)].sort_values("phi_deg")
    on = line.loc[line["active"] == 1, "x_mm"]
    assert np.ptp(on) == pytest.approx(2.0, abs=1e-6)  # nodes on the top and nodes on the base
    base, top = forces(pressed("plane", "24x32", delta_mm="6,8"))
    assert base < forces(solution)[-1] < top  # all of the base has come 6 mm, a part of the tyre 8


@pytest.mark.slow
def test_the_solid_takes_the_same_foundations() -> None:
    request = {"foundation": "drum", "foundation_radius_mm": "300", "delta_mm": "8"}
    quarter, whole = (solve(*resolve("tyre-solid", request, "8x10", model=model)) for model in ("quarter", "full"))
    flat = solve(*resolve("tyre-solid", {"delta_mm": "8"}, "8x10"))
    assert forces(quarter) == pytest.approx(forces(whole), rel=1e-8)
    assert forces(quarter)[0] < 0.98 * forces(flat)[0]


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_resolved_value_is_told(name) -> None:
    _, request = resolve("tyre", {"foundation": name})
    names = {key for key in request.settings if key.startswith(("foundation_", "cleat_"))}
    assert names == set(PARAMETERS[name])


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"foundation": "kerb"}, "hollow-drum"),
        ({"foundation_radius_mm": "100"}, "'plane' has no foundation_radius_mm"),
        ({"foundation": "sphere", "cleat_height_mm": "5"}, "'sphere' has no cleat_height_mm"),
        ({"foundation": "drum", "foundation_radius_mm": "0"}, "(0, 1e+06]"),
        ({"foundation": "cleat", "cleat_rounding_mm": "100"}, "no such cleat: a rounding of 100 mm"),
        ({"foundation": "cleat", "cleat_flank_deg": "120"}, "[1, 90]"),
        ({"foundation": "hollow-drum", "foundation_radius_mm": "200"}, "too narrow"),
    ],
)
def test_impossible_foundations_are_refused(given, said) -> None:
    with pytest.raises(UsageError) as caught:
        solve(*resolve("tyre", {"delta_mm": "2", **given}, "12x12"))
    assert said in str(caught.value)


@pytest.mark.slow
def test_a_tyre_does_not_go_through_the_edge_of_a_box(monkeypatch: pytest.MonkeyPatch) -> None:
    """In one step of 20 mm nodes go in through the top of a narrow box and hang on its side; in 20 steps none does."""
    box = {"cleat_height_mm": "20", "cleat_flank_deg": "90", "cleat_rounding_mm": "2", "cleat_top_mm": "10"}
    asked = {"foundation": "cleat", **box, "delta_mm": "20"}
    forces = {}
    for steps, checked in ((1, True), (1, False), (20, False)):
        if not checked:
            monkeypatch.setattr("contact.continuation.load_stepping.passed_through", lambda *step: [])
        solution = solve(*resolve("tyre", asked, "16x18", steps=steps))
        assert solution.outcome.converged == ((steps, checked) != (1, False))
        forces[steps, checked] = solution.quantities["force_N"]
        assert any("passes through" in cut for cut in solution.as_json()["cuts"]) == checked
        swept = [step["failures"] for step in solution.steps]
        assert swept == ([["swept"]] if (steps, checked) == (1, False) else [[]])
    assert forces[1, True] == pytest.approx(forces[20, False], rel=1e-6)
    assert forces[1, False] < 0.7 * forces[20, False]


@pytest.mark.parametrize("name", PARAMETERS)
def test_the_foremost_point_is_at_the_origin_and_the_tyre_before_it(name: str) -> None:
    actual = foundation({"foundation": name, **PARAMETERS[name]})
    np.testing.assert_allclose(actual.gap(np.array([[0.0, 0, 0], [-1.0, 0, 0]])), [0.0, 1.0], rtol=0, atol=1e-12)
