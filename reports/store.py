"""The store as the reports see it: planned cells, their results and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from reports.cells import CELL_KEYS, Cell, planned_cell
from reports.reading import SCHEMA, StoreError, read_table, read_versioned, require

SHEETS = "sheets"  # the group of the cells that are drawn, which no other page means
INDEX_KEYS = ("schema", "campaign", "title", "pages", "cells")
REFERENCE_KEYS = ("scene", "quantity", "value", "at", "kind", "source", "uncertainty")
# columns of tables that may be empty; what is not there is an empty word
OF_A_REQUEST = "label command scene measure contact newton element model configuration settings quantity mesh"
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
        first one; none that was refused before it was solved, and none of a sheet unless by its group. Raises
        StoreError for another cell without a record.
        """
        unique: dict[str, Cell] = {}
        for each in self._by_scene[wanted["scene"]] if "scene" in wanted else self.planned:
            apart = each.group == SHEETS and "group" not in wanted
            if each.shown and not apart and (each.result or each.ended != "unsupported") and each.matches(wanted):
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

    def has(self, name: str) -> bool:
        """Is there a table that is of this campaign, or of none?"""
        found = (
            self._read(name) if (self.path / "tables" / f"{name}.csv").exists() else pd.DataFrame({"campaign": [""]})
        )
        return "campaign" not in found or bool((found["campaign"] == self.campaign).all())

    def table(self, name: str) -> pd.DataFrame:
        """A table of this campaign or of the whole store; raises StoreError when it is missing or another's."""
        found = self._read(name)
        if not self.has(name):
            raise StoreError(f"{self.path / 'tables' / name}.csv: not of campaign {self.campaign!r}")
        return found.copy()

    def _read(self, name: str) -> pd.DataFrame:
        """As it stands there, with empty words for what is not; each is read once."""
        if name not in self._tables:
            found = read_table(self.path / "tables" / f"{name}.csv", prose=PROSE.get(name, ()))
            empty = {
                column: found[column].astype(object).where(found[column].notna(), "") for column in WORDS & {*found}
            }
            self._tables[name] = found.assign(**empty)
        return self._tables[name]

    @cached_property
    def _tables(self) -> dict[str, pd.DataFrame]:
        return {}

    def rows(self, table: str, /, **where: str) -> pd.DataFrame:
        """The rows of a table with these words; no rows where it is not there, or is another campaign's."""
        found = self.table(table) if self.has(table) else pd.DataFrame(columns=[*where])
        for key, value in where.items():
            found = found[found[key].fillna("") == value]
        return found

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
    references = read_versioned(path / "references.json", ("schema", "references"))["references"]
    for row in references:
        require(row, REFERENCE_KEYS, path / "references.json")
    for row in index["cells"]:
        require(row, CELL_KEYS, index_path)
    planned = tuple(planned_cell(path, row) for row in index["cells"])
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
