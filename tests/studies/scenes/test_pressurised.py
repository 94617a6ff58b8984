"""Walls under pressure against closed forms of membranes, and where thin and thick ones leave them."""

import pytest

from contact.problem import Outcome
from studies.scenes import SCENES
from studies.scenes.benchmarks.pressurised import sphere_load
from support.problems.solved import at, ended, referenced, solved

OLD = {"interpolation": "curvilinear", "thickness_strain": "nodal", "membrane": "compatible"}
UNIFORM = ("stretch", "thickness_ratio")


@pytest.mark.parametrize(
    ("scene", "where"), [("cylinder", {"ends": "fixed"}), ("cylinder", {"ends": "open"}), ("sphere", {})]
)
def test_a_pressurised_wall_is_the_membrane_on_every_mesh(scene: str, where: dict[str, str]) -> None:
    for mesh in ("1x1", "4x4"):
        result = solved(f"pressurised-{scene}", mesh, **OLD, **where)
        for fraction in (0.25, 0.5, 0.75, 1.0):
            exact = referenced(f"pressurised-{scene}", "exact", *UNIFORM, load_fraction=fraction, **where)
            assert at(result, fraction, *UNIFORM) == pytest.approx(exact, rel=1e-3)  # h/R


@pytest.mark.slow
def test_sphere_as_thin_as_double_precision_allows_and_thinner() -> None:
    """Rounding leaves 2e-3 of the load at h/R = 1e-7, where it moves nothing; ten times thinner no digit is left."""
    exact = referenced("pressurised-sphere", "exact", *UNIFORM, load_fraction=1.0)
    for h, residual in (("1e-4", 1e-5), ("1e-5", 1e-3)):
        thin = solved("pressurised-sphere", "4x4", **OLD, h_mm=h)
        assert max(step["kkt"]["equilibrium"] for step in thin.steps) > residual
        assert at(thin, 1.0, *UNIFORM) == pytest.approx(exact, rel=1e-5)
    thinner = ended("pressurised-sphere", "4x4", h_mm="1e-6")
    assert thinner.outcome is Outcome.STEP_LIMIT
    assert "singular to working precision" in thinner.reason


@pytest.mark.parametrize(
    ("h", "load", "thickness", "tolerance"),
    [("10", 1.0319, 0.8897, 2e-2), ("1", 1.0030, 0.9040, 3e-4)],  # 2 (h/R)^2, and the printed digits
)
def test_thick_sphere_against_the_3d_solution(h: str, load: float, thickness: float, tolerance: float) -> None:
    """3D St. Venant-Kirchhoff, pressure on the deformed inner face, stretch 1.1 of the middle: p over its membrane."""
    fraction = sphere_load(1.1) / sphere_load(1.2)
    for _ in range(4):
        settings = {"h_mm": h, "pressure_area": "face", "load_fraction": repr(float(fraction))}
        quantities = solved("pressurised-sphere", "4x4", **OLD, **settings).quantities
        ratio = fraction * sphere_load(1.2) / sphere_load(quantities["stretch"])
        fraction *= sphere_load(1.1) / sphere_load(quantities["stretch"])
    assert quantities["stretch"] == pytest.approx(1.1, abs=1e-5)
    assert ratio == pytest.approx(load, rel=tolerance)
    assert quantities["thickness_ratio"] == pytest.approx(thickness, rel=tolerance)


def torus_errors(mesh: str, h: str) -> dict[str, float]:
    found = solved("pressurised-torus", mesh, **OLD, h_mm=h).quantities
    names = [r.quantity for r in SCENES["pressurised-torus"].references]
    exact = referenced("pressurised-torus", "exact", *names, load_fraction=1.0)
    return {name: abs(found[name] / value - 1) for name, value in zip(names, exact, strict=True)}


def test_torus_carries_the_membrane_resultants() -> None:
    for mesh in ("32x1", "64x1", "128x1"):
        for name, error in torus_errors(mesh, "0.1").items():
            assert error <= (2e-2 if "theta_crown" in name else 1.5e-3), name
    # the hoop force at the crown is where the wall bends: what is left there falls as (h/r)^(1/3), not with the mesh
    thick, thin = (torus_errors("128x1", h)["N_theta_crown_N_per_mm"] for h in ("1", "0.125"))
    assert thick / thin == pytest.approx(8 ** (1 / 3), rel=0.15)
