"""Stores of another machine: a few cells of every kind, solved once, with the fields of all of them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from contact.problem import ContactSolution
from studies.ask.request import Request
from studies.gate.recompute import Opened, arrays_of, as_written, state_of
from studies.output.vtu import write_vtu
from studies.run.archive import Archive
from studies.run.campaign import find
from studies.run.running import run

BEAMS = """
title = "beams"
[[cross]]
name = "a"
measures = ["exact", "linear"]
[cross.scenes.cantilever]
meshes = ["4x1", "8x1"]
set = { load_fraction = "0.5,1" }
[[cross]]
name = "a"
tolerances = [1e-3, 1e-9]
[cross.scenes.strip-contact]
meshes = ["8x1"]
set = { load_fraction = "5" }
"""
TYRES = """
title = "tyres"
[[cross]]
name = "a"
[cross.scenes.tyre]
meshes = ["8x8"]
set = { delta_mm = "5" }
[cross.scenes.shallow-cap]
meshes = ["4x1"]
[[cross]]
name = "fails"
[cross.scenes.tyre]
meshes = ["8x8"]
set = { delta_mm = "0", p0_MPa = "-2" }
"""
BEAM, FINE, LINEAR = "a cantilever exact 4x1", "a cantilever exact 8x1", "a cantilever linear 4x1"
STRIP, LOOSE = "a strip-contact 8x1 tolerance=1e-09", "a strip-contact 8x1 tolerance=0.001"
TYRE, CAP, FAILS = "a tyre 8x8", "a shallow-cap 4x1", "fails tyre 8x8"

Change = Callable[[dict[str, Any]], object]


class Elsewhere:
    """A store that a test may falsify, cell by cell."""

    def __init__(self, root: Path) -> None:
        self.root, self.archive = root, Archive(root)
        (self.campaign,) = self.archive.campaigns()
        self.ids = {row["label"]: row["id"] for row in self.archive.index(self.campaign)["cells"]}

    def record(self, label: str) -> dict[str, Any]:
        """As it is there."""
        return dict(json.loads(self.archive.record_path(self.ids[label]).read_text()))

    def falsify(self, label: str, change: Change) -> None:
        """Change the record of a cell in place."""
        record = self.record(label)
        change(record)
        self.archive.record_path(self.ids[label]).write_text(json.dumps(record))

    def field(self, label: str) -> Path:
        """The file of the field of a cell."""
        return self.archive.files(self.ids[label]) / "fields.vtu"

    def bend(self, label: str, change: Callable[[ContactSolution], object]) -> None:
        """Change unknowns or pressures of a cell in place; all else in the file of its field follows from them."""
        model, state = self.state(label)
        change(state)
        model.write_fields(self.field(label), state)

    def state(self, label: str) -> tuple[Any, ContactSolution]:
        """The model of a cell, and its state as the file of its field has it."""
        row = next(row for row in self.archive.index(self.campaign)["cells"] if row["label"] == label)
        model: Any = Opened.of(Request.of(row["request"])).model
        wanted = as_written(model, ContactSolution.at_rest(model.n_unknowns, 0))[1]
        m = int(model.candidate_of_node.max()) + 1
        return model, state_of(model, arrays_of(self.field(label).read_bytes(), wanted), m)

    def scratch(self, label: str, change: Callable[[dict[str, np.ndarray]], object]) -> None:
        """Change displacement or pressure in the file of a field alone."""
        path = self.field(label)
        read = meshio.read(path)
        data = {name: values.copy() for name, values in read.point_data.items()}
        change(data)
        cells = {name: values[0] for name, values in read.cell_data.items()}
        write_vtu(path, read.points, read.cells[0].data, data, cells)


def solved(folder: Path, name: str, text: str) -> Path:
    """The campaign, solved with the fields of every cell."""
    (folder / f"{name}.toml").write_text(text)
    run(find(str(folder / f"{name}.toml")), folder / "elsewhere", fields=True)
    return folder / "elsewhere"
