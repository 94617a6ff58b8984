"""Load stepping: a failed step is cut, an easy one grows back, the history says so, and a dead end keeps its state."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy import sparse

import contact.events
from contact.catalogue import ALGORITHMS
from contact.continuation.candidates import EASY_ITERATIONS
from contact.continuation.load_stepping import (
    BRIEF,
    SMALLEST,
    WORTH,
    Attempt,
    Stepper,
    follow,
)
from contact.events import Event, EventKind, PathEnd
from contact.problem import ContactProblem, ContactSolution, Linearisation, Outcome, without_contact
from support.problems.contact_problems import Quadratic

EXACT = 1e-9


@pytest.fixture
def tracking():
    """problem_at(t): one spring whose solution is u = t, with a wall at 1 that presses from there on."""

    def at(t: float) -> ContactProblem:
        return Quadratic(np.eye(1), np.array([t]), -np.ones((1, 1)), np.array([1.0]), np.array([2.0])).problem()

    return at


@dataclass(frozen=True)
class Choosy:
    """A real algorithm that refuses steps of the load above ``reach``, and any load beyond ``wall``."""

    reach: float = math.inf
    wall: float = math.inf
    iterations: int = 1
    factorisations: int = 1
    in_vain: int = 0
    name: str = "choosy"
    epsilon: float = math.inf

    def supports(self, problem: ContactProblem) -> str | None:
        return None

    def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
        solution = ALGORITHMS["semismooth"]().solve(problem, start)
        load = float(solution.u[0] + 2 * solution.pressure[0])
        before = float(start.u[0] + 2 * start.pressure[0])
        counters = {"newton_iterations": self.iterations, "factorisations": self.factorisations}
        if abs(load - before) > self.reach * (1 + 1e-9) or load > self.wall:
            history = ({"residual": 1.0},)
            counters["factorisations"] = self.in_vain or self.factorisations
            return replace(start, outcome=Outcome.ITERATION_LIMIT, counters=counters, history=history)
        return replace(solution, counters=counters, history=({"residual": 0.5}, {"residual": 0.0}))


def run(tracking, algorithm, targets, start: float = 0.0, **options):
    begin = ContactSolution(np.array([start]), np.zeros(1), np.zeros(1, bool), Outcome.CONVERGED)
    return list(follow(tracking, start, targets, algorithm, begin, **options))


def parameters(point) -> list[float]:
    """The tried parameters, each once, in order."""
    tried = [row["parameter"] for row in point.history]
    return [t for i, t in enumerate(tried) if i == 0 or t != tried[i - 1]]


def events(point) -> list[tuple[float, str]]:
    """The events and the parameters they happened at."""
    return [(row["parameter"], str(row["event"])) for row in point.solution.history if "event" in row]


def test_easy_path_takes_the_steps_asked_for(tracking) -> None:
    points = run(tracking, Choosy(), [0.5, 2.0], steps=4)
    seen = [t for point in points for t, _ in point.way[1:]]
    assert [(p.requested, p.reached, p.substeps) for p in points] == [(0.5, 0.5, 4), (2.0, 2.0, 4)]
    assert seen == pytest.approx([0.125, 0.25, 0.375, 0.5, 0.875, 1.25, 1.625, 2.0], rel=EXACT)
    assert points[-1].solution.u[0] == pytest.approx(1.0, rel=EXACT)  # the wall
    assert points[-1].solution.pressure[0] == pytest.approx(0.5, rel=EXACT)  # (2 - 1)/area
    assert points[0].solution.counters["newton_iterations"] == 4
    assert not any("event" in row for p in points for row in p.solution.history)


def test_refused_steps_are_cut_until_they_pass(tracking) -> None:
    """A reach of 0.3 on a path of 1 is a path of quarters; growing back is refused and cut again each time."""
    (point,) = run(tracking, Choosy(reach=0.3), [1.0])
    assert point.outcome is Outcome.CONVERGED
    assert point.reached == point.requested == 1.0
    assert point.solution.u[0] == pytest.approx(1.0, rel=EXACT)
    assert point.substeps == 4
    assert parameters(point.solution) == [1.0, 0.5, 0.25, 0.75, 0.5, 1.0, 0.75, 1.0]
    reason, grown = Outcome.ITERATION_LIMIT.value, "easy step: the next one grows to 0.5"
    assert events(point)[:4] == [
        (1.0, f"{reason}: step cut to 0.5"),
        (0.5, f"{reason}: step cut to 0.25"),
        (0.25, grown),
        (0.75, f"{reason}: step cut to 0.25"),
    ]


def test_steps_that_were_hard_do_not_grow_back(tracking) -> None:
    (point,) = run(tracking, Choosy(reach=0.3, iterations=13), [1.0])
    assert point.outcome is Outcome.CONVERGED
    assert parameters(point.solution) == [1.0, 0.5, 0.25, 0.5, 0.75, 1.0]
    tries = 6
    assert point.solution.counters["newton_iterations"] == 13 * tries  # failed attempts are paid for, too
    assert len(point.solution.history) == 2 * 1 + 4 * 2


def test_steps_grow_back_after_a_bad_stretch(tracking) -> None:
    """Only the neighbourhood of 0.3 is refused in big steps: after it the full step returns, and no larger one."""

    @dataclass(frozen=True)
    class Patchy(Choosy):
        def solve(self, problem, start):
            return replace(self, reach=0.06 if start.u[0] < 0.3 else math.inf)._base(problem, start)

        def _base(self, problem, start):
            return Choosy.solve(self, problem, start)

    (point,) = run(tracking, Patchy(), [4.0], steps=16)
    assert point.outcome is Outcome.CONVERGED
    taken = np.diff([0.0, *[r["parameter"] for r in point.solution.history if r["residual"] == 0.0]])
    assert min(taken) <= 0.06
    assert max(taken) == pytest.approx(0.25, rel=EXACT)
    assert np.sum(taken > 0.24) >= 12


def test_a_dead_end_keeps_the_last_converged_state(tracking) -> None:
    points = run(tracking, Choosy(wall=0.7), [0.5, 1.0, 1.5])
    assert [p.requested for p in points] == [0.5, 1.0]  # 1.5 is never tried
    first, last = points
    assert first.outcome is Outcome.CONVERGED
    assert last.outcome is Outcome.STEP_LIMIT
    assert 0.7 - SMALLEST * 0.5 <= last.reached <= 0.7
    assert last.solution.outcome is Outcome.CONVERGED
    assert last.solution.u[0] == pytest.approx(last.reached, rel=EXACT)
    final = str(last.solution.history[-1]["event"])
    assert Outcome.ITERATION_LIMIT.value in final
    assert Outcome.STEP_LIMIT.value in final
    assert final.endswith(last.end.sentence)
    assert last.end.sentence.startswith("no limit point: the eigenvalue of least magnitude is 100 % of that at 0.5")
    assert last.cause is Outcome.ITERATION_LIMIT
    assert last.end.kind is PathEnd.NEITHER
    assert first.end is None


def test_nothing_ever_converges(tracking) -> None:
    (point,) = run(tracking, Choosy(wall=-1.0), [1.0])
    assert (point.outcome, point.reached, point.substeps) == (Outcome.STEP_LIMIT, 0.0, 0)
    assert point.solution.u[0] == 0.0
    halvings = round(-math.log2(SMALLEST))
    assert len(parameters(point.solution)) == halvings + 1
    assert point.solution.counters["newton_iterations"] == halvings + 1


@pytest.mark.parametrize("cost", [1, 12, 40, 100])
def test_a_path_that_has_ended_is_given_up_within_twenty_good_steps(tracking, cost: int) -> None:
    """Good steps are those up to the wall, and count no less than an easy one."""
    _, last = run(tracking, Choosy(wall=0.7, factorisations=5, in_vain=cost), [0.5, 1.0])
    well = 5 * last.substeps
    vain = last.solution.counters["factorisations"] - well
    assert not last.outcome.converged
    assert vain <= WORTH * EASY_ITERATIONS + well + cost
    assert cost > BRIEF or vain <= WORTH * EASY_ITERATIONS + well
    assert 0.5 < last.reached <= 0.7
    assert last.end is not None
    assert last.cause is Outcome.ITERATION_LIMIT
    assert (last.outcome is Outcome.GIVEN_UP) == (cost > EASY_ITERATIONS)
    assert (Outcome.GIVEN_UP.value in events(last)[-1][1]) == (cost > EASY_ITERATIONS)


@pytest.mark.slow
def test_a_dear_path_that_has_not_ended_is_not_given_up(tracking) -> None:
    """Steps of a hundredth of the target, each of them twelve factorisations: it goes on as long as it arrives."""
    (point,) = run(tracking, Choosy(reach=0.01, factorisations=12), [1.0])
    assert point.outcome is Outcome.CONVERGED
    assert point.substeps >= 100


def test_attempts_after_a_failure_are_brief(tracking) -> None:
    """A step that is small enough is easy; the algorithm is told to stop after fewer iterations."""
    asked: list[int] = []

    @dataclass(frozen=True)
    class Limited(Choosy):
        max_iterations: int = 40

        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            asked.append(self.max_iterations)
            return super().solve(problem, start)

    run(tracking, Limited(reach=0.3), [1.0, 1.2])
    assert asked[:3] == [40, BRIEF, BRIEF]
    assert asked[-1] == 40  # on the way to the next target


def test_the_path_also_runs_backwards(tracking) -> None:
    (easy,) = run(tracking, Choosy(), [-1.0], start=0.9, steps=4)
    assert parameters(easy.solution) == pytest.approx([0.425, -0.05, -0.525, -1.0], rel=EXACT)
    (hard,) = run(tracking, Choosy(reach=0.3), [-1.0], start=0.9)
    assert hard.outcome is Outcome.CONVERGED
    assert hard.solution.u[0] == pytest.approx(-1.0, rel=EXACT)
    assert hard.substeps == 8  # of 1.9/8


def test_a_target_already_reached_costs_nothing(tracking) -> None:
    (point,) = run(tracking, Choosy(), [0.0])
    assert (point.outcome, point.substeps, point.solution.history) == (Outcome.CONVERGED, 0, ())


@pytest.mark.parametrize("name", ["semismooth", "augmented-lagrangian"])
def test_a_path_that_newton_cannot_take_in_one_step(name) -> None:
    """A softening spring P = atan u, unloaded from 1.4 to -1: Newton overshoots and diverges, cut steps arrive."""

    def at(load: float) -> ContactProblem:
        def linearise(u, memory):
            return Linearisation(np.arctan(u) - load, sparse.csc_matrix(np.diag(np.cos(np.arctan(u)) ** 2)), 1.0)

        return without_contact(linearise, 1)

    begin = ContactSolution(np.tan([1.4]), np.zeros(0), np.zeros(0, bool), Outcome.CONVERGED)
    algorithm = ALGORITHMS[name]()
    assert not algorithm.solve(at(-1.0), begin).outcome.converged
    points = list(follow(at, 1.4, [0.5, -1.0], algorithm, begin))
    assert [p.outcome for p in points] == [Outcome.CONVERGED] * 2
    assert [p.reached for p in points] == [0.5, -1.0]
    assert [p.solution.u[0] for p in points] == pytest.approx(np.tan([0.5, -1.0]), rel=10 * EXACT)
    assert points[0].substeps > 1
    assert contact.events.events(points[0].solution.history, EventKind.STEP_CUT)


def test_an_algorithm_without_a_history_is_cut_and_told_about_all_the_same(tracking) -> None:
    @dataclass(frozen=True)
    class Silent(Choosy):
        def solve(self, problem: ContactProblem, start: ContactSolution) -> ContactSolution:
            return replace(super().solve(problem, start), history=())

    (point,) = run(tracking, Silent(reach=0.3), [1.0])
    loud = run(tracking, Choosy(reach=0.3), [1.0])[0]
    assert point.outcome is Outcome.CONVERGED
    assert events(point) == events(loud)
    (dead,) = run(tracking, Silent(wall=0.0), [1.0])
    assert dead.outcome is Outcome.STEP_LIMIT
    assert Outcome.STEP_LIMIT.value in events(dead)[-1][1]


def test_a_refusal_ends_the_path_at_once() -> None:
    """No smaller step makes a tangent symmetric: one attempt, its reason in the last row, the start kept."""

    def at(load: float) -> ContactProblem:
        K = np.array([[2.0, 1.0], [-1.0, 2.0]])
        return Quadratic(K, np.full(2, load), -np.eye(2), np.full(2, 0.1), np.ones(2)).problem()

    (point,) = follow(at, 0.0, [1.0, 2.0], ALGORITHMS["qp"](), ContactSolution.at_rest(2, 2))
    assert (point.outcome, point.reached, point.substeps) == (Outcome.REFUSED, 0.0, 0)
    assert parameters(point.solution) == [1.0]
    assert "no energy to minimise" in str(point.solution.history[-1]["event"])


def test_nothing_grows_after_the_last_step_to_a_target(tracking) -> None:
    """Quarters to each target: the last of them is as easy as the others, but no step follows it."""
    first, second = run(tracking, Choosy(reach=0.3), [1.0, 2.0])
    for point in (first, second):
        t, event = events(point)[-1]
        assert t < point.requested or "cut" in event
        assert [t for t, event in events(point) if "grows" in event] == pytest.approx(
            [point.requested - part for part in (0.75, 0.5, 0.25)], rel=EXACT
        )


def test_what_has_passed_through_is_not_asked_for_as_far_again(tracking) -> None:
    """The step that is cut is then the longest; after any other failure it may grow to what was asked for."""
    rest = ContactSolution(np.zeros(1), np.zeros(1), np.zeros(1, bool), Outcome.CONVERGED)
    begun = Stepper(tracking, Choosy(), 1.0, 1.0, SMALLEST, ((0.0, rest),), 1.0, ((0.0, rest),))
    for kind, longest in ((EventKind.FAILED | EventKind.PASSED, 0.5), (EventKind.FAILED, 1.0)):
        failure = Event(kind, "no state")
        cut = begun.reject(Attempt(1.0, rest, failure), failure)
        assert (cut.step, cut.asked) == (0.5, longest)
