"""A store of another machine: a few cells of every kind, solved once, with the fields of all of them."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from studies.campaigns.file import find
from studies.campaigns.run import run
from studies.store.layout import Archive

CELLS = """
title = "few"
[[cross]]
name = "few"
[cross.scenes.cantilever]
meshes = ["4x1", "8x1"]
set = { load_fraction = "0.5,1" }
[cross.scenes.strip-contact]
meshes = ["8x1", "16x1"]
set = { load_fraction = "5" }
[cross.scenes.shallow-cap]
meshes = ["4x1"]
[cross.scenes.tyre]
meshes = ["8x8"]
set = { delta_mm = "5" }
[[cross]]
name = "linear"
measures = ["linear"]
[cross.scenes.cantilever]
meshes = ["4x1"]
set = { load_fraction = "0.5,1" }
[[cross]]
name = "loose"
tolerances = [1e-3]
[cross.scenes.strip-contact]
meshes = ["8x1"]
set = { load_fraction = "5" }
[[cross]]
name = "fails"
[cross.scenes.tyre]
meshes = ["4x4"]
set = { delta_mm = "60" }
"""
BEAM, FINE_BEAM = "few cantilever 4x1", "few cantilever 8x1"
STRIP, FINE_STRIP, CAP, TYRE = "few strip-contact 8x1", "few strip-contact 16x1", "few shallow-cap 4x1", "few tyre 8x8"
LINEAR, LOOSE, FAILS = "linear cantilever linear 4x1", "loose strip-contact 8x1 tolerance=0.001", "fails tyre 4x4"


class Elsewhere:
    """A store that a test may falsify, cell by cell."""

    def __init__(self, root: Path) -> None:
        self.root, self.archive = root, Archive(root)
        self.ids = {row["label"]: row["id"] for row in self.archive.index("few")["cells"]}

    def record(self, label: str) -> dict[str, Any]:
        """As it is there."""
        return dict(json.loads(self.archive.record_path(self.ids[label]).read_text()))

    def falsify(self, label: str, change: Callable[[dict[str, Any]], object]) -> None:
        """Change the record of a cell in place."""
        record = self.record(label)
        change(record)
        self.archive.record_path(self.ids[label]).write_text(json.dumps(record))

    def files(self, label: str) -> Path:
        """The folder beside the record."""
        return self.archive.files(self.ids[label])


@pytest.fixture(scope="session")
def honest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Solved here, with the fields of every cell."""
    folder = tmp_path_factory.mktemp("honest")
    (folder / "few.toml").write_text(CELLS)
    run(find(str(folder / "few.toml")), folder / "elsewhere", fields=True)
    return folder / "elsewhere"


@pytest.fixture
def elsewhere(honest: Path, tmp_path: Path) -> Elsewhere:
    """A copy of its own."""
    return Elsewhere(Path(shutil.copytree(honest, tmp_path / "elsewhere")))
