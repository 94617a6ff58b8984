"""The algorithms that enter through the open door on every scene with contact, each against semismooth."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from contact.catalogue import ALGORITHMS
from contact.problem import ContactSolution, Outcome
from contact.verify import judge
from studies.ask.scene import has_contact
from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.scenes.walk import Visited, walk
from support.kinds import EXACT_ONLY, NAMES, SPENT

FORCES = 1e-8  # relative
GROWTH = 1.3  # of all iterations, those of Newton and an entry's own, on meshes that are three times as fine
ALIKE = 1.2  # cost of a first proximal step ten times as long or as short
SMALL = (
    "strip-contact 16x1 load_fraction=5",
    "heavy-strip 16x1 load_fraction=1",
    "panel 6x6",
    "panel 6x6 foundation=ball",
)
MESHES = {  # smaller than the default one
    "tyre": "28x26",
    "tyre-solid": "14x18",
    "pinched-ring": "1x48",
    "crossed-tubes": "8x12",
    "half-spheres": "20x1",
    "two-cylinders": "1x8",
    "ironing": "1x24 depth_mm=0.5 slide_mm=0.2",
    "ring-on-layer": "1x12 delta_mm=35",
    "tyre-on-plate": "14x14 delta_mm=10",
    "tyre-on-drum": "14x14 delta_mm=10",
}
TOLERANCES = {"manufactured-contact": "1e-11"}  # its forces are ten times as wrong as its balance, which is 1e-9
SETTINGS = (
    "tyre 14x12 load=follower delta_mm=20",
    "tyre 12x12 section=nonsymmetric delta_mm=10",
    "tyre 14x12 foundation=drum delta_mm=10",
    "tyre 14x12 foundation=sphere delta_mm=10",
    "tyre 28x26 foundation=cleat delta_mm=10",
)
CELLS = (*(f"{name} {MESHES.get(name, '')}" for name, scene in SCENES.items() if has_contact(scene)), *SETTINGS)
BY_ALL = (*SMALL, *SETTINGS, "face-patch ")  # on a face that all touches, the interior point asks no programme
each = pytest.mark.parametrize("name", NAMES)
PAIRS = [  # every scene by one of them by turns
    pytest.param(name, cell, marks=[] if cell in SMALL else [pytest.mark.slow])
    for i, cell in enumerate((*SMALL, *CELLS))
    for k, name in enumerate(NAMES)
    if i % len(NAMES) == k or cell in BY_ALL
]
pytestmark = pytest.mark.usefixtures("modules")


def visited(name: str, cell: str, **parameters: float) -> list[Visited]:
    """The points of a cell, ``scene mesh key=value ...``; nothing for the mesh is the default one."""
    scene, *given = cell.split()
    mesh = given.pop(0) if given and "=" not in given[0] else None
    settings = dict(pair.split("=") for pair in given)
    if scene in TOLERANCES:
        settings["tolerance"] = TOLERANCES[scene]
    built, request = complete(scene, settings, mesh)
    algorithm = ALGORITHMS[name](tolerance=request.settings["tolerance"], **parameters)
    return list(walk(built.build(request).stages(), algorithm))


@cache
def by_semismooth(cell: str) -> list[Visited]:
    return visited("semismooth", cell)


def counted(points: list[Visited], key: str) -> int:
    return sum(int(point.point.solution.counters.get(key, 0)) for point in points)


@pytest.mark.parametrize(("name", "cell"), PAIRS)
def test_sets_and_forces_are_those_of_semismooth(name: str, cell: str) -> None:
    expected, points = by_semismooth(cell), visited(name, cell)
    assert len(points) == len(expected)
    for one, other in zip(points, expected, strict=True):
        assert one.converged
        assert other.converged
        np.testing.assert_array_equal(one.state.active, other.state.active)
        solution: ContactSolution = one.point.solution
        force, right = (x.problem.nodal_forces(x.point.solution.pressure) for x in (one, other))
        assert np.linalg.norm(force - right) <= FORCES * np.linalg.norm(right)
        assert judge(one.problem, solution.u, solution.pressure).failures() == []
    at_once = name == "interior-point" and cell.startswith("face-patch")  # all touch: no programme is asked
    assert counted(points, SPENT[name]) >= (not cell.startswith("panel") and not at_once)


@pytest.mark.slow
def test_consistent_coupling_on_a_shell_is_refused_by_the_interior_point_alone() -> None:
    cell = "tyre 12x12 coupling=consistent delta_mm=10"
    *_, refused = visited("interior-point", cell)
    assert refused.point.outcome is Outcome.REFUSED
    assert "needs lumped coupling" in refused.said
    right = by_semismooth(cell)[-1].state.pressure
    for name in EXACT_ONLY:
        pressure = visited(name, cell)[-1].state.pressure
        assert np.linalg.norm(pressure - right) <= FORCES * np.linalg.norm(right)


@pytest.mark.slow
@each
def test_iterations_hardly_grow_with_the_mesh_of_the_tyre(name: str) -> None:
    """Of the pressing alone; without contact all algorithms are the same Newton.

    Those of the barrier and of the proximal steps are steps of Newton themselves; those of the interior point are
    dense, on the candidates, and come on top.
    """
    spent = []
    for mesh in ("28x26", "84x80"):
        pressed = visited(name, f"tyre {mesh} delta_mm=20")[-1:]
        assert pressed[0].converged
        inner = counted(pressed, SPENT[name]) if name == "interior-point" else 0
        spent.append(counted(pressed, "newton_iterations") + inner)
    assert spent[1] <= GROWTH * spent[0]


@pytest.mark.slow
def test_proximal_steps_do_not_depend_on_how_long_the_first_one_is() -> None:
    cells = ("tyre 14x14 delta_mm=20", "ring", "crushed-ring", "strip-contact", "plate-contact")
    cost = {
        a: sum(counted(visited("proximal", cell, alpha=a), "factorisations") for cell in cells) for a in (1, 10, 100)
    }
    assert max(cost.values()) <= ALIKE * cost[10]
