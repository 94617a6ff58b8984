"""The solved cells of a campaign by the labels of its plan: records and tables, read when they are asked for."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.scene import UsageError
from studies.run.archive import Archive, DamagedError
from studies.scenes.complete import Cell

HERE = 1e-9  # loads this close are one


@dataclass(frozen=True, eq=False)
class Answer:
    """A cell with a record; ``files``: the directory of its tables."""

    label: str
    command: str
    record: Mapping[str, Any]
    files: Path

    @property
    def converged(self) -> bool:
        """True when every requested load was reached."""
        return bool(self.record["outcome"] == "converged")

    @property
    def settings(self) -> Mapping[str, Any]:
        """Every resolved setting."""
        return dict(self.record["settings"])

    @property
    def steps(self) -> list[dict[str, Any]]:
        """One record per load that was reached."""
        return list(self.record["steps"])

    @property
    def size(self) -> float:
        """Of its elements: 1 over their number along the first direction."""
        return 1 / int(self.record["mesh"].split("x")[0])

    def value(self, quantity: str, **at: float) -> float:
        """A number of the step at a load, or, without a load, of the whole path; NaN when it was not reached."""
        if not at:
            return number(self.record["quantities"].get(quantity)) if self.converged else math.nan
        for step in self.steps:
            if all(abs(step[key] - value) < HERE for key, value in at.items()):
                return number(step.get(quantity))
        return math.nan

    def table(self, name: str) -> pd.DataFrame:
        """A table of the cell, as contact or profile."""
        return pd.read_csv(self.files / f"{name}.csv")


@dataclass(frozen=True, eq=False)
class Answers:
    """A campaign of a store; planned: the rows of its index by label."""

    archive: Archive
    planned: Mapping[str, Mapping[str, Any]]

    @staticmethod
    def of(store: Path, campaign: str) -> Answers:
        """Those of a campaign; raises UsageError when the store has none of this name."""
        archive = Archive(Path(store))
        return Answers(archive, {row["label"]: row for row in archive.index(campaign)["cells"]})

    def get(self, label: str) -> Answer | None:
        """The answer of a cell, None where it is not planned or has no record; raises UsageError for a damaged one."""
        row = self.planned.get(label)
        if row is None or row["id"] is None:
            return None
        try:
            record = self.archive.record(row["id"])
        except DamagedError as error:
            raise UsageError(f"{error}; footprint run sets it aside and solves it again") from None
        if record is None:
            return None
        return Answer(label, row["command"], record, self.archive.files(row["id"]))

    def those(self, cells: Iterable[Cell]) -> list[Answer]:
        """The answers of cells that are planned and have one."""
        answers = (self.get(cell.label) for cell in cells)
        return [answer for answer in answers if answer is not None]


def number(value: Any) -> float:
    """A number of a record; null stands for NaN."""
    return math.nan if value is None else float(value)
