"""Which configuration is good enough, and what is the cheapest? From the cells of a scene whose errors are verified.

A configuration qualifies when the upper confidence bound of its error, the verified error and what its reference is
uncertain by, meets the tolerance. Where its formulation alone is further off than the cell, two errors cancel by
chance: then the formulation's counts, and one that is wrong in any quantity of the scene is not advised for another.
Nothing is extrapolated: what no cell has shown is not advised.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from studies.analysis.fronts import COSTS, WRONG, beyond_reference, priced
from studies.analysis.rows import keys
from studies.analysis.verify import REFERENCE, choices, headline
from studies.complete import complete
from studies.request import Value, text_of
from studies.scene import UsageError
from studies.scenes import SCENES

CONFIGURATION = ("measure", "contact", "newton", "element")  # two cells that differ in one of them are two ways
COST = "seconds"  # what a user pays
STEPS = (0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001)
TARGETS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)  # of the table
COVER = 0.9  # of the interval of the seconds
ADVICE_COLUMNS = (
    *("scene", "quantity", "against", "tolerance", "cells", "label", "configuration", "bound"),
    *("cost", "seconds_low", "seconds", "seconds_high", "runner_up", "runner_up_ratio", "next_ratio", "command"),
)


@dataclass(frozen=True)
class Question:
    """Cells of one scene that answer the same question, verified against the same value.

    cells: rows of the table with value, error (no less than the formulation's), uncertainty, bound, ``cost.NAME``, and
    the price, which is one of them and sorts the rows.  cost: its name.
    """

    scene: str
    quantity: str
    against: str
    cost: str
    cells: pd.DataFrame

    @property
    def settings(self) -> dict[str, Value]:
        """What its cells share of their settings: all that may not be chosen to answer it."""
        settings, free = self.cells["request"].iloc[0].settings, choices()
        return {key: value for key, value in settings.items() if key not in free}

    @property
    def words(self) -> str:
        """The settings that are not the scene's defaults, for people."""
        usual = complete(self.scene, {})[1].settings if self.scene in SCENES else {}
        told = (f"{key}={text_of(value)}" for key, value in self.settings.items() if usual.get(key) != value)
        return " ".join(told) or "defaults"


@dataclass(frozen=True)
class Advice:
    """The cheapest cell that qualifies, the next configuration, the next tolerance; None where there is none.

    best, runner_up, next_best: rows of the question's cells. nearest: the cell with the smallest bound.
    """

    question: Question
    tolerance: float
    best: Mapping[str, Any] | None
    runner_up: Mapping[str, Any] | None
    next_step: float
    next_best: Mapping[str, Any] | None
    nearest: Mapping[str, Any]

    def times(self, other: Mapping[str, Any] | None) -> float:
        """What another cell costs over the best one; NaN where either is none."""
        return math.nan if other is None or self.best is None else other["price"] / self.best["price"]


def questions(table: pd.DataFrame, verified: pd.DataFrame, scene: str, quantity: str, cost: str) -> list[Question]:
    """What a scene was asked, each with its cells, the best answered first.

    Cells with a reference come before cells with a limit: where some have one, the others have solved another problem.
    """
    own = verified[(verified["scene"] == scene) & (verified["quantity"] == quantity) & verified["error"].notna()]
    own = own[~(own["label"].map(beyond_reference(verified)) > WRONG)]
    own = own.assign(error=own[["error", "formulation_error"]].max(axis=1))
    facts = own[["label", "value", "error", "uncertainty", "against", "reference", "formulation_error"]]
    cells = priced(table[(table["scene"] == scene) & (table["outcome"] == "converged")]).merge(facts, on="label")
    if cells.empty:
        return []
    cells = cells.assign(bound=cells["error"] + cells["uncertainty"], price=cells[f"cost.{cost}"])
    cells = cells.dropna(subset="price").sort_values("price", kind="stable")
    found = []
    for _, rows in cells.groupby(keys(cells, *choices()), sort=False):
        referred = rows["against"].str.startswith(REFERENCE)
        answered = rows[referred] if referred.any() else rows
        for against, same in answered.groupby("against", sort=False):
            found.append(Question(scene, quantity, str(against), cost, same.reset_index(drop=True)))
    return sorted(found, key=lambda question: -len(question.cells))


def asked_question(
    table: pd.DataFrame,
    verified: pd.DataFrame,
    scene: str,
    quantity: str | None = None,
    settings: Mapping[str, str] | None = None,
    cost: str = COST,
) -> Question:
    """The question that is meant: the largest one with these settings. Raises UsageError when there is none."""
    known = sorted(set(table["scene"]))
    if scene not in known:
        raise UsageError(f"scene {scene!r} is not in this campaign; it has {', '.join(known)}")
    if COSTS.get(cost) not in table:
        raise UsageError(f"cost {cost!r} must be one of {', '.join(k for k, v in COSTS.items() if v in table)}")
    name = quantity or headline(table, scene) or ""
    there = sorted(set(verified["quantity"][(verified["scene"] == scene) & verified["error"].notna()]))
    if name not in there:
        raise UsageError(f"{scene} has no verified quantity {name!r}; it has {', '.join(there) or 'none'}")
    found = questions(table, verified, scene, name, cost)
    wanted = _parsed(scene, settings or {})
    for question in found:
        if wanted.items() <= question.settings.items():
            return question
    has = "; ".join(question.words for question in found)
    raise UsageError(f"{scene} was not solved with {dict(settings or {})}; it was with: {has}")


def _parsed(scene: str, given: Mapping[str, str]) -> dict[str, Value]:
    """The values of settings; those that the scene does not have stay texts."""
    known = {setting.key: setting for setting in SCENES[scene].settings} if scene in SCENES else {}
    return {key: known[key].parse(text) if key in known else text for key, text in given.items()}


def advise(question: Question, tolerance: float) -> Advice:
    """The advice for a relative error."""
    cells = question.cells
    best = _cheapest(cells, tolerance)
    runner_up = next_best = None
    step = next((each for each in STEPS if each < 0.999 * tolerance), math.nan)
    if best is not None:
        ways = cells[list(CONFIGURATION)].agg(" ".join, axis=1)
        other = cells[ways != ways[cells["label"] == best["label"]].iloc[0]]
        runner_up = _cheapest(other, tolerance)
        next_best = _cheapest(cells, step)
    nearest = _cheapest(cells.sort_values("bound", kind="stable"), math.inf)
    assert nearest is not None
    return Advice(question, tolerance, best, runner_up, step, next_best, nearest)


def _cheapest(cells: pd.DataFrame, tolerance: float) -> dict[str, Any] | None:
    """The first cell, in the order of cost, whose bound meets the tolerance."""
    good = cells[cells["bound"] <= tolerance]
    return None if good.empty else {str(key): value for key, value in good.iloc[0].to_dict().items()}


def seconds_interval(question: Question, cell: Mapping[str, Any]) -> tuple[float, float, float]:
    """Seconds that a cell takes, and between what: its operations by the law of all its cells, with their spread.

    log seconds = a + b log operations over the cells of the scene; NaN when there are less than three.
    """
    timed = question.cells.reindex(columns=["cost.operations", "cost.seconds"]).astype(float)
    timed = timed[(timed > 0).all(axis=1)]
    if len(timed) < 3 or timed["cost.operations"].nunique() < 2:
        return math.nan, math.nan, math.nan
    x, y = np.log(timed.to_numpy().T)
    law = np.polyfit(x, y, 1)
    at = float(np.polyval(law, math.log(cell["cost.operations"])))
    low, high = np.quantile(y - np.polyval(law, x), [(1 - COVER) / 2, (1 + COVER) / 2])
    return math.exp(at + low), math.exp(at), math.exp(at + high)


def advice_table(table: pd.DataFrame, verified: pd.DataFrame, cost: str = COST) -> pd.DataFrame:
    """The advice for every scene, its largest question and headline, at each of TARGETS; empty where none qualifies."""
    rows = []
    for scene in dict.fromkeys(table["scene"]):
        found = questions(table, verified, scene, headline(table, scene) or "", cost)
        for target in TARGETS if found else ():
            rows.append(_advice_row(advise(found[0], target)))
    return pd.DataFrame(rows, columns=list(ADVICE_COLUMNS))


def _advice_row(advice: Advice) -> list[object]:
    question, best = advice.question, advice.best
    named = [question.scene, question.quantity, question.against, advice.tolerance, len(question.cells)]
    if best is None:
        return [*named, "", "", advice.nearest["bound"], *[math.nan] * 4, "", math.nan, math.nan, ""]
    numbers = [best["bound"], best["price"], *seconds_interval(question, best)]
    others: list[object] = ["" if advice.runner_up is None else words_of(advice.runner_up)]
    others += [advice.times(advice.runner_up), advice.times(advice.next_best)]
    return [*named, best["label"], words_of(best), *numbers, *others, best["command"]]


def lines(advice: Advice) -> Iterator[str]:
    """The advice for a terminal."""
    question, cost = advice.question, advice.question.cost
    asked = f"{question.scene}, {question.quantity} within {advice.tolerance:.3g} of {question.against}"
    if advice.best is None:
        near = advice.nearest
        yield f"{asked}: none qualifies of {len(question.cells)} cells"
        yield f"nearest: error at most {100 * near['bound']:.3g} %, {words_of(near)}"
        yield f"  {near['command']}"
        return
    low, at, high = seconds_interval(question, advice.best)
    yield asked
    yield f"cheapest: {words_of(advice.best)}: error at most {100 * advice.best['bound']:.3g} %"
    yield f"  {advice.best['command']}"
    yield f"  {advice.best['price']:.4g} {cost}, about {at:.2g} s on this machine, in [{low:.2g}, {high:.2g}] s"
    told = [("runner-up", advice.runner_up, "no other configuration qualifies")]
    if not math.isnan(advice.next_step):
        told.append((f"next step, {100 * advice.next_step:g} %", advice.next_best, "none qualifies"))
    for name, other, without in told:
        words = without if other is None else f"{words_of(other)}: {advice.times(other):.3g} times the {cost}"
        yield f"{name}: {words}"


def words_of(cell: Mapping[str, Any]) -> str:
    """The configuration of a cell, its mesh and its tolerance."""
    words = [cell[name] for name in (*CONFIGURATION, "mesh") if cell[name]]
    return " ".join(words) + ("" if pd.isna(cell["tolerance"]) else f", tolerance {cell['tolerance']:g}")
