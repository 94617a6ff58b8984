"""The tables that advice is given from where there is no store: those of the standard campaign, shipped beside this.

Of the cells of a question only those are kept that no other of the same configuration beats in error and in all prices.
After a new standard campaign ``make advice STORE=DIR`` copies them from the tables of its store.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from studies.analysis.advice.questions import (
    CONFIGURATION,
    COST,
    COSTS,
    Question,
    all_questions,
    known_quantity,
    known_scene,
    meant,
)
from studies.ask.scene import UsageError

HERE = Path(__file__).parent
CELLS, QUESTIONS, SUMMARY = "advice_cells", "advice_questions", "held_out_summary"
PRICES = tuple(f"cost.{name}" for name in COSTS)
CELL_COLUMNS = (
    *("question", "label", *CONFIGURATION, "mesh", "tolerance", "bound"),
    *(*PRICES, "t.seconds_low", "t.seconds_high", "command"),
)
QUESTION_COLUMNS = ("question", "scene", "quantity", "against", "cells", "settings")
DIGITS = 5


def shipped_tables(table: pd.DataFrame, verified: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """What is kept of a campaign: its questions, and the cells that may be advised, by the numbers of these."""
    asked, cells = [], []
    for number, question in enumerate(all_questions(table, verified)):
        settings = " ".join(f"{key}={text}" for key, text in question.settings.items())
        whole = len(question.cells)
        asked.append([number, question.scene, question.quantity, question.against, whole, settings])
        kept = _unbeaten(question.cells.reindex(columns=sorted({*question.cells.columns, *CELL_COLUMNS})))
        cells.append(kept.assign(question=number)[list(CELL_COLUMNS)])
    found = pd.concat(cells, ignore_index=True) if cells else pd.DataFrame(columns=list(CELL_COLUMNS))
    for name in ("bound", "cost.seconds", "t.seconds_low", "t.seconds_high"):
        found[name] = found[name].map(lambda value: float(f"{value:.{DIGITS}g}"))
    return {QUESTIONS: pd.DataFrame(asked, columns=list(QUESTION_COLUMNS)), CELLS: found}


def _unbeaten(cells: pd.DataFrame) -> pd.DataFrame:
    """Those of each configuration that are best in something."""
    kept = []
    for _, own in cells.groupby(list(CONFIGURATION), sort=False, dropna=False):
        values = own[["bound", *PRICES]].to_numpy(float)
        beaten = [np.any(np.all(values <= row, axis=1) & np.any(values < row, axis=1)) for row in np.nan_to_num(values)]
        kept.append(own[~np.array(beaten)])
    return pd.concat(kept).sort_values("price", kind="stable")


def shipped_question(
    scene: str,
    quantity: str | None = None,
    settings: Mapping[str, str] | None = None,
    cost: str = COST,
    directory: Path = HERE,
) -> Question:
    """The question that is meant, from the shipped tables; raises UsageError when there is none."""
    asked = pd.read_csv(directory / f"{QUESTIONS}.csv", keep_default_na=False)
    known_scene(scene, asked["scene"])
    if cost not in COSTS:
        raise UsageError(f"cost {cost!r} must be one of {', '.join(COSTS)}")
    own = asked[asked["scene"] == scene]
    name = known_quantity(scene, quantity or str(own["quantity"].iloc[0]), sorted(set(own["quantity"])))
    cells = pd.read_csv(directory / f"{CELLS}.csv", dtype=dict.fromkeys(CONFIGURATION, str))
    cells = cells.fillna(dict.fromkeys(CONFIGURATION, "")).assign(price=cells[f"cost.{cost}"])
    found = []
    for row in own[own["quantity"] == name].to_dict("records"):
        texts = dict(pair.split("=", 1) for pair in str(row["settings"]).split())
        its = cells[cells["question"] == row["question"]].sort_values("price", kind="stable", ignore_index=True)
        found.append(Question(scene, name, str(row["against"]), cost, texts, its))
    return meant(found, scene, settings or {})


def worth(store: Path | None = None) -> str:
    """How sure such advice is, in one line: of a store's tables, else of the shipped ones; empty where not known."""
    own = None if store is None else store / "tables" / f"{SUMMARY}.csv"
    path = own if own is not None and own.exists() else HERE / f"{SUMMARY}.csv"
    row = pd.read_csv(path).query("quantities == 'headline'").to_dict("records")[0]
    if not row["advised"]:
        return ""
    return (
        f"how sure: on {row['scenes']:.0f} scenes left out it met the tolerance in {100 * row['met']:.0f} % of"
        f" {row['advised']:.0f} cases, at {row['median_regret']:.2f} times the least price in the median,"
        f" {row['mean_regret']:.2f} in the mean, {row['worst_regret']:.1f} at worst;"
        f" over {row['dear']:.1f} in {100 * row['share_above']:.0f} %"
    )
