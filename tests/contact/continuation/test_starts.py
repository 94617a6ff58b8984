"""Starts that are no states of a path: they save iterations, and change neither answers nor what a path remembers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import sparse

from contact.algorithms.semismooth import Semismooth
from contact.continuation.candidates import Start, none_known
from contact.continuation.load_stepping import follow
from contact.coulomb import Friction
from contact.events import EventKind, events
from contact.problem import ContactProblem, ContactSolution, Linearisation, without_contact

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
    (found,) = follow(softening, 0.0, [0.5], Semismooth(), REST, starts=lambda index, last, t: at(5.0))
    assert found.outcome.converged
    assert found.substeps == 1
    assert np.array_equal(found.solution.u, plain.solution.u)
    assert found.solution.counters["assemblies"] > plain.solution.counters["assemblies"]
    (event,) = events(found.solution.history, EventKind.FAILED)
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
    found = start.instead_of(last, np.array([10.0, 20.0])).friction
    assert found is not None
    assert np.array_equal(found.force, [[10, 10], [20, 20]])
    assert np.array_equal(found.state, state)
    assert (found.since is before.since, found.anchors is before.anchors, found.dissipation) == (True, True, 3.0)
