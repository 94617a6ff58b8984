"""Algorithms, judge and oracle of friction on the same steps: written apart from one another, they have to agree."""

from __future__ import annotations

import numpy as np
import pytest

from contact.algorithms.semismooth import Semismooth
from contact.algorithms.trial_and_error import TrialAndError
from contact.interchange.friction_oracle import confirm
from contact.interchange.linearised_step import freeze
from contact.problem import ContactSolution
from contact.verify import judge
from support.problems.planted_friction import Planted, planted

MU = (0.1, 0.5, 1.0)


def solved(algorithm: Semismooth | TrialAndError, wanted: Planted) -> ContactSolution:
    """From rest."""
    return algorithm.solve(wanted.problem, ContactSolution.at_rest(len(wanted.u), len(wanted.normal)))


@pytest.mark.parametrize("mu", MU)
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 34))])
def test_the_judge_takes_the_answer_of_semismooth_and_the_oracle_has_it(seed: int, mu: float) -> None:
    wanted = planted(seed, mu)
    found = solved(Semismooth(), wanted)
    assert found.outcome.converged
    assert np.array_equal(found.rubbed.state, wanted.state)
    assert not judge(wanted.problem, found.u, found.pressure, found.rubbed.force).failures()
    step = freeze(wanted.problem, np.zeros_like(found.u), np.zeros_like(found.pressure), {})
    same = confirm(step, found.u, found.pressure, found.rubbed.force)
    assert same.agrees
    assert max(same.displacement_error, same.force_error) <= 1e-8


@pytest.mark.slow
@pytest.mark.parametrize("mu", MU)
@pytest.mark.parametrize("seed", range(6))
def test_the_naive_set_is_right_where_it_ends(seed: int, mu: float) -> None:
    wanted = planted(seed, mu)
    found = solved(TrialAndError(epsilon=np.inf), wanted)
    if found.outcome.converged:
        assert np.array_equal(found.rubbed.state, wanted.state)
        assert not judge(wanted.problem, found.u, found.pressure, found.rubbed.force).failures()


@pytest.mark.slow
def test_the_naive_set_ends_on_some_and_cycles_on_most() -> None:
    """What comes back to the foundation sticks, is torn loose, and lifts off again."""
    ended = [solved(TrialAndError(epsilon=np.inf), planted(seed, 0.5)).outcome.converged for seed in range(20)]
    assert 0 < sum(ended) < 10
