"""Scenes whose walls need surfaces inside them: laminates, rubber, contact, against closed forms and solids."""

import itertools

import meshio
import numpy as np
import pytest
from scipy.integrate import solve_bvp

from formulations.section.laminate import Ply
from formulations.section.laws import LAWS, NeoHooke
from formulations.section.material import Hencky
from studies.ask.request import UsageError
from studies.ask.scene import SceneModel
from studies.scenes.benchmarks.layered_cylinders import HOOP, PRINTED, lame
from studies.scenes.benchmarks.pagano import COLUMNS, SQUARE
from studies.scenes.benchmarks.rubber import MU, RADIUS, SOFT, TERMS, THICK
from studies.scenes.closed_forms.elasticity import inflation_pressure
from studies.scenes.complete import complete, holding
from studies.solving.solve import solve
from support.problems.differences import fitted_order
from support.problems.solved import ended, read, solved

MESHES = 6, 12
SLOW = pytest.mark.slow


def square_plate(surfaces: str, S: float) -> dict[str, float]:
    """Of Pagano's square plate in the limit of two meshes, whose order is 2."""
    settings = {"S": str(S), "aspect": "1", "surfaces": surfaces}
    coarse, fine = (solved("pagano", f"{n}x{n}", measure="linear", **settings).quantities for n in MESHES)
    return {name: fine[name] + (fine[name] - coarse[name]) / 3 for name in fine}


@pytest.mark.parametrize(("surfaces", "within"), [("2/ply", 0.04), pytest.param("3/ply", 0.01, marks=SLOW)])
def test_surfaces_in_every_ply_come_to_elasticity(surfaces, within) -> None:
    """The limits of 2 and 3 a ply are those of layerwise polynomials of their degree, digit by digit."""
    actual = square_plate(surfaces, 4.0)["w_bar"]
    assert actual == pytest.approx(SQUARE[4.0][0], rel=within)
    assert actual == pytest.approx({"2/ply": 1.937908, "3/ply": 1.986382}[surfaces], rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("S", [4.0, 10.0])
def test_stresses_between_plies(S) -> None:
    """By the law and by equilibrium, four surfaces a ply."""
    actual = square_plate("4/ply", S)
    exact = dict(zip(COLUMNS.values(), SQUARE[S], strict=True))
    assert actual["w_bar"] == pytest.approx(exact["w_bar"], rel=3e-3)
    assert actual["sigma_x_bar"] == pytest.approx(exact["sigma_x_bar"], rel=5e-3)
    for name in ("tau_xz_bar", "tau_yz_bar"):
        assert actual[name] == pytest.approx(exact[name], rel=1e-2)
        assert actual[f"{name}_equilibrium"] == pytest.approx(exact[name], rel=5e-3)


def test_wrapped_cylinder_is_lames() -> None:
    free, fixed = (
        solved("wrapped-cylinder", "1x4", measure="linear", ends=ends).quantities for ends in ("free", "fixed")
    )
    for name, printed in zip(HOOP, PRINTED, strict=True):
        assert lame("free")[name] == pytest.approx(printed, rel=7e-3)
        assert free[name] == pytest.approx(lame("free")[name], rel=6e-3)
        assert fixed[name] == pytest.approx(lame("fixed")[name], rel=2e-3)
    fine = solved("wrapped-cylinder", "1x4", measure="linear", ends="fixed", surfaces="4/ply").quantities
    assert max(abs(fine[name] / lame("fixed")[name] - 1) for name in HOOP) <= 2e-4


@pytest.mark.parametrize(("scene", "law"), list(itertools.product(("rubber-tube", "rubber-sphere"), TERMS)))
@pytest.mark.parametrize(
    ("mesh", "surfaces"), [("2x2", "3"), pytest.param("2x2", "5", marks=SLOW), pytest.param("4x4", "3", marks=SLOW)]
)
def test_thick_rubber_is_blown_up_to_a_stretch_of_two(scene, law, mesh, surfaces) -> None:
    """nu = 0.4999: what volume costs leaves as many ways to keep it as a wall of n surfaces has, n - 1."""
    result = solved(scene, mesh, law=law, surfaces=surfaces)
    inner, outer = RADIUS * (1 - THICK / 2), RADIUS * (1 + THICK / 2)
    for stretch, pressure in zip((1.25, 1.5, 2.0), read(result, "pressure_MPa"), strict=True):
        exact = inflation_pressure(TERMS[law], stretch, inner, outer, sphere=scene == "rubber-sphere")
        assert pressure == pytest.approx(exact, rel=1e-3)
    assert all(step["stability"]["negative"] == 0 for step in result.steps)


def test_thin_rubber_takes_few_iterations_more_than_thick() -> None:
    """Its steps follow those of a wall that keeps its volume, and rounding is that of displacements from rest."""
    for scene in ("rubber-tube", "rubber-sphere"):
        thick, thin = solved(scene), solved(scene, h_over_R=0.01)
        inner, outer = RADIUS * (1 - 0.005), RADIUS * (1 + 0.005)
        exact = inflation_pressure(TERMS["neo-hooke"], 2.0, inner, outer, sphere=scene == "rubber-sphere")
        assert read(thin, "pressure_MPa")[-1] == pytest.approx(exact, rel=1e-3)
        assert thin.counters["newton_iterations"] <= thick.counters["newton_iterations"] + 2


def test_a_solid_cylinder_or_ball_but_for_a_hole_is_blown_up() -> None:
    """h/R = 1: the outer radius is three times the inner one."""
    for scene in ("rubber-tube", "rubber-sphere"):
        result = solved(scene, h_over_R=1, surfaces="5")
        exact = inflation_pressure(TERMS["neo-hooke"], 2.0, 0.5 * RADIUS, 1.5 * RADIUS, sphere=scene == "rubber-sphere")
        assert read(result, "pressure_MPa")[-1] == pytest.approx(exact, rel=3e-3)
        assert all(step["stability"]["negative"] == 0 for step in result.steps)


@pytest.mark.parametrize("nu", [0.3, 0.4999])
def test_stresses_of_a_wall_that_keeps_its_volume_are_lames(nu) -> None:
    """Radial ones at both faces and in the middle, and hoop ones: the pressure is not met where the strain is."""
    scene, request = complete("rubber-tube", {"law": "svk", "nu": str(nu), "load_fraction": "1e-6", "surfaces": "5"})
    result, shell = solve(scene, request), scene.build(request).shell.scaled(1e-6)
    sampling, inner, outer = shell.discretisation.wall.sampling, RADIUS * (1 - THICK / 2), RADIUS * (1 + THICK / 2)
    d = np.array([inner, RADIUS, outer]) - RADIUS
    S = shell.wall_stresses(result.end.point.solution.u, sampling.taken(0, d)[None])[:, 0]
    p, r = result.quantities["pressure_MPa"], RADIUS + d
    radial, hoop = (p / ((outer / inner) ** 2 - 1) * (1 + sign * (outer / r) ** 2) for sign in (-1, 1))
    assert np.abs(S[:, :, 5] - radial).max() <= 2e-3 * p
    assert np.abs(S[:, :, 1] / hoop - 1).max() <= 2e-3


def test_the_linear_law_leaves_nothing_of_a_wall_blown_up_further() -> None:
    for scene, last in (("rubber-tube", 0.41), ("rubber-sphere", 0.22)):
        assert solved(scene, law="svk", load_fraction=last, nu=0.499, h_over_R=0.03).quantities["thinning"] < 1
        with pytest.raises(
            UsageError, match=r"law = svk: at load_fraction = 0.42 the thickness of the wall would be negative"
        ):
            solved(scene, law="svk", load_fraction=0.42, nu=0.499)


def test_the_field_of_rubber_is_that_of_the_load_reached(tmp_path) -> None:
    """Half of the way out: the inner face of a tube whose radius doubles has moved by half of its radius."""
    scene, request = complete("rubber-tube", {"load_fraction": "0.25,0.5"})
    solve(scene, request).write_artefacts(tmp_path)
    moved = meshio.read(tmp_path / "fields.vtu").point_data["displacement"]
    radial = np.linalg.norm(np.split(moved, 2)[0], axis=1)
    assert radial == pytest.approx(np.full(len(radial), 0.5 * RADIUS * (1 - THICK / 2)), rel=1e-9)


def test_closed_forms_of_rubber_are_those_of_a_compressible_wall_that_hardly_is() -> None:
    """r'' of a tube in equilibrium, P_rr' + (P_rr - P_tt)/R = 0, by collocation with the law of the shell."""
    ply = Ply.isotropic(2 * MU * (1 + SOFT), SOFT, 1.0)
    law, inner, outer = NeoHooke.of(ply), RADIUS * (1 - THICK / 2), RADIUS * (1 + THICK / 2)

    def stress(R: np.ndarray, r: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        strain = np.zeros((len(R), 6))
        strain[:, 1], strain[:, 3] = 0.5 * ((r / R) ** 2 - 1), 0.5 * (slope**2 - 1)
        S, _ = law.response(strain)
        return slope * S[:, 3], r / R * S[:, 1]

    def field(R: np.ndarray, y: np.ndarray) -> np.ndarray:
        r, P = y  # the slope follows from P_rr by Newton
        slope = R / r
        for _ in range(30):
            now, _ = stress(R, r, slope)
            step = 1e-7 * slope
            tangent = (stress(R, r, slope + step)[0] - stress(R, r, slope - step)[0]) / (2 * step)
            slope = slope - (now - P) / tangent
        return np.stack([slope, (stress(R, r, slope)[1] - P) / R])

    stretch = 1.5
    R = np.linspace(inner, outer, 41)
    r = np.sqrt(R**2 + (stretch**2 - 1) * inner**2)
    actual = solve_bvp(field, lambda a, b: [a[0] - stretch * inner, b[1]], R, [r, 0.2 * (R - outer)], tol=1e-8)
    assert actual.success
    exact = inflation_pressure(TERMS["neo-hooke"], stretch, inner, outer, sphere=False)
    assert -actual.y[1, 0] / stretch == pytest.approx(exact, rel=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["svk", "hencky", "neo-hooke"])
def test_crushed_ring_of_any_law_is_that_of_the_solid(law) -> None:
    """The thick ring at its largest approach. Eight bricks through its wall are 0.1 % too stiff, four 0.7 %."""
    shell = solved("crushed-ring", surfaces="5", law=law)
    solid = solved("crushed-ring-solid", "1x24", law=law, newton="plain", per_ply=8).quantities["force_N"]
    assert shell.quantities["force_N"] == pytest.approx(solid, rel=2e-3)
    assert all(step["stability"]["negative"] == 0 for step in shell.steps)


@pytest.mark.slow
@pytest.mark.parametrize("surfaces", ["3", "5"])
def test_the_tyre_of_more_surfaces_is_stable_and_close(surfaces) -> None:
    """Two faces have the reduced law, the others the plain one; no element lets a surface alternate."""
    asked = {"delta_mm": "10,20", "E_MPa": "20", "nu": "0.3"}
    two, more = (solved("tyre", "24x20", surfaces=each, **asked) for each in ("2", surfaces))
    assert read(more, "force_N") == pytest.approx(read(two, "force_N"), rel=1e-2)
    assert all(step["stability"]["negative"] == 0 for step in more.steps)


@pytest.mark.slow
def test_the_tyre_of_cords_in_rubber_is_stable_and_close_to_that_of_linear_plies() -> None:
    """What is strained is the rubber, and the cords carry: the force is within a percent, at no travel the same."""
    linear, rubber = (solved("tyre", "16x46", surfaces="3", law=law) for law in ("svk", "neo-hooke"))
    change = read(rubber, "force_N") / read(linear, "force_N") - 1
    assert np.all((np.abs(change) > 1e-4) & (np.abs(change) < 1e-2))
    assert all(step["stability"]["negative"] == 0 for step in (*linear.steps, *rubber.steps))


def test_friction_acts_on_the_outer_face_of_more_surfaces() -> None:
    asked = {"E_MPa": "20", "nu": "0.3", "delta_mm": "10", "mu": "0.3"}
    two, three = (solved("tyre", "14x12", surfaces=each, **asked).quantities["force_N"] for each in ("2", "3"))
    assert three == pytest.approx(two, rel=2e-2)


def test_order_of_a_law_at_points() -> None:
    """The crushed ring on four meshes, its errors against their limit."""
    sizes, values = (4, 8, 16, 32), []
    for n in sizes:
        values.append(
            solved("crushed-ring", f"1x{4 * n}", surfaces="3", law="neo-hooke", delta_mm="5").quantities["force_N"]
        )
    errors = [abs(value - values[-1] - (values[-1] - values[-2]) / 3) for value in values[:-1]]
    assert fitted_order([1 / n for n in sizes[:-1]], errors) >= 1.5


@pytest.mark.parametrize(
    ("scene", "settings", "message"),
    [
        ("tyre", {"surfaces": "4"}, "must be one of 2, 3, 5, 7"),
        ("pagano", {"surfaces": "3", "element": "quads", "distort": "0.2"}, "need undistorted grid lines"),
        ("tyre", {"law": "hencky"}, "needs surfaces = 3 or more"),
        ("tyre", {"surfaces": "3", "section": "full-3d"}, "section = full-3d applies to two faces only"),
        (
            "scordelis-lo",
            {"surfaces": "3", "shear_correction": "0.8"},
            "shear_correction = 0.8 applies to two faces only",
        ),
        (
            "tyre",
            {"surfaces": "3", "element": "arc"},
            "bending = arc: arcs apply to two faces only, and the wall",
        ),
        ("tyre", {"bending": "arc"}, "bending = arc: arcs need thickness strain nodal, got balanced"),
        ("strip-contact", {"surfaces": "3"}, "the shear correction of this wall applies to two faces only"),
        ("raasch-hook", {"element": "arc"}, "element = 'arc' must be one of"),
        ("manufactured", {"law": "ogden"}, "manufactured has no setting 'law'"),
    ],
)
def test_what_does_not_go_with_surfaces_is_refused_in_one_line(scene, settings, message) -> None:
    with pytest.raises(UsageError, match=message):
        built(scene, settings)


def test_arcs_refuse_measures_that_know_no_large_rotations() -> None:
    with pytest.raises(UsageError, match="arcs apply to large rotations, which measure linear neglects"):
        built("hemisphere", {"element": "arc"}, measure="linear")


def test_laws_of_greens_strain_refuse_other_measures() -> None:
    with pytest.raises(UsageError, match="needs measure exact, got linear"):
        built("hemisphere", {"surfaces": "3", "law": "ogden"}, measure="linear")


def test_a_law_that_refuses_the_plies_is_a_wrong_request(monkeypatch) -> None:
    """One without cords, as of a file, to a ply that has some."""
    monkeypatch.setitem(LAWS, "bare", Hencky.of)
    for scene, settings in (("tyre", {"surfaces": "3"}), ("tyre-solid", {"E_L_MPa": "510.45"})):
        with pytest.raises(UsageError, match=r"bare.*: this law is isotropic: the ply must be, too"):
            built(scene, {**settings, "law": "bare"})


def built(scene: str, settings: dict[str, str], **options: str) -> SceneModel:
    actual, request = complete(scene, settings, **options)
    return actual.build(request)


@pytest.mark.slow
def test_three_surfaces_have_the_answers_of_thin_shells_of_two() -> None:
    """The plain law beside the reduced one, within 0.2 % on one mesh."""
    for scene, mesh, quantity in (
        ("hemisphere", "16x16", "inward_mm"),
        ("scordelis-lo", "16x16", "edge_deflection_mm"),
    ):
        two, three = (ended(scene, mesh, surfaces=each).quantities[quantity] for each in ("2", "3"))
        assert three == pytest.approx(two, rel=2e-3), scene


def test_a_reference_that_names_no_law_is_of_the_linear_one() -> None:
    """The membrane of a pressurised cylinder is St. Venant and Kirchhoff's: a wall of Hencky's is stretched further."""
    settings = {"surfaces": "3", "load_fraction": "0.25"}
    for law, known in (("svk", True), ("hencky", False)):
        scene, request = complete("pressurised-cylinder", {**settings, "law": law})
        there = {**request.settings, "measure": request.measure, "load_fraction": 0.25}
        assert bool(list(holding(scene.name, there))) is known
