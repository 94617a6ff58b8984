"""Algorithms, oracle and judge on random steps with open, sticking and slipping candidates."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS, by_the_exact_law
from contact.coulomb import State
from contact.interchange.friction_oracle import compared, minimise
from contact.problem import ContactSolution
from contact.verify import judge
from studies.arena.frictional_steps import random_step

FEW, MANY = 20, 150
TOLERANCE = 1e-12  # of the residual: what it leaves of forces is below the agreement with the oracle
EXACT = [name for name, algorithm in by_the_exact_law().items() if np.isinf(algorithm.epsilon)]
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
            found = algorithm.solve(problem, ContactSolution.at_rest(len(step.r), len(step.mu)))
            if not found.outcome.converged:
                counts[f"{algorithm.name} {found.outcome.word}"] += 1
                continue
            counts["false"] += bool(judge(problem, found.u, found.pressure, found.rubbed.force).failures())
            same = compared(step, own, found.u, found.pressure, found.rubbed.force).agrees
            counts[f"{algorithm.name} {'agrees' if same else 'differs'}"] += 1
    return counts


@pytest.mark.parametrize("seed", range(FEW))
def test_semismooth_and_the_oracle_agree_on_random_steps(seed: int) -> None:
    found = counted([seed])
    assert found["false"] == 0
    assert found["semismooth agrees"] == 1
    assert not [name for name in found if name.endswith("differs")]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2 * FEW))
def test_no_exact_algorithm_has_another_answer(seed: int) -> None:
    found = counted([seed], EXACT)
    assert found["false"] == 0
    assert not [name for name in found if name.endswith("differs")]


@pytest.mark.slow
def test_they_agree_on_many() -> None:
    """The naive set ends on a quarter of them, cycles on the others."""
    found = counted(range(MANY))
    assert found["false"] == 0
    assert found["semismooth agrees"] == MANY
    assert not [name for name in found if name.endswith("differs")]
    assert found["trial-and-error agrees"] >= 0.1 * MANY
    assert found["every state"] >= 0.9 * MANY


def test_steps_are_the_same_for_the_same_seed_alone() -> None:
    one, again, other = random_step(3), random_step(3), random_step(4)
    assert np.array_equal(one.r, again.r)
    assert len(one.r) != len(other.r) or not np.array_equal(one.r, other.r)
    assert minimise(one).state.tolist() == minimise(again).state.tolist()
