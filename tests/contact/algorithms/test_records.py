"""Contact algorithms that cycle, fail, are restarted, and what they write down.

What the algorithms say of their parameters is true.
"""

import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls

from contact.catalogue import ALGORITHMS, is_exact
from contact.events import EventKind, events
from contact.parameters import EPSILON, Parameter
from contact.problem import ContactProblem, ContactSolution, Outcome
from contact.verify import judge
from studies.ask.scene import Setting
from studies.ask.settings import configured, own_keys
from support.problems.contact_problems import EXACT, Quadratic, applicable, random_quadratic, solve_from_rest

ORACLE = 1e-7  # agreement with the independent solutions, all quantities are of the order one
ROUNDING = 1e-10

each_exact_one = pytest.mark.parametrize("name", EXACT)


# --- cycling ------------------------------------------------------------------------------------------------------

CYCLING_M = np.array([[4.0, 5.0, -5.0], [5.0, 9.0, -5.0], [-5.0, -5.0, 7.0]])
CYCLING_C = np.array([-2.0, -1.0, 3.0])


def cycling():
    """min x.M.x/2 + c.x, x >= 0: the gap of each candidate is its x, the contact holds x = 0."""
    return Quadratic(CYCLING_M, -CYCLING_C, np.eye(3), np.zeros(3), np.ones(3))


def test_plain_set_swapping_cycles_on_the_example() -> None:
    """The premise of the next two tests, in plain numpy: from full as from no contact the sets repeat every 3 swaps."""
    for start in ([True] * 3, [False] * 3):
        active, seen = np.array(start), []
        for _ in range(10):
            seen.append(tuple(active.tolist()))
            x, free = np.zeros(3), ~active
            x[free] = np.linalg.solve(CYCLING_M[np.ix_(free, free)], -CYCLING_C[free])
            pressure = CYCLING_M @ x + CYCLING_C
            active = np.where(active, pressure >= 0, x < 0)
        assert seen[1:4] == seen[4:7] == seen[7:10]
        assert len(set(seen[1:4])) == 3


def test_trial_and_error_detects_the_cycle_and_still_converges() -> None:
    data = cycling()
    solution = solve_from_rest("trial-and-error", data.problem(), 3)
    assert solution.outcome is Outcome.CONVERGED
    (event,) = events(solution.history)
    assert event.kind is EventKind.CYCLE
    assert "cycle detected" in str(event)
    # x is the multiplier-free unknown here: nnls on the primal itself
    factor = np.linalg.cholesky(CYCLING_M)
    x, _ = nnls(factor.T, -np.linalg.solve(factor, CYCLING_C))
    np.testing.assert_allclose(solution.u, x, rtol=0, atol=ORACLE)
    np.testing.assert_allclose(solution.pressure, CYCLING_M @ x + CYCLING_C, rtol=0, atol=ORACLE)


def test_a_cycle_is_solved_or_reported() -> None:
    """Who fails says so, and who says that it has converged is right."""
    for name in EXACT:
        data = cycling()
        solution = solve_from_rest(name, data.problem(), 3)
        verdict = judge(data.problem(), solution.u, solution.pressure)
        if solution.outcome.converged:
            assert verdict.failures() == []
        else:
            assert solution.outcome in (Outcome.ITERATION_LIMIT, Outcome.CYCLING)
            assert set(verdict.failures()) & {"penetration", "tension"}


def many_cycles(copies: int = 60) -> Quadratic:
    """So many of the example side by side: each must be got out of its own cycle."""
    n = 3 * copies
    K, f = np.kron(np.eye(copies), CYCLING_M), np.tile(-CYCLING_C, copies)
    return Quadratic(K, f, np.eye(n), np.zeros(n), np.ones(n))


def test_semismooth_ends_however_it_settles() -> None:
    """A linearisation for every set is the textbook's method, and goes round without the answer to a set come back."""
    for settle in (0.0, 0.05, 1.0):
        solution = solve_from_rest("semismooth", many_cycles(1).problem(), 3, settle=settle)
        assert solution.outcome is Outcome.CONVERGED
        assert events(solution.history, EventKind.CYCLE)


@pytest.mark.parametrize(("name", "epsilon"), applicable(math.inf, 1e8))
def test_sixty_cycles_end_within_twenty_factorisations(name, epsilon) -> None:
    """Single swaps would take one set or more for each of them: what settles them must settle them together."""
    for full in (False, True):
        data = many_cycles()
        start = ContactSolution(np.zeros(180), np.zeros(180), np.full(180, full), Outcome.CONVERGED)
        solution = ALGORITHMS[name](epsilon=epsilon).solve(data.problem(), start)
        assert solution.outcome is Outcome.CONVERGED
        assert solution.counters["factorisations"] <= 20
        factor = np.linalg.cholesky(CYCLING_M)
        x, _ = nnls(factor.T, -np.linalg.solve(factor, CYCLING_C))
        soft = 0 if math.isinf(epsilon) else 10 / epsilon
        np.testing.assert_allclose(solution.u, np.tile(x, 60), rtol=0, atol=ORACLE + soft)


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name != "qp")) for name in EXACT])
def test_a_matrix_that_is_no_p_matrix_ends_with_a_reason(name) -> None:
    """-x - 1 = p has no p >= 0 with x >= 0: no sequence of sets ends, and each must be given up, releases or not."""
    data = Quadratic(np.array([[-1.0, 0.0], [0.0, 1.0]]), np.array([1.0, 0.0]), np.eye(2), np.zeros(2), np.ones(2))
    solution = solve_from_rest(name, data.problem(), 2, max_iterations=10)
    assert solution.outcome in (Outcome.CYCLING, Outcome.UNSOLVED)


# --- records ------------------------------------------------------------------------------------------------------


@each_exact_one
def test_counters_and_history_are_those_of_the_run(name) -> None:
    data = random_quadratic(np.random.default_rng(3), "obstacle")
    calls = []
    problem = data.problem()
    counted = ContactProblem(
        lambda u, memory: calls.append(u) or problem.linearise(u, memory),
        problem.gap,
        problem.gap_jacobian,
        problem.weights,
    )
    solution = solve_from_rest(name, counted, len(data.f))
    assert solution.counters["assemblies"] == len(calls) == len(solution.history)
    assert solution.counters["factorisations"] >= solution.counters["newton_iterations"] > 0
    last = solution.history[-1]
    assert last["contact_nodes"] == solution.active.sum()
    assert sum(row["added"] - row["removed"] for row in solution.history) == solution.active.sum()


def test_restarting_from_the_answer_takes_no_step() -> None:
    for name, epsilon in applicable(math.inf, 1e4):
        data = random_quadratic(np.random.default_rng(3), "inclined")
        first = solve_from_rest(name, data.problem(), len(data.f), epsilon)
        again = ALGORITHMS[name](epsilon=epsilon).solve(data.problem(), first)
        assert again.outcome is Outcome.CONVERGED
        # one of an exact constraint where rounding has pushed a closed gap to -1e-17
        assert again.counters["newton_iterations"] <= math.isinf(epsilon)
        np.testing.assert_allclose(again.u, first.u, rtol=0, atol=ROUNDING)


def test_pressures_from_before_that_are_far_too_large_are_taken_back() -> None:
    """They open gaps, where nothing penetrates: a stiffness that is too soft to close them at once must go on."""
    ways = *((name, {}) for name in ALGORITHMS), ("augmented-lagrangian", {"c": 10.0})
    for name, options in ways:
        data = random_quadratic(np.random.default_rng(3), "inclined")
        epsilon = math.inf if is_exact(name) else 1e4
        first = solve_from_rest(name, data.problem(), len(data.f), epsilon)
        begun = replace(first, pressure=5 * first.pressure)
        again = ALGORITHMS[name](epsilon=epsilon, **options).solve(data.problem(), begun)
        assert again.outcome is Outcome.CONVERGED
        np.testing.assert_allclose(again.u, first.u, rtol=0, atol=ORACLE)
        np.testing.assert_allclose(again.pressure, first.pressure, rtol=0, atol=ORACLE)


@each_exact_one
def test_memory_is_passed_on_and_forgotten_with_the_solve(name) -> None:
    """Each linearisation gets what the last step remembered, or None at the start of a Newton."""
    data = random_quadratic(np.random.default_rng(2), "obstacle")
    problem, seen, given = data.problem(), [], []

    def remember(du):
        given.append(len(given))
        return given[-1]

    def linearise(u, memory):
        seen.append(memory)
        return replace(problem.linearise(u, memory), remember=remember)

    solution = solve_from_rest(
        name, ContactProblem(linearise, problem.gap, problem.gap_jacobian, problem.weights), len(data.f)
    )
    assert solution.outcome is Outcome.CONVERGED
    assert seen[0] is None
    assert [m for m in seen if m is not None] == given


@each_exact_one
def test_singular_mechanics_is_an_outcome(name) -> None:
    """The foundation would hold both unknowns, and a programme needs no stiffness to find that."""
    for K in (np.zeros((2, 2)), np.array([[1.0, -1.0], [-1.0, 1.0]])):
        data = Quadratic(K, np.array([1.0, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2))
        solution = solve_from_rest(name, data.problem(), 2)
        if name == "qp":
            assert solution.outcome is Outcome.CONVERGED
            assert judge(data.problem(), solution.u, solution.pressure).failures() == []
        else:
            assert solution.outcome is Outcome.SINGULAR


@each_exact_one
def test_gaps_that_depend_on_one_another_are_an_outcome(name) -> None:
    """Two candidates at one place, both pressed in: no force of either by itself, but none on one of them."""
    data = Quadratic(np.eye(2), np.array([1.0, 0.5]), -np.eye(2)[[0, 0]], np.array([0.1, 0.1]), np.ones(2))
    solution = solve_from_rest(name, data.problem(), 2)
    if name == "lcp":
        assert solution.outcome is Outcome.CONVERGED
        assert sorted(solution.pressure) == pytest.approx([0.0, 0.9])
    else:
        assert solution.outcome is Outcome.SINGULAR


def test_nan_is_divergence() -> None:
    for name in EXACT:
        data = Quadratic(np.eye(2), np.array([np.nan, 0.5]), -np.eye(2), np.array([10.0, 10.0]), np.ones(2))
        assert solve_from_rest(name, data.problem(), 2).outcome is Outcome.DIVERGED


def test_iteration_limit_is_an_outcome() -> None:
    for name in ALGORITHMS:
        data = random_quadratic(np.random.default_rng(0), "obstacle")
        limited = solve_from_rest(name, data.problem(), len(data.f), ALGORITHMS[name]().epsilon, max_iterations=0)
        assert limited.outcome is Outcome.ITERATION_LIMIT


def test_who_takes_which_epsilon() -> None:
    """Those of the exact law an infinite one, springs a finite one alone; an augmented Lagrangian has exact ones."""
    taken = {*applicable(math.inf, 1e4)}
    assert [name for name in ALGORITHMS if ((name, math.inf) in taken) != is_exact(name)] == []
    assert [name for name in ALGORITHMS if (name, 1e4) not in taken and not is_exact(name)] == []
    assert ("augmented-lagrangian", 1e4) not in taken
    assert not is_exact("regularised")


def test_only_converged_counts_as_converged() -> None:
    assert [outcome for outcome in Outcome if outcome.converged] == [Outcome.CONVERGED]


def test_every_parameter_is_a_field_with_a_default_in_its_range() -> None:
    for name, algorithm in ALGORITHMS.items():
        assert algorithm().name == name
        fields = {field.name: field.default for field in dataclasses.fields(algorithm)}
        keys = [parameter.key for parameter in algorithm.parameters]
        assert EPSILON in algorithm.parameters
        assert len(set(keys)) == len(keys)
        for parameter in algorithm.parameters:
            default = fields[parameter.key]
            assert parameter.meaning
            assert Setting.of(parameter, default).parse(str(default)) == default


def test_an_algorithm_gets_its_own_settings_alone() -> None:
    assert {"settle", "c", "backend", "method"} < {*own_keys()}
    chosen = configured("lcp", {"epsilon": 7.0, "method": "nnls", "settle": 0.5, "p0_MPa": 1.0})
    assert (chosen.epsilon, chosen.method) == (7.0, "nnls")


def test_a_default_out_of_its_range_is_seen() -> None:
    """Must fail beside must pass."""
    with pytest.raises(ValueError, match="share"):
        Setting.of(Parameter("share", "of something", low=0, high=1), 2.0).parse("2.0")
