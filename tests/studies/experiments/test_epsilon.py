"""The study of epsilon: its laws on a problem with a closed form, condition numbers, and where rounding takes over."""

import numpy as np
import pandas as pd
import pytest
from scipy import sparse

from contact.problem import ContactSolution, Outcome
from studies.experiments import epsilon as study
from studies.scenes.complete import Cell
from support.problems.contact_problems import Quadratic, dual_by_nnls, random_quadratic


@pytest.fixture(scope="module")
def strip() -> pd.DataFrame:
    case = Cell("strip", "strip-contact", {"mesh": "16x1", "measure": "linear"}, {"load_fraction": "5"})
    return study.epsilon_study((case,), (1.0, 1e2, 1e4, 1e6, 1e8, 1e13))


def test_condition_of_a_known_matrix(rng) -> None:
    A = rng.normal(size=(12, 12))
    found = [study.condition(sparse.csc_matrix(A)) for _ in range(5)]
    assert len(set(found)) == 1
    assert found[0] / np.linalg.cond(A, 1) == pytest.approx(0.75, abs=0.2501)  # an estimate from below
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
            found = study.by_displacements(data.problem(), start, epsilon)
            assert found.outcome is Outcome.CONVERGED
            np.testing.assert_allclose(found.u, u, atol=1e-7)
            np.testing.assert_allclose(found.pressure, pressure, atol=1e-6)


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
    options = "--mesh 16x1 --model full --set load_fraction=5 --set epsilon=10000"
    assert study.command(case, 1e4) == f"footprint solve strip-contact {options} --out DIR"
    assert "--set epsilon=inf" in study.command(case, np.inf)


def test_the_wall_of_every_case_is_that_of_its_scene() -> None:
    """Modulus and thickness as asked for, and elements no smaller than the wall is thick, as the advice needs."""
    walls = {case.label: study.wall(case) for case in study.CASES}
    assert walls["tyre"][:2] == (510.45, pytest.approx(4.8))
    assert walls["rubber tyre, thin"][:2] == (20.0, pytest.approx(1.2))
    assert walls["strip"] == (1200.0, 1.0, 100 / 64)
    assert all(side > thickness for _, thickness, side in walls.values())
