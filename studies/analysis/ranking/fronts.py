"""What accuracy costs: fronts of cost against verified error, per scene and per family of scenes.

An error below what the reference is uncertain by counts as that uncertainty: no cell is better than what is known. One
below what its formulation is off by counts as that: two errors have cancelled. An answer that is off by more than WRONG
beyond it is wrong, however fast: it is flagged and on no front. So is one whose formulation is that far off in any
quantity of the scene: on a coarse mesh two errors may cancel.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd

from studies.analysis.cells.rows import PRICES, mesh_ranks
from studies.analysis.verify import CLAIMED, family_of, headline, questions
from studies.result import UNSUPPORTED

WRONG = 0.1  # relative error from which an answer is none
TIE = 0.05  # of a cost: two that differ by less are equal
SAME = 0.01  # errors that differ by less of themselves are one: what is left is the solver's noise
COSTS = {"dofs": "c.dofs", **PRICES}
NAMES = ("measure", "contact", "newton", "element", "model", "tolerance")  # of a configuration, beside its mesh
SCENE_COLUMNS = (
    *("label", "scene", "family", "main", *NAMES, "mesh", "outcome", "path_end"),
    *("quantity", "error", "formulation_error", "uncertainty", "against"),
)


def on_front(cost: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Which are on the front (n,): no other has both at most as much cost and error, and less of one; NaN never is.

    Errors that differ by less than SAME of themselves count as equal; of equals the first one is. So do costs that
    differ by less than TIE: of those the most accurate one is.
    """
    front = np.zeros(len(cost), bool)
    best = np.inf
    for i in np.lexsort((error, cost)):
        if np.isfinite(cost[i]) and error[i] < (1 - SAME) * best:  # NaN is not below
            # of those that cost the same, the first with this error
            same = (cost == cost[i]) & (error * (1 - SAME) <= error[i])
            front[np.flatnonzero(same)[0]], best = True, error[i]
    on = np.flatnonzero(front)
    on = on[np.argsort(cost[on], kind="stable")]
    for cheaper, better in pairwise(on):
        front[cheaper] = cost[better] > (1 + TIE) * cost[cheaper]
    return front


def counting(rows: pd.DataFrame) -> pd.Series:
    """The error of each answer, no less than that of its formulation: on a coarse mesh two errors may cancel."""
    return rows[["error", "formulation_error"]].astype(float).max(axis=1, skipna=True).where(rows["error"].notna())


def fronts(table: pd.DataFrame, verified: pd.DataFrame) -> pd.DataFrame:
    """One row a planned cell and its scene's headline quantity: SCENE_COLUMNS, flag, and the fronts of each cost.

    Cells compete that were asked the same question; ``main`` is the one that the scene was asked most often.
    flag: "wrong", "failed" (no answer), "unsupported", "unverified", or "".  shown: the error that counts, NaN for a
    cell with a flag.  Columns ``cost.NAME`` and ``front.NAME``, and the request.
    """
    named = {scene: headline(table, scene) for scene in table["scene"].unique()}
    own = verified[verified["quantity"] == verified["scene"].map(named)]
    rows = priced(table).join(own.set_index("label")[list(SCENE_COLUMNS[-5:])], on="label")
    asked = questions(table)
    most_often = asked.groupby(table["scene"]).transform(lambda own: own.value_counts().index[0])
    rows = rows.assign(family=rows["scene"].map(family_of), main=asked == most_often)
    kinds = [name for name in COSTS if f"cost.{name}" in rows]
    rows = rows.reindex(columns=[*SCENE_COLUMNS, *(f"cost.{kind}" for kind in kinds), "command", "request"])
    beyond = np.maximum(rows["error"] - rows["uncertainty"], rows["label"].map(beyond_reference(verified)).fillna(0.0))
    flags = {
        "unsupported": rows["outcome"] == UNSUPPORTED,
        "failed": ~rows["outcome"].isin(CLAIMED),
        "wrong": (rows["outcome"] == "wrong") | (beyond > WRONG),
        "unverified": rows["error"].isna(),
    }
    rows["flag"] = np.select(list(flags.values()), list(flags), "")
    rows["shown"] = counting(rows).clip(lower=rows["uncertainty"].astype(float)).where(rows["flag"] == "")
    for kind in kinds:
        rows[f"front.{kind}"] = _fronts_of(asked, rows[f"cost.{kind}"], rows["shown"].to_numpy(float))
    return rows


def priced(table: pd.DataFrame) -> pd.DataFrame:
    """A collected table whose costs have the names of COSTS: ``cost.NAME``."""
    return table.rename(columns={column: f"cost.{name}" for name, column in COSTS.items()})


def beyond_reference(verified: pd.DataFrame) -> pd.Series:
    """By label, how far off the formulation is in any quantity of the scene; NaN where that is not known."""
    return verified.groupby("label")["formulation_error"].max()


def family_fronts(scenes: pd.DataFrame) -> pd.DataFrame:
    """One row a configuration of a family, solved and not wrong on all its scenes: geometric means over the scenes.

    scenes: of ``fronts``; the main question of each counts.
    rung: 0 the coarsest mesh of each scene.  Costs are over the smallest one of the scene.
    Columns: family, scenes, NAMES, rung, error, ``cost.NAME``, ``front.NAME``.
    """
    kinds = [name for name in COSTS if f"cost.{name}" in scenes]
    good = scenes[(scenes["flag"] == "") & scenes["main"]].copy()
    good["rung"] = mesh_ranks(good)
    for kind in kinds:
        good[f"cost.{kind}"] /= good.groupby("scene")[f"cost.{kind}"].transform("min")
    keys = ["family", *(name for name in NAMES if good[name].notna().any()), "rung"]
    numbers = ["shown", *(f"cost.{kind}" for kind in kinds)]
    logs = good.assign(**{name: np.log(good[name].astype(float)) for name in numbers})
    # several cells of one scene with the same names (other settings) count once, so that each scene has the same weight
    per_scene = logs.groupby([*keys, "scene"], dropna=False)[numbers].mean().reset_index()
    means = per_scene.groupby(keys, dropna=False).agg(scenes=("scene", "nunique"), **{n: (n, "mean") for n in numbers})
    whole = scenes.groupby("family")["scene"].nunique()
    found = means.reset_index()
    found = found[found["scenes"] == found["family"].map(whole)].copy()
    found[numbers] = np.exp(found[numbers])
    found = found.rename(columns={"shown": "error"})
    for kind in kinds:
        found[f"front.{kind}"] = _fronts_of(found["family"], found[f"cost.{kind}"], found["error"].to_numpy(float))
    return found.reset_index(drop=True)


def _fronts_of(group: pd.Series, cost: pd.Series, error: np.ndarray) -> np.ndarray:
    """Which are on the front of their own group."""
    values, front = cost.to_numpy(float), np.zeros(len(cost), bool)
    for own in cost.groupby(group.to_numpy()).indices.values():
        front[own] = on_front(values[own], error[own])
    return front
