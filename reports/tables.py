"""The store as the reports see it: cells by label, their results and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

SCHEMA = 2
RESULT_KEYS = (
    *("scene", "measure", "contact", "newton", "mesh", "model", "settings", "outcome", "class", "reason"),
    *("quantities", "steps", "cuts", "counters", "timing_s", "provenance"),
)
RECORD_KEYS = ("schema", "id", *RESULT_KEYS)
FAILURE_KEYS = ("schema", "id", "class", "reason")
INDEX_KEYS = ("schema", "campaign", "title", "pages", "cells")
CELL_KEYS = ("label", "id", "scene", "command", "options", "settings", "files", "request", "reason")
CLASSES = ("converged", "wrong", "not-converged", "cap-hit", "time", "memory", "crash", "unsupported", "missing")
REFERENCE_KEYS = ("scene", "quantity", "value", "at", "kind", "source", "uncertainty")
TYRES = ("tyre", "tyre-solid")
TYRE_STEP_KEYS = (
    *("delta_mm", "force_N", "centre_pressure_MPa", "contact_nodes", "half_length_mm", "half_width_mm", "kkt"),
    *("failures", "substeps"),
    *("newton_iterations", "central_asymmetry", "mirror_asymmetry"),
)
STEP_KEYS = ("kkt", "failures", "rounding", "newton_iterations", "substeps")  # of every other scene
TABLE_COLUMNS = {
    "contact": ("delta_mm", "psi_deg", "phi_deg", "pressure_MPa", "gap_mm", "active"),
    "profile": (
        *("state", "delta_mm", "psi_deg"),
        *("inner_radial_mm", "inner_axial_mm", "outer_radial_mm", "outer_axial_mm"),
    ),
    "history": ("stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed"),
}
WORDS = {  # columns of the analysis that may be empty
    *("flag", "against", "largest", "removed", "flips", "label", "configuration", "runner_up", "command"),
    *(
        "ladder",
        "family",
        "at",
        "advised",
        "best",
        "measure",
        "contact",
        "newton",
        "element",
        "model",
        "scene",
        "ranking",
        "ended",
    ),
}


class StoreError(ValueError):
    """A store that cannot be reported; its message is the one line the user reads."""


@dataclass(frozen=True, eq=False)
class Cell:
    """One solved request: ``result`` is result.json, the tables are read when asked for.

    expected: why it is expected not to go as asked, if so. group: the list of the campaign that it is of.
    """

    label: str
    scene: str
    command: str
    directory: Path
    result: Mapping[str, Any]
    expected: str = ""
    group: str = ""

    @property
    def converged(self) -> bool:
        """True when every requested load was reached."""
        return bool(self.result["outcome"] == "converged")

    @property
    def unsupported(self) -> bool:
        """True when the algorithm refused the problem; the reason says why."""
        return bool(self.result["outcome"] == "unsupported")

    @property
    def steps(self) -> list[dict[str, Any]]:
        """One record per load that was reached."""
        return list(self.result["steps"])

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
        return _read_table(self.directory / f"{name}.csv", TABLE_COLUMNS[name])

    def cuts(self) -> list[str]:
        """The events of rejected attempts, in order; empty when every step was taken as asked."""
        return [str(event) for event in self.result["cuts"]]


@dataclass(frozen=True, eq=False)
class Planned:
    """A cell of the plan, and what became of it: ``ended`` is one of CLASSES; asked: the request, as far as it went.

    result: its record, or None where there is none. shown: is it one of the cells behind the pages?
    """

    label: str
    id: str | None
    scene: str
    command: str
    asked: Mapping[str, Any]
    ended: str
    reason: str
    result: Mapping[str, Any] | None
    shown: bool = False

    def matches(self, wanted: Mapping[str, Any]) -> bool:
        """Has the resolved request all these values? A number matches a path of one value, "8x4" a mesh."""
        settings = self.asked.get("settings", {})
        return all(_same(self.asked.get(key, settings.get(key)), value) for key, value in wanted.items())


@dataclass(frozen=True, eq=False)
class Store:
    """A campaign of a store: ``planned`` is everything it asks for, in order; ``cells`` by label those with records.

    references: as written by the scenes.  pages: which of them the campaign is made for.
    """

    path: Path
    campaign: str
    cells: Mapping[str, Cell]
    references: tuple[Mapping[str, Any], ...]
    planned: tuple[Planned, ...] = ()
    title: str = ""
    pages: str = ""

    def cell(self, label: str) -> Cell:
        """The cell of a label; raises StoreError when the campaign has none."""
        if label not in self.cells:
            ended = next((f"{each.ended}: {each.reason}" for each in self.planned if each.label == label), "")
            lacks = f"no record of cell {label!r} ({ended})" if ended else f"no cell {label!r}"
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has {lacks}, which the pages need")
        return self.cells[label]

    def select(self, **wanted: Any) -> list[Cell]:
        """The cells behind the pages whose resolved request has all these values, in the order of the campaign.

        wanted: scene, measure, contact, newton, mesh, model, steps, or any setting. Of equal requests the first one;
        none that was refused before it was solved. Raises StoreError for another cell without a record.
        """
        matching = [
            each
            for each in self.planned
            if each.shown and (each.result or each.ended != "unsupported") and each.matches(wanted)
        ]
        unique: dict[str, Planned] = {}
        for each in matching:
            unique.setdefault(json.dumps(each.asked, sort_keys=True), each)
        return [self.cell(each.label) for each in unique.values()]

    def find(self, **wanted: Any) -> Cell:
        """The one cell of ``select``; raises StoreError when there is none, or more than one."""
        found = self.select(**wanted)
        if len(found) != 1:
            asked = ", ".join(f"{key} {value}" for key, value in wanted.items())
            names = (
                f" ({', '.join(repr(cell.label) for cell in found[:3])}{', ...' * (len(found) > 3)})" if found else ""
            )
            count = f"{len(found)} cells" if found else "no cell"
            raise StoreError(
                f"{self.path}: campaign {self.campaign!r} has {count}{names} with {asked}; the pages need one"
            )
        return found[0]

    def references_of(self, scene: str, quantity: str, kind: str) -> list[Mapping[str, Any]]:
        """The references of a quantity; raises StoreError when there is none."""
        wanted = {"scene": scene, "quantity": quantity, "kind": kind}
        found = [row for row in self.references if all(row[key] == value for key, value in wanted.items())]
        if not found:
            raise StoreError(f"{self.path / 'references.json'}: no {kind} reference for {quantity} of {scene}")
        return found

    def reference(self, scene: str, quantity: str, kind: str, **at: float) -> Mapping[str, Any]:
        """The one reference of a quantity at a load; raises StoreError when there is none."""
        for row in self.references_of(scene, quantity, kind):
            if all(row["at"].get(key) == value for key, value in at.items()):
                return row
        raise StoreError(f"{self.path / 'references.json'}: no {kind} reference for {quantity} of {scene} at {at}")

    def has_table(self, name: str) -> bool:
        """True when a table that no campaign makes by itself has been put there."""
        return (self.path / "tables" / f"{name}.csv").exists()

    def table(self, name: str) -> pd.DataFrame:
        """A table of the whole store, e.g. rigid_body; raises StoreError when it is missing or damaged."""
        return _read_table(self.path / "tables" / f"{name}.csv")

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
        return _read_table(self.path / "references" / name, columns, comment="#")


def load_store(path: Path, campaign: str | None = None) -> Store:
    """Read and check a campaign of a store, except for its tables; raises StoreError.

    Without a name it is the only one there: two are never mixed.
    """
    if not path.is_dir():
        raise StoreError(f"{path}: no such directory")
    index_path = path / "campaigns" / f"{campaign or _only(path)}.json"
    index = _checked(index_path, INDEX_KEYS)
    references = _checked(path / "references.json", ("schema", "references"))["references"]
    for row in references:
        _require(row, REFERENCE_KEYS, path / "references.json")
    planned = tuple(_planned(path, index_path, row) for row in index["cells"])
    cells = {
        row["label"]: Cell(
            *(each.label, each.scene, each.command, path / "cells" / str(each.id), each.result),
            *(row.get("expected", ""), row.get("group", "")),
        )
        for row, each in zip(index["cells"], planned, strict=True)
        if row["files"] and each.result is not None
    }
    return Store(path, index["campaign"], cells, tuple(references), planned, index["title"], index["pages"])


def _only(path: Path) -> str:
    """The name of the one campaign of a store; raises StoreError."""
    names = sorted(each.stem for each in (path / "campaigns").glob("*.json"))
    if len(names) > 1:
        raise StoreError(f"{path}: has the campaigns {', '.join(names)}; choose one by --campaign")
    if not names:
        old = path / "campaign.json"
        raise StoreError(
            f"{old}: schema 1, but this program reads {SCHEMA}" if old.exists() else f"{path}: no campaign"
        )
    return names[0]


def _planned(path: Path, index_path: Path, row: Mapping[str, Any]) -> Planned:
    """A row of the index with its record, its failure, or neither; raises StoreError for what cannot be read."""
    _require(row, CELL_KEYS, index_path)
    asked = row["request"] or {**row["options"], "settings": row["settings"]}
    head = (row["label"], row["id"], row["scene"], row["command"], asked)
    if row["id"] is None:
        return Planned(*head, "unsupported", row["reason"], None, bool(row["files"]))
    record = path / "cells" / f"{row['id']}.json"
    if record.exists():
        result = _checked(record, RECORD_KEYS)
        if result["id"] != row["id"] or result["scene"] != row["scene"]:
            raise StoreError(f"{record}: of cell {result['id']!r} of {result['scene']}, not of {row['label']!r}")
        _require_steps(result, record)
        return Planned(*head, result["class"], result["reason"], result, bool(row["files"]))
    failure = path / "failures" / f"{row['id']}.json"
    if failure.exists():
        found = _checked(failure, FAILURE_KEYS)
        return Planned(*head, found["class"], found["reason"], None, bool(row["files"]))
    return Planned(*head, "missing", "not solved yet", None, bool(row["files"]))


def _same(there: Any, wanted: Any) -> bool:
    """Are two values of a request the same? As written in JSON, infinity being a word and a path a list."""
    if isinstance(there, list):
        if isinstance(wanted, str):
            return "x".join(map(str, there)) == wanted
        return there == (list(wanted) if isinstance(wanted, list | tuple) else [wanted])
    return bool(there == ("inf" if wanted == math.inf else wanted))


def load_cell(directory: Path, label: str, command: str = "") -> Cell:
    """Read and check one solved request; raises StoreError."""
    result = _read_json(directory / "result.json", RESULT_KEYS)
    _require_steps(result, directory / "result.json")
    return Cell(label, result["scene"], command, directory, result)


def _require_steps(result: Mapping[str, Any], path: Path) -> None:
    for step in result["steps"]:
        _require(step, TYRE_STEP_KEYS if result["scene"] in TYRES else STEP_KEYS, path)


def _checked(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    """As _read_json, of this schema."""
    data = _read_json(path, ("schema",))
    if data["schema"] != SCHEMA:
        raise StoreError(f"{path}: schema {data['schema']!r}, but this program reads {SCHEMA}")
    _require(data, keys, path)
    return data


def _read_json(path: Path, keys: Iterable[str]) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise StoreError(f"{path}: missing") from None
    except (OSError, ValueError) as error:
        raise StoreError(f"{path}: cannot be read: {_one_line(error)}") from None
    _require(data, keys, path)
    return dict(data)


def _require(data: object, keys: Iterable[str], path: Path) -> None:
    if not isinstance(data, Mapping):
        raise StoreError(f"{path}: expected a record, found {type(data).__name__}")
    missing = [key for key in keys if key not in data]
    if missing:
        raise StoreError(f"{path}: lacks {', '.join(missing)}")


def _read_table(path: Path, columns: Iterable[str] = (), comment: str | None = None) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, comment=comment)
    except FileNotFoundError:
        raise StoreError(f"{path}: missing") from None
    except (OSError, ValueError) as error:
        raise StoreError(f"{path}: cannot be read: {_one_line(error)}") from None
    missing = [column for column in columns if column not in table]
    if missing:
        raise StoreError(f"{path}: lacks the columns {', '.join(missing)}")
    return table


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())
