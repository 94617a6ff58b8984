"""Which configuration is good enough, and what is the cheapest? From the cells of a question, in what a user pays.

Nothing is extrapolated: what no cell has shown is not advised. Prices within TIE of one another are a tie, which the
smaller error decides: another run may turn them.

Where there is no store, advice is given from the tables of the standard campaign, shipped beside this. Of the cells of
a question only those are kept that no other of the same configuration beats in error and in all prices. After a new
standard campaign ``make advice STORE=DIR`` copies them from the tables of its store.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from studies.analysis.advice.questions import (
    CONFIGURATION,
    COST,
    COSTS,
    TIE,
    Question,
    all_questions,
    asked_question,
    cheapest_of,
    known_quantity,
    known_scene,
    meant,
)
from studies.analysis.verify import verified
from studies.ask.request import Request
from studies.ask.scene import UsageError

STEPS = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001)


@dataclass(frozen=True)
class Advice:
    """The cheapest cell that qualifies, the next configuration, the next tolerance; None where there is none.

    best, runner_up, next_best: rows of the question's cells.  by_operations: the one with the fewest operations.
    nearest: the cell with the smallest bound.
    """

    question: Question
    tolerance: float
    best: Mapping[str, Any] | None
    runner_up: Mapping[str, Any] | None
    next_step: float
    next_best: Mapping[str, Any] | None
    by_operations: Mapping[str, Any] | None
    nearest: Mapping[str, Any]

    def times(self, other: Mapping[str, Any] | None) -> float:
        """What another cell costs over the best one; NaN where either is none."""
        return math.nan if other is None or self.best is None else other["price"] / self.best["price"]


def advise(question: Question, tolerance: float) -> Advice:
    """The advice for a relative error."""
    cells = question.cells
    best = cheapest(cells, tolerance)
    runner_up = next_best = None
    step = next((each for each in STEPS if each < 0.999 * tolerance), math.nan)
    if best is not None:
        ways = cells[list(CONFIGURATION)].agg(" ".join, axis=1)
        other = cells[ways != ways[cells["label"] == best["label"]].iloc[0]]
        runner_up = cheapest(other, tolerance)
        next_best = cheapest(cells, step)
    counted = cells.reindex(columns=[*cells.columns[cells.columns != "cost.operations"], "cost.operations"])
    by_operations = cheapest(counted.dropna(subset="cost.operations"), tolerance, "cost.operations")
    nearest = _row(cells.sort_values("bound", kind="stable").iloc[0])
    return Advice(question, tolerance, best, runner_up, step, next_best, by_operations, nearest)


def cheapest(cells: pd.DataFrame, tolerance: float, price: str = "price") -> dict[str, Any] | None:
    """The cell with the least price whose bound meets the tolerance; of a tie the one with the smallest bound."""
    good = cells[cells["bound"] <= tolerance]
    if good.empty:
        return None
    return _row(cheapest_of(good, "bound", price))


def _row(cell: pd.Series) -> dict[str, Any]:
    return {str(key): value for key, value in cell.to_dict().items()}


PRICED = ("cost.seconds", "t.seconds_low", "t.seconds_high", "cost.operations", "cost.dofs")


def lines(advice: Advice) -> Iterator[str]:
    """The advice for a terminal."""
    question, cost = advice.question, advice.question.cost
    asked = f"{question.scene}, {question.quantity} within {advice.tolerance:.3g} of {question.against}"
    best = advice.best
    if best is None:
        near = advice.nearest
        yield f"{asked}: none qualifies of {len(question.cells)} cells"
        yield f"nearest: error at most {100 * near['bound']:.3g} %, {words_of(near)}"
        yield f"  {near['command']}"
        return
    yield asked
    yield from _of_one_measure(question.cells)
    yield f"cheapest: {words_of(best)}: error at most {100 * best['bound']:.3g} %"
    yield f"  {best['command']}"
    yield f"  {_prices(best)}"
    offers = [("runner-up", advice.runner_up, "no other configuration qualifies")]
    if not math.isnan(advice.next_step):
        offers.append((f"next step, {100 * advice.next_step:g} %", advice.next_best, "none qualifies"))
    if advice.by_operations is not None and advice.by_operations["label"] != best["label"]:
        offers.append(("by operations", advice.by_operations, ""))
    for name, other, without in offers:
        words = without if other is None else f"{words_of(other)}: {advice.times(other):.3g} times the {cost}"
        tied = other is not None and abs(advice.times(other) - 1) <= TIE
        yield f"{name}: {words}{', a tie' if tied else ''}"


def _of_one_measure(cells: pd.DataFrame) -> Iterator[str]:
    """What a reference that holds for one measure says nothing of: whether that measure is enough."""
    (measure, *others) = dict.fromkeys(cells["measure"])
    if not others and measure != Request.measure:
        yield f"of measure {measure} alone: the error of {measure} against {Request.measure} is not known"


def _prices(cell: Mapping[str, Any]) -> str:
    seconds, low, high, operations, unknowns = (float(cell.get(name, math.nan)) for name in PRICED)
    timed = "in one run" if math.isnan(low) else f"[{low:.3g}, {high:.3g}] in repeated runs"
    return f"{seconds:.3g} s of processor time, {timed}; {unknowns:.0f} unknowns, {operations:.3g} operations"


def words_of(cell: Mapping[str, Any]) -> str:
    """The configuration of a cell, its mesh and its tolerance."""
    words = [cell[name] for name in (*CONFIGURATION, "mesh") if cell[name]]
    return " ".join(words) + ("" if pd.isna(cell["tolerance"]) else f", tolerance {cell['tolerance']:g}")


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
    rounded = pd.concat(cells, ignore_index=True) if cells else pd.DataFrame(columns=list(CELL_COLUMNS))
    for name in ("bound", "cost.seconds", "t.seconds_low", "t.seconds_high"):
        rounded[name] = rounded[name].map(lambda value: float(f"{value:.{DIGITS}g}"))
    return {QUESTIONS: pd.DataFrame(asked, columns=list(QUESTION_COLUMNS)), CELLS: rounded}


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
    shipped = []
    for row in own[own["quantity"] == name].to_dict("records"):
        texts = dict(pair.split("=", 1) for pair in str(row["settings"]).split())
        its = cells[cells["question"] == row["question"]].sort_values("price", kind="stable", ignore_index=True)
        shipped.append(Question(scene, name, str(row["against"]), cost, texts, its))
    return meant(shipped, scene, settings or {})


def question_of(
    scene: str, quantity: str | None, settings: Mapping[str, str], cost: str, store: Path | None, campaign: str
) -> Question:
    """The question that is meant, of a campaign in a store, or of the shipped tables; raises UsageError without one."""
    if store is None:
        return shipped_question(scene, quantity, settings, cost)
    from studies.run.collect import collect  # advice from what is shipped does without a store

    table = collect(store, campaign)
    return asked_question(table, verified(table), scene, quantity, settings, cost)


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
