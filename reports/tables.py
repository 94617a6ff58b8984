"""The store as the reports see it: planned cells, their results and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

import json
import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from reports.reading import SCHEMA, StoreError, read_record, read_table, read_versioned, require

REQUEST_KEYS = ("scene", "measure", "contact", "newton", "mesh", "model", "settings")
ENDING_KEYS = ("class", "reason")
ANSWER_KEYS = ("outcome", "quantities", "steps", "cuts", "counters", "timing_s", "provenance")
RESULT_KEYS = (*REQUEST_KEYS, *ENDING_KEYS, *ANSWER_KEYS)
INDEX_KEYS = ("schema", "campaign", "title", "pages", "cells")
CELL_KEYS = ("label", "id", "scene", "command", "options", "settings", "files", "request", "reason")
CLASSES = (
    *("converged", "unstable", "wrong", "not-converged", "cap-hit"),
    *("time", "memory", "crash", "unsupported", "missing"),
)
REFERENCE_KEYS = ("scene", "quantity", "value", "at", "kind", "source", "uncertainty")
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
    "grid": ("a1_low", "a1_high", "a2_low", "a2_high", "level"),
    "history": ("stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed"),
}
OF_A_REQUEST = {"label", "command", "scene", "measure", "contact", "newton", "element", "model", "configuration"}
OF_A_LADDER = {"ladder", "family", "at", "against", "largest"}
OF_A_COMPARISON = {
    "flag",
    "removed",
    "flips",
    "ranking",
    "ended",
    "path_end",
    "found_by",
    "why",
    "advised",
    "best",
    "runner_up",
}
WORDS = OF_A_REQUEST | OF_A_LADDER | OF_A_COMPARISON  # columns of the analysis that may be empty


@dataclass(frozen=True, eq=False)
class Cell:
    """One request of a campaign, and what became of it: ``ended`` is one of CLASSES.

    result: result.json, empty where there is none; the tables beside it are read when asked for. asked: the request, as
    far as it went. expected: why it is expected not to go as asked, if so. group: the list of the campaign that it is
    of. shown: is it one of the cells behind the pages?
    """

    label: str
    scene: str
    command: str
    directory: Path
    result: Mapping[str, Any]
    ended: str
    reason: str
    asked: Mapping[str, Any] = field(default_factory=dict)
    expected: str = ""
    group: str = ""
    shown: bool = False

    @property
    def converged(self) -> bool:
        """True when every requested load was reached."""
        return bool(self.result["outcome"] == "converged")

    @property
    def unsupported(self) -> bool:
        """True when the algorithm refused the problem; the reason says why."""
        return bool(self.result["outcome"] == "unsupported")

    @property
    def settings(self) -> Mapping[str, Any]:
        """Every resolved setting."""
        return self.result["settings"]

    @property
    def steps(self) -> list[dict[str, Any]]:
        """One record per load that was reached."""
        return list(self.result["steps"])

    @property
    def cuts(self) -> list[str]:
        """The events of rejected attempts, in order; empty when every step was taken as asked."""
        return [str(event) for event in self.result["cuts"]]

    def find_step(self, **at: float) -> dict[str, Any] | None:
        """The step with these values, e.g. ``delta_mm=20``, or None when the path did not get there."""
        return next((s for s in self.steps if all(abs(s[key] - value) < 1e-9 for key, value in at.items())), None)

    def step(self, **at: float) -> dict[str, Any]:
        """As find_step; raises StoreError when the path did not get there."""
        found = self.find_step(**at)
        if found is None:
            wanted = ", ".join(f"{key} = {value:g}" for key, value in at.items())
            raise StoreError(f"cell {self.label!r} has no step at {wanted}: {self.result['reason']}")
        return found

    def value(self, quantity: str, **at: float) -> float:
        """A number of the step with these values; NaN when the path did not get there."""
        step = self.find_step(**at)
        return float("nan") if step is None else float(step[quantity])

    def table(self, name: str) -> pd.DataFrame:
        """A table of the cell (contact, profile or history); raises StoreError when it is missing or damaged."""
        if name not in self._tables:
            self._tables[name] = read_table(self.directory / f"{name}.csv", TABLE_COLUMNS[name])
        return self._tables[name].copy()

    @cached_property
    def _tables(self) -> dict[str, pd.DataFrame]:
        """Those that were read: the reference of a comparison is asked for by each that is compared with it."""
        return {}

    def matches(self, wanted: Mapping[str, Any]) -> bool:
        """Has the resolved request all these values? A number matches a path of one value, "8x4" a mesh."""
        return all(_same(self._known.get(key), value) for key, value in wanted.items())

    @cached_property
    def request(self) -> str:
        """What was asked, the same for cells that ask for the same."""
        return json.dumps(self.asked, sort_keys=True)

    @cached_property
    def _known(self) -> Mapping[str, Any]:
        return {"group": self.group, **self.asked.get("settings", {}), **self.asked}


@dataclass(frozen=True, eq=False)
class Store:
    """A campaign of a store: ``planned`` is everything it asks for, in order.

    references: as written by the scenes.  pages: which of them the campaign is made for.
    """

    path: Path
    campaign: str
    references: tuple[Mapping[str, Any], ...]
    planned: tuple[Cell, ...] = ()
    title: str = ""
    pages: str = ""

    @property
    def cells(self) -> list[Cell]:
        """The cells behind the pages, those that have records."""
        return [each for each in self.planned if each.shown and each.result]

    def select(self, **wanted: Any) -> list[Cell]:
        """The cells behind the pages whose resolved request has all these values, in the order of the campaign.

        wanted: scene, measure, contact, newton, mesh, model, steps, any setting, or the group. Of equal requests the
        first one; none that was refused before it was solved. Raises StoreError for another cell without a record.
        """
        unique: dict[str, Cell] = {}
        for each in self._by_scene[wanted["scene"]] if "scene" in wanted else self.planned:
            if each.shown and (each.result or each.ended != "unsupported") and each.matches(wanted):
                unique.setdefault(each.request, each)
        for each in unique.values():
            if not each.result:
                lacks = f"no record of cell {each.label!r} ({each.ended}: {each.reason})"
                raise StoreError(f"{self.path}: campaign {self.campaign!r} has {lacks}, which the pages need")
        return list(unique.values())

    @cached_property
    def _by_scene(self) -> Mapping[str, list[Cell]]:
        found: dict[str, list[Cell]] = defaultdict(list)
        for each in self.planned:
            found[each.scene].append(each)
        return found

    def find(self, **wanted: Any) -> Cell:
        """The one cell of ``select``; raises StoreError when there is none, or more than one."""
        found = self.select(**wanted)
        if len(found) != 1:
            asked = ", ".join(f"{key} {value}" for key, value in wanted.items())
            names = ", ".join([repr(cell.label) for cell in found[:3]] + ["..."] * (len(found) > 3))
            has = f"{len(found)} cells ({names})" if found else "no cell"
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has {has} with {asked}; the pages need one")
        return found[0]

    def reference(self, scene: str, quantity: str, kind: str, **at: float) -> Mapping[str, Any]:
        """The first reference of a quantity, at a load where one is given; raises StoreError when there is none."""
        wanted = {"scene": scene, "quantity": quantity, "kind": kind}
        known = [row for row in self.references if all(row[key] == value for key, value in wanted.items())]
        found = [row for row in known if all(row["at"].get(key) == value for key, value in at.items())]
        if not found:
            where = f" at {at}" if known else ""
            raise StoreError(f"{self.path / 'references.json'}: no {kind} reference for {quantity} of {scene}{where}")
        return found[0]

    def has_table(self, name: str) -> bool:
        """True when a table that no campaign makes by itself has been put there."""
        return (self.path / "tables" / f"{name}.csv").exists()

    def table(self, name: str) -> pd.DataFrame:
        """A table of the whole store, e.g. rigid_body; raises StoreError when it is missing or damaged."""
        return read_table(self.path / "tables" / f"{name}.csv")

    def has_analysis(self, name: str) -> bool:
        """True when a table is there that is of this campaign, or of none."""
        if not self.has_table(name):
            return False
        found = self.table(name)
        return "campaign" not in found or bool((found["campaign"] == self.campaign).all())

    def analysis(self, name: str) -> pd.DataFrame:
        """A table of the analysis of this campaign; raises StoreError when it is missing, damaged, or another's."""
        if not self.has_analysis(name):
            raise StoreError(f"{self.path / 'tables' / name}.csv: not of campaign {self.campaign!r}")
        found = self.table(name)
        for column in WORDS.intersection(found.columns):
            found[column] = found[column].astype(object).where(found[column].notna(), "")
        return found

    def rules(self) -> Mapping[str, float]:
        """The thresholds by which the analysis judges, by name."""
        return {str(name): float(value) for name, value in self.analysis("rules").iloc[0].items() if name != "campaign"}

    def reference_table(self, name: str, columns: Iterable[str] = ()) -> pd.DataFrame:
        """A raw reference table, its # lines skipped; raises StoreError when it is missing or damaged."""
        return read_table(self.path / "references" / name, columns, comment="#")


def load_store(path: Path, campaign: str | None = None) -> Store:
    """Read and check a campaign of a store, except for its tables; raises StoreError.

    Without a name it is the only one there: two are never mixed.
    """
    if not path.is_dir():
        raise StoreError(f"{path}: no such directory")
    index_path = path / "campaigns" / f"{campaign or _only(path)}.json"
    index = read_versioned(index_path, INDEX_KEYS)
    references = read_versioned(path / "references.json", ("schema", "references"))["references"]
    for row in references:
        require(row, REFERENCE_KEYS, path / "references.json")
    for row in index["cells"]:
        require(row, CELL_KEYS, index_path)
    planned = tuple(_planned(path, row) for row in index["cells"])
    return Store(path, index["campaign"], tuple(references), planned, index["title"], index["pages"])


def _only(path: Path) -> str:
    """The name of the one campaign of a store; raises StoreError."""
    names = sorted(each.stem for each in (path / "campaigns").glob("*.json"))
    if len(names) > 1:
        raise StoreError(f"{path}: has the campaigns {', '.join(names)}; choose one by --campaign")
    if not names:
        old = path / "campaign.json"
        lacks = f"{old}: schema 1, but this program reads {SCHEMA}" if old.exists() else f"{path}: no campaign"
        raise StoreError(lacks)
    return names[0]


def _planned(path: Path, row: Mapping[str, Any]) -> Cell:
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
    asked.pop("model_reason", None)  # of older stores, whose requests say why a model was chosen: it decides nothing
    about = {"expected": row.get("expected", ""), "group": row.get("group", ""), "shown": bool(row["files"])}
    named = (row["label"], row["scene"], row["command"], path / "cells" / str(row["id"]))
    return Cell(*named, result, ending["class"], ending["reason"], asked, **about)


def load_cell(directory: Path, label: str, command: str = "") -> Cell:
    """Read and check one solved request; raises StoreError."""
    result = read_record(directory / "result.json", RESULT_KEYS)
    _require_steps(result, directory / "result.json")
    return Cell(label, result["scene"], command, directory, result, result["class"], result["reason"])


def _require_steps(result: Mapping[str, Any], path: Path) -> None:
    for step in result["steps"]:
        require(step, TYRE_STEP_KEYS if result["scene"] in TYRES else STEP_KEYS, path)


def _same(there: Any, wanted: Any) -> bool:
    """Are two values of a request the same? As written in JSON, infinity being a word and a path a list."""
    if isinstance(there, list):
        if isinstance(wanted, str):
            return "x".join(map(str, there)) == wanted
        return there == (list(wanted) if isinstance(wanted, list | tuple) else [wanted])
    return bool(there == ("inf" if wanted == math.inf else wanted))
