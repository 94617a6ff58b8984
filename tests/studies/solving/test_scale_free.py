"""No unit, no travel and no load is a special one: scenes solved at scales far from ordinary ones, and judged there."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.optimize import nnls

from contact.catalogue import ALGORITHMS
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.verify import judge
from studies.ask.settings import configured
from studies.experiments.extremes import CONVERGED, FAILED, UNSTABLE, UNTOUCHED, attempt, chart_of
from studies.footprint import solve
from studies.scenes.complete import complete
from studies.scenes.walk import Visited, walk
from studies.solving.certificate import certificate
from studies.solving.solve import solve as solve_request

MAPS = ("length-unit", "stress-unit")
ROUNDING = 1e-8  # of forces; the tolerance of Newton is 1e-9
H = 0.5  # mm, of the panel that is pressed by less and less
LIGHT = 2e-6  # of the force


def ends(scene: str, contact: str, mesh: str, **settings: str) -> Visited:
    """The last point that a walk visits."""
    built, request = complete(scene, settings, mesh, contact=contact)
    *_, last = walk(built.build(request).stages(), configured(contact, request.settings))
    return last


@cache
def in_units(name: str, contact: str, exponent: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict[str, float]]:
    """u over the unit of length, forces over that of force, set, and counters of a point of a map."""
    cell = chart_of(name).point(f"{10.0**exponent:.6g}", contact)
    visited = ends("panel", contact, cell.options["mesh"], **cell.settings)
    solution, epsilon = visited.point.solution, float(cell.settings.get("epsilon", ALGORITHMS[contact]().epsilon))
    assert visited.converged
    assert certificate(visited.problem, solution, epsilon)["failures"] == []
    length, stress = (float(cell.settings.get(key, 1)) for key in ("length_unit", "stress_unit"))
    state = visited.state
    counters = {key: value for key, value in solution.counters.items() if not key.endswith("_s")}
    forces = visited.problem.nodal_forces(state.pressure) / (stress * length**2)
    return state.u / length, forces, state.active, counters


@pytest.mark.parametrize("contact", ALGORITHMS)
@pytest.mark.parametrize("exponent", [-12.0, 12.0])
@pytest.mark.parametrize("name", MAPS)
def test_a_panel_is_the_same_in_any_units(name, exponent, contact) -> None:
    """Powers of ten change the last digits and nothing else: certified, set, iterations, forces."""
    u, forces, active, counters = in_units(name, contact, exponent)
    own_u, own_forces, own_active, own_counters = in_units(name, contact, 0.0)
    np.testing.assert_array_equal(active, own_active)
    assert counters == own_counters
    np.testing.assert_allclose(u, own_u, rtol=0, atol=ROUNDING * np.max(np.abs(own_u)))
    np.testing.assert_allclose(forces, own_forces, rtol=0, atol=ROUNDING * np.max(own_forces))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MAPS, "touch", "everywhere"])
def test_the_whole_map_is_of_one_colour(name) -> None:
    """Of all points; a travel that the plane's place of 1 mm has no digit for is none.

    A plate that is inflated as a whole has a second equilibrium, which regularised finds in one step; it says so, or
    the judge does, that elements are inside out.
    """
    chart = chart_of(name)
    for i, contact in enumerate(chart.y.values):
        for j, x in enumerate(chart.x.values):
            below = name == "touch" and float(x) <= np.spacing(1.0) / 4
            other = name == "everywhere" and contact == "regularised" and float(x) > 0.3
            right = {UNTOUCHED} if below else {CONVERGED, UNSTABLE} if other else {CONVERGED}
            actual = attempt(chart.cell(i, j))
            assert actual.kind in right or (other and "inverted" in actual.reason), (contact, x)


@pytest.mark.slow
def test_the_thinnest_wall_is_right_or_given_up_for_rounding() -> None:
    """Which of both depends on the last digits of the machine."""
    actual = attempt(chart_of("thin-travel").point("0.562341", "2.05353e-06"))
    assert actual.kind in (CONVERGED, UNSTABLE) or "rounding" in actual.reason


@pytest.mark.slow
@pytest.mark.parametrize("h_over_R", ["4.21697e-06", "8.65964e-06"])
def test_a_very_thin_wall_is_known_to_the_last_digit_of_its_faces(h_over_R) -> None:
    """What is out of balance is what rounding each stored displacement brings, and next to nothing of all moves.

    Were the middle of the wall and its director stored, and not the faces, it would be ten thousand times less.
    """
    point = chart_of("thin-travel").point("0.562341", h_over_R)
    actual = ends("panel", "semismooth", point.options["mesh"], **point.settings)
    verdict = judge(actual.problem, actual.state.u, actual.state.pressure)
    assert verdict.failures() == []
    assert verdict.equilibrium > 100 * RESIDUAL_TOLERANCE
    body, u = actual.problem.linearise(actual.state.u, None), actual.state.u
    rng, half = np.random.default_rng(0), np.finfo(float).eps / 2

    def out_of_balance(stored: Callable[[], np.ndarray]) -> float:
        return float(np.median([np.linalg.norm(body.tangent @ stored()) for _ in range(50)])) / body.scale

    def faces() -> np.ndarray:
        return half * rng.uniform(-1, 1, u.shape) * np.abs(u)

    def middle_and_director() -> np.ndarray:
        inner, outer = u.reshape(-1, 3, 2).transpose(2, 0, 1)
        moved = half * rng.uniform(-1, 1, inner.shape) * np.abs(inner + outer) / 2
        turned = half * rng.uniform(-1, 1, inner.shape) * np.abs(outer - inner) / 2
        return np.stack([moved - turned, moved + turned], axis=-1).ravel()

    assert 0.3 < verdict.equilibrium / out_of_balance(faces) < 3
    assert out_of_balance(middle_and_director) < 1e-4 * out_of_balance(faces)


@pytest.mark.parametrize("contact", ALGORITHMS)
def test_a_travel_of_next_to_nothing_is_pressed_as_a_linear_body_is(contact) -> None:
    """Against Lawson and Hanson's least squares on the compliance of the unloaded panel, an epsilon's included."""
    share = 1e-9
    actual = ends("panel", contact, "4x4", h_over_R=f"{H / 100}", delta_mm=f"{share * H}")
    assert actual.converged
    problem, epsilon = actual.problem, ALGORITHMS[contact]().epsilon
    rest = np.zeros_like(actual.state.u)
    K, G = problem.linearise(rest, None).tangent.toarray(), problem.gap_jacobian(rest).toarray()
    compliance = G @ np.linalg.solve(K, G.T) + np.diag(1 / (epsilon * problem.weights))
    root = np.linalg.cholesky(compliance).T
    forces, _ = nnls(root, -np.linalg.solve(root.T, problem.gap(rest) / (share * H)))
    np.testing.assert_allclose(
        problem.nodal_forces(actual.state.pressure) / (share * H), forces, rtol=0, atol=LIGHT * forces.max()
    )


@cache
def force_on_tyre(contact: str, p0: str) -> float:
    """N, at a travel of 5 mm."""
    steps = solve("tyre", contact=contact, mesh="6x6", p0_MPa=p0, delta_mm="5").steps
    return float(steps["force_N"].iloc[-1])


@pytest.mark.parametrize(
    ("contact", "p0"),
    [
        pytest.param(contact, p0, marks=[] if (contact, p0) == ("semismooth", "-7e-18") else [pytest.mark.slow])
        for contact in ALGORITHMS
        for p0 in ("-7e-18", "1e-18", "1e-300")
    ],
)
def test_a_tyre_is_pressed_under_any_pressure_down_to_none(p0, contact) -> None:
    """-7e-18 MPa is no reason to end otherwise than none; 1e-4 MPa, the control, is seen in the force."""
    assert math.isclose(force_on_tyre(contact, p0), force_on_tyre(contact, "0"), rel_tol=1e-12)
    assert not math.isclose(force_on_tyre(contact, "1e-4"), force_on_tyre(contact, "0"), rel_tol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("nu", ["0.492501", "0.496838"])
def test_what_rounding_leaves_is_not_called_converged_unless_it_is_known_to_move_nothing(nu: str) -> None:
    """Nearly incompressible, 2e6 times thinner than its radius: four times beyond where the last digits decide."""
    actual = attempt(chart_of("nu-thin").point(nu, "5e-07"))
    assert actual.kind == FAILED


def test_what_is_read_off_a_panel_is_in_units_of_its_own() -> None:
    asked = ({}, {"length_unit": 1e3, "stress_unit": 1e-3})
    one, other = (solve_request(*complete("panel", each, "4x4")).quantities for each in asked)
    assert one["peak_MPa"] > 0
    assert other == pytest.approx(one, rel=1e-8)
