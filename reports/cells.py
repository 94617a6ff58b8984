"""A cell of a campaign as the reports see it: the record of a request, checked on entry, and the tables beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from reports.reading import StoreError, read_record, read_table, read_versioned, require

REQUEST_KEYS = ("scene", "measure", "contact", "newton", "mesh", "model", "settings")
ENDING_KEYS = ("class", "reason")
ANSWER_KEYS = ("outcome", "quantities", "steps", "cuts", "counters", "timing_s", "provenance")
RESULT_KEYS = (*REQUEST_KEYS, *ENDING_KEYS, *ANSWER_KEYS)
CELL_KEYS = ("label", "id", "scene", "command", "options", "settings", "files", "request", "reason")
CLASSES = (
    *("converged", "unstable", "wrong", "not-converged", "cap-hit"),
    *("time", "memory", "crash", "unsupported", "missing"),
)
TYRES = ("tyre", "tyre-solid")
SOLVED_KEYS = ("kkt", "failures", "newton_iterations", "substeps")
STEP_KEYS = (*SOLVED_KEYS, "rounding")  # of every other scene
PATCH = ("force_N", "centre_pressure_MPa", "contact_nodes", "half_length_mm", "half_width_mm")
TYRE_STEP_KEYS = (*SOLVED_KEYS, "delta_mm", *PATCH, "central_asymmetry", "mirror_asymmetry")
FACES = tuple(f"{face}_{along}_mm" for face in ("inner", "outer") for along in ("radial", "axial"))
TABLE_COLUMNS = {
    "contact": ("delta_mm", "psi_deg", "phi_deg", "pressure_MPa", "gap_mm", "active"),
    "profile": ("state", "delta_mm", "psi_deg", *FACES),
    "mode": ("psi_deg", "phi_deg", "x", "y", "z"),
    "curve": ("newton_iterations", "limit_point"),
    "grid": ("a1_low", "a1_high", "a2_low", "a2_high", "level"),
    "gradients": ("quantity", "setting", "relative"),
}


@dataclass(frozen=True, eq=False)
class Cell:
    """One request of a campaign, and what became of it: ``ended`` is one of CLASSES.

    result: result.json, empty where there is none; the tables beside it are read when asked for. asked: the request, as
    far as it went. shown: is it one of the cells behind the pages?
    """

    label: str
    scene: str
    command: str
    directory: Path
    result: Mapping[str, Any]
    ended: str
    reason: str
    asked: Mapping[str, Any] = field(default_factory=dict)
    shown: bool = False

    @property
    def converged(self) -> bool:
        """True when every requested load was reached."""
        return bool(self.result["outcome"] == "converged")

    @property
    def settings(self) -> Mapping[str, Any]:
        """Every resolved setting."""
        return self.result["settings"]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """One record per load that was reached."""
        return list(self.result["steps"])

    def find_step(self, **at: float) -> dict[str, Any] | None:
        """The step with these values, e.g. ``delta_mm=20``, or None when the path did not get there."""
        return next((s for s in self.steps if all(abs(s[key] - value) < 1e-9 for key, value in at.items())), None)

    def step(self, **at: float) -> dict[str, Any]:
        """As find_step; raises StoreError when the path did not get there."""
        reached = self.find_step(**at)
        if reached is None:
            wanted = ", ".join(f"{key} = {value:g}" for key, value in at.items())
            raise StoreError(f"cell {self.label!r} has no step at {wanted}: {self.result['reason']}")
        return reached

    def value(self, quantity: str, **at: float) -> float:
        """A number of the step with these values; NaN when the path did not get there."""
        step = self.find_step(**at)
        return float("nan") if step is None else float(step[quantity])

    def table(self, name: str) -> pd.DataFrame:
        """A table of the cell, by a name of TABLE_COLUMNS; raises StoreError when it is missing or damaged."""
        if name not in self._tables:
            self._tables[name] = read_table(self.directory / f"{name}.csv", TABLE_COLUMNS[name])
        return self._tables[name].copy()

    @cached_property
    def _tables(self) -> dict[str, pd.DataFrame]:
        """Those that were read: the reference of a comparison is asked for by each that is compared with it."""
        return {}


def planned_cell(path: Path, row: Mapping[str, Any]) -> Cell:
    """A row of the index with its record, its failure, or neither; raises StoreError for what cannot be read."""
    record, failure = (path / folder / f"{row['id']}.json" for folder in ("cells", "failures"))
    result: Mapping[str, Any] = {}
    ending: Mapping[str, Any] = {"class": "missing", "reason": "not solved yet"}
    if row["id"] is None:
        ending = {"class": "unsupported", "reason": row["reason"]}
    elif record.exists():
        ending = result = read_versioned(record, ("schema", "id", *RESULT_KEYS))
        if result["id"] != row["id"] or result["scene"] != row["scene"]:
            raise StoreError(f"{record}: of cell {result['id']!r} of {result['scene']}, not of {row['label']!r}")
        _require_steps(result, record)
    elif failure.exists():
        ending = read_versioned(failure, ("schema", "id", *ENDING_KEYS))
    asked = dict(row["request"] or {**row["options"], "settings": row["settings"]})
    named = (row["label"], row["scene"], row["command"], path / "cells" / str(row["id"]))
    return Cell(*named, result, ending["class"], ending["reason"], asked, bool(row["files"]))


def load_cell(directory: Path) -> Cell:
    """Read and check one solved request; raises StoreError."""
    result = read_record(directory / "result.json", RESULT_KEYS)
    _require_steps(result, directory / "result.json")
    return Cell(directory.name, result["scene"], "", directory, result, result["class"], result["reason"])


def _require_steps(result: Mapping[str, Any], path: Path) -> None:
    for step in result["steps"]:
        require(step, TYRE_STEP_KEYS if result["scene"] in TYRES else STEP_KEYS, path)
