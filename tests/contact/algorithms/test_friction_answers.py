"""Every algorithm with friction on small problems against values written down once: whatever is rebuilt, they stay.

Algorithms, oracle and judge on random steps with open, sticking and slipping candidates.

Random paths on which the foundation is dragged, reversed and turned and the load is cut: every state is judged.
"""

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS, by_the_exact_law
from contact.continuation.friction_path import PathState, Stage, follow
from contact.coulomb import State
from contact.interchange.friction_oracle import compared, minimise
from contact.newton.friction_states import Laws, Local, friction_of
from contact.newton.solves import RESIDUAL_TOLERANCE
from contact.problem import ContactProblem, ContactSolution
from contact.verify import judge
from studies.arena.frictional_steps import random_step
from studies.experiments.friction.bars import Bar
from support.problems.frictional import linear, manufactured, planted, tied, with_mu

GOLDEN = json.loads(Path(__file__).with_name("friction_golden.json").read_text(encoding="utf-8"))
EXACT = 1e-12  # of the largest
BY_TOLERANCE = {"regularised, stiff": 10 * RESIDUAL_TOLERANCE}  # rounding decides whether one more iteration is made
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "set_changes")
WAYS: dict[str, tuple[str, dict[str, Any]]] = {
    "trial-and-error": ("trial-and-error", {"naive": True}),
    "semismooth": ("semismooth", {}),
    "semismooth, settled": ("semismooth", {"settle": 0.0}),
    "semismooth on springs": ("semismooth", {"epsilon": 30.0}),
    "regularised": ("regularised", {"epsilon": 1e4}),
    "regularised, stiff": ("regularised", {"epsilon": 1e8}),
    "augmented-lagrangian": ("augmented-lagrangian", {}),
    "qp": ("qp", {}),
    "qp on discs": ("qp", {"backend": "clarabel"}),
    "lcp": ("lcp", {}),
    "lcp on springs": ("lcp", {"epsilon": 30.0}),
    "lcp, polygon": ("lcp", {"finish": False}),
}
EXACT_LAW = {"epsilon": np.inf}
BARS = {
    "strip": (Bar(10, 100.0, 1.0, press=0.5), (20.0, 0.0, -20.0)),
    "drum": (Bar(8, 200.0, 0.3, curvature=0.01, tension=10.0, held=True), (5.0, 2.5)),
}


def floating() -> ContactProblem:
    """Two masses and springs between them that only the foundation holds."""
    K, along, off = np.zeros((4, 4)), [0, 2], [1, 3]
    K[np.ix_(along, along)] = K[np.ix_(off, off)] = [[1.0, -1.0], [-1.0, 1.0]]
    G, S = np.eye(4)[off], np.zeros((4, 4))
    S[[0, 2]] = np.eye(4)[along]
    return linear(K, np.array([0.0, -1.0, 0.8, -1.0]), G, S, np.zeros(2), np.zeros((2, 2)), np.full(2, 0.5))


@cache
def problems() -> dict[str, ContactProblem]:
    """By name."""
    one = planted(5, 0.5).problem
    return {
        "planted": one,
        "mixed": with_mu(one, np.where(np.arange(7) % 2, 0.5, 0.0)),
        "one way": planted(6, 0.4, components=1).problem,
        "strong": planted(3, 1.0, m=10, coupled=0.8).problem,
        "smooth": planted(2, 0.0).problem,
        "tied": tied(3),
        "random": random_step(1).problem(),
        "random, another": random_step(4).problem(),
        "floating": floating(),
        "shared": manufactured(np.random.default_rng(0), 4, np.array([0, 1, 2, 2]))[0].problem(),
    }


def compare(
    found: ContactSolution, normal: np.ndarray, wanted: dict[str, Any], exact: float = EXACT, mu: float | None = None
) -> None:
    """The answer with what is written down; where there is none, why alone.

    mu: who is held at its bound sticks or slips by the last digit; forces and displacements are the same to 1e-12.
    """
    assert found.outcome.word == wanted["outcome"]
    if not found.outcome.converged:
        return
    size = np.linalg.norm(found.rubbed.force, axis=1)
    held = np.zeros(len(size), bool) if mu is None else size >= mu * normal * (1 - EXACT)
    for state, other, either in zip(found.rubbed.state, wanted["states"], held, strict=True):
        assert "OSL"[state] == other or (either and {"OSL"[state], other} == {"S", "L"})
    assert exact > EXACT or [found.counters[name] for name in COUNTERS] == wanted["counts"]
    for name, values in (("u", found.u), ("normal", normal), ("friction", found.rubbed.force.ravel())):
        weighed = float(values @ np.cos(np.arange(1, len(values) + 1)))
        size = float(np.max(np.abs(values), initial=0.0))
        assert weighed == pytest.approx(wanted[name], rel=exact, abs=exact * size), name


@pytest.mark.parametrize(
    "way", [pytest.param(way, marks=[pytest.mark.slow] if way == "trial-and-error" else []) for way in WAYS]
)
def test_an_answer_is_what_it_was(way: str) -> None:
    kind, options = WAYS[way]
    algorithm = ALGORITHMS[kind](**EXACT_LAW | options)
    for name, problem in problems().items():
        if (case := f"{way}: {name}") in GOLDEN:
            n = problem.coulomb.slip_jacobian(np.zeros(0)).shape[1]
            solution = algorithm.solve(problem, ContactSolution.at_rest(n, len(problem.weights)))
            compare(solution, problem.nodal_forces(solution.pressure), GOLDEN[case], BY_TOLERANCE.get(way, EXACT))


def test_every_value_written_down_is_compared() -> None:
    alone = {f"{way}: {name}" for way in WAYS for name in problems()}
    paths = {f"{way}: {name} at {pull:g}" for way in WAYS for name, (_, pulls) in BARS.items() for pull in pulls}
    assert GOLDEN.keys() <= alone | paths


def test_a_path_is_what_it_was() -> None:
    for way, name in product(("semismooth", "regularised", "augmented-lagrangian", "qp", "lcp"), BARS):
        bar, pulls = BARS[name]
        kind, options = WAYS[way]
        states = list(follow(bar.stage_at, pulls, ALGORITHMS[kind](**EXACT_LAW | options), bar.rest))
        for pull, state in zip(pulls, states, strict=False):
            wanted = GOLDEN[f"{way}: {name} at {pull:g}"]
            compare(state.solution, bar.shares * state.solution.pressure, wanted, mu=bar.mu)
            assert state.dissipation == pytest.approx(wanted["dissipation"], rel=EXACT, abs=EXACT)


FEW, MANY = 4, 150
TOLERANCE = 1e-12  # of the residual: what it leaves of forces is below the agreement with the oracle
EXACT_ONES = [name for name, algorithm in by_the_exact_law().items() if np.isinf(algorithm.epsilon)]
QUICK = ["semismooth", "trial-and-error"]


def counted(seeds: Iterable[int], names: Iterable[str] = QUICK) -> Counter[str]:
    """What the algorithms say, what the judge says to that, and whether the oracle has the same."""
    counts = Counter[str]()
    for seed in seeds:
        step = random_step(seed)
        problem = step.problem()
        own = minimise(step)
        counts["false"] += bool(judge(problem, own.du, own.normal, own.friction).failures())
        counts["every state"] += len(set(own.state.tolist())) == len(State)
        for algorithm in [ALGORITHMS[name](tolerance=TOLERANCE, epsilon=np.inf) for name in names]:
            solution = algorithm.solve(problem, ContactSolution.at_rest(len(step.r), len(step.mu)))
            if not solution.outcome.converged:
                counts[f"{algorithm.name} {solution.outcome.word}"] += 1
                continue
            counts["false"] += bool(judge(problem, solution.u, solution.pressure, solution.rubbed.force).failures())
            same = compared(step, own, solution.u, solution.pressure, solution.rubbed.force).agrees
            counts[f"{algorithm.name} {'agrees' if same else 'differs'}"] += 1
    return counts


def test_semismooth_and_the_oracle_agree_on_random_steps() -> None:
    for seed in range(FEW):
        actual = counted([seed])
        assert actual["false"] == 0
        assert actual["semismooth agrees"] == 1
        assert not [name for name in actual if name.endswith("differs")]


@pytest.mark.slow
def test_no_exact_algorithm_has_another_answer() -> None:
    actual = counted(range(10 * FEW), EXACT_ONES)
    assert actual["false"] == 0
    assert not [name for name in actual if name.endswith("differs")]


@pytest.mark.slow
def test_they_agree_on_many() -> None:
    """The naive set ends on a quarter of them, cycles on the others."""
    actual = counted(range(MANY))
    assert actual["false"] == 0
    assert actual["semismooth agrees"] == MANY
    assert not [name for name in actual if name.endswith("differs")]
    assert actual["trial-and-error agrees"] >= 0.1 * MANY
    assert actual["every state"] >= 0.9 * MANY


STOPS = 7
DISSIPATED = 1e-10  # of the largest dissipation of a step: below zero, rounding explains it


class RandomPath:
    """The body of a random step before a foundation at ``drags`` (stops, 2) [mm], under ``loads`` (stops,) of its own.

    Each stop goes on, stands still, goes back all the way, goes back a little, or turns; the load is kept or cut.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([seed, 61])
        self.step = random_step(seed)
        size = 10 ** rng.uniform(-2, 1)
        drag, way, load = np.zeros(2), rng.standard_normal(2), 1.0
        self.drags, self.loads = [drag], [load]
        for _ in range(STOPS):
            turn = rng.choice([0.0, np.pi, np.pi, np.pi / 2, rng.uniform(0, 2 * np.pi)])
            c, s = np.cos(turn), np.sin(turn)
            way = np.array([[c, -s], [s, c]]) @ way
            drag = drag + size * rng.choice([0.0, 0.1, 1.0]) * way
            load *= rng.choice([1.0, 1.0, 0.5, 2.0])
            self.drags.append(drag)
            self.loads.append(load)

    def stage(self, stop: float, anchors: np.ndarray) -> Stage:
        """The problem at a stop, slips counted from the anchors (m, 2) on the moving foundation."""
        drag, S = self.drags[int(stop)], self.step.S
        slip = np.tile(-drag, (len(anchors), 1)) - anchors
        moved = replace(self.step, r=self.loads[int(stop)] * self.step.r, slip=slip)
        return Stage(moved.problem(), lambda u: (S @ u).reshape(-1, 2) - drag)

    def states(self, name: str) -> list[tuple[Stage, PathState]]:
        """The accepted states of an algorithm with the problems that they answer."""
        n, m = len(self.step.r), len(self.step.mu)
        seen: list[Stage] = []

        def stage_at(stop: float, anchors: np.ndarray) -> Stage:
            seen.append(self.stage(stop, anchors))
            return seen[-1]

        start = PathState(-1, ContactSolution.at_rest(n, m), np.zeros((m, 2)))
        path = follow(stage_at, range(len(self.drags)), by_the_exact_law()[name], start)
        return [(seen[i], at) for i, at in enumerate(path) if at.solution.outcome.converged]


BY_TURNS = 3  # of the algorithms, each path is walked by a third


@pytest.mark.parametrize(
    ("name", "seeds"),
    [
        *((name, range(1, 2)) for name in ALGORITHMS if name != "trial-and-error"),
        *(
            pytest.param(name, range(k % BY_TURNS, 84, BY_TURNS), marks=pytest.mark.slow)
            for k, name in enumerate(ALGORITHMS)
        ),
    ],
)
def test_no_algorithm_converges_to_what_the_judge_refuses(name: str, seeds: range) -> None:
    epsilon = by_the_exact_law()[name].epsilon
    for seed in seeds:
        states = RandomPath(seed).states(name)
        assert states or name == "trial-and-error", seed  # which cycles on most of them, and says so
        largest = max((abs(at.dissipation) for _, at in states), default=0.0)
        for stage, at in states:
            actual = at.solution
            verdict = judge(stage.problem, actual.u, actual.pressure, actual.rubbed.force, epsilon=epsilon)
            assert not verdict.failures(), (seed, at.load, verdict.kkt)
            if np.isinf(epsilon):
                assert at.dissipation >= -DISSIPATED * largest, seed


def test_friction_of_the_step_before_is_not_that_of_a_reversed_slip() -> None:
    for seed in range(12):
        rng = np.random.default_rng(seed)
        angle = rng.uniform(0, 2 * np.pi)
        old = np.array([[np.cos(angle), np.sin(angle)]])
        slips = Laws(np.array([State.SLIP]), np.zeros((1, 2)), np.zeros(1))
        for slip in (-0.3 * old, 0.3 * old):
            local = Local(np.zeros(1), slip, np.ones(1), -0.5 * old, np.zeros(1))
            friction = friction_of(local, slips, np.array([0.5]), 1e-12)
            assert float(np.sum(friction * slip)) == pytest.approx(-0.5 * 0.3)
