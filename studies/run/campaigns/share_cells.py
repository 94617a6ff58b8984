"""Cells for the share of the thickness strain that is sampled at the nodes: every ladder's scene, whole load, coarse.

The meshes are half of the scene's default one each way, where an element's own error shows, and the default one, which
has to confirm what the coarse one says of limit points.
"""

from __future__ import annotations

from collections.abc import Iterator

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import Ladder
from studies.run.campaigns.ladder_cells import LADDERS
from studies.scenes import SCENES
from studies.scenes.complete import Cell

LABEL, GROUP = "share {ladder} {mesh} {share}", "shares"
COARSE = {"tyre": "20x20"}  # even numbers only
COMPARED = tuple(ladder for ladder in LADDERS if ladder.settings.get("interpolation", "curvilinear") == "curvilinear")


def meshes_of(ladder: Ladder) -> tuple[str, str]:
    """Half of the default mesh of its scene, and that mesh."""
    n1, n2 = SCENES[ladder.scene].default_mesh
    return COARSE.get(ladder.scene, f"{max(1, n1 // 2)}x{max(1, n2 // 2)}"), f"{n1}x{n2}"


def read_at(ladder: Ladder) -> dict[str, float]:
    """The step where its quantities are read, which is the one that its limit is of; empty: the whole path."""
    if ladder.at:
        key, _, value = ladder.at.partition("=")
        return {key: float(value)}
    return {key: float(ladder.settings[key]) for key in ladder.whole if key in ladder.settings and key != "until"}


def share_cells() -> Iterator[Cell]:
    """Both meshes with every share; all else as in the default element."""
    for ladder in COMPARED:
        settings = {**ladder.settings, **ladder.whole}
        for mesh in meshes_of(ladder):
            for share in THICKNESS_STRAINS:
                label = LABEL.format(ladder=ladder.name, mesh=mesh, share=share)
                options = {"measure": ladder.measure, "mesh": mesh}
                settings["thickness_strain"] = share
                yield Cell(label, ladder.scene, options, dict(settings), artefacts=False, group=GROUP)
