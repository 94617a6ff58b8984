"""Every entry of ``steps`` carries the judge's certificate, by the law of the algorithm's epsilon."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import null_space

from contact.catalogue import ALGORITHMS
from contact.continuation.load_stepping import PathPoint
from contact.events import Ending, PathEnd
from contact.problem import ContactProblem, ContactSolution, Outcome
from studies.ask.scene import Stage
from studies.scenes.complete import complete
from studies.scenes.walk import Visited, walk
from studies.solving.branching import branches_of
from studies.solving.certificate import _linearised_once, certificate
from studies.solving.result import CAP_HIT, CONVERGED, NOT_CONVERGED, UNSTABLE, Result
from studies.solving.solve import solve
from support.problems.contact_problems import Quadratic

KEYS = {"failures", "diagnosis", "kkt", "balances", "rounding", "stability"}
MESH = "12x12"


@pytest.fixture(scope="module")
def tyre():
    return pressed({})


def pressed(given: dict[str, str], contact: str = "semismooth"):
    """A tyre at 8 mm: its last problem, its state, and the result."""
    solution = solve(*complete("tyre", {"delta_mm": "8", **given}, MESH, contact=contact, model="full"))
    assert solution.outcome.converged
    assert all(set(step) >= KEYS for step in solution.steps)
    assert [step["failures"] + step["diagnosis"] for step in solution.steps] == [[]] * len(solution.steps)
    inflation, press = solution.model.stages()
    problem_at, rest = inflation.begin(None)
    inflated = ALGORITHMS["semismooth"]().solve(problem_at(1.0), rest)
    return press.begin(inflated)[0](press.targets[-1]), solution.last, solution


def test_a_converged_tyre_is_certified(tyre) -> None:
    problem, state, actual = tyre
    again = certificate(problem, state)
    assert again["failures"] == []
    assert set(again["balances"]) == set(actual.steps[-1]["balances"]) == {"energy", "force"}
    assert max(again["balances"].values()) <= 1e-10


def test_a_regularised_state_is_certified_by_its_own_law_only() -> None:
    problem, state, actual = pressed({"epsilon": "1e4"}, "trial-and-error")
    assert actual.steps[-1]["kkt"]["penetration"] > 1e-6  # the true one is told
    assert certificate(problem, state, 1e4)["failures"] == []
    assert certificate(problem, state, 5e3)["failures"] == ["complementarity"]
    assert "penetration" in certificate(problem, state, math.inf)["failures"]


def test_scenes_without_contact_are_certified_too() -> None:
    for scene, balances in (("cantilever", {"energy", "force"}), ("pressurised-sphere", {"force"})):
        solution = solve(*complete(scene, {}, "4x2" if scene == "cantilever" else "6x6"))
        for step in solution.steps:
            assert set(step) >= KEYS
            assert step["failures"] == []
            assert set(step["balances"]) == balances
            assert max(step["balances"].values()) <= 1e-8


def test_a_state_of_rest_is_certified_against_an_open_foundation(tyre) -> None:
    """Zero displacement under load is not an equilibrium, and is named so."""
    problem, state, _ = tyre
    rest = ContactSolution.at_rest(len(state.u), len(state.pressure))
    actual = certificate(problem, rest)
    assert "equilibrium" in actual["failures"]
    assert actual["diagnosis"]


def free_eigenvalues(problem: ContactProblem, state: ContactSolution, epsilon: float) -> np.ndarray:
    """Of the tangent on the null space of the gaps of the set, or with the springs of an epsilon; dense."""
    K = problem.stiffness(problem.linearise(state.u, None), state.u, state.pressure).toarray()
    G = problem.gap_jacobian(state.u)[state.active].toarray()
    if math.isinf(epsilon):
        Z = null_space(G)
        return np.linalg.eigvalsh(Z.T @ K @ Z)
    return np.linalg.eigvalsh(K + epsilon * G.T @ np.diag(problem.weights[state.active]) @ G)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("contact", "epsilon", "measure", "mesh", "alone"),
    [
        ("semismooth", math.inf, "thin-green-lagrange", "8x8", 2),
        ("regularised", 1e4, "thin-green-lagrange", "8x8", 2),
        ("semismooth", math.inf, "elongation", "8x8", 1),
        ("semismooth", math.inf, "exact", "10x10", 0),
    ],
)
def test_negative_eigenvalues_of_a_coarse_tyre_are_all_counted_and_are_of_its_elements(
    contact, epsilon, measure, mesh, alone
) -> None:
    """By dense algebra they are as many; from 10 x 10 elements on there are none."""
    scene, request = complete("tyre", {"delta_mm": "20"}, mesh, measure=measure, contact=contact)
    *_, last = walk(scene.build(request).stages(), ALGORITHMS[contact](epsilon=epsilon))
    values = free_eigenvalues(last.problem, last.point.solution, epsilon)
    record = certificate(last.problem, last.point.solution, epsilon)["stability"]
    assert record["negative"] + record["element_modes"] == alone == int(np.sum(values < 0))
    assert (record["negative"], record["word"]) == (0, "stable")


def test_an_unstable_equilibrium_is_a_class_of_its_own() -> None:
    solution = solve(*complete("sze-moment", {"load_fraction": "0.9,1"}, "8x1"))
    assert solution.outcome.converged
    assert solution.verdict == UNSTABLE
    assert [step["failures"] for step in solution.steps] == [[], []]
    assert solution.as_json()["class"] == "unstable"
    assert solution.as_json()["reason"].startswith("load at 0.9: unstable: 1 negative eigenvalue of the tangent")
    assert len(solution.unstable) == 2


@pytest.mark.slow
def test_points_of_a_traced_curve_say_their_count_and_are_no_such_class() -> None:
    """The roof snaps: its curve passes unstable points on purpose, from the limit point to the other."""
    solution = solve(*complete("roof-b", {}, "4x4"))
    counts = [step["stability"]["negative"] for step in solution.steps]
    limits = [i for i, step in enumerate(solution.steps) if step["limit_point"]]
    assert solution.verdict == CONVERGED
    assert len(limits) == 2
    assert set(counts[: limits[0]]) == set(counts[limits[1] + 1 :]) == {0}
    assert set(counts[limits[0] + 1 : limits[1]]) == {1}


@pytest.mark.parametrize(
    ("outcome", "end", "verdict", "found_by"),
    [
        (Outcome.LIMIT_POINT, Ending(PathEnd.LIMIT_POINT, "", 7.5), NOT_CONVERGED, "arc length"),
        (Outcome.STEP_LIMIT, Ending(PathEnd.BIFURCATION, ""), NOT_CONVERGED, "the tangent"),
        (Outcome.STEP_LIMIT, Ending(PathEnd.NEITHER, ""), CAP_HIT, None),
        (Outcome.STEP_LIMIT, None, CAP_HIT, None),
    ],
)
def test_a_limit_of_iterations_is_no_cause_where_the_path_ends(outcome, end, verdict, found_by) -> None:
    _, request = complete("cantilever", {}, "4x2")
    rest = ContactSolution.at_rest(1, 0)
    point = PathPoint(20.0, 7.4, outcome, rest, 3, Outcome.ITERATION_LIMIT, end)
    visited = Visited(Stage("press", lambda before: (None, before), (20.0,), None), lambda t: None, rest, point, 0)
    actual = Result(request, outcome=outcome, cause=Outcome.ITERATION_LIMIT, visits=[visited])
    assert actual.verdict == verdict
    at = {} if end is None or end.limit is None else {"parameter": end.limit}
    kind = (
        {} if found_by is None else {"kind": end.kind.value, "stage": "press", "parameter": 7.4, "found_by": found_by}
    )
    assert actual.path_end == (kind | at if kind else {})


@pytest.mark.slow
def test_a_stepper_that_jumps_through_the_foundation_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball of 0.05 mm that comes by 1 mm: behind the panel, where nothing touches and all residuals are zero."""
    asked = complete("panel", {"foundation": "ball", "ball_mm": "0.05", "delta_mm": "1"}, "4x4")
    solution = solve(*asked)
    assert solution.verdict == "converged"
    assert solution.quantities["force_N"] > 0
    assert any("passes through the foundation" in cut for cut in solution.as_json()["cuts"])
    (note,) = solution.notes
    assert "0.05 mm, is below the size of an element there, 12.6 mm: only nodes are checked" in note
    monkeypatch.setattr("contact.continuation.load_stepping.passed_through", lambda *step: [])
    blind = solve(*asked)
    assert (blind.outcome.word, blind.verdict, blind.quantities["force_N"]) == ("wrong", "wrong", 0.0)
    assert blind.as_json()["reason"].startswith("swept: candidate 4 passes through the foundation")
    (step,) = blind.steps
    assert step["failures"] == ["swept"]
    (stated,) = step["diagnosis"]
    assert stated.startswith("swept: candidate 4 passes through the foundation, from 0")  # of 9, the one at the crown


@pytest.mark.slow
def test_of_two_equilibria_of_one_question_the_certificate_says_which_is_stable() -> None:
    """On a cleat two algorithms end at 761.2 and 712.2 N; the second is a saddle, and leads down to the first."""
    given = {"gamma_deg": "70", "p0_MPa": "0.1", "delta_mm": "20", "pressure_area": "face", "foundation": "cleat"}
    given |= {"thickness_strain": "balanced", "interpolation": "isoparametric"}
    stable = solve(*complete("tyre", given, "14x12"))
    saddle = solve(*complete("tyre", given | {"epsilon": "inf"}, "14x12", contact="trial-and-error"))
    assert (stable.verdict, saddle.verdict) == (CONVERGED, UNSTABLE)
    assert saddle.steps[-1]["force_N"] < 0.95 * stable.steps[-1]["force_N"]
    assert saddle.steps[-1]["stability"]["negative"] == 1
    forces = [row["force_N"] for row in branches_of(saddle) if row["found"]]
    assert len(forces) == 2
    assert max(forces) == pytest.approx(stable.steps[-1]["force_N"], rel=1e-6)


def test_what_is_linearised_once_is_so_at_one_state_alone() -> None:
    problem = Quadratic(np.eye(2), np.ones(2), np.zeros((0, 2)), np.zeros(0), np.zeros(0)).problem()
    here, there = np.zeros(2), np.ones(2)
    once = _linearised_once(problem, here)
    assert once.linearise(here, None) is once.linearise(here, None)
    np.testing.assert_array_equal(once.linearise(there, None).residual, problem.linearise(there, None).residual)
