"""The tyre of the paper, end to end: forces, patch, symmetry, algorithms, and the isotropic tyre against 3D solids."""

import numpy as np
import pytest

from contact.problem import Outcome
from studies.scenes.complete import complete as resolve
from studies.scenes.data import read_reference
from studies.solving.result import Result
from studies.solving.solve import solve

# force [N] at delta [mm] of the independent trial implementation, dead pressure on the mid area
TRIAL_FORCE = {5.0: 312.0, 10.0: 767.0, 15.0: 1327.0, 20.0: 1959.0}
ONE_PERCENT = 0.01
ISOTROPIC = {
    **{"E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"},
    **{"load": "follower", "pressure_area": "face"},
}
TO_20 = {"delta_mm": "20"}


def run(settings: dict[str, str], mesh: str = "42x40", **options: object) -> Result:
    return solve(*resolve("tyre", settings, mesh, **options))


@pytest.fixture(scope="module")
def paper() -> Result:
    """All of it, so that its symmetry is a finding."""
    return run({}, model="full")


@pytest.fixture(scope="module")
def coarse() -> Result:
    return run({}, "20x20", model="full")


@pytest.mark.slow
def test_paper_tyre_forces_within_one_percent(paper: Result) -> None:
    assert paper.outcome.converged
    by_name = {step["delta_mm"]: step["force_N"] for step in paper.steps}
    assert by_name == pytest.approx(TRIAL_FORCE, rel=ONE_PERCENT)


@pytest.mark.slow
def test_paper_tyre_centre_pressure_and_equator(paper: Result) -> None:
    assert paper.steps[-1]["centre_pressure_MPa"] == pytest.approx(0.158, rel=ONE_PERCENT)
    assert paper.steps[-1]["centre_pressure_MPa"] == pytest.approx(0.156, rel=0.015)  # printed
    assert paper.quantities["inflated_equator_outer_mm"] == pytest.approx(-1.79, rel=ONE_PERCENT)


@pytest.mark.parametrize("mesh", ["coarse", pytest.param("paper", marks=pytest.mark.slow)])
def test_every_step_passes_the_judge_and_is_centrally_symmetric(mesh: str, request: pytest.FixtureRequest) -> None:
    result: Result = request.getfixturevalue(mesh)
    assert [step["delta_mm"] for step in result.steps] == list(TRIAL_FORCE)
    for step in result.steps:
        assert step["kkt"]["equilibrium"] <= 1e-8
        assert step["kkt"]["penetration"] <= 1e-9
        assert step["kkt"]["tension"] == 0.0
        assert step["central_asymmetry"] <= 1e-9
        assert step["mirror_asymmetry"] > 0.01  # the angle-ply tyre does break mirror symmetry


@pytest.mark.slow
@pytest.mark.parametrize("mesh", ["20x20", "42x40"])
@pytest.mark.parametrize("element", ["paper", "refined"])
def test_a_load_deflection_curve_of_eight_points_takes_at_most_fifty_iterations(element: str, mesh: str) -> None:
    """From rest, inflation included: each point starts from the state and the set of the one before."""
    solution = run({"delta_mm": "2.5,5,7.5,10,12.5,15,17.5,20", "element": element}, mesh)
    assert len(solution.steps) == 8
    assert all(step["substeps"] == 1 for step in solution.steps)
    assert solution.counters["newton_iterations"] <= 50


@pytest.mark.slow
def test_one_step_takes_no_more_iterations_on_a_finer_mesh() -> None:
    """20 mm from the inflated state: Newton on the linearised contact problem does not feel the mesh."""
    coarse, fine = (run(TO_20, mesh=mesh).steps[-1] for mesh in ("42x40", "84x80"))
    for step in (coarse, fine):
        assert step["substeps"] == 1
        assert step["newton_iterations"] <= 12
    assert fine["newton_iterations"] <= 1.5 * coarse["newton_iterations"]


@pytest.mark.slow
def test_the_paper_tyre_goes_on_to_a_limit_point() -> None:
    """Beyond 37 mm the sidewall gives way beside the patch, well before the clamp: the program says so."""
    solution = run({"delta_mm": "30,35,40", "element": "paper"}, model="half")
    assert {step["delta_mm"]: step["force_N"] for step in solution.steps[:2]} == pytest.approx(
        {30.0: 3408.3, 35.0: 4193.8}, rel=1e-3
    )
    assert solution.outcome is Outcome.LIMIT_POINT
    assert "limit point of the path at 37.23" in solution.reason
    assert solution.quantities["press_limit_point"] == pytest.approx(37.236, abs=0.002)
    assert solution.quantities["patch_to_clamp_mm"] > 50


@pytest.mark.slow
@pytest.mark.parametrize("mesh", ["20x18", "28x26"])
def test_a_travel_beyond_the_limit_point_ends_at_it_for_a_bounded_cost(mesh: str) -> None:
    """Under 60 times the cost of a step to 20 mm, with a state that the judge would pass, and the place of the mode."""
    easy, lost = (run({"delta_mm": delta}, mesh, model="half") for delta in ("20", "40"))
    assert lost.outcome is Outcome.LIMIT_POINT
    for what in ("factorisations", "operations"):
        assert lost.counters[what] < 60 * easy.counters[what]
    limit = lost.quantities["press_limit_point"]
    assert f"limit point of the path at {limit:.7g}" in lost.reason
    assert "this is the path on the grid " in lost.reason
    assert "negative eigenvalues of the tangent" in lost.reason
    assert 50 < lost.quantities["mode_psi_deg"] < 90  # beside the rim of the patch
    assert lost.quantities["mode_phi_deg"] < 15
    assert "its mode is largest at psi = {mode_psi_deg:.4g}".format(**lost.quantities) in lost.reason
    assert lost.quantities["short_wave_N_mm"] < 0
    assert "a finer grid may turn back earlier" in lost.reason
    mode = lost.table("mode").frame()
    assert np.max(np.linalg.norm(mode[["x", "y", "z"]], axis=1)) == pytest.approx(1.0)
    reached = run({"delta_mm": f"{limit - 0.05}"}, mesh, model="half", steps=8)
    assert reached.outcome.converged  # by plain steps of the travel
    force = reached.steps[-1]["force_N"]
    forces = lost.model.candidates.weights @ lost.last.pressure * lost.model.part.copies
    assert force == pytest.approx(forces, rel=0.01)


@pytest.mark.parametrize(
    ("measure", "epsilon"),
    [("exact", "inf"), ("linear", "1e4")],
)
def test_algorithms_agree_in_set_and_force(measure: str, epsilon: str) -> None:
    settings = {**TO_20, "epsilon": epsilon}
    a, b = (run(settings, "20x20", measure=measure, contact=name) for name in ("semismooth", "trial-and-error"))
    assert a.outcome.converged
    assert b.outcome.converged
    assert np.array_equal(a.last.active, b.last.active)
    assert a.steps[-1]["force_N"] == pytest.approx(b.steps[-1]["force_N"], rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("section", ["constant-s33", "nonsymmetric"])
@pytest.mark.parametrize("load", ["dead", "follower"])
def test_every_algorithm_finds_the_same_set_and_force(load: str, section: str) -> None:
    """All settings at 5, 10, 15 and 20 mm; who needs symmetry refuses the non-symmetric section and says why."""
    ways = [("semismooth", {}), ("trial-and-error", {"epsilon": "inf"}), ("augmented-lagrangian", {}), ("qp", {})]
    ways += [("lcp", {"method": method}) for method in ("lemke", "active-set", "nnls")]
    ways += [("semismooth", {"epsilon": "1e4"}), ("trial-and-error", {}), ("regularised", {})]
    values = [
        (contact, run({"load": load, "section": section, **more}, mesh="14x14", contact=contact))
        for contact, more in ways
    ]
    for family in (values[:7], values[7:]):
        reference = family[0][1]
        assert reference.outcome.converged
        for contact, result in family[1:]:
            if not result.outcome.converged:
                assert result.outcome is Outcome.REFUSED
                assert "symmetric" in result.unsupported or "transpose" in result.unsupported
                assert contact in ("qp", "lcp")
                assert section == "nonsymmetric" or load == "follower"
                continue
            assert np.array_equal(result.last.active, reference.last.active)
            forces = [[step["force_N"] for step in each.steps] for each in (result, reference)]
            assert forces[0] == pytest.approx(forces[1], rel=1e-7)


@pytest.mark.slow
def test_epsilon_differs_from_the_exact_multiplier_by_parts_in_a_million() -> None:
    exact, regular = (run({**TO_20, "epsilon": epsilon}, "20x20") for epsilon in ("inf", "1e4"))
    difference = abs(regular.steps[-1]["force_N"] / exact.steps[-1]["force_N"] - 1)
    assert 1e-8 < difference < 5e-6
    assert regular.steps[-1]["kkt"]["penetration"] == pytest.approx(
        regular.last.pressure.max() / 1e4, rel=1e-6
    )  # p = -epsilon g


@pytest.mark.slow
def test_plain_newton_and_trial_and_error_reach_the_same_state(paper: Result) -> None:
    plain = run({**TO_20, "epsilon": "inf"}, contact="trial-and-error", newton="plain", steps=4, model="full")
    assert plain.outcome.converged
    assert plain.steps[-1]["force_N"] == pytest.approx(paper.steps[-1]["force_N"], rel=1e-8)
    assert np.array_equal(plain.last.active, paper.last.active)
    assert plain.counters["newton_iterations"] > 3 * 20


@pytest.mark.slow
def test_linear_theory_overestimates_the_force_about_as_the_paper_says(paper: Result) -> None:
    ratio = run(TO_20, measure="linear").steps[-1]["force_N"] / paper.steps[-1]["force_N"]
    assert 1.3 < ratio < 2.2  # "about two" in the paper; the report prints ours


@pytest.mark.parametrize(("load", "area"), [("dead", "mid"), ("follower", "face")])
def test_a_load_has_its_area_unless_another_is_named(load: str, area: str) -> None:
    """A follower pressure acts on the true face: on the mid-surface a tyre is 4 % stiffer than two 3D programs say."""
    base = {"delta_mm": "10", "load": load, "E_MPa": "20", "nu": "0.45", "plies": "1", "ply_thickness_mm": "4.8"}
    force = {
        name: run({**base, **named}, "12x12").steps[-1]["force_N"]
        for name, named in {"": {}, **{a: {"pressure_area": a} for a in ("mid", "face")}}.items()
    }
    assert force[""] == force[area]
    if load == "follower":
        assert force["mid"] / force["face"] == pytest.approx(1.04, abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize(("mesh", "force"), [("42x40", 2247.0), ("84x80", 2200.0)])
def test_follower_pressure_on_the_face(mesh: str, force: float) -> None:
    solution = run({**TO_20, "load": "follower", "pressure_area": "face"}, mesh)
    assert solution.steps[-1]["force_N"] == pytest.approx(force, rel=ONE_PERCENT)


@pytest.fixture(scope="module", params=["42x40", pytest.param("84x80", marks=pytest.mark.slow)])
def isotropic(request: pytest.FixtureRequest) -> Result:
    return run(ISOTROPIC, mesh=request.param)


@pytest.mark.slow
def test_isotropic_tyre_force_against_3d_solids(isotropic: Result) -> None:
    reference = read_reference("isotropic_tyre_3d_solid.csv").set_index("delta_mm")["force_N_ngsolve"]
    for step in isotropic.steps:
        bound = ONE_PERCENT if step["delta_mm"] >= 10 else 0.015
        assert step["force_N"] == pytest.approx(reference[step["delta_mm"]], rel=bound), step["delta_mm"]


def test_isotropic_tyre_is_mirror_symmetric(isotropic: Result) -> None:
    assert max(step["mirror_asymmetry"] for step in isotropic.steps) <= 1e-9


def test_isotropic_inflated_profile_against_3d_solids(isotropic: Result) -> None:
    three_percent = 0.03
    assert isotropic.quantities["inflated_equator_inner_mm"] == pytest.approx(4.6256, rel=three_percent)
    assert isotropic.quantities["inflated_equator_outer_mm"] == pytest.approx(4.3463, rel=three_percent)
    profile = isotropic.table("profile").frame()
    middle = 0.5 * (
        profile[["inner_radial_mm", "inner_axial_mm"]].to_numpy()
        + profile[["outer_radial_mm", "outer_axial_mm"]].to_numpy()
    )
    unloaded, inflated = (middle[profile["state"] == state] for state in ("unloaded", "inflated"))
    psi = profile.loc[profile["state"] == "inflated", "psi_deg"]
    reference = read_reference("isotropic_tyre_3d_inflation.csv")
    for axis, name in enumerate(("radial_mm", "axial_mm")):
        ours = np.interp(reference["psi_deg"], psi, (inflated - unloaded)[:, axis])
        # relative to the largest displacement of the profile
        assert np.max(np.abs(ours - reference[name])) <= three_percent * reference["radial_mm"].max()


def test_consistent_coupling_is_solved_and_keeps_central_symmetry() -> None:
    solution = run({**TO_20, "coupling": "consistent"}, "20x20", model="full")
    assert solution.outcome.converged
    assert solution.steps[-1]["central_asymmetry"] <= 1e-9
    assert solution.steps[-1]["kkt"]["penetration"] <= 1e-9


@pytest.mark.slow
def test_nonsymmetric_section_is_close_to_the_symmetric_one(paper: Result) -> None:
    solution = run({**TO_20, "section": "nonsymmetric"})
    assert solution.outcome.converged
    assert solution.steps[-1]["force_N"] == pytest.approx(paper.steps[-1]["force_N"], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("mesh", ["20x20", pytest.param("42x40", marks=pytest.mark.slow)])
def test_cross_ply_tyre_is_mirror_symmetric(mesh: str) -> None:
    """With the paper's element to 20 mm; near 12 mm such a tyre bifurcates, and the softer element finds that first."""
    for settings in ({**TO_20, "element": "paper"}, {"delta_mm": "10", "element": "refined"}):
        assert run({**settings, "gamma_deg": "0"}, mesh, model="full").steps[-1]["mirror_asymmetry"] <= 1e-9


@pytest.mark.slow
def test_quadrilaterals_of_any_shape_have_the_force_of_lines_of_curvature() -> None:
    """Limits of 30x86 and 60x172, whose elements are about as long as wide: 1881 N on own lines, 1882 N on random
    quadrilaterals, 1884 N on trapezoids. On 84x80 elements are up to eight times as long, those that are moved by a
    share of that are needles, and the force falls far slower.
    """

    def limit(**given: str) -> float:
        coarse, fine = (run({**TO_20, **given}, mesh).quantities["force_N"] for mesh in ("30x86", "60x172"))
        return float(fine + (fine - coarse) / 3)

    own = limit()
    assert own == pytest.approx(1877.3, rel=3e-3)
    for kind in ("random", "trapezoid"):
        assert limit(element="quads", distort="0.2", distortion=kind) == pytest.approx(own, rel=2e-3)
