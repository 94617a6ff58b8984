"""Cells that compare the shares of the thickness strain: all scenes of a shell, and nothing else that differs."""

from __future__ import annotations

from itertools import groupby

import pytest

from formulations.element.mixed import THICKNESS_STRAINS
from studies.run.scene_cells import COMPARED, meshes_of, read_at, share_cells
from studies.scenes import SCENES
from studies.scenes.complete import complete

NO_REFERENCE, NO_SHELL = {"panel", "manufactured", "manufactured-contact"}, {"tyre-solid", "crushed-ring-solid"}
OWN_MESHES = "crushed-ring"  # of its error budget


def test_every_scene_of_a_shell_is_compared() -> None:
    assert {ladder.scene for ladder in COMPARED} == set(SCENES) - {*NO_REFERENCE, OWN_MESHES, *NO_SHELL}


def test_the_share_is_all_that_differs_from_the_default_element() -> None:
    requests = [complete(cell.scene, cell.settings, **cell.options)[1] for cell in share_cells()]
    assert len(requests) == len(COMPARED) * 2 * len(THICKNESS_STRAINS)
    without = [request.key(("thickness_strain",)) for request in requests]
    assert [len(list(same)) for _, same in groupby(without)] == [len(THICKNESS_STRAINS)] * (2 * len(COMPARED))
    assert {request.settings["membrane"] for request in requests} == {"relaxed"}


@pytest.mark.parametrize("ladder", COMPARED, ids=[ladder.name for ladder in COMPARED])
def test_quantities_are_read_where_the_limit_is_of(ladder) -> None:
    """At a load that is asked for: that of the ladder, whatever comes after it."""
    cells = [cell for cell in share_cells() if cell.label.startswith(f"share {ladder.name} ")]
    asked = complete(cells[0].scene, cells[0].settings, **cells[0].options)[1].settings
    own = complete(ladder.scene, ladder.settings, mesh=ladder.meshes[0], measure=ladder.measure)[1].settings
    for key, value in read_at(ladder).items():
        assert value in asked[key]
        assert ladder.at or own[key][-1] == value
    coarse, fine = (tuple(map(int, mesh.split("x"))) for mesh in meshes_of(ladder))
    assert coarse < fine == SCENES[ladder.scene].default_mesh
