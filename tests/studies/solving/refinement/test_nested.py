"""Nested iteration: the answer of a path from rest, started from one on a coarser grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import studies.solving.solve
from contact.algorithms.semismooth import Semismooth
from contact.catalogue import ALGORITHMS
from studies.ask.request import PartError, Request
from studies.ask.scene import Scene
from studies.scenes.complete import complete
from studies.scenes.element import tree_over
from studies.solving.refinement import nested
from studies.solving.refinement.grids import near
from studies.solving.refinement.nested import FAR, sketch, solve_from
from studies.solving.result import Result
from studies.solving.solve import solve

TYRE = {"delta_mm": "10,20"}
ASKED = [  # scene, settings, mesh, options
    ("tyre", TYRE, "20x18", {}),
    ("plate-contact", {}, "64x1", {"contact": "lcp"}),
    ("heavy-strip", {"mu": "0.2"}, "16x1", {}),
    ("heavy-strip", {"mu": "0.2"}, "32x1", {}),
    ("tyre", {"delta_mm": "10"}, "20x18", {"measure": "donnell", "newton": "plain"}),
    ("manufactured", {}, "16x16", {}),
    ("tyre", {"delta_mm": "20", "grading": "uniform"}, "28x28", {"model": "full"}),
    ("tyre", TYRE | {"mu": "0.3", "drag_mm": "2,-2"}, "20x18", {}),
    ("tyre", {"delta_mm": "10"}, "20x18", {"contact": "qp"}),
    ("hemisphere", {"load_fraction": "1"}, "16x16", {"measure": "elongation"}),
    ("ring", {}, "1x64", {"contact": "trial-and-error"}),
]
FAST = slice(1, 3)


def iterations(result: Result) -> int:
    return int(result.counters["newton_iterations"])


def from_coarser(scene: Scene, request: Request) -> Result:
    """From a path of 0.7 times the elements both ways, itself started from half."""
    half, most = near(scene, request, 0.5), near(scene, request, 0.7)
    assert half is not None
    assert most is not None
    known = sketch(scene, most, sketch(scene, half))
    assert known is not None
    return solve_from(scene, request, known)


@pytest.mark.parametrize(
    ("scene", "settings", "mesh", "options"),
    [*ASKED[FAST], *(pytest.param(*each, marks=pytest.mark.slow) for each in ASKED if each not in ASKED[FAST])],
    ids=lambda part: str(part)[:30],
)
def test_the_answer_is_that_from_rest(scene, settings, mesh, options) -> None:
    asked = complete(scene, settings, mesh, **options)
    result, cold = from_coarser(*asked), solve(*asked)
    assert result.verdict == cold.verdict == "converged"
    assert iterations(result) <= iterations(cold)
    scale = max(map(abs, cold.quantities.values()))
    for name, value in cold.quantities.items():
        assert result.quantities[name] == pytest.approx(value, rel=1e-7, abs=1e-8 * scale), name
    for mine, other in zip(result.loads, cold.loads, strict=True):
        stated, before = (each.certificate.get("stability", {}).get("word") for each in (mine, other))
        assert stated == before


@pytest.mark.slow
def test_iterations_of_a_single_load_are_saved() -> None:
    asked = complete("hemisphere", {"load_fraction": "1"}, "24x24")
    assert iterations(from_coarser(*asked)) <= 5 < iterations(solve(*asked))


def test_a_grid_with_hanging_nodes_starts_from_the_one_below() -> None:
    scene, request = complete("scordelis-lo", {}, (8, 8))
    tree = tree_over(request, *scene.build(request).shell.discretisation.grid.lines)
    tree = tree.refined(np.arange(len(tree.leaves)) < 10)
    cut = replace(request, leaves=tuple(map(tuple, tree.leaves.tolist())))
    actual = solve_from(scene, cut, sketch(scene, request))
    assert actual.quantities == pytest.approx(solve(scene, cut).quantities, rel=1e-9)


def test_a_path_that_a_start_leads_elsewhere_is_followed_from_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """The judge's word on the last grid decides."""
    seen = iter(["unstable", "converged"])

    def solved(*asked, **more):
        result = solve(*asked, **more)
        if next(seen) == "unstable":
            result.unstable.append("planted")
        return result

    monkeypatch.setattr(nested, "solve", solved)
    result = from_coarser(*complete("ring", {}, "1x32"))
    assert result.verdict == "converged"
    assert result.remarks == ["from a coarser grid the path is unstable: this one starts from rest"]


@pytest.mark.slow
def test_what_does_not_get_there_is_no_start() -> None:
    assert sketch(*complete("tyre", {"delta_mm": "40"}, "8x8")) is None


@pytest.mark.slow
def test_what_is_not_one_shell_is_no_start_but_has_values() -> None:
    known = sketch(*complete("two-cylinders", {"delta_mm": "0.01"}, "1x8"))
    scene, request = complete("two-cylinders", {"delta_mm": "0.01"}, "1x12")
    from_it, from_rest = solve_from(scene, request, known), solve(scene, request)
    assert from_it.quantities == from_rest.quantities
    assert from_it.counters["newton_iterations"] == from_rest.counters["newton_iterations"]


@pytest.mark.parametrize(("scene", "mesh"), [("ring", "1x16"), ("two-rings", "1x12")])
def test_a_path_to_the_tolerance_is_judged_and_not_followed_again(scene: str, mesh: str, monkeypatch) -> None:
    asked = complete(scene, {"delta_mm": "20"}, mesh)
    known, cold = sketch(*asked, loose=0.0), solve(*asked)
    assert known is not None
    monkeypatch.setattr(studies.solving.solve, "walk", None)
    judged = solve_from(*asked, known)
    assert judged.quantities == cold.quantities
    assert [step.flat for step in judged.loads] == [step.flat for step in cold.loads]
    assert judged.counters["newton_iterations"] == cold.counters["newton_iterations"]
    assert judged.work == cold.work


def test_a_curve_is_followed_for_what_it_says_of_the_limit() -> None:
    """It starts from nowhere else, and has the values of the solve."""
    asked = complete("roof-a", {"until": "limit"}, "4x4")
    known = sketch(*asked)
    assert set(known.strayed.values()) == {0.0}
    assert known.quantities == pytest.approx(solve(*asked).quantities)


def strayed(scene: str, mesh: str, settings: dict[str, str], **options: str) -> float:
    """Of the states on a grid from those of half the elements, as starts."""
    asked = complete(scene, settings, mesh, **options)
    half = near(*asked, 0.5)
    assert half is not None
    known = sketch(*asked, sketch(asked[0], half))
    return max(known.strayed.values())


def test_how_far_a_start_is_from_its_state_is_known_in_steps() -> None:
    """With the order 2 of the grids."""
    far = [strayed("hemisphere", mesh, {"load_fraction": "1"}) for mesh in ("12x12", "24x24")]
    assert 0.001 < far[1] < 0.5 * far[0] < FAR


def test_a_path_whose_own_starts_were_far_off_starts_no_other() -> None:
    scene, request = complete("hemisphere", {"load_fraction": "1"}, "16x16")
    half = near(scene, request, 0.5)
    assert half is not None
    known = sketch(scene, half)
    assert known is not None
    cold = iterations(solve(scene, request))
    assert iterations(solve_from(scene, request, replace(known, strayed={"load": FAR}))) == cold
    assert iterations(solve_from(scene, request, known)) < cold


@pytest.mark.parametrize(
    ("scene", "mesh", "times", "found"),
    [
        ("tyre", "42x40", 0.5, (20, 20)),  # even numbers only
        ("ring", "1x64", 0.5, (1, 32)),
        ("ring", "1x8", 0.5, (1, 4)),
        ("ring", "1x4", 0.5, None),
        ("hemisphere", "16x16", 2**0.5, (23, 23)),
    ],
)
def test_the_nearest_grid_that_a_scene_takes(scene: str, mesh: str, times: float, found) -> None:
    asked = near(*complete(scene, {}, mesh), times)
    assert (None if asked is None else asked.mesh) == found


def test_a_part_from_outside_that_breaks_on_a_coarser_grid_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken(Semismooth):
        name = "broken"

        def solve(self, problem, start):
            raise RuntimeError("out of order")

    monkeypatch.setitem(ALGORITHMS, "broken", Broken)
    with pytest.raises(PartError, match="broken"):
        sketch(*complete("ring", {}, "1x16", contact="broken"))
