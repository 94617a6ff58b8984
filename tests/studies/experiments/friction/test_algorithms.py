"""All algorithms with friction on the reference problems: who ends, where, and with what."""

import math
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.catalogue import ALGORITHMS, by_the_exact_law, is_exact
from contact.continuation.friction_path import follow
from contact.coulomb import Coulomb, State
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, linear_mechanics
from studies.experiments.friction.bars import LENGTH, PULL, STRIP_END, TAU, Bar
from studies.experiments.friction.greco import GrecoPlate
from studies.experiments.friction.klarbring import CASES, Springs, answers, klarbring_table

EXACT = [name for name in ALGORITHMS if is_exact(name) and name != "trial-and-error"]


def algorithm(name: str) -> ContactAlgorithm:
    return by_the_exact_law(1e9)[name]


def test_klarbrings_springs_have_the_answers_that_the_case_is_named_for_and_all_obey_the_law() -> None:
    """Against the equations themselves: forces balance, nothing penetrates, friction is on its interval and opposes."""
    for case, k in CASES.items():
        words = [answer.word for answer in answers(k)]
        number = {"two": 2, "three": 3, "none": 0}
        assert len(words) == next((n for name, n in number.items() if f", {name}" in case), 1), case
        assert all(word in case for word in words) or len(words) > 1, case
        for a in answers(k):
            assert k.tt * a.u_t + k.nt * a.u_n == pytest.approx(k.along + a.t, abs=1e-12), case
            assert k.nt * a.u_t + k.nn * a.u_n == pytest.approx(k.off + a.f, abs=1e-12), case
            slip = a.u_t + k.slip0
            assert min(a.u_n, a.f) == pytest.approx(0, abs=1e-12), case
            assert abs(a.t) <= k.mu * a.f + 1e-12, case
            assert a.t * slip <= 1e-12, case
            assert abs(slip) < 1e-12 or abs(a.t) == pytest.approx(k.mu * a.f, abs=1e-12), case


def test_below_the_bound_there_is_one_answer() -> None:
    for nt, mu, along, off in product((-0.9, -0.6, 0.6), (0.8, 1.8, 6.0), (-4.0, 0.3, 1.8), (-1.0, 1.0)):
        springs = Springs(1.0, nt, 1.0, mu, along, off, 0.35)
        assert len(answers(springs)) in ((1,) if springs.coupling < 1 else (1, 3)), springs


@pytest.mark.slow
def test_a_claimed_answer_is_one_of_them_and_below_the_bound_all_find_it() -> None:
    """Beyond it programmes and pivots alone end on a candidate that is pulled off and rubs itself down."""
    table = klarbring_table().set_index(["case", "algorithm"])
    assert not (table["found"] == "wrong").any()
    assert (table["outcome"][table["answers"] == 0] == "cycling").all()
    claimed = table[table["outcome"] == "converged"]
    assert all(actual in which.split(", ") for actual, which in zip(claimed["found"], claimed["which"], strict=True))
    alone = table[(table["answers"] == 1) & (table["mu_Knt_over_Ktt"] < 1)]
    assert (alone["outcome"] == "converged").all()
    pulled = table.loc["beyond it, slip - alone, pulled off", "outcome"]
    assert set(pulled.index[pulled == "converged"]) == {"semismooth", "qp", "lcp"}  # semismooth by pivots
    assert set(pulled[pulled != "converged"]) == {"cycling"}


def test_the_greco_plate_in_all_hands() -> None:
    """The naive set alone cycles; all others agree to the last digits, on springs to the inverse of their stiffness."""
    plate = GrecoPlate("Q2", 8)
    wanted = plate.solve(algorithm("semismooth"), 1.0)
    assert wanted.outcome.converged
    largest = np.max(plate.weights * wanted.pressure)
    for name in (*EXACT[1:], "trial-and-error"):
        solution = plate.solve(algorithm(name), 1.0)
        assert solution.outcome.converged, name
        assert np.array_equal(solution.rubbed.state, wanted.rubbed.state), name
        assert np.max(np.abs(solution.u - wanted.u)) < 1e-8 * np.max(np.abs(wanted.u)), name
        assert np.max(np.abs(solution.rubbed.force - wanted.rubbed.force)) < 1e-8 * largest, name
    assert plate.solve(by_the_exact_law(naive=True)["trial-and-error"], 1.0).outcome.word == "cycling"
    sprung = plate.solve(algorithm("regularised"), 1.0)
    assert sprung.outcome.converged
    assert np.max(np.abs(sprung.rubbed.force - wanted.rubbed.force)) < 1e-4 * largest


def test_trial_and_error_on_bars() -> None:
    """As semismooth Newton there and back; what the others do is written down among the golden answers."""
    bar = Bar(10, LENGTH, 1.0, press=TAU)
    states = list(follow(bar.stage_at, [PULL, 0.0], algorithm("trial-and-error"), bar.rest))
    for actual, known in zip(states, bar.follow([PULL, 0.0]), strict=True):
        assert actual.solution.outcome.converged
        assert np.max(np.abs(actual.solution.u - known.solution.u)) < 1e-8 * STRIP_END


def on_slope(slope: float, mu: float, push: float) -> ContactProblem:
    """A block of 1 N on soft springs, pushed horizontally; slip is positive upwards."""
    up, off = np.array([math.cos(slope), math.sin(slope)]), np.array([-math.sin(slope), math.cos(slope)])
    G, S = sparse.csr_matrix(off[None]), sparse.csr_matrix(np.array([up, [0.0, 0.0]]))
    mechanics = linear_mechanics(sparse.csc_matrix(np.eye(2)), np.array([push, -1.0]))
    law = Coulomb(np.full(1, mu), lambda u: (S @ u).reshape(1, 2), lambda u: S)
    return ContactProblem(mechanics, lambda u: G @ u, lambda u: G, np.ones(1), coulomb=law)


def test_wedge_and_slope_in_all_hands() -> None:
    """NAFEMS CGS-4: it moves up at F/G = 0.412371; a block on 26.565 degrees stays where mu is above its tangent."""
    wedge, slope = math.atan(0.1), math.radians(26.565)
    cases = {
        (wedge, 0.3, 0.412371 - 1e-5): State.STICK,
        (wedge, 0.3, 0.412371 + 1e-5): State.SLIP,
        (slope, 0.5, 0.0): State.STICK,
        (slope, 0.49, 0.0): State.SLIP,
    }
    for name, (case, state) in product(ALGORITHMS, cases.items()):
        solution = algorithm(name).solve(on_slope(*case), ContactSolution.at_rest(2, 1))
        assert solution.outcome.converged, name
        assert solution.rubbed.state[0] == state, name
