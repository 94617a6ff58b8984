"""Nonlinear benchmark scenes against published, computed and closed-form values, on three meshes and extrapolated.

Published values are ABAQUS S4R on one mesh, transcribed: they carry its errors. Where ours differ by more than the
tolerance, the test says by how much, and which independent value decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

from contact.problem import Outcome
from studies.scenes import SCENES
from studies.scenes.benchmarks.pressurised import sphere_load
from studies.scenes.benchmarks.sze_annulus import P_MAX
from studies.scenes.complete import complete as resolve
from studies.solving.refinement.grids import Family
from studies.solving.result import Result
from studies.solving.solve import solve

CLOSE = 5e-3  # of a published value, after refinement
LIMIT = "limit_load_fraction"


@cache
def run(scene: str, mesh: str, steps: int = 1, **settings: str) -> Result:
    given = {"interpolation": "curvilinear", "thickness_strain": "nodal", "membrane": "compatible", **settings}
    result = solve(*resolve(scene, given, mesh, steps=steps))
    assert result.outcome is Outcome.CONVERGED, result.reason
    for step in result.steps:
        assert step["kkt"]["equilibrium"] <= max(1e-9, step["rounding"])
    return result


def at(result: Result, fraction: float, *quantities: str) -> np.ndarray:
    step = next(step for step in result.steps if step["load_fraction"] == fraction)
    return np.array([step[quantity] for quantity in quantities])


def reference(scene: str, kind: str, fraction: float, *quantities: str, **where: str) -> np.ndarray:
    wanted = {"load_fraction": fraction, **where}
    found = {
        r.quantity: r.value
        for r in SCENES[scene].references
        if r.kind == kind and all(r.at.get(key) == value for key, value in wanted.items())
    }
    return np.array([found[quantity] for quantity in quantities])


def extrapolated(coarse: np.ndarray, fine: np.ndarray, ratio: float) -> np.ndarray:
    """Limit of a sequence whose error is of the order 2 in the element size; ``ratio``: coarse over fine size."""
    return fine + (fine - coarse) / (ratio**2 - 1)


# --- pull-out, hemisphere ---------------------------------------------------------------------------------------------


ENDS = ("outward_mm", "inward_mm")
QUARTERS = "0.05,0.25,0.5,0.75,1"


def hemispheres(solver: Callable[..., Result]) -> list[Result]:
    return [solver("hemisphere", mesh, load_fraction=QUARTERS) for mesh in ("16x16", "24x24", "32x32")]


@pytest.mark.slow
def test_hemisphere_is_pulled_as_published() -> None:
    """The inward point as published from three quarters of the load on; before, S4R lies 0.6 to 0.9 % above our limit.

    It does so already at a twentieth of the load, where the outward point agrees to 0.2 %; a high-order code confirms
    our limit of both at a hundredth (tests of the linear scenes), and isoparametric elements have it at every load.
    """
    curvilinear = hemispheres(run)
    isoparametric = hemispheres(partial(run, interpolation="isoparametric"))
    for fraction in (0.05, 0.25, 0.5, 0.75, 1.0):
        found = [at(result, fraction, *ENDS) for result in curvilinear]
        assert np.all(np.diff(found, axis=0) > 0)
        assert np.all(found[2] - found[1] < found[1] - found[0])
        limit = extrapolated(found[1], found[2], 4 / 3)
        others = [at(result, fraction, *ENDS) for result in isoparametric]
        assert extrapolated(others[1], others[2], 4 / 3) == pytest.approx(limit, rel=1.5e-3)
        outward, inward = reference("hemisphere", "read", fraction, *ENDS) / limit - 1
        assert abs(outward) <= (CLOSE if fraction > 0.25 else 2e-3)
        if fraction >= 0.75:
            assert abs(inward) <= CLOSE
        else:
            assert CLOSE < inward <= 9e-3


@pytest.mark.slow
def test_nodal_thickness_strain_pays_on_the_hemisphere() -> None:
    inward = reference("hemisphere", "read", 1.0, "inward_mm")
    projected, nodal = (
        abs(at(run("hemisphere", "16x16", thickness_strain=option), 1.0, "inward_mm") / inward - 1)
        for option in ("projected", "nodal")
    )
    assert nodal < 0.5 * projected


POINTS = ("w_A_mm", "u_B_mm", "u_C_mm")


@pytest.mark.slow
def test_pulled_cylinder_before_the_snap() -> None:
    found = [at(run("sze-pullout", mesh, load_fraction="0.25"), 0.25, *POINTS) for mesh in ("8x12", "12x18", "16x24")]
    printed = reference("sze-pullout", "read", 0.25, *POINTS)
    errors = [np.max(np.abs(value / printed - 1)) for value in found]
    assert errors[0] > errors[1] > errors[2]
    assert extrapolated(found[0], found[2], 2) == pytest.approx(printed, rel=CLOSE)


PULLED = ("12x18", "16x24", "24x36")


@pytest.mark.slow
def test_pulled_cylinder_through_the_snap() -> None:
    """After the snap, A within 0.1 %; B and C up to 0.65 % from S4R on one mesh, 24x36.

    Isoparametric elements have our limits to 0.05 %.
    """
    load = "0.75,1"
    curvilinear = [run("sze-pullout", mesh, load_fraction=load) for mesh in PULLED]
    isoparametric = [run("sze-pullout", mesh, load_fraction=load, interpolation="isoparametric") for mesh in PULLED]
    for fraction in (0.75, 1.0):
        found, others = ([at(r, fraction, *POINTS) for r in results] for results in (curvilinear, isoparametric))
        limit = extrapolated(found[1], found[2], 1.5)
        assert extrapolated(others[1], others[2], 1.5) == pytest.approx(limit, rel=5e-4)
        error = np.abs(limit / reference("sze-pullout", "read", fraction, *POINTS) - 1)
        assert error[0] <= 1e-3
        assert np.max(error) <= 6.5e-3
    # the published table jumps between 0.5 and 0.525; ours passes a maximum there, and a minimum 1 % below it
    snaps = [result.quantities[LIMIT] for result in curvilinear]
    assert snaps[0] < snaps[1] < snaps[2]
    assert 0.5 < snaps[2] < extrapolated(np.array(snaps[1]), np.array(snaps[2]), 1.5) < 0.525
    assert [result.quantities["limit_points"] for result in curvilinear] == [2, 2, 2]


# --- pressure ---------------------------------------------------------------------------------------------------------

UNIFORM = ("stretch", "thickness_ratio")


@pytest.mark.parametrize(
    ("scene", "where"), [("cylinder", {"ends": "fixed"}), ("cylinder", {"ends": "open"}), ("sphere", {})]
)
def test_a_pressurised_wall_is_the_membrane_on_every_mesh(scene: str, where: dict[str, str]) -> None:
    for mesh in ("1x1", "4x4"):
        result = run(f"pressurised-{scene}", mesh, **where)
        for fraction in (0.25, 0.5, 0.75, 1.0):
            exact = reference(f"pressurised-{scene}", "exact", fraction, *UNIFORM, **where)
            assert at(result, fraction, *UNIFORM) == pytest.approx(exact, rel=1e-3)  # h/R


@pytest.mark.slow
def test_sphere_as_thin_as_double_precision_allows_and_thinner() -> None:
    """Rounding leaves 2e-5 of the load at h/R = 1e-6, where it moves nothing; ten times thinner it is too much."""
    thin = run("pressurised-sphere", "4x4", h_mm="1e-4")
    assert max(step["kkt"]["equilibrium"] for step in thin.steps) > 1e-5
    exact = reference("pressurised-sphere", "exact", 1.0, *UNIFORM)
    assert at(thin, 1.0, *UNIFORM) == pytest.approx(exact, rel=1e-5)
    thinner = solve(*resolve("pressurised-sphere", {"h_mm": "1e-5"}, "4x4"))
    assert thinner.outcome is Outcome.STEP_LIMIT
    assert Outcome.ROUNDING.value in thinner.reason


@pytest.mark.parametrize(
    ("h", "load", "thickness", "tolerance"),
    [("10", 1.0319, 0.8897, 2e-2), ("1", 1.0030, 0.9040, 3e-4)],  # 2 (h/R)^2, and the printed digits
)
def test_thick_sphere_against_the_3d_solution(h: str, load: float, thickness: float, tolerance: float) -> None:
    """3D St. Venant-Kirchhoff, pressure on the deformed inner face, stretch 1.1 of the middle: p over its membrane."""
    fraction = sphere_load(1.1) / sphere_load(1.2)
    for _ in range(4):
        settings = {"h_mm": h, "pressure_area": "face", "load_fraction": repr(float(fraction))}
        quantities = run("pressurised-sphere", "4x4", **settings).quantities
        ratio = fraction * sphere_load(1.2) / sphere_load(quantities["stretch"])
        fraction *= sphere_load(1.1) / sphere_load(quantities["stretch"])
    assert quantities["stretch"] == pytest.approx(1.1, abs=1e-5)
    assert ratio == pytest.approx(load, rel=tolerance)
    assert quantities["thickness_ratio"] == pytest.approx(thickness, rel=tolerance)


def torus_errors(mesh: str, h: str) -> dict[str, float]:
    found = run("pressurised-torus", mesh, h_mm=h).quantities
    names = [r.quantity for r in SCENES["pressurised-torus"].references]
    exact = reference("pressurised-torus", "exact", 1.0, *names)
    return {name: abs(found[name] / value - 1) for name, value in zip(names, exact, strict=True)}


def test_torus_carries_the_membrane_resultants() -> None:
    for mesh in ("32x1", "64x1", "128x1"):
        for name, error in torus_errors(mesh, "0.1").items():
            assert error <= (2e-2 if "theta_crown" in name else 1.5e-3), name
    # the hoop force at the crown is where the wall bends: what is left there falls as (h/r)^(1/3), not with the mesh
    thick, thin = (torus_errors("128x1", h)["N_theta_crown_N_per_mm"] for h in ("1", "0.125"))
    assert thick / thin == pytest.approx(8 ** (1 / 3), rel=0.15)


@pytest.mark.parametrize("lines", ["even", "edges"])
@pytest.mark.parametrize("cut", [False, True])
def test_an_edge_load_is_uniform_on_lines_of_any_spacing(lines: str, cut: bool) -> None:
    """The side of the slit annulus, its elements of different size: resultant and moment about the axis."""
    scene, request = resolve("sze-annulus", {"lines": lines}, "6x20")
    if cut:
        tree = Family.of(scene, request).tree
        assert tree is not None
        leaves = tree.refined(tree.leaves[:, 1] < 2).leaves
        request = replace(request, leaves=tuple(map(tuple, leaves.tolist())))
    shell = scene.build(request).shell
    force, radii = (
        shell.discretisation.map.placed(shell.forces)[:, 4:].sum(axis=1),
        shell.discretisation.grid.nodes[:, 0],
    )
    inner, outer = shell.discretisation.grid.ends[0]
    assert force.sum() == pytest.approx(P_MAX * (outer - inner))
    assert force @ radii == pytest.approx(P_MAX * (outer**2 - inner**2) / 2)
    if not cut:  # no node hangs: each carries what its hat function does
        side = shell.discretisation.grid.on_line(1, 0.0)
        fine = np.linspace(inner, outer, 20001)
        hats = [np.trapezoid(np.interp(fine, radii[side], unit), fine) for unit in np.eye(len(side))]
        np.testing.assert_allclose(force[side], P_MAX * np.array(hats), rtol=1e-6)
