"""Candidates left out of a step: the answer is that with all of them, whoever turns out to touch.

Starts that are not states of a path: they save iterations, and change neither answers nor what a path remembers.
"""

from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.continuation.candidates import Start, none_known, solve_within_reach
from contact.continuation.load_stepping import follow
from contact.coulomb import Friction
from contact.events import EventKind, events
from contact.obstacles.foundation import Candidates, RigidPlane, against
from contact.problem import ContactAlgorithm, ContactProblem, ContactSolution, Linearisation, without_contact
from studies.scenes.complete import complete as resolve
from studies.solving.solve import solve
from support.problems.contact_problems import linear_mechanics

DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True)
class Watched:
    """An algorithm that keeps how many candidates it was given."""

    inner: ContactAlgorithm
    seen: list[int] = field(default_factory=list)

    def __getattr__(self, name: str) -> object:
        return getattr(self.inner, name)

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        self.seen.append(len(problem.weights))
        return self.inner.solve(problem, start)


def seesaw(arm: float, coupling: sparse.csr_matrix | None = None) -> ContactProblem:
    """Two points at heights 0 and 3, a floor at 1: lifting the first lowers the second ``arm`` times as far."""
    heights = np.array([0.0, 3.0])
    x = np.array([[0.0, 0.0, z] for z in heights])
    on_z = sparse.csr_matrix((np.ones(2), ([2, 5], [0, 1])), shape=(6, 2))
    candidates = Candidates(x, on_z, np.ones(2), coupling)
    soft, stiff = np.array([1.0, 0.0]), np.array([arm, 1.0])  # the stiff motion: w + arm v = 0
    K = 0.1 * np.outer(soft, soft) + 1e3 * np.outer(stiff, stiff)
    return against(linear_mechanics(K, np.zeros(2)), candidates, RigidPlane(DOWN, -1.0))


def test_who_was_left_out_and_penetrates_is_taken_in() -> None:
    """The second point, twice as far off as the foundation has come, is lowered by more than that when arm = 5."""
    for name, arm in product(ALGORITHMS, (1.0, 5.0)):
        problem, algorithm = seesaw(arm), Watched(ALGORITHMS[name]())
        rest = ContactSolution.at_rest(2, 2)
        near = solve_within_reach(algorithm, problem, rest)
        every = ALGORITHMS[name]().solve(problem, rest)
        assert algorithm.seen == ([1] if arm == 1.0 else [1, 2])
        np.testing.assert_allclose(near.u, every.u, rtol=0, atol=1e-9)
        np.testing.assert_allclose(near.pressure, every.pressure, rtol=1e-9, atol=1e-12)
        np.testing.assert_array_equal(near.active, every.active)
        noted = events(near.history, EventKind.TAKEN_IN)
        assert len(noted) == len(algorithm.seen) - 1
        assert near.counters["factorisations"] >= every.counters["factorisations"]


def test_consistent_coupling_keeps_every_candidate() -> None:
    coupling = sparse.csr_matrix(np.array([[2.0, 1.0], [1.0, 2.0]]))
    problem, algorithm = seesaw(1.0, coupling), Watched(Semismooth())
    solve_within_reach(algorithm, problem, ContactSolution.at_rest(2, 2))
    assert problem.only is None
    assert algorithm.seen == [2]
    with pytest.raises(ValueError, match="taken apart"):
        Candidates(np.zeros((2, 3)), sparse.csr_matrix((6, 2)), np.ones(2), coupling).only(np.array([True, False]))


def test_the_failure_of_the_few_is_that_of_the_step() -> None:
    """Nothing resists the first point: singular with or without the second."""
    problem = seesaw(0.0)
    assert problem.only is not None
    only, nothing = problem.only, linear_mechanics(np.zeros((2, 2)), np.array([0.0, 1.0]))
    loose = replace(problem, linearise=nothing, only=lambda chosen: replace(only(chosen), linearise=nothing))
    actual = solve_within_reach(Semismooth(), loose, ContactSolution.at_rest(2, 2))
    assert not actual.outcome.converged


@pytest.mark.slow
def test_the_tyre_is_solved_with_the_nodes_near_its_patch(monkeypatch: pytest.MonkeyPatch) -> None:
    """And its answer has the digits of the one with all nodes."""
    request = resolve("tyre", {"delta_mm": "5,20"}, "16x18", model="full")
    seen: list[int] = []

    class Watching(Semismooth):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            seen.append(len(problem.weights))
            return super().solve(problem, start)

    monkeypatch.setitem(ALGORITHMS, "semismooth", Watching)
    near = solve(*request)
    monkeypatch.setattr(
        "contact.continuation.load_stepping.solve_within_reach", lambda algorithm, *step: algorithm.solve(*step)
    )
    every = solve(*request)
    few, all_of_them = seen[1:3], seen[4:]  # after inflation without any
    assert all_of_them == [len(every.last.pressure)] * 2
    assert max(few) < all_of_them[0] / 3
    assert near.quantities["force_N"] == pytest.approx(every.quantities["force_N"], rel=1e-12)
    np.testing.assert_array_equal(near.last.active, every.last.active)


REST = ContactSolution.at_rest(2, 0)


def softening(t: float) -> ContactProblem:
    """tanh u = t in both unknowns."""

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        with np.errstate(over="ignore"):  # far from the answer
            slope = 1 / np.cosh(u) ** 2
        return Linearisation(np.tanh(u) - t, sparse.csc_matrix(np.diag(slope)), 1.0)

    return without_contact(linearise, 2)


def at(u: float) -> Start:
    return Start(np.full(2, u), np.zeros(0), np.zeros(0, bool))


def test_a_start_near_the_answer_saves_iterations_and_moves_nothing() -> None:
    (plain,) = follow(softening, 0.0, [0.5], Semismooth(), REST)
    near = np.arctanh(0.5) + 1e-6
    (from_near,) = follow(softening, 0.0, [0.5], Semismooth(), REST, starts=lambda index, last, t: at(near))
    assert from_near.solution.u == pytest.approx(plain.solution.u, rel=1e-9)
    assert from_near.solution.counters["newton_iterations"] < plain.solution.counters["newton_iterations"]


def test_a_start_that_leads_nowhere_is_left_for_the_last_state_and_paid_for() -> None:
    (plain,) = follow(softening, 0.0, [0.5], Semismooth(), REST)
    (actual,) = follow(softening, 0.0, [0.5], Semismooth(), REST, starts=lambda index, last, t: at(5.0))
    assert actual.outcome.converged
    assert actual.substeps == 1
    assert np.array_equal(actual.solution.u, plain.solution.u)
    assert actual.solution.counters["assemblies"] > plain.solution.counters["assemblies"]
    (event,) = events(actual.solution.history, EventKind.FAILED)
    assert "not from the state of another grid" in str(event)


def test_starts_are_asked_with_the_index_of_the_point_and_the_last_state() -> None:
    asked = []

    def starts(index: int, last: tuple[float, ContactSolution], t: float) -> None:
        asked.append((index, last[0], t))

    list(follow(softening, 0.0, [0.2, 0.4], Semismooth(), REST, 2, starts=starts))
    assert np.array(asked) == pytest.approx(np.array([(0, 0.0, 0.1), (0, 0.1, 0.2), (1, 0.2, 0.3), (1, 0.3, 0.4)]))
    assert none_known(0, (0.0, REST), 1.0) is None


def test_its_memory_is_that_of_the_start_alone() -> None:
    heard = []

    def linearise(u: np.ndarray, memory: object) -> Linearisation:
        heard.append(memory)
        return Linearisation(u, sparse.csc_matrix(np.eye(2)), 1.0)

    start = replace(at(1.0), memory="known")
    problem = start.remembered(without_contact(linearise, 2))
    for u, memory in ((start.u, None), (start.u, "own"), (start.u + 1, None)):
        problem.linearise(u, memory)
    assert heard == ["known", "own", None]


def test_slips_are_counted_from_the_path_and_not_from_the_start() -> None:
    places = np.arange(6.0).reshape(2, 3)
    before = Friction(np.zeros((2, 2)), np.array([1, 0], np.int8), places, places + 1, dissipation=3.0)
    last = replace(ContactSolution.at_rest(4, 2), friction=before)
    traction, state = np.ones((2, 2)), np.array([2, 1], np.int8)
    start = Start(np.ones(4), np.ones(2), np.ones(2, bool), None, traction, state)
    actual = start.instead_of(last, np.array([10.0, 20.0])).friction
    assert np.array_equal(actual.force, [[10, 10], [20, 20]])
    assert np.array_equal(actual.state, state)
    assert (actual.since is before.since, actual.anchors is before.anchors, actual.dissipation) == (True, True, 3.0)
