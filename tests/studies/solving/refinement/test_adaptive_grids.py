"""Families of grids: where elements are cut, where they must not be, and every scene on a grid with hanging nodes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from studies.scenes import SCENES
from studies.scenes.complete import complete
from studies.solving.refinement.adaptive_grids import FLAT, GROWTH, Family, _mirror
from studies.solving.refinement.grids import coarsest
from studies.solving.result import CONVERGED
from studies.solving.solve import solve

CHEAP = {  # a load that a few steps reach
    "hemisphere": {"load_fraction": "0.02"},
    "sze-annulus": {"load_fraction": "0.02"},
    "sze-moment": {"load_fraction": "0.1"},
    "sze-pullout": {"load_fraction": "0.02"},
    "sze-pinched": {"load_fraction": "0.02"},
    "shallow-cap": {"load_fraction": "0.2"},
    "ring": {"delta_mm": "5"},
    "tyre": {"delta_mm": "2"},
    **{name: {"load_fraction": "0.05"} for name in SCENES if name.startswith(("roof", "semicylinder"))},
}
FAST = {"cantilever", "roof-a", "pressurised-torus", "scordelis-lo", "pagano", "strip-contact", "ring", "panel"}
ALL = [pytest.param(name, marks=[] if name in FAST else pytest.mark.slow) for name in SCENES]


def family(scene: str, mesh: str, model: str = "auto", **settings: str) -> Family:
    return Family.of(*complete(scene, settings, mesh, model=model))


def one(family: Family, chosen: int) -> np.ndarray:
    """Indicators with nearly all at one element."""
    return np.where(np.arange(len(family.tree.leaves)) == chosen, 1.0, 1e-6)


@pytest.mark.parametrize("chosen", [0, 27, 63])
def test_elements_are_cut_where_the_indicators_are(chosen: int) -> None:
    coarse = family("pagano", "8x8")
    finer = coarse.refined(one(coarse, chosen)).tree
    depth = np.zeros(64, int)
    np.maximum.at(depth, coarse.tree.parents(finer), finer.leaves[:, 0])
    assert depth.argmax() == chosen
    assert depth[chosen] > 1
    assert np.mean(depth == 0) > 0.5
    assert GROWTH * 64 <= len(finer.leaves) < 4 * 64


def test_even_indicators_cut_everywhere() -> None:
    coarse = family("pagano", "4x4")
    rng = np.random.default_rng(0)
    for eta in (np.ones(16), rng.uniform(0.8, 1.2, 16)):
        np.testing.assert_array_equal(coarse.refined(eta).tree.leaves, coarse.everywhere().tree.leaves)


@pytest.mark.parametrize("chosen", [0, 75, 150])
def test_half_a_tyre_stays_symmetric(chosen: int) -> None:
    actual = family("tyre", "16x24", "half")
    assert actual.mirrored
    grid = actual.refined(one(actual, chosen)).tree.grid()
    assert grid.hanging is not None
    boxes = np.round(np.concatenate([grid.centre, grid.half], axis=1), 9)
    mirrored = boxes * [-1, 1, 1, 1] + 0.0
    assert set(map(tuple, mirrored)) == set(map(tuple, boxes + 0.0))


def test_no_node_hangs_on_an_element_that_is_curved() -> None:
    """Scordelis and Lo's roof, a cylinder of radius 25 and thickness 0.25: l^2/(25 0.25) by the arc l of an element."""
    actual = family("scordelis-lo", "4x4")
    for _ in range(2):  # the first cuts all elements, the second some
        actual = actual.refined(one(actual, 0))
        grid = actual.tree.grid()
        on = grid.hanging.owner if grid.hanging else []
        assert np.all((25 * 2 * grid.half[on, 1]) ** 2 / (25 * 0.25) <= FLAT)
    assert len(on)


def test_a_scene_without_a_tree_is_refined_by_its_mesh() -> None:
    actual = family("panel", "4x2")
    assert actual.tree is None
    assert actual.asked.mesh == (4, 2)
    assert actual.everywhere().everywhere().asked.mesh == (16, 8)


@pytest.mark.parametrize("name", ALL)
def test_every_scene_has_its_answers_on_a_grid_with_hanging_nodes(name: str) -> None:
    """From its coarsest grid, a third of the elements cut at random: it is solved, judged right, and read off."""
    scene, request = coarsest(name, CHEAP.get(name, {}))
    actual = Family.of(scene, request)
    if actual.tree is None:
        assert scene.build(actual.everywhere().asked).n_unknowns > scene.build(request).n_unknowns
        return
    n = len(actual.tree.leaves)
    marked = np.random.default_rng(0).permutation(n) < n / 3
    if actual.mirrored:
        marked |= marked[_mirror(actual.tree)]
    refined = replace(actual, tree=actual.tree.refined(marked))
    assert np.ptp(refined.tree.leaves[:, 0]) == 1
    uniform, result = solve(scene, request), solve(scene, refined.asked)
    assert result.verdict == uniform.verdict == CONVERGED
    assert result.counters["dofs"] > uniform.counters["dofs"]
    known = {key for key, value in uniform.quantities.items() if np.isfinite(value)}
    assert known
    assert all(np.isfinite(result.quantities[key]) for key in known)


def test_elements_that_have_modes_by_themselves_are_cut_across() -> None:
    """One element across a cantilever has none while it is long enough, and shorter ones have."""
    for mesh, finer in (("64x1", (64, 1)), ("128x1", (128, 2))):
        scene, request = complete("cantilever", {"load_fraction": "1"}, mesh)
        actual = Family.of(scene, request)
        shorter = actual.shortened(scene, solve(scene, request))
        assert shorter.asked.mesh == finer
        assert (shorter is actual) == (finer == request.mesh)
