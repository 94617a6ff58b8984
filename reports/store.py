"""The store as the reports see it: planned cells, their results and tables, the references; all checked on entry.

Nothing is computed here beyond looking things up. Whatever is wrong with a store ends in one StoreError of one line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd

from reports.cells import CELL_KEYS, Cell, planned_cell
from reports.reading import StoreError, read_table, read_versioned, require

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
