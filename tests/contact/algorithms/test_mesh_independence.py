"""Iterations on meshes of 64 to 1024 elements: the rim of contact is not let go of one element an iteration."""

from __future__ import annotations

import numpy as np
import pytest

from studies.scenes.complete import complete
from studies.solving.solve import solve

FACTOR = 2  # between the fewest and the most iterations to one load
SCENES = {
    "plate-contact": ("{n}x1", {}),
    "strip-contact": ("{n}x1", {}),
    "ring": ("1x{n}", {"delta_mm": "37"}),
}


def iterations(scene: str, n: int) -> np.ndarray:
    """Of each load, reached in one step."""
    mesh, settings = SCENES[scene]
    result = solve(*complete(scene, settings, mesh.format(n=n)))
    assert result.outcome.converged
    assert all(not load.certificate["failures"] and load.counters["substeps"] == 1 for load in result.loads)
    return np.array([load.counters["newton_iterations"] for load in result.loads])


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_iterations_of_semismooth_do_not_grow_with_the_mesh(scene: str) -> None:
    """Every load, and the whole path."""
    found = np.array([iterations(scene, n) for n in (64, 256, 1024)])
    for each in (*found.T, found.sum(axis=1)):
        assert each.max() <= FACTOR * each.min(), found


def test_the_rim_of_a_strip_is_settled_on_one_linearisation() -> None:
    """The quick end of the same: 23 iterations where each lets go of one row of elements."""
    coarse, fine = iterations("strip-contact", 16), iterations("strip-contact", 64)
    assert np.all(fine <= FACTOR * coarse)
