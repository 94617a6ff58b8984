"""Ladders of meshes: every one is nested in the next, and closer lines are where they are asked for.

Cells that compare the shares of the thickness strain: all scenes of a shell, and nothing else that differs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import groupby, product

import numpy as np
import pytest
from scipy.spatial import KDTree

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import Ladder
from studies.ask.scene import UsageError
from studies.run.lists import COMPARED, LADDERS, meshes_of, read_at, share_cells
from studies.scenes import SCENES
from studies.scenes.closed_forms.contact import lifted_strip, strip_contact
from studies.scenes.complete import Cell, complete
from studies.scenes.complete import complete as resolve
from studies.scenes.contact.base import rim_lines
from studies.scenes.element import spaced_lines, tree_over
from support.kinds import MANY_SURFACES, OF_SOLIDS, ON_QUADS

SAME = 1e-12
BUILT = 1500  # elements, of a mesh that is built in a test


def sides(mesh: str) -> tuple[int, int]:
    n1, n2 = mesh.split("x")
    return int(n1), int(n2)


def nodes(ladder: Ladder, mesh: str) -> np.ndarray:
    """(N, 2): those of the grid that is solved on."""
    whole = {"model": "full"} if ladder.scene == "tyre" else {}
    scene, request = resolve(ladder.scene, ladder.settings, mesh, measure=ladder.measure, **whole)
    return np.asarray(scene.build(request).shell.discretisation.grid.nodes)


def test_every_mesh_is_nested_in_the_next() -> None:
    for ladder in LADDERS:
        nested(ladder)


def nested(ladder: Ladder) -> None:
    """All nodes of a mesh are nodes of the next one, which halves its elements, in one direction or in both."""
    built = {mesh: nodes(ladder, mesh) for mesh in ladder.meshes if math.prod(sides(mesh)) <= BUILT}
    for coarse, fine in zip(ladder.meshes[:-1], ladder.meshes[1:], strict=True):
        (n1, n2), (m1, m2) = sides(coarse), sides(fine)
        assert m1 == 2 * n1, ladder.name
        assert m2 in (n2, 2 * n2), ladder.name
        if fine in built:
            few, many = built[coarse], built[fine]
            extent = np.ptp(many, axis=0)
            apart, _ = KDTree(many / extent).query(few / extent, p=math.inf)
            assert apart.max() <= SAME, ladder.name


def test_a_ladder_has_three_meshes_with_every_element() -> None:
    for ladder in LADDERS:
        assert len(ladder.climbed(finest=True)) >= 3
        assert len(ladder.climbed(finest=False)) >= 3
        assert set(ladder.causes) <= set(ladder.quantities)


@pytest.mark.parametrize(("to_start", "to_end"), [(False, False), (True, False), (False, True), (True, True)])
def test_lines_get_closer_where_they_are_asked_to(to_start: bool, to_end: bool) -> None:
    """By the slope of the map at the ends, 0 where lines gather: the last element is of second order there."""
    n = 64
    lines = spaced_lines(2.0, 5.0, n, to_start, to_end)
    assert (lines[0], lines[-1]) == (2.0, 5.0)
    size = np.diff(lines) * n / 3.0
    second = np.pi**2 / (4 * n) if to_start and to_end else np.pi**2 / (8 * n)
    for closer, end in ((to_start, size[0]), (to_end, size[-1])):
        assert end == pytest.approx(second, rel=1e-3) if closer else end >= 1 - SAME
    assert np.all(np.abs(np.diff(size)) <= 0.08)  # smooth: no element jumps in size
    assert spaced_lines(2.0, 5.0, 2 * n, to_start, to_end)[::2] == pytest.approx(lines, abs=SAME)


def test_lines_with_a_rim_are_nested() -> None:
    for n, rim in product((16, 20, 24, 28, 30), (0.01, 0.2797, 0.5, 0.57, 0.999)):
        coarse, fine, finest = (rim_lines(k * n, (0.0, 1.0), rim) for k in (1, 2, 4))
        assert np.any(coarse == rim), (n, rim)
        assert len(coarse) == n + 1
        assert fine[::2] == pytest.approx(coarse, abs=SAME)
        assert finest[::2] == pytest.approx(fine, abs=SAME)


@pytest.mark.parametrize(
    ("scene", "settings", "rim"),
    [
        ("strip-contact", {"lam_over_a": "0.2", "load_fraction": "2,5"}, 100 * strip_contact(120, 0.2).free_length),
        ("strip-contact", {"lam_over_a": "0.001", "load_fraction": "5"}, 100 * (72 / 120) ** 0.25),
        ("heavy-strip", {"load_fraction": "1"}, 100 * lifted_strip(0.2)[0]),
        ("heavy-strip", {"load_fraction": "0.0625"}, 50 * lifted_strip(0.4)[0]),  # lengths go with its fourth root
    ],
)
def test_the_rim_is_where_the_closed_form_has_it_at_the_last_load(scene, settings, rim) -> None:
    ladder = Ladder("", (), (), "linear", settings | {"lines": "rim"}, scene=scene)
    assert np.min(np.abs(nodes(ladder, "16x1")[:, 0] - rim)) <= 100 * SAME


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        ("strip-contact", {"load_fraction": "0.5"}),
        ("ring", {"delta_mm": "10"}),
        ("plate-contact", {"load_fraction": "1"}),
    ],
)
def test_where_nothing_has_a_rim_its_lines_are_refused(scene, settings) -> None:
    actual, request = resolve(scene, settings | {"lines": "rim"}, "16x16")
    with pytest.raises(UsageError, match="needs a rim of contact"):
        actual.build(request)


@pytest.mark.parametrize("scene", ["strip-contact", "heavy-strip", "plate-contact", "ring"])
@pytest.mark.parametrize("lines", ["even", "rim"])
def test_lines_of_contact_scenes_are_refined_as_asked(scene: str, lines: str) -> None:
    """All elements cut once: the mesh of twice as many along the strip."""
    at = {"delta_mm": "50"} if scene == "ring" else {"load_fraction": "1" if scene == "heavy-strip" else "5"}
    asked, twice = ("16x16", "32x32") if scene == "ring" else ("16x1", "32x1")
    actual, request = resolve(scene, at | {"lines": lines}, asked, measure="exact" if scene == "ring" else "linear")
    tree = tree_over(request, np.arange(request.mesh[0] + 1.0), np.arange(request.mesh[1] + 1.0)).everywhere()
    grid = actual.build(replace(request, leaves=tuple(map(tuple, tree.leaves.tolist())))).shell.discretisation.grid
    wanted = nodes(Ladder("", (), (), request.measure, at | {"lines": lines}, scene=scene), twice)
    assert np.sort(grid.nodes, axis=0) == pytest.approx(np.sort(wanted, axis=0), abs=1e-9)


NO_REFERENCE, NO_SHELL = (
    {"panel", "manufactured", "manufactured-contact"},
    {"tyre-solid", "crushed-ring-solid", *OF_SOLIDS},
)
OWN_MESHES = "crushed-ring"  # of its error budget


def test_every_scene_of_a_shell_is_compared() -> None:
    others = {*NO_REFERENCE, OWN_MESHES, *NO_SHELL, *MANY_SURFACES, *ON_QUADS}
    assert {ladder.scene for ladder in COMPARED} == set(SCENES) - others


def test_the_share_is_all_that_differs_from_the_default_element() -> None:
    requests = [complete(cell.scene, cell.settings, **cell.options)[1] for cell in share_cells()]
    assert len(requests) == len(COMPARED) * 2 * len(THICKNESS_STRAINS)
    without = [request.key(("thickness_strain",)) for request in requests]
    assert [len(list(same)) for _, same in groupby(without)] == [len(THICKNESS_STRAINS)] * (2 * len(COMPARED))
    assert {request.settings["membrane"] for request in requests} == {"relaxed"}


def test_quantities_are_read_where_the_limit_is_of() -> None:
    """At a load that is asked for: that of the ladder, whatever comes after it."""
    every = list(share_cells())
    for ladder in COMPARED:
        read_as_asked(ladder, [cell for cell in every if cell.label.startswith(f"share {ladder.name} ")])


def read_as_asked(ladder: Ladder, cells: list[Cell]) -> None:
    asked = complete(cells[0].scene, cells[0].settings, **cells[0].options)[1].settings
    own = complete(ladder.scene, ladder.settings, mesh=ladder.meshes[0], measure=ladder.measure)[1].settings
    for key, value in read_at(ladder).items():
        assert value in asked[key], ladder.name
        assert ladder.at or own[key][-1] == value
    coarse, fine = (tuple(map(int, mesh.split("x"))) for mesh in meshes_of(ladder))
    assert coarse < fine == SCENES[ladder.scene].default_mesh
