"""Cycles of the plain active set, their published periods, and what our algorithms make of the same starts."""

from __future__ import annotations

import numpy as np
import pytest

from studies.experiments.obstacle_problems.active_set_cycles import cycles, plain_period, small
from studies.experiments.obstacle_problems.collection import obstacle, torsion


@pytest.mark.slow
def test_periods_and_what_becomes_of_them() -> None:
    found = cycles().set_index("problem")
    periods = {"3x3": 3, "Ben Gharbia-Gilbert 3": 3, "Ben Gharbia-Gilbert 5": 5, "Ben Gharbia-Gilbert 7": 7}
    periods |= {f"OBSTCLB{start} 23": 2 for start in "LMU"} | {"TORSION c=5 22": 0}
    assert found["plain_period"].to_dict() == periods
    one_sided = [name for name, period in periods.items() if period > 2]
    for way in ("trial-and-error", "semismooth", "semismooth, settle 1", "regularised"):  # told, and solved
        assert set(found.loc[one_sided, way]) == {"converged, cycle detected"}
        assert set(found[way].drop(one_sided)) == {"converged"}


def test_the_plain_set_settles_where_nothing_jumps() -> None:
    """The comparison is a fair one: the same code finds the answer of problems with one bound at work."""
    assert plain_period(torsion(5.0, 10)) == 0
    assert plain_period(obstacle("OBSTCLAE", 23)) == 0


def test_the_small_problem_is_definite() -> None:
    K = small().K.toarray()
    assert np.array_equal(K, K.T)
    assert np.linalg.eigvalsh(K)[0] > 0
