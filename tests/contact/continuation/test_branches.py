"""Stable branches beside unstable equilibria, in closed form: a column, with and without a wall, a shallow truss."""

import math

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS
from contact.continuation.branches import held_at, stable_branches
from contact.continuation.spectrum import lowest, spectrum
from contact.continuation.stability import STABLE, UNSTABLE, stability
from contact.problem import ContactProblem, ContactSolution, Linearisation, Linearise, Outcome

K, LENGTH = 3.0, 2.0
EXACT = 1e-8


def column(load: float, wall: float = math.inf) -> ContactProblem:
    """An upright link on a spring k under P = load k/l, in front of a wall that its top reaches at x = ``wall``."""
    P = load * K / LENGTH

    def linearise(u, memory):
        tangent = sparse.csc_matrix([[K - P * LENGTH * np.cos(u[0])]])
        return Linearisation(np.array([K * u[0] - P * LENGTH * np.sin(u[0])]), tangent, P * LENGTH)

    if math.isinf(wall):
        return without(linearise)
    return ContactProblem(
        linearise,
        lambda u: np.array([wall - LENGTH * np.sin(u[0])]),
        lambda u: sparse.csr_matrix([[-LENGTH * np.cos(u[0])]]),
        np.ones(1),
        gap_curvature=lambda u, f: sparse.csc_matrix([[f[0] * LENGTH * np.sin(u[0])]]),
    )


def without(linearise: Linearise) -> ContactProblem:
    nothing = sparse.csr_matrix((0, 1))
    return ContactProblem(linearise, lambda u: np.zeros(0), lambda u: nothing, np.zeros(0))


def at(u: float, m: int = 0) -> ContactSolution:
    return ContactSolution(np.array([u]), np.zeros(m), np.zeros(m, bool), Outcome.CONVERGED)


def tilted(load: float) -> float:
    """The positive angle with th = load sin th."""
    angle = 3.0
    for _ in range(100):
        angle -= (angle - load * math.sin(angle)) / (1 - load * math.cos(angle))
    return angle


@pytest.mark.parametrize("load", [1.02, 2.0])
def test_a_buckled_column_leans_to_either_side(load: float) -> None:
    problem, upright = column(load), at(0.0)
    assert stability(problem, upright).word == UNSTABLE
    actual = stable_branches(problem, upright, ALGORITHMS["semismooth"](tolerance=1e-12))
    assert actual is not None
    assert [branch.found for branch in actual] == [True, True]
    assert [branch.stability.word for branch in actual] == [STABLE, STABLE]
    angles = sorted(float(branch.solution.u[0]) for branch in actual)
    assert angles == pytest.approx([-tilted(load), tilted(load)], rel=EXACT)


def test_a_column_that_stands_has_no_branch() -> None:
    assert stable_branches(column(0.9), at(0.0), ALGORITHMS["semismooth"]()) is None


@pytest.mark.parametrize(
    "name",
    ["semismooth", "lcp", *(pytest.param(name, marks=pytest.mark.slow) for name in ("trial-and-error", "qp"))],
)
def test_a_column_leans_on_a_wall_with_the_force_of_its_moments(name: str) -> None:
    """P l sin th = k th + N l cos th at the wall, l sin th = d; to the other side it is free."""
    load, wall = 1.5, 0.8
    angle, P = math.asin(wall / LENGTH), load * K / LENGTH
    assert angle < tilted(load)
    actual = stable_branches(column(load, wall), at(0.0, 1), ALGORITHMS[name](epsilon=math.inf))
    assert actual is not None
    free, leaning = sorted(actual, key=lambda branch: float(branch.solution.u[0]))
    assert [free.found, leaning.found] == [True, True]
    assert free.solution.u[0] == pytest.approx(-tilted(load), rel=EXACT)
    assert leaning.solution.u[0] == pytest.approx(angle, rel=EXACT)
    force = (P * LENGTH * math.sin(angle) - K * angle) / (LENGTH * math.cos(angle))
    assert leaning.solution.pressure[0] == pytest.approx(force, rel=EXACT)


def test_a_shallow_truss_snaps_to_the_outer_roots_of_its_cubic() -> None:
    """a ((h + w)^2 - h^2)(h + w) = P with h = 1: of three equilibria the middle one is unstable."""
    a, P = 2.0, -0.3
    roots = np.sort(np.real(np.roots([1.0, 0.0, -1.0, -P / a]))) - 1.0  # in w + h

    def linearise(u, memory):
        y = 1.0 + u[0]
        return Linearisation(np.array([a * (y**2 - 1) * y - P]), sparse.csc_matrix([[a * (3 * y**2 - 1)]]), abs(P))

    problem, middle = without(linearise), at(float(roots[1]))
    assert stability(problem, middle).negative == 1
    actual = stable_branches(problem, middle, ALGORITHMS["semismooth"](tolerance=1e-12))
    assert actual is not None
    assert sorted(float(branch.solution.u[0]) for branch in actual) == pytest.approx([roots[0], roots[2]], rel=EXACT)


@pytest.mark.slow
def test_a_descent_without_an_end_says_so() -> None:
    """r = -u: no equilibrium but the unstable one."""
    problem = without(lambda u, memory: Linearisation(-u, sparse.csc_matrix([[-1.0]]), max(abs(float(u[0])), 1.0)))
    actual = stable_branches(problem, at(0.0), ALGORITHMS["semismooth"](tolerance=1e-12))
    assert actual is not None
    assert not any(branch.found for branch in actual)
    assert all(branch.reason for branch in actual)


def test_springs_add_their_stiffness_and_vanish_where_they_hold() -> None:
    problem, here = column(1.2), np.array([0.3])
    held = held_at(problem, here, np.array([7.0])).linearise(here, None)
    free = problem.linearise(here, None)
    assert held.residual == pytest.approx(free.residual, rel=EXACT)
    assert held.tangent.toarray() - free.tangent.toarray() == pytest.approx(7.0)
    away = held_at(problem, here, np.array([7.0])).linearise(here + 0.1, None)
    assert away.residual - problem.linearise(here + 0.1, None).residual == pytest.approx(0.7)


def test_the_unstable_mode_may_be_far_stiffer_than_the_softest() -> None:
    """Thirty soft springs of 1, and an unknown with -5 + y^2: its branches are y^2 = 5, whatever the others."""
    n, soft = 31, np.ones(30)

    def linearise(u, memory):
        y = float(u[-1])
        tangent = sparse.csc_matrix(sparse.diags_array(np.append(soft, 3 * y**2 - 5)))
        return Linearisation(np.append(soft * u[:-1], (y**2 - 5) * y), tangent, 1.0)

    nothing = sparse.csr_matrix((0, n))
    problem = ContactProblem(linearise, lambda u: np.zeros(0), lambda u: nothing, np.zeros(0))
    middle = ContactSolution(np.zeros(n), np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED)
    softest = spectrum(problem, middle)
    assert min(softest.eigenvalues) > 0  # they do not show it
    assert lowest(problem, middle, np.inf, 1, softest).eigenvalues == pytest.approx([-5.0], rel=EXACT)
    actual = stable_branches(problem, middle, ALGORITHMS["semismooth"](tolerance=1e-12))
    assert actual is not None
    assert sorted(float(branch.solution.u[-1]) for branch in actual) == pytest.approx([-(5**0.5), 5**0.5], rel=EXACT)


def test_multipliers_are_no_motions_where_a_stiff_mode_is_looked_for() -> None:
    """Thirty soft springs, an unknown of -5, and one that a multiplier holds."""
    K = sparse.lil_array(np.diag([*[1.0] * 30, -5.0, 2.0, 0.0]))
    K[31, 32] = K[32, 31] = 1.0
    tangent, nothing = sparse.csc_matrix(K), sparse.csr_matrix((0, 33))

    def linearise(u, memory):
        return Linearisation(tangent @ u, tangent, 1.0)

    problem = ContactProblem(linearise, lambda u: np.zeros(0), lambda u: nothing, np.zeros(0), multipliers=1)
    rest = ContactSolution(np.zeros(33), np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED)
    actual = lowest(problem, rest, np.inf, 1, spectrum(problem, rest))
    assert actual.eigenvalues == pytest.approx([-5.0], rel=EXACT)
    assert abs(actual.modes[30, 0]) == pytest.approx(1.0)
