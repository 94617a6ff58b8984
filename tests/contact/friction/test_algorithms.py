"""What the six algorithms with friction have in common: their answers, their twins, and how they say there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.augmented_lagrangian import AugmentedLagrangian
from contact.algorithms.base import NewtonAlgorithm, require_friction
from contact.algorithms.lcp import Lcp
from contact.algorithms.qp import Qp
from contact.algorithms.regularised import Regularised
from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS, by_the_exact_law
from contact.coulomb import State
from contact.events import EventKind, events
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Outcome
from contact.verify import judge
from support.problems.frictional import manufactured
from support.problems.planted_friction import linear, planted, tied, with_mu

EXACT: dict[str, ContactAlgorithm] = {
    "semismooth": Semismooth(),
    "augmented-lagrangian": AugmentedLagrangian(),
    "qp": Qp(),
    "qp on discs": Qp(backend="clarabel"),
    "lcp": Lcp(),
}
HELD = ("trial-and-error", "semismooth", "qp", "lcp")  # need unknowns of a candidate's own
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 20))]


def solved(algorithm: ContactAlgorithm, problem: ContactProblem) -> ContactSolution:
    """From rest."""
    n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
    return algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.coulomb.mu)))


@pytest.mark.parametrize("mu", [0.1, 0.5, 1.0])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", EXACT)
def test_all_that_claim_the_exact_law_agree(name: str, seed: int, mu: float) -> None:
    wanted = planted(seed, mu)
    found = solved(EXACT[name], wanted.problem)
    assert found.outcome is Outcome.CONVERGED
    assert np.array_equal(found.rubbed.state, wanted.state)
    for mine, built in ((found.u, wanted.u), (found.pressure, wanted.normal), (found.rubbed.force, wanted.friction)):
        assert np.max(np.abs(mine - built)) < 1e-8
    assert not judge(wanted.problem, found.u, found.pressure, found.rubbed.force).failures()


@pytest.mark.parametrize("epsilon", [10.0, 1e4, 1e8])
@pytest.mark.parametrize("name", ["semismooth", "qp", "lcp", "trial-and-error"])
def test_all_that_know_springs_agree_on_them(name: str, epsilon: float) -> None:
    problem = planted(6, 0.4, components=1).problem  # where the naive set ends
    wanted = solved(Regularised(epsilon=epsilon), problem)
    found = solved(ALGORITHMS[name](epsilon=epsilon), problem)
    assert found.outcome is wanted.outcome is Outcome.CONVERGED
    assert np.array_equal(found.rubbed.state, wanted.rubbed.state)
    assert np.max(np.abs(found.u - wanted.u)) < 1e-8
    assert np.max(np.abs(found.pressure - wanted.pressure)) < 1e-8
    assert np.max(np.abs(found.rubbed.force - wanted.rubbed.force)) < 1e-8


@pytest.mark.parametrize("name", ALGORITHMS)
def test_with_none_the_answer_is_that_without_friction(name: str) -> None:
    problem = planted(2, 0.0).problem
    frictionless = ALGORITHMS[name](epsilon=1e4 if name == "regularised" else np.inf)
    wanted = frictionless.solve(replace(problem, coulomb=None), ContactSolution.at_rest(26, 7))
    found = solved(frictionless, problem)
    assert wanted.outcome is found.outcome is Outcome.CONVERGED
    assert np.array_equal(found.active, wanted.active)
    assert np.max(np.abs(found.u - wanted.u)) < 1e-8
    assert np.max(np.abs(found.pressure - wanted.pressure)) < 1e-8
    assert not np.any(found.rubbed.force)


@pytest.mark.parametrize("name", EXACT)
def test_smooth_candidates_beside_rough_ones(name: str) -> None:
    problem = planted(4, 0.7).problem
    mixed = with_mu(problem, np.where(np.arange(7) % 2, problem.coulomb.mu, 0.0))
    wanted, found = solved(Semismooth(), mixed), solved(EXACT[name], mixed)
    assert wanted.outcome is found.outcome is Outcome.CONVERGED
    assert np.max(np.abs(found.rubbed.force - wanted.rubbed.force)) < 1e-8
    assert not np.any(found.rubbed.force[::2])
    assert not judge(mixed, found.u, found.pressure, found.rubbed.force).failures()


@pytest.mark.parametrize("name", ["trial-and-error", "regularised", "augmented-lagrangian"])
def test_an_endless_friction_ties(name: str) -> None:
    problem = tied(3)
    wanted, found = solved(Semismooth(), problem), solved(by_the_exact_law(1e8)[name], problem)
    assert wanted.outcome is found.outcome is Outcome.CONVERGED
    assert np.max(np.abs(found.rubbed.force - wanted.rubbed.force)) < (1e-6 if name == "regularised" else 1e-8)
    assert not np.any(found.rubbed.state == State.SLIP)


@pytest.mark.parametrize("name", ["qp", "lcp"])
def test_it_gives_programmes_no_bound(name: str) -> None:
    assert "infinite coefficient" in (ALGORITHMS[name]().supports(tied(3)) or "")


@pytest.mark.parametrize("seed", range(3))
def test_candidates_that_share_unknowns_need_springs(seed: int) -> None:
    """Every gap and slip depends on all unknowns: held by none of their own, but by springs."""
    step, wanted = manufactured(np.random.default_rng(seed), 4, np.array([0, 1, 2, 2]))
    problem = step.problem()
    for name in HELD:
        found = by_the_exact_law()[name].solve(problem, ContactSolution.at_rest(len(wanted.u), 4))
        assert found.outcome is Outcome.REFUSED, name
        assert "share an unknown" in str(events(found.history, EventKind.FAILED)[-1])
    found = AugmentedLagrangian().solve(problem, ContactSolution.at_rest(len(wanted.u), 4))
    assert found.outcome is Outcome.CONVERGED
    assert np.max(np.abs(found.u - wanted.u)) < 1e-8
    assert np.max(np.abs(found.rubbed.force - wanted.friction)) < 1e-8
    assert np.array_equal(found.rubbed.state, wanted.state)


def two_ways() -> ContactProblem:
    """One candidate of two unknowns whose slips are the same, pressed and pulled to where it sticks."""
    G, S = np.array([[0.0, 1.0]]), np.array([[1.0, 0.0], [1.0, 0.0]])
    return linear(np.eye(2), np.array([0.2, -1.0]), G, S, np.zeros(1), np.zeros((1, 2)), np.ones(1))


@pytest.mark.parametrize("name", HELD)
def test_a_candidate_with_less_ways_than_its_slip_is_refused(name: str) -> None:
    found = solved(by_the_exact_law()[name], two_ways())
    assert found.outcome is Outcome.REFUSED
    assert "less ways than its slip has" in str(events(found.history, EventKind.FAILED)[-1])


@pytest.mark.parametrize("name", ALGORITHMS)
def test_all_of_the_catalogue_know_friction(name: str) -> None:
    algorithm = ALGORITHMS[name](tolerance=1e-7, epsilon=123.0)
    require_friction(algorithm)
    assert (algorithm.supports(two_ways()) is None) == (name != "augmented-lagrangian")
    coupled = replace(two_ways(), coupling=sparse.eye_array(1, format="csr"))
    assert "lumped" in ALGORITHMS[name]().supports(coupled)
    with pytest.raises(ValueError, match="lumped"):
        ALGORITHMS[name]().solve(coupled, ContactSolution.at_rest(2, 1))
    with pytest.raises(ValueError, match="lumped"):
        judge(coupled, np.zeros(2), np.zeros(1), np.zeros((1, 2)))


@pytest.mark.parametrize("mu", [np.ones(2), np.ones((1, 1)), np.ones(())])
def test_other_numbers_of_coefficients_than_candidates_are_refused(mu: np.ndarray) -> None:
    problem = two_ways()
    other = replace(problem, coulomb=replace(problem.coulomb, mu=mu))
    assert Semismooth().supports(other) == "mu must be 1 numbers in [0, inf]"
    with pytest.raises(ValueError, match="mu must be 1 numbers"):
        judge(other, np.zeros(2), np.zeros(1), np.zeros((1, 2)))


def test_friction_of_a_problem_without_a_law_is_refused() -> None:
    with pytest.raises(ValueError, match="has none"):
        judge(replace(two_ways(), coulomb=None), np.zeros(2), np.zeros(1), np.zeros((1, 2)))


@pytest.mark.parametrize(
    ("name", "key", "value"), [("lcp", "method", "nnls"), ("semismooth", "c", 7.0), ("qp", "system", "full")]
)
def test_a_parameter_that_friction_does_not_have_is_refused(name: str, key: str, value: object) -> None:
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
        with pytest.raises(ValueError, match=f"'{algorithm.name}' knows no friction"):
            require_friction(algorithm)
        assert "knows no friction" in str(algorithm.supports(two_ways()))
    require_friction(Says())


@pytest.mark.parametrize("mu", [1.0, 3.0])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 12))])
@pytest.mark.parametrize("name", EXACT)
def test_what_strong_friction_is_said_to_be_obeys_the_law(name: str, seed: int, mu: float) -> None:
    """Beyond what is known to have one answer, each finds one."""
    wanted = planted(seed, mu, coupled=0.8, m=10)
    found = solved(EXACT[name], wanted.problem)
    assert found.outcome is Outcome.CONVERGED
    assert not judge(wanted.problem, found.u, found.pressure, found.rubbed.force).failures()
