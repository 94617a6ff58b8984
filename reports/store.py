"""The store as the reports see it: planned cells, their records and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from reports.files import StoreError, read_record, read_table, read_versioned, require

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


INDEX_KEYS = ("schema", "campaign", "title", "pages", "cells")
# columns of tables that may be empty; what is not there is an empty word
OF_A_REQUEST = "label command scene measure contact way newton element model configuration settings quantity mesh"
OF_A_LADDER = "ladder family at against largest"
OF_A_COMPARISON = "flag removed flips ranking ended path_end found_by why advised best runner_up verdict said"
OF_A_FINDING = "cause causes refusals worst_scene error_scene load_key regime name axis"
WORDS = {*f"{OF_A_REQUEST} {OF_A_LADDER} {OF_A_COMPARISON} {OF_A_FINDING}".split()}

PROSE: Mapping[str, tuple[str, ...]] = {  # columns of whole sentences
    **{"statements": ("text", "scope"), "statement_values": ("word",), "sheet_parts": ("about", "source")},
    **{"claims": ("sentence", "source", "regime", "measured")},
}


@dataclass(frozen=True, eq=False)
class Store:
    """A campaign of a store: ``planned`` is everything it asks for, in order; pages: which the campaign is made for."""

    path: Path
    campaign: str
    planned: tuple[Cell, ...] = ()
    title: str = ""
    pages: str = ""

    @property
    def cells(self) -> list[Cell]:
        """The cells behind the pages, those that have records."""
        return [each for each in self.planned if each.shown and each.result]

    def cell(self, label: str) -> Cell:
        """The cell of a label that the pages need; raises StoreError when it is not planned, or has no record."""
        match = next((each for each in self.planned if each.label == label), None)
        if match is None:
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has no cell {label!r}, which the pages need")
        if not match.result:
            lacks = f"no record of cell {label!r} ({match.ended}: {match.reason})"
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has {lacks}, which the pages need")
        return match

    def has(self, name: str) -> bool:
        """Is there a table that is of this campaign, or of none?"""
        table = (
            self._read(name) if (self.path / "tables" / f"{name}.csv").exists() else pd.DataFrame({"campaign": [""]})
        )
        return "campaign" not in table or bool((table["campaign"] == self.campaign).all())

    def table(self, name: str) -> pd.DataFrame:
        """A table of this campaign or of the whole store; raises StoreError when it is missing or another's."""
        rows = self._read(name)
        if not self.has(name):
            raise StoreError(f"{self.path / 'tables' / name}.csv: not of campaign {self.campaign!r}")
        return rows.copy()

    def _read(self, name: str) -> pd.DataFrame:
        """As it stands there, with empty words for what is not; each is read once."""
        if name not in self._tables:
            table = read_table(self.path / "tables" / f"{name}.csv", prose=PROSE.get(name, ()))
            empty = {
                column: table[column].astype(object).where(table[column].notna(), "") for column in WORDS & {*table}
            }
            self._tables[name] = table.assign(**empty)
        return self._tables[name]

    @cached_property
    def _tables(self) -> dict[str, pd.DataFrame]:
        return {}

    def rows(self, table: str, /, **where: str) -> pd.DataFrame:
        """The rows of a table with these words; no rows where it is not there, or is another campaign's."""
        every = self.table(table) if self.has(table) else pd.DataFrame(columns=[*where])
        for key, value in where.items():
            every = every[every[key].fillna("") == value]
        return every

    def rules(self) -> Mapping[str, float]:
        """The thresholds by which the analysis judges, by name."""
        return {str(name): float(value) for name, value in self.table("rules").iloc[0].items() if name != "campaign"}


def load_store(path: Path, campaign: str | None = None) -> Store:
    """Read and check a campaign of a store, except for its tables; raises StoreError.

    Without a name it is the only one there: two are never mixed.
    """
    if not path.is_dir():
        raise StoreError(f"{path}: no such directory")
    index_path = path / "campaigns" / f"{campaign or _only(path)}.json"
    index = read_versioned(index_path, INDEX_KEYS)
    for row in index["cells"]:
        require(row, CELL_KEYS, index_path)
    planned = tuple(planned_cell(path, row) for row in index["cells"])
    return Store(path, index["campaign"], planned, index["title"], index["pages"])


def _only(path: Path) -> str:
    """The name of the one campaign of a store; raises StoreError."""
    names = sorted(each.stem for each in (path / "campaigns").glob("*.json"))
    if len(names) > 1:
        raise StoreError(f"{path}: has the campaigns {', '.join(names)}; choose one by --campaign")
    if not names:
        raise StoreError(f"{path}: no campaign")
    return names[0]
