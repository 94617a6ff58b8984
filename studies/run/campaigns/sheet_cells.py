"""Cells whose answers and fields stand on the sheets: one for every scene, and the tyre at the travels of a filmstrip.

Each is its scene at the whole load with the measure it is meant for, on a mesh whose fields fit on a page.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from studies.ask.scene import ladders_of
from studies.run.campaigns.cell import Cell
from studies.scenes import SCENES

LABEL, FRAME, GROUP = "sheet {scene}", "sheet tyre at {delta} mm", "sheets"
FRAMES = ("1", "4", "8", "12", "16", "20")  # mm of travel
MESHES: Mapping[str, str] = {  # where the default mesh is more, or less, than a picture shows
    **{"tyre": "42x60", "tyre-solid": "14x18", "panel": "12x12", "sze-pinched": "24x24"},
    **{"pressurised-cylinder": "8x16", "pressurised-sphere": "8x8", "pressurised-torus": "64x4"},
    **dict.fromkeys(("semicylinder", "semicylinder-0-90-0"), "16x16"),  # the path of the third one ends on such a mesh
}
PRESSED: Mapping[str, Mapping[str, str]] = {  # instead of what their ladders ask for
    "tyre": {"delta_mm": "20"},
    "tyre-solid": {"delta_mm": "20"},
    "panel": {"delta_mm": "5"},
}
WHOLE_TYRE: Mapping[str, str] = {"model": "full"}


def sheet_cell(scene: str) -> Cell:
    """The cell of a scene's sheet, for any scene of the catalogue."""
    ladder = next(iter(ladders_of(SCENES[scene])), None)
    n1, n2 = SCENES[scene].default_mesh
    options = {"measure": ladder.measure} if ladder else {}
    options |= {"mesh": MESHES.get(scene, f"{n1}x{n2}"), **(WHOLE_TYRE if scene == "tyre" else {})}
    settings = {**ladder.settings, **ladder.whole} if ladder else {}
    return Cell(LABEL.format(scene=scene), scene, options, {**settings, **PRESSED.get(scene, {})}, group=GROUP)


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
