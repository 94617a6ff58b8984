"""Six algorithms on scenes of two bodies and more, or of two branches: all agree, or say why not.

Each algorithm takes every scene, in one of its cells by turns: without friction, with it, or on other faces.

Springs are compared with the states that semismooth finds by the same law of springs, the others by the exact law.
"""

import math
from collections.abc import Iterator
from functools import cache
from itertools import groupby, product

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS, is_exact
from studies.scenes.complete import complete
from studies.scenes.walk import Visited, walk
from studies.solving.solve import stages_of

FORCES = 1e-8  # relative
SPRINGS = 1e4  # MPa/mm
TOLERANCE = 1e-10  # of the residual
CELLS = {
    "two-rings": "1x16 delta_mm=20,35",
    "two-rings, mu": "1x16 delta_mm=10,20 h_mm=1 other_h_mm=1.2 mu=0.2",
    "pinched-ring": "1x24 F_R2_over_EI=4,6,8",
    "stack": "1x12 delta_mm=10,20",
    "stack, mu": "1x12 delta_mm=10,20 mu=0.2",
    "half-spheres": "20x1 delta_mm=0.2,0.4",
    "half-spheres, mu": "20x1 delta_mm=0.2,0.4 mu=0.2",
    "half-spheres, facets, mu": "20x1 faces=facets delta_mm=0.2,0.4 mu=0.2",
    "face-patch": "4x4",
    "face-patch, curved": "4x4 shape=curved faces=curved",
    "face-patch, dragged": "4x4 mu=0.3 drag_mm=0.01,1,12,8",
    "crossed-tubes": "8x12 delta_mm=1,4",
    "crossed-tubes, mu": "8x12 delta_mm=1,2 mu=0.2",
    "two-cylinders": "1x8",
    "two-cylinders, mu": "1x8 E_ratio=10 mu=0.2",
    "ring-on-layer": "1x12 delta_mm=35",
    "ring-on-layer, mu": "1x12 delta_mm=20,35 mu=0.2",
    "tyre-on-plate": "14x14 delta_mm=5,10",
    "tyre-on-plate, mu": "14x14 delta_mm=5 mu=0.3",
    "tyre-on-drum": "14x14 delta_mm=5,10 through=1",
    "tyre-on-drum, averaged": "14x14 delta_mm=5,10 through=1 pairing=mortar slave=second",
    "walled-column": "32x1",
    "collapsing-tube": "1x16",
}
BY_ROUNDING = {"two-cylinders, mu": 1e-9}  # all that its forces are known to
CYCLES = {  # what becomes of it then, rounding decides: it fails and says why, or steps are cut until it does not
    (f"{cell}, mu", "trial-and-error")
    for cell in ("stack", "half-spheres", "two-rings", "ring-on-layer", "crossed-tubes")
}
BY_ALL = {"face-patch, dragged"}  # the face below alone keeps the upper plate from falling over
OTHERS = [name for name in ALGORITHMS if name != "semismooth"]
CLOSE = 2e-2  # relative, of the whole force by other steps
pytestmark = pytest.mark.slow


def by_turns() -> Iterator[tuple[str, str]]:
    """Every scene by every algorithm, and every cell by some; whatever cycles, too."""
    for s, (_, cells) in enumerate(groupby(CELLS, lambda cell: cell.partition(",")[0])):
        own = list(cells)
        for (i, cell), (k, name) in product(enumerate(own), enumerate(OTHERS)):
            if i == (s + k) % len(own) or cell in BY_ALL or (cell, name) in CYCLES:
                yield cell, name


@cache
def visited(cell: str, name: str, epsilon: float) -> list[Visited]:
    """The points of a cell, down to the one that is not reached."""
    scene, *_ = cell.split(",")
    mesh, *given = CELLS[cell].split()
    built, request = complete(scene, dict(each.split("=") for each in given), mesh)
    algorithm = ALGORITHMS[name](epsilon=epsilon, tolerance=BY_ROUNDING.get(cell, TOLERANCE))
    return list(walk(stages_of(built.build(request), request), algorithm))


@pytest.mark.parametrize(("cell", "name"), list(by_turns()))
def test_algorithms_agree_or_say_why_not(cell: str, name: str) -> None:
    """States of a path with friction depend on its steps: where one was cut only the whole force is compared."""
    epsilon = math.inf if is_exact(name) else SPRINGS
    actual, wanted = visited(cell, name, epsilon), visited(cell, "semismooth", epsilon)
    assert all(each.converged for each in wanted)
    if (cell, name) in CYCLES:
        assert actual[-1].converged or actual[-1].said
        for one, other in zip(actual, wanted, strict=False):
            if one.converged:
                forces, right = (each.problem.nodal_forces(each.state.pressure).sum() for each in (one, other))
                assert forces == pytest.approx(right, rel=CLOSE)
        return
    assert len(actual) == len(wanted)
    for one, other in zip(actual, wanted, strict=True):
        assert one.converged, one.said
        ours, theirs = one.state, other.state
        forces, right = (each.problem.nodal_forces(each.state.pressure) for each in (one, other))
        assert np.linalg.norm(forces - right) <= FORCES * np.linalg.norm(right)
        if theirs.friction is not None:
            apart = np.linalg.norm(ours.rubbed.force - theirs.rubbed.force)
            assert apart <= FORCES * np.linalg.norm(right)
