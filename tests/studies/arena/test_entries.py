"""The algorithms that enter through the open door: independent answers, and the closed form of a membrane."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.events import EventKind, events
from contact.problem import ContactProblem, Outcome
from contact.solvers.lcp_pivoting import lemke
from contact.verify import judge
from studies.arena.card.laws import laws_of
from studies.cli import main
from studies.experiments.membrane import Membrane, membrane_table
from studies.scenes.closed_forms.contact import SphereObstacle
from support.kinds import EXACT_ONLY, FILES, NAMES, SPENT
from support.problems.contact_problems import Quadratic, definite, dual_by_nnls, random_quadratic, solve_from_rest

ROOT = Path(__file__).parents[3]
ORACLE = 1e-7  # agreement with the independent solutions, all quantities are of the order one
SAME = 1e-9
PRINTED_RADIUS = 0.348982574111686  # of contact, MFEM's example 36

each = pytest.mark.parametrize("name", NAMES)
pytestmark = pytest.mark.usefixtures("modules")


def test_nothing_of_the_suite_imports_them() -> None:
    imported = re.compile(rf"^ *(from|import) .*\b({'|'.join(FILES)})\b", re.MULTILINE)
    sources = (path for package in ("contact", "studies", "reports") for path in (ROOT / package).rglob("*.py"))
    assert [path for path in sources if imported.search(path.read_text(encoding="utf-8"))] == []


# --- independent answers ------------------------------------------------------------------------------------------


@each
def test_solution_is_that_of_nnls(name: str) -> None:
    for kind, seed in product(("obstacle", "definite", "inclined"), range(4)):
        data = random_quadratic(np.random.default_rng(seed), kind)
        solution = solve_from_rest(name, data.problem(), len(data.f))
        assert solution.outcome is Outcome.CONVERGED
        u, pressure = dual_by_nnls(data, math.inf)
        np.testing.assert_allclose(solution.u, u, rtol=0, atol=ORACLE)
        np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=ORACLE)
        np.testing.assert_array_equal(solution.active, pressure > 10 * ORACLE)
        assert judge(data.problem(), solution.u, solution.pressure).failures() == []


def test_interior_point_keeps_the_law_of_a_finite_epsilon() -> None:
    for seed in range(4):
        data = random_quadratic(np.random.default_rng(seed), "inclined")
        solution = solve_from_rest("interior-point", data.problem(), len(data.f), 1e4)
        np.testing.assert_allclose(solution.pressure, dual_by_nnls(data, 1e4)[1], rtol=0, atol=ORACLE)


@pytest.mark.slow
@each
def test_every_law_of_a_card_is_kept(name: str) -> None:
    """Built-in answers of any size, with candidates that touch without pressure, restarts, hopeless problems, ..."""
    assert [law for law in laws_of(name) if not law.passed or law.refused] == []


@each
def test_exact_steps_correct_a_set_that_is_read_off_too_early(name: str) -> None:
    """However little has been done on the way, the answer is the same."""
    hasty = {"barrier": {"crossover": 1.0}, "interior-point": {"complementarity": 0.1}, "proximal": {"crossover": 1.0}}
    data = random_quadratic(np.random.default_rng(1), "definite", 40)
    solution = solve_from_rest(name, data.problem(), len(data.f), **hasty[name])
    np.testing.assert_allclose(solution.pressure, dual_by_nnls(data, math.inf)[1], rtol=0, atol=ORACLE)


def test_the_path_ends_at_the_answer_of_lemke(modules: Mapping[str, ModuleType]) -> None:
    """Monotone matrices, symmetric or not; where there is no solution the path has no end, and says so."""
    path, rng = modules["interior_point"].central_path, np.random.default_rng(5)
    for turned in (0.0, 1.0):
        M = definite(rng, 30)
        skew = rng.normal(size=M.shape)
        M, q = M + turned * (skew - skew.T), rng.normal(size=30)
        central = path(M, q, 1e-10)
        assert central.ended
        assert central.iterations <= 25
        np.testing.assert_array_equal(central.z > central.w, lemke(M, q).z > 0)
    for a in (-1.0, -3.0):
        assert not path(np.array([[a]]), -np.ones(1)).ended


def test_the_clamped_barrier_is_that_of_ipc(modules: Mapping[str, ModuleType]) -> None:
    """-x b'(x) of b = -(x - 1)^2 ln x by central differences; nothing from x = 1 on."""
    x, h = np.linspace(0.05, 0.95, 19), 1e-6

    def b(x: np.ndarray) -> np.ndarray:
        return -((x - 1) ** 2) * np.log(x)

    clamped = modules["barrier"].clamped
    np.testing.assert_allclose(clamped(x), -x * (b(x + h) - b(x - h)) / (2 * h), rtol=0, atol=1e-8)
    assert clamped(np.array([0.0]))[0] == 1
    assert not clamped(np.array([1.0, 2.0])).any()


def test_the_filter_keeps_gaps_open() -> None:
    """All states on the way of the barrier, from open gaps on: none deeper than the foundation stands back."""
    data = random_quadratic(np.random.default_rng(3), "definite", 20)
    data = Quadratic(data.K, 5 * data.f, data.G, np.abs(data.g0) + 0.1, data.w)
    problem, visited = data.problem(), list[np.ndarray]()
    spied = replace(problem, linearise=lambda u, memory: visited.append(u) or problem.linearise(u, memory))
    solution = solve_from_rest("barrier", spied, len(data.f), reach=1e-3)
    free = problem.gap(np.linalg.solve(data.K, data.f))
    assert np.min(free) < 0 < solution.active.sum()
    on_the_way = visited[: int(solution.counters["barrier_iterations"]) + 1]
    assert len(on_the_way) > 3
    assert min(np.min(problem.gap(u)) for u in on_the_way) > 1e-3 * np.min(free)


# --- protocol -----------------------------------------------------------------------------------------------------


@each
def test_counters_and_history_are_those_of_the_run(name: str) -> None:
    data = random_quadratic(np.random.default_rng(3), "obstacle")
    problem, calls = data.problem(), list[np.ndarray]()
    counted = replace(problem, linearise=lambda u, memory: calls.append(u) or problem.linearise(u, memory))
    solution = solve_from_rest(name, counted, len(data.f))
    counters = solution.counters
    assert counters["assemblies"] == len(calls) == len(solution.history) == counters["newton_iterations"] + 1
    assert counters["factorisations"] >= counters["newton_iterations"] > 0
    assert counters[SPENT[name]] > 0
    assert sum(row["added"] - row["removed"] for row in solution.history) == solution.active.sum()
    assert solution.history[-1]["contact_nodes"] == solution.active.sum()


@each
def test_restarting_from_the_answer_takes_no_step(name: str) -> None:
    data = random_quadratic(np.random.default_rng(3), "inclined")
    first = solve_from_rest(name, data.problem(), len(data.f))
    again = ALGORITHMS[name]().solve(data.problem(), first)
    assert again.counters["newton_iterations"] <= 1  # where rounding has pushed a closed gap to -1e-17
    assert again.counters[SPENT[name]] == 0
    np.testing.assert_allclose(again.u, first.u, rtol=0, atol=1e-10)


@each
def test_failure_is_a_value(name: str) -> None:
    data = random_quadratic(np.random.default_rng(0), "obstacle")
    assert solve_from_rest(name, data.problem(), len(data.f), max_iterations=0).outcome is Outcome.ITERATION_LIMIT
    nan = Quadratic(np.eye(2), np.array([np.nan, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2))
    assert solve_from_rest(name, nan.problem(), 2).outcome is Outcome.DIVERGED
    loose = Quadratic(np.zeros((2, 2)), np.array([1.0, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2))
    assert solve_from_rest(name, loose.problem(), 2).outcome is Outcome.SINGULAR


@pytest.mark.parametrize("name", EXACT_ONLY)
def test_exact_steps_alone_are_told_and_a_finite_epsilon_is_refused(name: str) -> None:
    """A body that nothing holds has no stiffness to begin with."""
    loose = Quadratic(np.zeros((2, 2)), np.array([1.0, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2))
    substitutes = events(solve_from_rest(name, loose.problem(), 2).history, EventKind.SUBSTITUTE)
    assert [str(event).startswith("exact steps alone: ") for event in substitutes] == [True]
    assert "epsilon must be infinite" in ALGORITHMS[name](epsilon=1e4).supports(loose.problem())


def test_consistent_coupling_is_refused_by_the_interior_point_alone() -> None:
    data = random_quadratic(np.random.default_rng(0), "definite")
    coupled: ContactProblem = data.problem(np.diag(data.w) + 0.1)
    assert "needs lumped coupling" in ALGORITHMS["interior-point"]().supports(coupled)
    for name in EXACT_ONLY:
        solution = solve_from_rest(name, coupled, len(data.f))
        assert judge(coupled, solution.u, solution.pressure).failures() == []


def test_a_parameter_out_of_its_range() -> None:
    for name, key, value, says in (
        ("barrier", "reach", 0.0, "reach = 0.0 must be a number in [1e-06, 10]"),
        ("barrier", "reduction", 1.0, "reduction = 1.0 must be a number in [0.001, 0.9]"),
        ("interior-point", "boundary", 1.0, "boundary = 1.0 must be a number in [0.5, 0.99999]"),
        ("proximal", "alpha", math.nan, "alpha = nan must be a number in [0.001, 1000]"),
        ("proximal", "growth", 0.5, "growth = 0.5 must be a number in [1, 100]"),
        ("proximal", "epsilon", -1.0, "epsilon = -1.0 must be a number in (0, inf]"),
    ):
        with pytest.raises(ValueError, match="must be") as raised:
            ALGORITHMS[name](**{key: value})
        assert str(raised.value) == says


# --- the membrane over a sphere -----------------------------------------------------------------------------------


def test_all_find_the_membrane_of_semismooth() -> None:
    table = membrane_table({"P1": (2,), "Q1": (2,), "Q2": (1,)}, ("semismooth", *NAMES))
    assert (table["outcome"] == "converged").all()
    assert table["apart"].max() < SAME
    assert (table.groupby("element")["contact_nodes"].nunique() == 1).all()
    assert table["radius_by_force"].to_numpy() == pytest.approx(PRINTED_RADIUS, rel=0.01)


@pytest.mark.slow
@each
def test_the_free_boundary_of_mfem_s_example_36_is_met_with_the_order_of_the_elements(name: str) -> None:
    """The radius printed there: by the area of contact with the first order, by the resultant faster."""
    table = membrane_table({"P1": (2, 3, 4, 5), "Q2": (1, 2, 3, 4)}, ("semismooth", name))
    assert table["apart"].max() < SAME
    own = table[table["algorithm"] == name]
    for element, order in (("P1", 0.95), ("Q2", 1.4)):
        rows = own[own["element"] == element]
        finest = rows.iloc[-1]
        assert finest["order_h1"] > order
        assert finest["order_radius"] == pytest.approx(1, abs=0.15)
        assert finest["order_force"] > 1.1
        assert finest["radius"] < 0.02
        assert finest["radius_by_force"] == pytest.approx(PRINTED_RADIUS, rel=3e-4)


def test_proximal_steps_of_one_length_find_the_set_of_the_membrane_by_themselves() -> None:
    """Exact steps have nothing to correct then, and one leaves the answer."""
    membrane = Membrane.build("P1", 3, SphereObstacle())
    even = ALGORITHMS["proximal"](epsilon=math.inf, alpha=3, growth=1, crossover=1e-6, max_iterations=100)
    solution = even.solve(membrane.body.problem(), membrane.body.begin())
    steps = int(solution.counters[SPENT["proximal"]])
    rows = solution.history[steps:]
    assert 20 < steps < 100
    assert len(rows) == 2
    assert not any(row["added"] or row["removed"] for row in rows)
    assert membrane.errors(solution)["radius_by_force"] == pytest.approx(PRINTED_RADIUS, rel=4e-3)


# --- the open door ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("file", FILES)
def test_a_command_takes_one_in_from_any_directory(
    file: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    use = ["--use", os.path.relpath(FILES[file]), "--contact", file.replace("_", "-"), "--mesh", "16x1", "--out", "out"]
    assert main(["solve", "strip-contact", *use]) == 0
    assert (tmp_path / "out" / "result.json").exists()
    assert main(["solve", "strip-contact", *use, "--set", "tolerance=0"]) == 2
    assert "tolerance = '0' must be" in capsys.readouterr().err
