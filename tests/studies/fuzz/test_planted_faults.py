"""Planted faults are there only while they are looked for, and the fuzzer finds them."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from contact.obstacles.drum_sphere import Sphere
from studies.fuzz.attempt import Asked
from studies.fuzz.cases import asked_of, kind_of
from studies.fuzz.examine import examine, minimised
from support.planted_faults import FAULTS, MOST, found_after, too_large
from support.planted_in_friction import Fault

EARLY = 60  # of the faults that show in most cases
FEW = 50  # cases of the scene that a rare fault can show in; which ones are drawn changes with the list of scenes
RARE: dict[str, Callable[[Asked], bool]] = {  # requests that a fault can show in, where they are few
    "nodes on the seam of half a tyre have twice their area": lambda asked: (
        asked.scene == "tyre" and asked.options.get("contact") == "regularised"  # springs, whose force grows with areas
    ),
    "modes of elements are counted as those of the body": lambda asked: (
        asked.scene == "cantilever" and "distortion" in asked.settings  # elements of all shapes
    ),
}


def test_a_fault_leaves_nothing_behind() -> None:
    curvature = Sphere.curvature
    for fault in FAULTS:
        with fault.planted():
            pass
    assert ALGORITHMS["semismooth"] is Semismooth
    assert Sphere.curvature is curvature


@pytest.mark.slow
def test_a_wrong_area_is_found_soon() -> None:
    cases, law = found_after(too_large, EARLY)
    assert 0 < cases <= EARLY
    assert law == "certified"


@pytest.mark.slow
def test_a_finding_is_made_smaller_while_it_breaks_the_same_law() -> None:
    """Nothing but the scene and its grid is left of a request that breaks its law whatever is asked."""
    seed = next(s for s in range(200) if kind_of(s) == "scene" and _many(asked_of(s)) and _found(s))
    with too_large.planted():
        asked = minimised(seed, asked_of(seed), "certified")
    assert asked.settings == {}
    assert set(asked.options) <= {"mesh"}


def _many(asked: Asked) -> bool:
    return len(asked.settings) > 1 and asked.options.get("contact", "semismooth") == "semismooth"


def _found(seed: int) -> bool:
    with too_large.planted():
        return examine(seed).law == "certified"


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_every_fault_is_found(fault: Fault) -> None:
    most = FEW if fault.name in RARE else MOST
    cases, _ = found_after(fault, most, RARE.get(fault.name))
    assert 0 < cases <= most
