"""The membrane over a sphere: its closed form, and the orders that every exact algorithm shares."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from contact.catalogue import ALGORITHMS
from studies.experiments.membrane import EXACT, Membrane, membrane_table, quarter_disc
from studies.scenes.closed_forms.contact import SphereObstacle

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
