"""Rows of the table that belong together, ladders of meshes, and the references that apply."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from studies.ask.request import Value
from studies.ask.scene import Reference
from studies.scenes.references import STEP_KEYS, holding
from studies.solving.result import SOLVED

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


def holds_from(holds: Sequence[bool] | np.ndarray | pd.Series) -> int:
    """The index of the first from which on something holds of all; as many as there are where it does not of the last.

    The one rule of what reaches an accuracy: a mesh that is within it counts with all finer ones, one may be by luck.
    """
    broken = np.flatnonzero(~np.asarray(holds, bool))
    return int(broken[-1]) + 1 if len(broken) else 0


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
    found = [
        (row["label"], quantity, each.value, each.uncertainty, each.kind, each.source)
        for row in table[table["outcome"].isin(SOLVED)].to_dict("records")
        for quantity, each in _applicable(row).items()
    ]
    rows = pd.DataFrame(found, columns=["label", "quantity", "value", "uncertainty", "kind", "source"])
    return rows.astype({"value": float, "uncertainty": float})


def _applicable(row: Mapping[Any, Any]) -> dict[str, Reference]:
    there: dict[str, Value | None] = {**row["request"].settings, "measure": row["request"].measure}
    for key in STEP_KEYS:  # the last step is what the table holds
        path = row.get(f"q.{key}", math.nan)
        if not isinstance(path, float) or math.isnan(path):
            values = there.get(key)
            path = values[-1] if isinstance(values, tuple) else values
        there = {**there, key: path}
    best: dict[str, Reference] = {}
    for reference in holding(row["scene"], there):
        if not pd.isna(row.get(f"q.{reference.quantity}", math.nan)):
            known = best.get(reference.quantity, reference)
            best[reference.quantity] = min(known, reference, key=lambda each: each.uncertainty)
    return best


def errors(table: pd.DataFrame, references: pd.DataFrame) -> pd.DataFrame:
    """``references`` with the column ``error``: relative distance of the cell's value from the reference."""
    values = references[["label", "quantity"]].merge(answers(table), how="left")["value"]
    return references.assign(error=(values.to_numpy() / references["value"] - 1).abs())
