"""The store as the reports see it: cells by label, their results and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

SCHEMA = 1
RESULT_KEYS = (
    *("scene", "measure", "contact", "newton", "mesh", "model", "settings", "outcome", "reason"),
    *("quantities", "steps", "counters", "timing_s", "provenance"),
)
CELL_KEYS = ("label", "id", "scene", "command")
REFERENCE_KEYS = ("scene", "quantity", "value", "at", "kind", "source", "uncertainty")
TYRES = ("tyre", "tyre-solid")
TYRE_STEP_KEYS = (
    *("delta_mm", "force_N", "centre_pressure_MPa", "contact_nodes", "half_length_mm", "half_width_mm", "kkt"),
    *("failures", "substeps"),
    *("newton_iterations", "central_asymmetry", "mirror_asymmetry"),
)
STEP_KEYS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(TYRES, TYRE_STEP_KEYS),
    "ring": ("delta_mm", "kkt", "failures", "rounding", "newton_iterations", "substeps"),
}
STATIC_STEP_KEYS = ("load_fraction", "kkt", "failures", "rounding", "newton_iterations", "substeps")
TABLE_COLUMNS = {
    "contact": ("delta_mm", "psi_deg", "phi_deg", "pressure_MPa", "gap_mm", "active"),
    "profile": (
        *("state", "delta_mm", "psi_deg"),
        *("inner_radial_mm", "inner_axial_mm", "outer_radial_mm", "outer_axial_mm"),
    ),
    "history": ("stage", "parameter", "iteration", "residual", "contact_nodes", "added", "removed"),
}
STORE_COLUMNS = {
    "rigid_body": ("measure", "surface", "motion", "theta_rad", "component", "strain", "declared", "largest"),
    "small_motions": ("measure", "surface", "motion", "amount", "strain", "declared", "largest"),
    "rotation_sweep": ("measure", "surface", "motion", "theta_rad", "strain", "declared"),
    "thickness_locking": ("load", "section", "nu", "elements", "stiffness_ratio", "law"),
    "shear_locking": ("l_over_h", "elements", "ratio", "two_node", "fully_integrated"),
    "curved_beam": ("h_over_R", "elements", "ratio"),
    "membrane_locking": (
        *("surface", "end", "membrane", "h_over_R", "elements", "energy_ratio", "energy_norm_error"),
        *("yardstick_reduced", "yardstick_unreduced"),
    ),
    "epsilon": (
        *("case", "form", "epsilon", "outcome", "iterations", "penetration_mm", "force_N", "force_error"),
        *("nodes_unlike", "condition"),
    ),
    "cycles": ("problem", "plain_period", "trial-and-error", "semismooth, settle 1", "semismooth"),
    "false_success": ("contender", "problems", "refused", "claimed", "false", "largest_error"),
    "symmetry": (
        *("check", "measure", "algorithm", "deviation", "rounding", "tolerance", "class", "reason"),
        *("contact_nodes", "nodes_unlike", "iterations", "iterations_other"),
    ),
    "extremes": ("map", "i", "j", "x", "y", "class", "asked", "complete", "reason", "iterations", "command"),
    "extremes_maps": ("map", "title", "x_label", "y_label", "y_named", "fixed"),
    "extremes_check": ("map", "points", "asked", "share", "distance", "unlike"),
    "mirror": (
        *("measure", "mesh", "gamma_deg", "kind", "outcome", "delta_mm", "negative", "command"),
        *("peak_MPa", "contact_nodes", "mirror_MPa", "mirror_both_MPa", "central_MPa"),
    ),
    "work_precision": ("element", "family", "mesh", "unknowns", "force_N", "error", "factorisation_s", "total_s"),
    "peers": ("program", "elements", "unknowns", "force_N", "seconds", "error", "ratio"),
    "scaling": (
        *(
            "mesh",
            "dofs",
            "elements",
            "elements_s",
            "scatter_s",
            "assembly_s",
            "factorisation_s",
            "solve_s",
            "contact_s",
        ),
        *("total_s", "same_matrix_s", "gemm_s", "copy_s", "peak_GiB", "repeats"),
    ),
    "ladders": ("ladder", "scene", "family", "quantity", "at", "mesh"),
}
CUT = "step cut"  # the words of a history event that say an attempt was rejected and repeated with a smaller step


class StoreError(ValueError):
    """A store that cannot be reported; its message is the one line the user reads."""


@dataclass(frozen=True, eq=False)
class Cell:
    """One solved request: ``result`` is result.json, the tables are read when asked for."""

    label: str
    scene: str
    command: str
    directory: Path
    result: Mapping[str, Any]

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
        history = self.table("history")
        if "event" not in history:
            return []
        return [str(event) for event in history["event"].dropna() if CUT in str(event)]


@dataclass(frozen=True, eq=False)
class Store:
    """A loaded store: ``cells`` by label in the order of the campaign, ``references`` as written by the scenes."""

    path: Path
    campaign: str
    cells: Mapping[str, Cell]
    references: tuple[Mapping[str, Any], ...]

    def cell(self, label: str) -> Cell:
        """The cell of a label; raises StoreError when the campaign has none."""
        if label not in self.cells:
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has no cell {label!r}, which the pages need")
        return self.cells[label]

    def matching(self, pattern: str) -> list[Cell]:
        """The cells whose whole label matches a regular expression; raises StoreError when there is none."""
        found = [cell for label, cell in self.cells.items() if re.fullmatch(pattern, label)]
        if not found:
            raise StoreError(f"{self.path}: campaign {self.campaign!r} has no cell {pattern!r}, which the pages need")
        return found

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
        return _read_table(self.path / "tables" / f"{name}.csv", STORE_COLUMNS[name])

    def reference_table(self, name: str, columns: Iterable[str] = ()) -> pd.DataFrame:
        """A raw reference table, its # lines skipped; raises StoreError when it is missing or damaged."""
        return _read_table(self.path / "references" / name, columns, comment="#")


def load_store(path: Path) -> Store:
    """Read and check a whole store except for its tables; raises StoreError."""
    if not path.is_dir():
        raise StoreError(f"{path}: no such directory")
    index = _read_json(path / "campaign.json", ("schema", "campaign", "cells"))
    if index["schema"] != SCHEMA:
        raise StoreError(f"{path / 'campaign.json'}: schema {index['schema']!r}, but this program reads {SCHEMA}")
    references = _read_json(path / "references.json", ("references",))["references"]
    for row in references:
        _require(row, REFERENCE_KEYS, path / "references.json")
    cells: dict[str, Cell] = {}
    for row in index["cells"]:
        _require(row, CELL_KEYS, path / "campaign.json")
        cells[row["label"]] = load_cell(path / "cells" / row["id"], row["label"], row["command"])
    return Store(path, index["campaign"], cells, tuple(references))


def load_cell(directory: Path, label: str, command: str = "") -> Cell:
    """Read and check one solved request; raises StoreError."""
    result = _read_json(directory / "result.json", RESULT_KEYS)
    for step in result["steps"]:
        _require(step, STEP_KEYS.get(result["scene"], STATIC_STEP_KEYS), directory / "result.json")
    return Cell(label, result["scene"], command, directory, result)


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


def _read_table(path: Path, columns: Iterable[str], comment: str | None = None) -> pd.DataFrame:
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
