"""Cells that every scene has: on its ladders, for the share of the thickness strain, and on its sheet.

Ladders: the same serve every element and every table over all scenes.

Shares, which are sampled at the nodes: every ladder's scene at its whole load. The meshes are half of the scene's
default one each way, where an element's own error shows, and the default one, which has to confirm what the coarse one
says of limit points.

Sheets: each is its scene at the whole load with the measure it is meant for, on a mesh whose fields fit on a page; the
tyre also at the travels of a filmstrip.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from formulations.element.mixed import THICKNESS_STRAINS
from studies.ask.declarations import BENCHMARKS as PUBLISHED
from studies.ask.declarations import Ladder
from studies.ask.scene import ladders_of, sheet_of
from studies.scenes import SCENES
from studies.scenes.complete import Cell

LADDER_LABEL = "convergence {ladder} {mesh} {element}"
CLIMBED = tomllib.loads(Path(__file__).with_name("ladders.toml").read_text(encoding="utf-8"))


def _declared(family: str, scenes: Iterable[str]) -> tuple[Ladder, ...]:
    return tuple(ladder for name in scenes for ladder in ladders_of(SCENES[name]) if ladder.family == family)


LADDERS = tuple(ladder for family, scenes in CLIMBED.items() for ladder in _declared(family, scenes))
BENCHMARKS = _declared(PUBLISHED, ("cantilever", "hemisphere"))


def ladder_cells(element_settings: Mapping[str, str], element_label: str, *, finest: bool = True) -> tuple[Cell, ...]:
    """The cells of all ladders with one element; their labels are those that the pages ask for.

    ``finest``: with the last mesh of each ladder, which costs more than all others together.
    """
    return tuple(
        Cell(
            LADDER_LABEL.format(ladder=ladder.name, mesh=mesh, element=element_label),
            ladder.scene,
            {"measure": ladder.measure, "mesh": mesh},
            {**ladder.settings, **element_settings},
        )
        for ladder in LADDERS
        for mesh in ladder.climbed(finest=finest)
    )


SHARE_LABEL, SHARES = "share {ladder} {mesh} {share}", "shares"
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
                label = SHARE_LABEL.format(ladder=ladder.name, mesh=mesh, share=share)
                options = {"measure": ladder.measure, "mesh": mesh}
                settings["thickness_strain"] = share
                yield Cell(label, ladder.scene, options, dict(settings), artefacts=False, group=SHARES)


SHEET_LABEL, FRAME, SHEETS = "sheet {scene}", "sheet tyre at {delta} mm", "sheets"
FRAMES = ("1", "4", "8", "12", "16", "20")  # mm of travel


def sheet_cell(name: str) -> Cell:
    """The cell of a scene's sheet, for any scene of the catalogue."""
    scene = SCENES[name]
    ladder, sheet = next(iter(ladders_of(scene)), None), sheet_of(scene)
    n1, n2 = scene.default_mesh
    options = {"measure": ladder.measure} if ladder else {}
    options |= {"mesh": sheet.mesh or f"{n1}x{n2}", **({"model": sheet.model} if sheet.model else {})}
    settings = {**ladder.settings, **ladder.whole} if ladder else {}
    return Cell(SHEET_LABEL.format(scene=name), name, options, {**settings, **sheet.settings}, group=SHEETS)


def frames() -> Iterator[Cell]:
    """The tyre of its sheet at the travels of the filmstrip."""
    last = sheet_cell("tyre")
    for delta in FRAMES:
        label, settings = FRAME.format(delta=delta), {**last.settings, "delta_mm": delta}
        yield Cell(label, "tyre", last.options, settings, group=SHEETS)


def sheet_cells() -> Iterator[Cell]:
    """All of those that are listed."""
    yield from (sheet_cell(name) for name, scene in SCENES.items() if sheet_of(scene).listed)
    yield from frames()
