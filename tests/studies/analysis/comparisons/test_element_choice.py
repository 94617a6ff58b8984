"""The choice of the element: verdicts and the mesh that is enough, from errors that are made up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from studies.analysis.comparisons.element_choice import elements_for, verdict_of

MESHES = ("10x10", "20x20", "40x40")


@pytest.mark.parametrize(
    ("default", "paper", "verdict"),
    [
        (0.02, -0.05, "better"),
        (-0.05, 0.02, "worse"),
        (0.0301, 0.0305, "equal"),  # closer than 0.1 %
        (0.0001, 0.0009, "equal"),  # nothing left to gain
        (math.nan, 0.02, "not solved by both"),
    ],
)
def test_verdict_is_that_of_the_coarsest_mesh(default: float, paper: float, verdict: str) -> None:
    assert verdict_of(default, paper, 0.0) == verdict


def test_what_the_limit_does_not_tell_apart_is_equal() -> None:
    assert verdict_of(-0.05, 0.02, 0.029) == "worse"
    assert verdict_of(-0.05, 0.02, 0.031) == "equal"


def test_enough_elements_are_interpolated_by_the_order() -> None:
    """Error 0.1 (10/n)^2 is 0.01 at n^2 = 1000 elements."""
    assert elements_for(MESHES, np.array([-0.1, -0.025, -0.00625])) == pytest.approx(1000)
    assert elements_for(MESHES, np.array([0.005, -0.02, 0.002])) == pytest.approx(
        400 * 4 ** (math.log(2) / math.log(10))
    )
    assert math.isnan(elements_for(MESHES, np.array([0.009, 0.002, 0.001])))  # on every mesh
    assert math.isnan(elements_for(MESHES, np.array([0.1, 0.05, 0.02])))  # on none
    assert math.isnan(elements_for(MESHES, np.array([0.1, 0.005, math.nan])))  # the last one was not solved
