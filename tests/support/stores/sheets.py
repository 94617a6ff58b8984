"""Answers and fields of the cells of sheets, made up: every quantity is its reference, every body is a sheared cube."""

from __future__ import annotations

from functools import cache
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from studies.output.vtu import write_vtu
from studies.scenes import SCENES
from studies.scenes.complete import Cell

BUILT, DRAWN = ("cantilever", "strip-contact"), ("tyre", "strip-contact")  # scenes with a model, and with fields
LOADS = ("load_fraction", "delta_mm")
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))  # in VTK's order


def sheet_answer(cell: Cell) -> tuple[dict[str, float], dict[str, float]]:
    """What the last step says, and the quantities of a cell."""
    quantities = {each.quantity: each.value for each in SCENES[cell.scene].references}
    loads = {key: float(text.split(",")[-1]) for key, text in cell.settings.items() if key in LOADS}
    return {**loads, **quantities}, quantities


@cache
def cube_text() -> str:
    """fields.vtu of eight elements."""
    lines = np.linspace(0.0, 10.0, 3)
    points = np.array([[x, y, z] for z, y, x in product(lines, repeat=3)])
    at = [[i + a + 3 * (j + b) + 9 * (k + c) for a, b, c in CORNERS] for k, j, i in product(range(2), repeat=3)]
    displacement = np.stack([0.5 * points[:, 2], 0 * points[:, 0], -0.1 * points[:, 2]], axis=-1)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "fields.vtu"
        write_vtu(path, points, np.array(at), {"displacement": displacement, "pressure": 0.01 * points[:, 2]}, {})
        return path.read_text(encoding="ascii")
