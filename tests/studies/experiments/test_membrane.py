"""The membrane over a sphere: its closed form, and the orders that every exact algorithm shares.

The study of epsilon: its laws on a problem with a closed form, condition numbers, and where rounding takes over.
"""

import numpy as np
import pandas as pd
import pytest
from scipy import sparse
from scipy.integrate import quad, solve_ivp

from contact.catalogue import ALGORITHMS
from contact.problem import ContactSolution, Outcome
from studies.experiments import epsilon as study
from studies.experiments.membrane import EXACT, Membrane, membrane_table, quarter_disc
from studies.scenes.closed_forms.contact import SphereObstacle
from studies.scenes.complete import Cell
from support.problems.contact_problems import Quadratic, dual_by_nnls, random_quadratic

PRINTED = {"contact_radius": 0.348982574111686, "factor": -0.340129705945858}  # MFEM, example 36
SAME = 1e-9


@pytest.mark.parametrize("r0", [0.2, 0.5, 0.85])
def test_closed_form_is_the_solution(r0: float) -> None:
    """Found from outside in by an integrator: from value and slope at a, u vanishes at 1; forces are in balance."""
    exact = SphereObstacle(r0)
    if r0 == 0.5:
        assert {name: getattr(exact, name) for name in PRINTED} == pytest.approx(PRINTED, rel=0, abs=1e-15)
    a = exact.contact_radius
    start = [float(exact.height(np.array(a))), float(exact.slope(np.array(a - 1e-12)))]
    shot = solve_ivp(lambda r, y: [y[1], -y[1] / r], (a, 1.0), start, rtol=1e-11, atol=1e-13)
    assert shot.y[0, -1] == pytest.approx(0, abs=1e-9)
    r = np.linspace(0, 1, 2001)
    assert np.all(exact.deflection(r) >= exact.height(r) - 1e-14)

    def pressure(radius: float) -> float:
        phi = np.sqrt(r0**2 - radius**2)
        return float(2 * np.pi * radius * (2 / phi + radius**2 / phi**3))

    assert quad(pressure, 0, a)[0] == pytest.approx(exact.force, rel=1e-10)
    assert exact.radius_under(exact.force) == pytest.approx(a, rel=1e-12)


def test_slope_is_that_of_the_deflection_and_contact_beyond_the_sphere_is_refused() -> None:
    exact, r = SphereObstacle(), np.linspace(0.01, 0.99, 57)
    differences = (exact.deflection(r + 1e-6) - exact.deflection(r - 1e-6)) / 2e-6
    np.testing.assert_allclose(exact.slope(r), differences, atol=1e-5)
    for r0 in (0.0, 0.88, 1.5):
        with pytest.raises(ValueError, match="must lie in"):
            SphereObstacle(r0)


def test_quarter_of_the_disc() -> None:
    """The area of a polygon with its nodes on the circle, from below with the second order."""
    missing = []
    for level in (1, 2):
        mesh = quarter_disc(level)
        p = mesh.p[:, mesh.t]
        diagonals = p[:, 2] - p[:, 0], p[:, 3] - p[:, 1]
        areas = 0.5 * (diagonals[0][0] * diagonals[1][1] - diagonals[0][1] * diagonals[1][0])
        assert areas.min() > 0
        missing.append(1 - areas.sum() / (np.pi / 4))
    assert missing[0] / missing[1] == pytest.approx(4, rel=0.03)


def test_all_exact_algorithms_find_the_same_membrane() -> None:
    table = membrane_table({"P1": (2,), "Q1": (2,), "Q2": (1,)})
    assert set(table["algorithm"]) == set(EXACT)
    assert (table["outcome"] == "converged").all()
    assert table["apart"].max() < SAME
    assert table["force"].max() < 0.02
    assert table["radius_by_force"].to_numpy() == pytest.approx(PRINTED["contact_radius"], rel=0.01)


@pytest.mark.slow
def test_orders_are_those_of_the_theory() -> None:
    """2 and 1 for linear elements; 3/2 in the energy for quadratic ones, 2 were it not for the rim."""
    table = membrane_table(algorithms=tuple(name for name in EXACT if name != "qp"))
    assert table["apart"].max() < SAME
    for (element, _), rows in table.groupby(["element", "algorithm"]):
        if len(rows) < 4:
            continue  # lcp, not on the finest mesh
        orders = rows.iloc[0]
        if element == "Q2":
            assert orders["order_h1"] == pytest.approx(1.5, abs=0.15)
        else:
            assert orders["order_h1"] == pytest.approx(1, abs=0.02)
            assert orders["order_l2"] == pytest.approx(2, abs=0.1)
        assert orders["order_radius"] == pytest.approx(1, abs=0.3)
        assert orders["order_force"] > 1


def test_another_radius_must_fail() -> None:
    """The errors see a sphere that is larger by a hundredth."""
    right, wrong = (Membrane.build("Q2", 2, SphereObstacle(r0)) for r0 in (0.5, 0.505))
    solution = ALGORITHMS["semismooth"]().solve(right.body.problem(), right.body.begin())
    assert wrong.errors(solution)["l2"] > 10 * right.errors(solution)["l2"]


@pytest.fixture(scope="module")
def strip() -> pd.DataFrame:
    case = Cell("strip", "strip-contact", {"mesh": "16x1", "measure": "linear"}, {"load_fraction": "5"})
    return study.epsilon_study((case,), (1.0, 1e2, 1e4, 1e6, 1e8, 1e13))


def test_condition_of_a_known_matrix(rng) -> None:
    A = rng.normal(size=(12, 12))
    values = [study.condition(sparse.csc_matrix(A)) for _ in range(5)]
    assert len(set(values)) == 1
    assert values[0] / np.linalg.cond(A, 1) == pytest.approx(0.75, abs=0.2501)  # an estimate from below
    assert study.condition(sparse.csc_matrix(np.diag([1.0, 2.0, 8.0]))) == pytest.approx(8.0)
    assert study.condition(sparse.csc_matrix(np.diag([1.0, 0.0]))) == np.inf


def test_both_forms_solve_the_same_equations(rng) -> None:
    """Against the dual by nnls, on problems without a shell."""
    for kind in ("obstacle", "definite"):
        data = random_quadratic(rng, kind)
        n, m = len(data.f), len(data.w)
        start = ContactSolution.at_rest(n, m)
        for epsilon in (1.0, 1e3):
            u, pressure = dual_by_nnls(data, epsilon)
            actual = study.by_displacements(data.problem(), start, epsilon)
            assert actual.outcome is Outcome.CONVERGED
            np.testing.assert_allclose(actual.u, u, atol=1e-7)
            np.testing.assert_allclose(actual.pressure, pressure, atol=1e-6)


def test_multiplier_form_never_breaks_down_and_penetration_falls_as_one_over_epsilon(strip: pd.DataFrame) -> None:
    own = strip[strip["form"] == "multiplier"]
    soft, stiff = own[own["epsilon"].between(1e2, 1e6)], own[own["epsilon"] >= 1e4]
    for column in ("penetration_mm", "force_error"):
        slope = np.polyfit(np.log(soft["epsilon"]), np.log(np.abs(soft[column])), 1)[0]
        assert slope == pytest.approx(-1, abs=0.01)
    assert list(own["outcome"].unique()) == ["converged"]
    assert stiff["condition"].max() / stiff["condition"].min() < 1.1
    assert (stiff["nodes_unlike"] == 0).all()
    assert abs(own.set_index("epsilon")["force_error"][1e13]) <= 1e-12
    assert np.isinf(own["epsilon"].iloc[-1])
    assert own["force_error"].iloc[-1] == 0


def test_displacement_form_must_break_down(strip: pd.DataFrame) -> None:
    """Its condition grows with epsilon; where that meets double precision, nothing converges and the force is off."""
    own = strip[strip["form"] == "displacement"].set_index("epsilon")
    multiplier = strip[strip["form"] == "multiplier"].set_index("epsilon")
    assert own["force_N"][1e2] == pytest.approx(multiplier["force_N"][1e2], rel=1e-8)
    assert own["condition"][1e8] / own["condition"][1e6] == pytest.approx(100, rel=0.05)
    assert own["outcome"][1e13] != "converged"
    assert abs(own["force_error"][1e13]) > 0.01


def test_rounding_stops_the_displacement_form() -> None:
    """Gaps of the order 1 mm: epsilon times their rounding is more than the load."""
    data = Quadratic(np.eye(2), np.array([1.0, 2.0]), -np.eye(2), np.array([0.3, 0.6]), np.ones(2))
    problem, start = data.problem(), ContactSolution.at_rest(2, 2)
    assert study.by_displacements(problem, start, 1e3).outcome is Outcome.CONVERGED
    assert not study.by_displacements(problem, start, 1e17).outcome.converged


def test_a_case_and_its_epsilon_have_a_command() -> None:
    case = Cell("strip", "strip-contact", {"mesh": "16x1"}, {"load_fraction": "5"})
    options = "--mesh 16x1 --set load_fraction=5 --set epsilon=10000"
    assert study.command(case, 1e4) == f"footprint solve strip-contact {options} --out DIR"
    assert "--set epsilon=inf" in study.command(case, np.inf)


def test_the_wall_of_every_case_is_that_of_its_scene() -> None:
    """Modulus and thickness as asked for, and elements no smaller than the wall is thick, as the advice needs."""
    walls = {case.label: study.wall(case) for case in study.CASES}
    assert walls["tyre"][:2] == (510.45, pytest.approx(4.8))
    assert walls["rubber tyre, thin"][:2] == (20.0, pytest.approx(1.2))
    assert walls["strip"] == (1200.0, 1.0, 100 / 64)
    assert all(side > thickness for _, thickness, side in walls.values())
