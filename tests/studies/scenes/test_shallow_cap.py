"""The shallow cap: its shallow equations against plates and published numbers, the scene against both."""

import math

import numpy as np
import pytest

from studies.scenes import SCENES
from studies.scenes.benchmarks.shallow_cap import BASE, NU, RADIUS, RISE, shallow_cap, thickness
from studies.scenes.closed_forms.marguerre_cap import ShallowCap, classical_pressure, shallowness
from studies.scenes.complete import complete as resolve
from studies.solving.result import Result
from studies.solving.solve import solve

PUBLISHED = 0.005  # of Teng and Rotter's three digits for caps four times as deep
CONVERGED = 0.002  # of the snap pressure of the shallow equations: shear, depth and the hole are left
AT = {"shallowness": 4.0}
HOLE = 1.5  # least order of the hole's error in its radius (theory: 2, less a logarithm)


def scene(mesh: str, **settings: object) -> Result:
    measure = settings.pop("measure", "exact")
    # compatible membranes: relaxed ones see the length of the elements around, which here are long
    given = {"membrane": "compatible", **{key: str(value) for key, value in settings.items()}}
    found = solve(*resolve("shallow-cap", given, mesh, measure=measure))
    assert found.outcome.converged, found.reason
    return found


# --- the shallow equations ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("nu", [0.0, 0.3])
def test_flat_cap_is_the_clamped_plate(nu) -> None:
    """R to infinity: p = 64 D/a^4 (w + c w^3/h^2 + ...) with Chien's c = (1 + nu)(173 - 73 nu)/360 (recalled)."""
    E, h, a = 1e3, 0.5, 20.0
    plate = ShallowCap(E, nu, 1e9, a, h)
    stiffness = 64 * E * h**3 / (12 * (1 - nu**2)) / a**4
    assert plate.at_deflection(1e-6)[0] / 1e-6 == pytest.approx(stiffness, rel=1e-6)
    cubic = (plate.at_deflection(0.05 * h)[0] / (0.05 * h * stiffness) - 1) / 0.05**2
    assert cubic == pytest.approx((1 + nu) * (173 - 73 * nu) / 360, rel=1e-3)


def test_shallow_equations_do_not_depend_on_their_degree() -> None:
    w = np.linspace(0.25, 2 * RISE, 20)
    fine = ShallowCap(1e4, NU, RADIUS, BASE, thickness(4.0), degree=36)
    np.testing.assert_allclose(shallow_cap(4.0).curve(w), fine.curve(w), rtol=1e-9)


@pytest.mark.parametrize("lam", [4.0, 5.0, 5.5])
def test_published_snap_pressures_are_met(lam) -> None:
    """Teng and Rotter within their digits; Budiansky's older ones are 2 to 6 % higher."""
    at = [r for r in SCENES["shallow-cap"].references if r.at["shallowness"] == lam and "load" in r.quantity]
    teng, budiansky, computed = (r.value for r in at)
    assert [r.kind for r in at] == ["read", "read", "computed"]
    pressure, _ = shallow_cap(lam).snap(2 * RISE)
    assert computed == pytest.approx(pressure / classical_pressure(1e4, NU, RADIUS, thickness(lam)), rel=1e-5)
    assert computed == pytest.approx(teng, rel=PUBLISHED)
    assert 1.02 < budiansky / computed < 1.06
    assert shallowness(RISE, thickness(lam), NU) == pytest.approx(lam, rel=1e-12)


def test_a_shallower_cap_does_not_snap() -> None:
    with pytest.raises(ArithmeticError, match="no limit point up to w0"):
        shallow_cap(3.0).snap(2 * RISE)


# --- the scene ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def meshes() -> list[Result]:
    return [scene(f"{n}x1") for n in (16, 32, 64)]


@pytest.mark.slow
def test_snap_pressure_converges_to_the_shallow_equations(meshes) -> None:
    """Second order; the extrapolated pressure and deflection are those of the shallow equations."""
    exact = {r.quantity: r.value for r in SCENES["shallow-cap"].references if (r.kind, r.at) == ("computed", AT)}
    for quantity, value in exact.items():
        a, b, c = (found.quantities[quantity] for found in meshes)
        assert 1.4 < math.log2((a - b) / (b - c)) < 2.3
        assert c + (c - b) / 3 == pytest.approx(value, rel=CONVERGED)
    assert all(found.quantities["limit_points"] == 2 for found in meshes)  # down again, and up in the inverted shape


@pytest.mark.slow
def test_the_curve_is_that_of_the_shallow_equations(meshes) -> None:
    """At every point up to a sag of the rise, far beyond the snap: 1 % of the snap pressure."""
    (curve,) = meshes[2].tables["curve"]
    w, p = (np.array(curve.columns[name]) for name in ("w_apex_mm", "load_fraction"))
    w, p = w[w <= RISE], p[w <= RISE]
    assert len(w) >= 12
    classical = classical_pressure(1e4, NU, RADIUS, thickness(4.0))
    np.testing.assert_allclose(p, shallow_cap(4.0).curve(w) / classical, rtol=0, atol=0.006)


@pytest.mark.slow
def test_elements_around_do_not_matter(meshes) -> None:
    around = scene("16x3").quantities
    assert around == pytest.approx(meshes[0].quantities, rel=1e-6)


@pytest.mark.slow
def test_cost_of_the_hole_falls_with_its_area() -> None:
    """Differences of successive holes, each half of the last."""
    snap = [scene("32x1", hole=hole).quantities["limit_load_fraction"] for hole in (0.1, 0.05, 0.025, 0.0125)]
    steps = -np.diff(snap)
    assert np.all(steps > 0)
    assert np.all(np.log2(steps[:-1] / steps[1:]) > HOLE)
    assert snap[0] / snap[-1] - 1 == pytest.approx(0.025, abs=0.005)
    assert steps[-1] / 3 < 0.001 * snap[-1]  # what is left of it at the default hole


@pytest.mark.slow
def test_a_linear_cap_never_snaps_and_shallow_measures_do_as_well_as_any() -> None:
    """Rotations stay below 0.1: Donnell and von Karman differ from the exact measure by less than the mesh, 0.8 %."""
    linear = scene("16x1", measure="linear").quantities
    assert linear["limit_points"] == 0
    exact = scene("16x1").quantities["limit_load_fraction"]
    for measure in ("donnell", "moderate-rotation"):
        found = scene("16x1", measure=measure).quantities["limit_load_fraction"]
        assert 1e-5 < abs(found / exact - 1) < 2e-3
