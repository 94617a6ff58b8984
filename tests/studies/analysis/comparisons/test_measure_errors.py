"""Where an error first leaves a level, and how large it ever was: curves that are made up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from studies.analysis.comparisons.measure_errors import first_beyond, largest

LOADS = [5.0, 10.0, 15.0, 20.0]
SIGN = np.array([-0.34, -0.11, 0.10, 0.49])  # small between 10 and 15, where it changes its sign


def test_an_error_that_changes_its_sign_was_large_before() -> None:
    assert first_beyond(LOADS, SIGN, 0.05) == 0  # at the first load already
    assert first_beyond(LOADS[1:], np.array([0.0, -0.02, 0.02]), 0.01) == pytest.approx(12.5)
    assert largest(LOADS[:3], SIGN[:3]) == (-0.34, 5.0)
    assert largest(LOADS, SIGN) == (0.49, 20.0)


def test_the_first_visit_counts_however_short() -> None:
    errors = np.array([0.0, 0.02, 0.0, -0.02])
    assert first_beyond(LOADS, errors, 0.01) == pytest.approx(7.5)
    assert first_beyond(LOADS, -errors, 0.01) == pytest.approx(7.5)
    assert largest(LOADS, errors) == (0.02, 10.0)


def test_the_error_itself_is_interpolated_through_zero() -> None:
    """From -0.9 % to 1.1 %: beyond 1 % at 95 % of the way, not where its size would be."""
    assert first_beyond([0.0, 1.0], np.array([-0.009, 0.011]), 0.01) == pytest.approx(0.95)


def test_what_never_leaves_or_was_never_reached_has_no_load() -> None:
    assert math.isnan(first_beyond(LOADS, np.full(4, 0.01), 0.01))
    assert math.isnan(first_beyond(LOADS, np.full(4, math.nan), 0.01))
    assert all(map(math.isnan, largest(LOADS, np.full(4, math.nan))))
    assert first_beyond(LOADS, np.array([0.0, math.nan, 0.02, math.nan]), 0.01) == pytest.approx(10.0)
