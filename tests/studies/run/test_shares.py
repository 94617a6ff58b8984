"""Cells that compare the shares of the thickness strain: all scenes of a shell, and nothing else that differs."""

from __future__ import annotations

from itertools import groupby

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import Ladder
from studies.run.lists import COMPARED, meshes_of, read_at, share_cells
from studies.scenes import SCENES
from studies.scenes.complete import Cell, complete
from support.kinds import MANY_SURFACES, OF_SOLIDS, ON_QUADS

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
