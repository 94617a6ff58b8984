"""Rows of the table that belong together: what a command says, ladders of meshes, and the references that apply.

Two cells differ in nothing but the mesh when their commands without ``--mesh`` are the same words; so for a setting.
"""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import pandas as pd

from studies.scene import Reference, UsageError, Value
from studies.scenes import SCENES
from studies.solve import resolve

STEP_KEYS = ("load_fraction", "delta_mm")  # what grows along a path; all else that a reference names is a setting
ERROR, ORDER = "error.", "order."  # prefixes of derived columns, as q. and c. are of collected ones


def parsed(command: str) -> tuple[str, dict[str, Any], dict[str, str]]:
    """Scene, options and settings of ``footprint solve SCENE --option value --set key=value ... --out DIR``."""
    words = shlex.split(command)[2:]
    scene, rest = words[0], words[1:]
    options: dict[str, Any] = {}
    settings: dict[str, str] = {}
    for name, value in zip(rest[::2], rest[1::2], strict=True):
        if name == "--set":
            key, _, text = value.partition("=")
            settings[key] = text
        elif name == "--steps":
            options["steps"] = int(value)
        elif name != "--out":
            options[name.removeprefix("--")] = value
    return scene, options, settings


def without(command: str, *names: str) -> str:
    """The command without some options and settings, for the comparison with others."""
    head, pairs = _pairs(command)
    return " ".join([head, *(words for name, words in pairs if name not in names)])


@cache
def _pairs(command: str) -> tuple[str, tuple[tuple[str, str], ...]]:
    """``footprint solve SCENE`` and, by name, the words of each option and setting."""
    words = shlex.split(command)
    pairs = zip(words[3::2], words[4::2], strict=True)
    named = (
        (value.split("=")[0] if name == "--set" else name.removeprefix("--"), name, value) for name, value in pairs
    )
    return " ".join(words[:3]), tuple((key, f"{name} {value}") for key, name, value in named)


def ladders(table: pd.DataFrame, fewest: int = 3) -> Iterator[pd.DataFrame]:
    """Converged rows that differ in the mesh only, coarse to fine, with their sizes in the column ``size``.

    The size is 1/n1, or 1/n2 where only that one changes.
    """
    solved = table[table["outcome"] == "converged"]
    if solved.empty:
        return
    key = solved["command"].map(lambda command: without(command, "mesh"))
    for _, rows in solved.groupby(key, sort=False):
        if len(rows) < fewest:
            continue
        refined = rows["n1"] if rows["n1"].nunique() > 1 else rows["n2"]
        rungs = rows.assign(size=1 / refined.astype(float)).sort_values("size", ascending=False)
        rungs = rungs.drop_duplicates("size", keep="last")
        if len(rungs) >= fewest:
            yield rungs


def quantities(table: pd.DataFrame) -> list[str]:
    """Names of the quantities of a table, without their prefix."""
    return [str(name).removeprefix("q.") for name in table if str(name).startswith("q.")]


def reference_rows(table: pd.DataFrame) -> pd.DataFrame:
    """One row for each quantity of a cell that has a reference: label, quantity, value, uncertainty, kind, source.

    Of several references that hold where the cell was solved, the least uncertain is taken; none that is zero, because
    errors are relative.
    """
    found = []
    for row in table[table["outcome"] == "converged"].to_dict("records"):
        for quantity, reference in _applicable(row).items():
            found.append(
                {
                    "label": row["label"],
                    "quantity": quantity,
                    "value": reference.value,
                    "uncertainty": reference.uncertainty,
                    "kind": reference.kind,
                    "source": reference.source,
                }
            )
    return pd.DataFrame(found, columns=["label", "quantity", "value", "uncertainty", "kind", "source"])


def _applicable(row: Mapping[Any, Any]) -> dict[str, Reference]:
    there = _settings(str(row["command"]))
    for key in STEP_KEYS:  # the last step is what the table holds
        path = row.get(f"q.{key}", math.nan)
        if not isinstance(path, float) or math.isnan(path):
            values = there.get(key)
            path = values[-1] if isinstance(values, tuple) else values
        there = {**there, key: path}
    best: dict[str, Reference] = {}
    scene = SCENES.get(row["scene"])  # a campaign may bring scenes of its own, which are not loaded here
    for reference in scene.references if scene is not None else ():
        value = row.get(f"q.{reference.quantity}", math.nan)
        holds = all(_same(there.get(key), at) for key, at in reference.at.items())
        if reference.value == 0.0 or pd.isna(value) or not holds:
            continue
        known = best.get(reference.quantity)
        if known is None or reference.uncertainty < known.uncertainty:
            best[reference.quantity] = reference
    return best


def _same(there: Value | None, at: float | str) -> bool:
    if isinstance(there, int | float) and isinstance(at, int | float):
        return math.isclose(there, at, rel_tol=1e-9, abs_tol=1e-12)
    return there == at


@cache
def _settings(command: str) -> Mapping[str, Value | None]:
    """All settings of a cell, defaults included; none when the request does not resolve."""
    scene, options, settings = parsed(command)
    try:
        _, request = resolve(scene, settings, **options)
    except UsageError:
        return {}
    return {**request.settings, "measure": request.measure}


def errors(table: pd.DataFrame, references: pd.DataFrame) -> pd.DataFrame:
    """``references`` with the column ``error``: relative distance of the cell's value from the reference."""
    values = table.set_index("label")
    found = [
        abs(float(str(values.at[row["label"], f"q.{row['quantity']}"])) / row["value"] - 1)
        for row in references.to_dict("records")
    ]
    return references.assign(error=found)
