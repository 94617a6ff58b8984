"""Curves of scenes by power series, by arc length, and who decides.

The shallow cap: its shallow equations against plates and published numbers, the scene against both.
"""

import math
from pathlib import Path

import numpy as np
import pytest

import studies.footprint
from contact.continuation.arc_length import ArcLength
from contact.continuation.series_path import PowerSeries
from studies.ask.scene import CurveStage
from studies.cli import main
from studies.scenes import SCENES
from studies.scenes.benchmarks.shallow_cap import BASE, NU, RADIUS, RISE, shallow_cap, thickness
from studies.scenes.closed_forms.marguerre_cap import ShallowCap, classical_pressure, shallowness
from studies.scenes.complete import complete as resolve
from studies.solving.result import Result
from studies.solving.solve import solve

CURVES = (*(f"roof-{letter}" for letter in "abcdef"), "shallow-cap", "sze-pullout")
FACTORISATIONS = 40  # of the whole curve; arc length takes 126 to 316
LIMIT_LOAD = 1e-8  # relative
STATE = 1e-7  # relative, of what is read off at a requested load


def continuation(**asked) -> object:
    scene, request = resolve("roof-a", asked.pop("given", {}), "2x2", **asked)
    (stage,) = scene.build(request).stages()
    assert isinstance(stage, CurveStage)
    return stage.continuation


def test_series_are_taken_where_they_apply() -> None:
    assert isinstance(continuation(), PowerSeries)
    assert isinstance(continuation(measure="sanders"), PowerSeries)
    assert isinstance(continuation(measure="elongation"), ArcLength)
    assert isinstance(continuation(given={"path": "arc-length"}), ArcLength)


def test_what_does_not_apply_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    asked = ["solve", "roof-a", "--mesh", "2x2", "--measure", "elongation", "--set", "path=series", "--out", str(out)]
    assert main(asked) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "path = series" in line
    assert "elongation" in line
    assert "arc-length" in line
    assert not out.exists()


def test_a_notebook_reads_the_curve_where_the_load_passes() -> None:
    run = studies.footprint.solve("roof-a", mesh="4x4", load_fraction=[0.25, 1.0])
    at, step = run.at(0.25), run.result.loads[0].seen
    assert at == pytest.approx(step, rel=1e-9)
    assert run.at(0.25, passage=1)["w_C_mm"] > at["w_C_mm"]
    assert run.result.at(0.25).u.shape == (run.result.model.n_unknowns,)
    with pytest.raises(LookupError):
        run.at(1.5)
    with pytest.raises(LookupError, match="points alone"):
        studies.footprint.solve("roof-a", mesh="2x2", path="arc-length", load_fraction=0.25).at(0.25)
    with pytest.raises(LookupError, match="load steps"):
        studies.footprint.solve("cantilever", mesh="4x1").at(0.25)


@pytest.mark.parametrize("path", ["series", pytest.param("arc-length", marks=pytest.mark.slow)])
def test_the_picture_is_drawn_from_the_curve(path: str, tmp_path: Path) -> None:
    run = studies.footprint.solve("roof-a", mesh="2x2", path=path)
    drawn = run.figures()[0].axes[0].lines[0].get_xydata()
    assert drawn[0].tolist() == [0.0, 0.0]  # rest, which is not a row
    assert drawn[1:, 1].tolist() == pytest.approx(run.result.table("curve").columns["load_fraction"])


def both(scene: str, mesh: str | None) -> list[Result]:
    return [solve(*resolve(scene, {"path": path}, mesh)) for path in ("series", "arc-length")]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "mesh"), [("roof-d", "4x4"), *(pytest.param(name, None, marks=pytest.mark.slow) for name in CURVES)]
)
def test_series_find_what_arc_length_finds(scene: str, mesh: str | None) -> None:
    """Limit loads, what is read off at requested loads, and whether one can stand there."""
    series, arc = both(scene, mesh)
    assert series.verdict == arc.verdict == "converged"
    key = "load_fraction"
    limits = [[s.load[key] for s in each.loads if s.counters["limit_point"]] for each in (series, arc)]
    assert len(limits[0]) >= 2
    assert limits[0] == pytest.approx(limits[1], rel=LIMIT_LOAD)
    for asked in series.request.numbers(key):
        ours, theirs = (next(s for s in each.loads if abs(s.load[key] - asked) < 1e-12) for each in (series, arc))
        assert ours.quantities == pytest.approx(theirs.quantities, rel=STATE)
        assert ours.certificate["stability"]["word"] == theirs.certificate["stability"]["word"]
    assert series.counters["factorisations"] <= FACTORISATIONS
    assert series.counters["factorisations"] <= 0.2 * arc.counters["factorisations"]


def test_all_curves_are_among_those_compared() -> None:
    traced = set()
    for name in SCENES:
        if any(setting.key == "path" and "series" in setting.choices for setting in SCENES[name].settings):
            traced.add(name)
    assert traced == {*CURVES}


PUBLISHED = 0.005  # of Teng and Rotter's three digits for caps four times as deep
CONVERGED = 0.002  # of the snap pressure of the shallow equations: shear, depth and the hole are left
AT = {"shallowness": 4.0}
HOLE = 1.5  # least order of the hole's error in its radius (theory: 2, less a logarithm)


def scene(mesh: str, **settings: object) -> Result:
    measure = settings.pop("measure", "exact")
    # compatible membranes: relaxed ones see the length of the elements around, which here are long
    given = {"membrane": "compatible", **{key: str(value) for key, value in settings.items()}}
    solution = solve(*resolve("shallow-cap", given, mesh, measure=measure))
    assert solution.outcome.converged, solution.reason
    return solution


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
        a, b, c = (actual.quantities[quantity] for actual in meshes)
        assert 1.4 < math.log2((a - b) / (b - c)) < 2.3
        assert c + (c - b) / 3 == pytest.approx(value, rel=CONVERGED)
    assert all(actual.quantities["limit_points"] == 2 for actual in meshes)  # down again, and up in the inverted shape


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
        actual = scene("16x1", measure=measure).quantities["limit_load_fraction"]
        assert 1e-5 < abs(actual / exact - 1) < 2e-3
