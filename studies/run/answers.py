"""The solved cells of a campaign by the labels of its plan: records and tables, read when they are asked for.

Rows of their table that belong together, ladders of meshes, the references that apply, and tables to be taken away: of
these seconds are rounded to 4 digits, all else to 10. Cells are numbered in the order of the table, and answers
name theirs. What a column is stands in ``columns.csv``, by its kind: of what was asked and what became of it, the
letter of a collected column, or of answers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from studies.ask.request import Value
from studies.ask.scene import Reference, UsageError
from studies.run.archive import Archive, DamagedError
from studies.scenes.complete import STEP_KEYS, Cell, closest
from studies.solving.result import SOLVED

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


REFINED = 1.3  # between two meshes of a ladder at the least, as Roache and ASME V&V 20 ask for: else an order is noise
PRICES = {"seconds": "t.seconds", "operations": "c.operations"}  # what an answer costs, each of them all of it
ERROR, ORDER = "error.", "order."  # prefixes of derived columns, as q. and c. are of collected ones


def keys(table: pd.DataFrame, *without: str) -> pd.Series:
    """What each cell was asked but for some fields and settings: the same for rows that differ in nothing else."""
    return table["request"].map(lambda request: request.key(without))


def ladders(table: pd.DataFrame, fewest: int = 3) -> Iterator[pd.DataFrame]:
    """Solved rows that differ in the mesh only, coarse to fine, with their sizes in the column ``size``.

    Meshes that are hardly coarser than the next are left out.
    """
    solved = table[table["outcome"].isin(SOLVED)]
    if solved.empty:
        return
    for _, rows in solved.groupby(keys(solved, "mesh"), sort=False):
        if len(rows) < fewest:
            continue
        rungs = rows.assign(size=sizes(rows)).sort_values("size", ascending=False, kind="stable")
        rungs = rungs.drop_duplicates("size", keep="last")
        rungs = rungs[_apart(rungs["size"].tolist())]
        if len(rungs) >= fewest:
            yield rungs


def sizes(rows: pd.DataFrame) -> pd.Series:
    """Of the elements: 1/n1, or 1/n2 where only that one changes."""
    return 1 / (rows["n1"] if rows["n1"].nunique() > 1 else rows["n2"]).astype(float)


def _apart(sizes: Sequence[float]) -> list[bool]:
    """Which sizes, coarse to fine, stay when each must be REFINED times the next finer one that stays."""
    stays = [True] * len(sizes)
    finer = sizes[-1]
    for i in range(len(sizes) - 2, -1, -1):
        stays[i] = sizes[i] >= REFINED * finer
        finer = sizes[i] if stays[i] else finer
    return stays


def quantities(table: pd.DataFrame) -> list[str]:
    """Names of the quantities of a table, without their prefix."""
    return [str(name).removeprefix("q.") for name in table if str(name).startswith("q.")]


def answers(table: pd.DataFrame) -> pd.DataFrame:
    """One row for each quantity that a cell has: label, quantity, value, and its PRICES, NaN where not known."""
    values = table.set_index("label")[[f"q.{name}" for name in quantities(table)]].astype(float)
    long = values.rename(columns=lambda name: name.removeprefix("q.")).melt(var_name="quantity", ignore_index=False)
    costs = table.set_index("label").reindex(columns=list(PRICES.values())).set_axis(list(PRICES), axis=1)
    return long.dropna().join(costs.astype(float)).reset_index()


def reference_rows(table: pd.DataFrame) -> pd.DataFrame:
    """One row for each quantity of a cell that has a reference: label, quantity, value, uncertainty, kind, source.

    Of several references that hold where the cell was solved, the least uncertain is taken; none that is zero, because
    errors are relative.
    """
    references = [
        (row["label"], quantity, each.value, each.uncertainty, each.kind, each.source)
        for row in table[table["outcome"].isin(SOLVED)].to_dict("records")
        for quantity, each in _applicable(row).items()
    ]
    rows = pd.DataFrame(references, columns=["label", "quantity", "value", "uncertainty", "kind", "source"])
    return rows.astype({"value": float, "uncertainty": float})


def _applicable(row: Mapping[Any, Any]) -> dict[str, Reference]:
    there: dict[str, Value | None] = {**row["request"].settings, "measure": row["request"].measure}
    for key in STEP_KEYS:  # the last step is what the table holds
        path = row.get(f"q.{key}", math.nan)
        if not isinstance(path, float) or math.isnan(path):
            values = there.get(key)
            path = values[-1] if isinstance(values, tuple) else values
        there = {**there, key: path}
    reached = {str(key).removeprefix("q.") for key, value in row.items() if str(key)[:2] == "q." and not pd.isna(value)}
    return closest(row["scene"], there, reached)


def errors(table: pd.DataFrame, references: pd.DataFrame) -> pd.DataFrame:
    """``references`` with the column ``error``: relative distance of the cell's value from the reference."""
    values = references[["label", "quantity"]].merge(answers(table), how="left")["value"]
    return references.assign(error=(values.to_numpy() / references["value"] - 1).abs())


DIGITS, OF_SECONDS = 10, 4
CLOCK = "s"  # unit of what is rounded as seconds
FILE = Path(__file__).with_name("columns.csv")
DESCRIBED: dict[tuple[str, str], tuple[str, str]] = {  # unit and description by kind and name
    (kind, name): (unit, words)
    for kind, name, unit, words in pd.read_csv(FILE, keep_default_na=False).to_numpy().tolist()
}
ASKED, ANSWERS = ([name for kind, name in DESCRIBED if kind == each] for each in ("asked", "answers"))
PREFIXES = {"asked": "", "c": "", "w": "operations_", "t": "time_", "k": "residual_"}  # of published columns, by kind


def published(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables data_cells, data_answers and data_columns of a collected table."""
    numbered = pd.concat([table, pd.Series(range(len(table)), table.index, name="cell")], axis=1)
    collected = {name: ("asked", name) for name in ASKED}
    collected |= {name: (name[0], name[2:]) for name in map(str, numbered) if name[1:2] == "." and name[0] in PREFIXES}
    kept = {name: _renamed(*of) for name, of in collected.items()}
    rows = [("cells", kept[name], *_described(*of)) for name, of in collected.items()]
    rows += [("answers", name, *_described("answers", name)) for name in ANSWERS]
    columns = pd.DataFrame(rows, columns=["table", "column", "unit", "description"])
    cells, values = numbered[list(kept)].rename(columns=kept), _answers(table, numbered)
    return {"data_cells": _rounded(cells, columns), "data_answers": _rounded(values, columns), "data_columns": columns}


def _answers(table: pd.DataFrame, numbered: pd.DataFrame) -> pd.DataFrame:
    own = answers(table)[["label", "quantity", "value"]]
    known = reference_rows(table).rename(columns={"value": "reference"})
    joined = own.merge(known, how="left", on=["label", "quantity"]).merge(numbered[["label", "cell"]], on="label")
    joined["error"] = joined["value"] / joined["reference"] - 1
    return joined.sort_values("cell", kind="stable")[ANSWERS]


def _renamed(kind: str, name: str) -> str:
    """The name that a collected column is published under: seconds and counters have no prefix."""
    return name if name.startswith("seconds") else PREFIXES[kind] + name


def _described(kind: str, name: str) -> tuple[str, str]:
    """Unit and description of a column; a counter that a part from outside keeps has its name alone."""
    return DESCRIBED.get((kind, name), ("", name.replace("_", " ")))


def _rounded(table: pd.DataFrame, columns: pd.DataFrame) -> pd.DataFrame:
    units = columns.set_index("column")["unit"].to_dict()
    return table.assign(
        **{
            str(name): _significant(table[name], OF_SECONDS if units[name] == CLOCK else DIGITS)
            for name in table.select_dtypes("float")
        }
    )


def _significant(values: pd.Series, digits: int) -> pd.Series:
    return values.map(lambda value: float(f"{value:.{digits}g}"))
