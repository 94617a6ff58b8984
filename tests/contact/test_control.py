"""Control by work: a truss that snaps and a string that is pushed onto an obstacle, whose loads are known."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.continuation.branches import stable_branches
from contact.continuation.spectrum import spectrum
from contact.continuation.stability import STABLE, UNSTABLE, stability
from contact.control import by_work
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome, linear_mechanics, without_contact
from contact.verify import judge
from support.problems.contact_problems import EXACT, Quadratic, solve_from_rest

H, A, C = 1.0, 2.0, 0.5  # height of the truss, a, spring before it: softer than the apex is where it snaps
EXACTLY = 1e-7  # where Newton ends at 1e-9 of the forces
STRING = 2e-3  # relative error of the load of a string of 192 elements


def force(w: float) -> float:
    """On the apex of a shallow truss of energy a/4 ((h - w)^2 - h^2)^2 that has come down by w."""
    return -A * ((H - w) ** 2 - H**2) * (H - w)


def slope(w: float) -> float:
    return A * (3 * (H - w) ** 2 - H**2)


def truss(load: float):
    """linearise of the apex w and the end d of a spring on it, which the load pushes down."""

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        w, d = u
        spring = C * (d - w)
        K = np.array([[slope(w) + C, -C], [-C, C]])
        return Linearisation(np.array([force(w) - spring, spring - load]), sparse.csc_matrix(K), max(1.0, abs(spring)))

    return linearise


def pushed_to(d: float, per_mm: float = 1.0) -> ContactProblem:
    """The truss where the work of a unit load, its travel, is given."""

    def work(u: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        return u[1], np.array([0.0, 1.0]), np.array([0.0, 1.0])

    return replace(without_contact(by_work(truss, work, d, per_mm), 3), multipliers=1)


def beside(w: float) -> ContactSolution:
    """A start near the state of the apex at w."""
    return ContactSolution(np.array([w + 1e-3, 0.0, 0.0]), np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED)


@pytest.mark.parametrize("per_mm", [0.03, 1.0, 40.0])
def test_a_truss_is_led_through_its_limit_points(per_mm) -> None:
    """Load and word at every w: slope + c > 0 where the end of the spring is given, slope > 0 where it is loaded."""
    words = set()
    for w in np.linspace(0.06, 2.2, 22):
        load = force(w)
        problem = pushed_to(w + load / C, per_mm)
        solution = Semismooth().solve(problem, beside(w))
        assert judge(problem, solution.u, solution.pressure).failures() == []
        assert [*solution.u[:-1], per_mm * solution.u[-1]] == pytest.approx([w, w + load / C, load], rel=EXACTLY)
        given = stability(problem, solution).word
        loaded = stability(without_contact(truss(load), 2), replace(solution, u=solution.u[:-1])).word
        assert (given == STABLE) == (slope(w) + C > 0)
        assert (loaded == STABLE) == (slope(w) > 0)
        assert spectrum(problem, solution).negative == (given == UNSTABLE)
        assert spectrum(problem, solution).eigenvalues == pytest.approx([slope(w) + C])
        words.add((given, loaded))
    assert words == {(STABLE, STABLE), (STABLE, UNSTABLE), (UNSTABLE, UNSTABLE)}


def test_branches_off_an_unstable_state_keep_what_is_given() -> None:
    """Three states of the apex belong to the spring's end at h: h in the middle, unstable, and two as far from it."""
    problem = pushed_to(H)
    middle = Semismooth().solve(problem, beside(H))
    branches = stable_branches(problem, middle, Semismooth())
    assert branches is not None
    away = np.sqrt(H**2 - C / A)
    assert sorted(branch.solution.u[0] for branch in branches) == pytest.approx([H - away, H + away])
    assert all(branch.found and branch.solution.u[1] == pytest.approx(H) for branch in branches)


@pytest.mark.parametrize("name", EXACT)
def test_a_string_is_blown_onto_an_obstacle(name) -> None:
    """The area V under it given, q unknown: free length l on both sides from V = g (L - 2 l/3), and q = 2 T g/l^2.

    The pressure of the obstacle is q.
    """
    n, L, T, g = 192, 2.0, 1.3, 0.25
    h = L / n
    K = T / h * (2 * np.eye(n - 1) - np.eye(n - 1, k=1) - np.eye(n - 1, k=-1))
    areas = np.full(n - 1, h)
    G = np.hstack([-np.eye(n - 1), np.zeros((n - 1, 1))])
    rest = Quadratic(np.eye(n), np.zeros(n), G, np.full(n - 1, g), areas).problem()
    for free in (0.9, 0.5, 0.3):
        given = g * (L - 2 * free / 3)
        linearise = by_work(
            lambda q: linear_mechanics(sparse.csc_matrix(K), q * areas),
            lambda u: (areas @ u, areas, areas),
            given,
            10.0,
        )
        problem = replace(rest, linearise=linearise, multipliers=1)
        actual = solve_from_rest(name, problem, n)
        assert actual.outcome is Outcome.CONVERGED
        assert judge(problem, actual.u, actual.pressure).failures() == []
        q = 10.0 * actual.u[-1]
        assert q == pytest.approx(2 * T * g / free**2, rel=STRING)
        inside = actual.pressure[actual.active][3:-3]
        np.testing.assert_allclose(inside, q, rtol=1e-6)
        assert stability(problem, actual).word == STABLE
