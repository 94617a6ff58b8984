"""Cells whose answers and fields stand on the sheets: one for every scene, and the tyre at the travels of a filmstrip.

Each is its scene at the whole load with the measure it is meant for, on a mesh whose fields fit on a page.
"""

from __future__ import annotations

from collections.abc import Iterator

from studies.ask.scene import ladders_of, sheet_of
from studies.scenes import SCENES
from studies.scenes.complete import Cell

LABEL, FRAME, GROUP = "sheet {scene}", "sheet tyre at {delta} mm", "sheets"
FRAMES = ("1", "4", "8", "12", "16", "20")  # mm of travel


def sheet_cell(name: str) -> Cell:
    """The cell of a scene's sheet, for any scene of the catalogue."""
    scene = SCENES[name]
    ladder, sheet = next(iter(ladders_of(scene)), None), sheet_of(scene)
    n1, n2 = scene.default_mesh
    options = {"measure": ladder.measure} if ladder else {}
    options |= {"mesh": sheet.mesh or f"{n1}x{n2}", **({"model": sheet.model} if sheet.model else {})}
    settings = {**ladder.settings, **ladder.whole} if ladder else {}
    return Cell(LABEL.format(scene=name), name, options, {**settings, **sheet.settings}, group=GROUP)


def frames() -> Iterator[Cell]:
    """The tyre of its sheet at the travels of the filmstrip."""
    last = sheet_cell("tyre")
    for delta in FRAMES:
        label, settings = FRAME.format(delta=delta), {**last.settings, "delta_mm": delta}
        yield Cell(label, "tyre", last.options, settings, group=GROUP)


def sheet_cells() -> Iterator[Cell]:
    """All of them."""
    yield from map(sheet_cell, SCENES)
    yield from frames()
