"""Planted faults are there only while they are looked for, and the fuzzer finds them."""

from __future__ import annotations

import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.obstacles.drum_sphere import Sphere
from studies.experiments.planted_faults import FAULTS, MOST, Fault, found_after, too_large

EARLY = 60  # of the faults that show in most cases


def test_a_fault_leaves_nothing_behind() -> None:
    curvature = Sphere.curvature
    for fault in FAULTS:
        with fault.planted():
            pass
    assert ALGORITHMS["semismooth"] is Semismooth
    assert Sphere.curvature is curvature


def test_a_wrong_area_is_found_soon() -> None:
    found = found_after(too_large, EARLY)
    assert 0 < found["cases"] <= EARLY
    assert found["law"] == "certified"


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_every_fault_is_found(fault: Fault) -> None:
    assert 0 < found_after(fault)["cases"] <= MOST
