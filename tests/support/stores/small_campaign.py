"""A campaign of six small cells, and the content of its store without what differs from run to run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from studies.run.campaign import find
from studies.run.running import Summary, run

SMALL = """
title = "small"
[[cross]]
name = "small"
contacts = ["semismooth", "qp"]
tolerances = [1e-9]
[cross.scenes.cantilever]
meshes = ["2x1", "4x1"]
[cross.scenes.strip-contact]
meshes = ["4x1", "8x1"]
set = { load_fraction = "5" }
"""
APART = ("timing_s", "provenance")


def small(folder: Path) -> Path:
    """Write the file of the campaign."""
    path = folder / "small.toml"
    path.write_text(SMALL)
    return path


def again(folder: Path, store: Path, **options: Any) -> Summary:
    """Solve what is missing."""
    return run(find(str(small(folder))), store, **options)


def content(store: Path) -> dict[str, Any]:
    """Everything in a store apart from timings and provenance."""
    found: dict[str, Any] = {}
    for path in sorted(each for each in store.rglob("*") if each.is_file() and each.name != ".lock"):
        name = path.relative_to(store).as_posix()
        found[name] = path.read_bytes()
        if name.startswith("cells/") and name.endswith(".json"):
            record = json.loads(found[name])
            found[name] = {key: value for key, value in record.items() if key not in APART}
    return found
