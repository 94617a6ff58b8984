"""The references of a scene that are valid for a request, at a load."""

import math
from collections.abc import Container, Iterator, Mapping
from typing import Any

from formulations.section.laws import LINEAR
from studies.ask.request import Value
from studies.ask.scene import Reference
from studies.scenes import SCENES

UNSAID: Mapping[str, float | str] = {"law": LINEAR, "mu": 0.0}  # of what does not name them
# what grows along a path; all else that a reference names is a setting
STEP_KEYS = ("load_fraction", "delta_mm", "way_mm")


def holding(scene: str, there: Mapping[str, Any]) -> Iterator[Reference]:
    """The references of a scene that are valid for these settings, this measure and this load.

    Those of value zero are left out: errors are relative. One that names neither law nor mu is of the linear law
    without friction. A campaign may bring scenes of its own, which are not loaded here.
    """
    where = {**UNSAID, **there}
    for reference in SCENES[scene].references if scene in SCENES else ():
        at = {**UNSAID, **reference.at}
        if reference.value != 0.0 and all(_same(where.get(key), value) for key, value in at.items()):
            yield reference


def closest(scene: str, there: Mapping[str, Any], quantities: Container[str]) -> dict[str, Reference]:
    """Of the references that are valid there, the least uncertain one of each of these quantities."""
    best: dict[str, Reference] = {}
    for reference in holding(scene, there):
        if reference.quantity in quantities:
            known = best.get(reference.quantity, reference)
            best[reference.quantity] = min(known, reference, key=lambda each: each.uncertainty)
    return best


def _same(there: Value | None, at: float | str) -> bool:
    if isinstance(there, int | float) and isinstance(at, int | float):
        return math.isclose(there, at, rel_tol=1e-9, abs_tol=1e-12)
    return there == at
