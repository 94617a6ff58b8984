"""What the six algorithms with friction have in common: their answers, their twins, and how they say there is none.

The first exact algorithm: planted answers, its limits without friction and with an endless one, its tangent.
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.augmented_lagrangian import AugmentedLagrangian
from contact.algorithms.base import NewtonAlgorithm, require_friction
from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.algorithms.regularised import Regularised
from contact.algorithms.semismooth import Semismooth
from contact.algorithms.trial_and_error import TrialAndError
from contact.catalogue import ALGORITHMS, by_the_exact_law, is_exact
from contact.coulomb import State
from contact.events import EventKind, events
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.verify import judge
from support.problems.frictional import linear, manufactured, planted, tied, with_mu

EXACT: dict[str, ContactAlgorithm] = {
    "semismooth": Semismooth(),
    "augmented-lagrangian": AugmentedLagrangian(),
    "qp": Qp(),
    "qp on discs": Qp(backend="clarabel"),
    "lcp": Lcp(),
}
HELD = ("trial-and-error", "semismooth", "qp", "lcp")  # by unknowns, not by springs
SEEDS = [range(1), pytest.param(range(1, 10), marks=pytest.mark.slow)]


def solved(algorithm: ContactAlgorithm, problem: ContactProblem) -> ContactSolution:
    """From rest."""
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    return algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


@pytest.mark.parametrize("seeds", SEEDS)
@pytest.mark.parametrize("name", EXACT)
def test_all_that_claim_the_exact_law_agree(name: str, seeds: range) -> None:
    for seed, mu in product(seeds, (0.1, 0.5, 1.0)):
        wanted = planted(seed, mu)
        solution = solved(EXACT[name], wanted.problem)
        assert solution.outcome is Outcome.CONVERGED, (seed, mu)
        assert np.array_equal(solution.rubbed.state, wanted.state), (seed, mu)
        fields = (solution.u, wanted.u), (solution.pressure, wanted.normal), (solution.rubbed.force, wanted.friction)
        for mine, built in fields:
            assert np.max(np.abs(mine - built)) < 1e-8, (seed, mu)
        assert not judge(wanted.problem, solution.u, solution.pressure, solution.rubbed.force).failures(), (seed, mu)


def same(found: ContactSolution, wanted: ContactSolution, close: float = 1e-8) -> None:
    """Converged, to the same states and fields."""
    assert found.outcome is wanted.outcome is Outcome.CONVERGED
    assert np.array_equal(found.rubbed.state, wanted.rubbed.state)
    for mine, theirs in (
        (found.u, wanted.u),
        (found.pressure, wanted.pressure),
        (found.rubbed.force, wanted.rubbed.force),
    ):
        assert np.max(np.abs(mine - theirs)) < close


@pytest.mark.parametrize("epsilon", [10.0, 1e4, 1e8])
def test_all_that_know_springs_agree_on_them(epsilon: float) -> None:
    problem = planted(6, 0.4, components=1).problem  # where the naive set ends
    wanted = solved(Regularised(epsilon=epsilon), problem)
    for name in ("semismooth", "qp", "lcp", "trial-and-error"):
        same(solved(ALGORITHMS[name](epsilon=epsilon), problem), wanted)


def test_with_none_the_answer_is_that_without_friction() -> None:
    for name in ALGORITHMS:
        problem = planted(2, 0.0).problem
        frictionless = by_the_exact_law()[name]
        wanted = frictionless.solve(replace(problem, coulomb=None), ContactSolution.at_rest(26, 7))
        solution = solved(frictionless, problem)
        assert wanted.outcome is solution.outcome is Outcome.CONVERGED
        assert np.array_equal(solution.active, wanted.active)
        assert np.max(np.abs(solution.u - wanted.u)) < 1e-8
        assert np.max(np.abs(solution.pressure - wanted.pressure)) < 1e-8
        assert not np.any(solution.rubbed.force)


def test_smooth_candidates_beside_rough_ones() -> None:
    for name in EXACT:
        problem = planted(4, 0.7).problem
        mixed = with_mu(problem, np.where(np.arange(7) % 2, problem.coulomb.mu, 0.0))
        wanted, actual = solved(Semismooth(), mixed), solved(EXACT[name], mixed)
        assert wanted.outcome is actual.outcome is Outcome.CONVERGED
        assert np.max(np.abs(actual.rubbed.force - wanted.rubbed.force)) < 1e-8
        assert not np.any(actual.rubbed.force[::2])
        assert not judge(mixed, actual.u, actual.pressure, actual.rubbed.force).failures()


def test_an_endless_friction_ties() -> None:
    for name in ("trial-and-error", "regularised", "augmented-lagrangian"):
        problem = tied(3)
        wanted, actual = solved(Semismooth(), problem), solved(by_the_exact_law(1e8)[name], problem)
        assert wanted.outcome is actual.outcome is Outcome.CONVERGED
        assert np.max(np.abs(actual.rubbed.force - wanted.rubbed.force)) < (1e-8 if is_exact(name) else 1e-6)
        assert not np.any(actual.rubbed.state == State.SLIP)


def test_it_gives_programmes_no_bound() -> None:
    for name in ("qp", "lcp"):
        assert "infinite coefficient" in (ALGORITHMS[name]().supports(tied(3)) or "")


def test_candidates_that_share_unknowns_are_held_together() -> None:
    """Every gap and slip depends on all unknowns. States that are swapped may go round in a circle."""
    ended = set[Outcome]()
    for seed in range(3):
        step, wanted = manufactured(np.random.default_rng(seed), 4, np.array([0, 1, 2, 2]))
        problem = step.problem()
        for name in HELD:
            solution = by_the_exact_law()[name].solve(problem, ContactSolution.at_rest(len(wanted.u), 4))
            if name == "trial-and-error" and not solution.outcome.converged:
                ended.add(solution.outcome)
                continue
            assert solution.outcome is Outcome.CONVERGED, name
            assert np.max(np.abs(solution.u - wanted.u)) < 1e-8
            assert np.max(np.abs(solution.rubbed.force - wanted.friction)) < 1e-8
        solution = AugmentedLagrangian().solve(problem, ContactSolution.at_rest(len(wanted.u), 4))
        assert solution.outcome is Outcome.CONVERGED
        assert np.max(np.abs(solution.u - wanted.u)) < 1e-8
        assert np.max(np.abs(solution.rubbed.force - wanted.friction)) < 1e-8
    assert ended <= {Outcome.CYCLING}


def two_ways() -> ContactProblem:
    """One candidate of two unknowns whose slips are the same, pressed and pulled to where it sticks."""
    G, S = np.array([[0.0, 1.0]]), np.array([[1.0, 0.0], [1.0, 0.0]])
    return linear(np.eye(2), np.array([0.2, -1.0]), G, S, np.zeros(1), np.zeros((1, 2)), np.ones(1))


def test_a_candidate_with_less_ways_than_its_slip_is_refused() -> None:
    for name in HELD:
        solution = solved(by_the_exact_law()[name], two_ways())
        assert solution.outcome is Outcome.REFUSED
        assert "fewer directions than its slip has" in str(events(solution.history, EventKind.FAILED)[-1])


def test_all_of_the_catalogue_know_friction() -> None:
    for name in ALGORITHMS:
        algorithm = ALGORITHMS[name](tolerance=1e-7, epsilon=123.0)
        require_friction(algorithm)
        assert (algorithm.supports(two_ways()) is None) == (name != "augmented-lagrangian")
        coupled = replace(two_ways(), coupling=sparse.eye_array(1, format="csr"))
        assert "lumped" in ALGORITHMS[name]().supports(coupled)
        with pytest.raises(ValueError, match="lumped"):
            ALGORITHMS[name]().solve(coupled, ContactSolution.at_rest(2, 1))
        with pytest.raises(ValueError, match="lumped"):
            judge(coupled, np.zeros(2), np.zeros(1), np.zeros((1, 2)))


def test_other_numbers_of_coefficients_than_candidates_are_refused() -> None:
    for mu in (np.ones(2), np.ones((1, 1)), np.ones(())):
        problem = two_ways()
        other = replace(problem, coulomb=replace(problem.coulomb, mu=mu))
        assert Semismooth().supports(other) == "mu must be 1 numbers in [0, inf]"
        with pytest.raises(ValueError, match="mu must be 1 numbers"):
            judge(other, np.zeros(2), np.zeros(1), np.zeros((1, 2)))


def test_friction_of_a_problem_without_a_law_is_refused() -> None:
    with pytest.raises(ValueError, match="has none"):
        judge(replace(two_ways(), coulomb=None), np.zeros(2), np.zeros(1), np.zeros((1, 2)))


def test_a_parameter_that_friction_does_not_have_is_refused() -> None:
    for name, key, value in (("lcp", "method", "nnls"), ("semismooth", "c", 7.0), ("qp", "system", "full")):
        with pytest.raises(ValueError, match=rf"{key} = {value}: with friction {name} has epsilon, tolerance, solver"):
            require_friction(ALGORITHMS[name](**{key: value}))
        assert f"{key} = {value}" in str(ALGORITHMS[name](**{key: value}).supports(two_ways()))


def test_who_knows_no_friction_is_refused() -> None:
    class Other(NewtonAlgorithm):
        name = "other"

    class Inherits(Semismooth):
        name = "inherits"

        def solve(self, problem, start):
            raise NotImplementedError

    class Says(Inherits):
        friction = True

    for algorithm in (Other(), Inherits()):
        with pytest.raises(ValueError, match=f"'{algorithm.name}' does not support friction"):
            require_friction(algorithm)
        assert "does not support friction" in str(algorithm.supports(two_ways()))
    require_friction(Says())


@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 12), marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", EXACT)
def test_what_strong_friction_is_said_to_be_obeys_the_law(name: str, seeds: range) -> None:
    """Beyond what is known to have one answer, each finds one."""
    for seed, mu in product(seeds, (1.0, 3.0)):
        wanted = planted(seed, mu, coupled=0.8, m=10)
        solution = solved(EXACT[name], wanted.problem)
        assert solution.outcome is Outcome.CONVERGED, (seed, mu)
        assert not judge(wanted.problem, solution.u, solution.pressure, solution.rubbed.force).failures(), (seed, mu)


def by_semismooth(problem: ContactProblem, algorithm: Semismooth | TrialAndError | None = None) -> ContactSolution:
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    return (algorithm or Semismooth()).solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


def test_the_planted_answer_is_found() -> None:
    """All three states are in each; with one component of slip the linearisation is exact and one iteration does."""
    for seed, mu, components in product(range(4), (0.1, 0.4, 1.0), (1, 2)):
        wanted = planted(seed, mu, components=components)
        actual = by_semismooth(wanted.problem)
        assert actual.outcome is Outcome.CONVERGED
        assert np.array_equal(actual.rubbed.state, wanted.state)
        for mine, built in (
            (actual.u, wanted.u),
            (actual.pressure, wanted.normal),
            (actual.rubbed.force, wanted.friction),
        ):
            assert np.max(np.abs(mine - built)) < 1e-9
        assert actual.counters["newton_iterations"] <= (1 if components == 1 else 6)


def test_semismooth_ties_who_touches_by_an_endless_friction() -> None:
    """Against K du - J_A^T F_A = f, v_A = 0 of the candidates that touch."""
    for seed in range(5):
        problem = tied(seed)
        actual = by_semismooth(problem)
        assert actual.outcome is Outcome.CONVERGED
        touch = actual.rubbed.state == State.STICK
        assert touch.any()
        assert np.all(touch | (actual.rubbed.state == State.OPEN))
        u = np.zeros_like(actual.u)
        lin = problem.linearise(u, None)
        slips = problem.coulomb.slip_jacobian(u)[np.repeat(touch, 2)]
        J = sparse.vstack([problem.gap_jacobian(u)[touch], slips]).toarray()
        v = np.append(problem.gap(u)[touch], problem.coulomb.slip(u)[touch].ravel())
        zero = np.zeros((len(J), len(J)))
        x = np.linalg.solve(np.block([[lin.tangent.toarray(), -J.T], [J, zero]]), np.append(-lin.residual, -v))
        assert np.max(np.abs(actual.u - x[: len(u)])) <= 1e-9 * np.max(np.abs(actual.u))
        assert np.all(problem.gap(actual.u)[~touch] >= 0)
        assert np.all(actual.pressure[touch] >= 0)


class TestKlarbring:
    """Two springs: K = [[Ktt, Ktn], [Ktn, Knn]] of one candidate, u = (u_t, u_n), gap -u_n + g0, slip u_t.

    A candidate that sticks, slips to either side, or is open: its candidate answers are worked out by hand, and which
    of them are answers is looked up. Where mu |Knt| < Ktt there is one; beyond there may be several, and
    the rate problem may have none.
    Source: Klarbring, Ingenieur-Archiv 60 (1990) 529-541.
    """

    K = np.array([[1.0, 0.6], [0.6, 1.0]])

    def problem(self, mu: float, load: tuple[float, float], slip0: float = 0.0) -> ContactProblem:
        G, S = np.array([[0.0, -1.0]]), np.array([[1.0, 0.0], [0.0, 0.0]])
        return linear(self.K, np.array(load), G, S, np.zeros(1), np.array([[slip0, 0.0]]), np.array([mu]))

    def answers(self, mu: float, load: tuple[float, float], slip0: float = 0.0) -> list[tuple[float, float, str]]:
        """(u_t, u_n, state) of all answers."""
        Ft, Fn = load
        values = []
        u = np.linalg.solve(self.K, load)
        if u[1] < 0:
            values.append((float(u[0]), float(u[1]), "open"))
        ut = -slip0
        f, t = Fn - self.K[1, 0] * ut, self.K[0, 0] * ut - Ft
        if f >= 0 and abs(t) <= mu * f:
            values.append((ut, 0.0, "stick"))
        for way in (1.0, -1.0):  # Ktt ut - Ft = -way mu f, f = Fn - Knt ut
            slope = self.K[0, 0] - way * mu * self.K[1, 0]
            ut = (Ft - way * mu * Fn) / slope
            f = Fn - self.K[1, 0] * ut
            if f >= 0 and way * (ut + slip0) > 0:
                values.append((ut, 0.0, "slip"))
        return values

    def test_below_the_bound_there_is_one_answer_and_it_is_found(self) -> None:
        for load in ((0.2, 1.0), (2.0, 1.0), (-2.0, 1.0), (0.3, -1.0), (5.0, 1.0)):
            answers = self.answers(0.8, load)
            assert len(answers) == 1
            actual = by_semismooth(self.problem(0.8, load))
            assert actual.outcome is Outcome.CONVERGED
            assert actual.u == pytest.approx(answers[0][:2], abs=1e-12)

    def test_beyond_it_no_false_answer_is_claimed(self) -> None:
        """One of several is found, or none is claimed; there is never none (Brouwer's theorem on Tresca's passes)."""
        counts = set[int]()
        for mu, force, slip0 in product((1.8, 2.5, 6.0), (-3.0, -1.0, 0.3, 1.5, 1.8, 2.5, 4.0), (-0.7, 0.0, 0.7)):
            load = (force, 1.0)
            answers, actual = self.answers(mu, load, slip0), by_semismooth(self.problem(mu, load, slip0))
            counts.add(len(answers))
            if actual.outcome is Outcome.CONVERGED:
                assert any(np.allclose(actual.u, each[:2], atol=1e-10) for each in answers), (actual, answers)
            else:
                assert actual.outcome in {Outcome.CYCLING, Outcome.SINGULAR, Outcome.ITERATION_LIMIT}
        assert min(counts) == 1 < max(counts)


@pytest.mark.parametrize("name", ["semismooth", "qp", "lcp"])
def test_a_point_that_rests_in_a_fold_has_no_state_and_one_on_its_side_has(name: str) -> None:
    """x = f - a p sign(x), p = 1 + a |x|, of a point that slips along the fold z = a |x|."""
    a, mu = 0.2, np.array([0.3])

    def pulled(f: float) -> ContactSolution:
        S, s0 = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]), np.array([[5.0, 0.0]])
        flat = linear(np.eye(3), np.array([f, 0.0, -1.0]), np.array([[0.0, 0.0, 1.0]]), S, np.zeros(1), s0, mu)
        folded = replace(
            flat,
            gap=lambda u: u[2:] - a * abs(u[:1]),
            gap_jacobian=lambda u: sparse.csr_matrix([[-a * np.sign(u[0]), 0.0, 1.0]]),
        )
        return solved(ALGORITHMS[name](), folded)

    beside, within = pulled(0.5), pulled(0.05)
    assert beside.outcome is Outcome.CONVERGED
    assert beside.u[0] == pytest.approx((0.5 - a) / (1 + a**2), rel=1e-12)
    assert within.outcome is Outcome.ALTERNATING
    assert within.counters["newton_iterations"] <= 6
