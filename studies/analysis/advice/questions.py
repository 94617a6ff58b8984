"""The questions that the cells of a campaign answer: one scene, one quantity, one statement of the problem.

A cell qualifies for a tolerance when the upper confidence bound of its error, the verified error and what its reference
is uncertain by, meets it, and those of all finer meshes of the same configuration do: a value that crosses its
reference proves no accuracy. Where its formulation alone errs more than the cell, two errors cancel by chance: then
the formulation's counts, and one that is wrong in any quantity of the scene answers none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pandas as pd

from studies.analysis.verify import REFERENCE, choices, headline, judged
from studies.ask.request import Value, text_of
from studies.ask.scene import Setting, UsageError
from studies.run.answers import PRICES, keys
from studies.scenes import SCENES
from studies.scenes.complete import complete

CONFIGURATION = ("measure", "contact", "newton", "element")  # two cells that differ in one of them are two ways
COST = "seconds"  # what a user pays
COSTS = {"dofs": "c.dofs", **PRICES}
TIE = 0.05  # of a price: two that differ by less are equal
WRONG = 0.1  # relative error from which an answer is none


@dataclass(frozen=True)
class Question:
    """Cells of one scene that answer the same question, verified against the same value.

    settings: what they share of their settings, as text: all that may not be chosen to answer it.
    cells: rows of the table with value, error (no less than that of finer meshes, and the formulation's), uncertainty,
    bound, ``cost.NAME``, and the price, which is one of them and sorts the rows.  cost: its name.
    """

    scene: str
    quantity: str
    against: str
    cost: str
    settings: Mapping[str, str]
    cells: pd.DataFrame

    @property
    def values(self) -> dict[str, Value]:
        """The settings as the scene reads them."""
        known = _known(self.scene)
        return {key: known[key].parse(text) if key in known else text for key, text in self.settings.items()}

    @property
    def words(self) -> str:
        """The settings that are not the scene's defaults, for people."""
        usual = complete(self.scene, {})[1].settings if self.scene in SCENES else {}
        texts = {key: text_of(value) for key, value in usual.items()}
        changed = (f"{key}={text}" for key, text in self.settings.items() if texts.get(key) != text)
        return " ".join(changed) or "defaults"


def questions(table: pd.DataFrame, verified: pd.DataFrame, scene: str, quantity: str, cost: str) -> list[Question]:
    """What a scene was asked, each with its cells, the best answered first.

    Cells with a reference come before cells with a limit: where some have one, the others have solved another problem.
    """
    own = verified[(verified["scene"] == scene) & (verified["quantity"] == quantity) & verified["error"].notna()]
    beyond = verified.groupby("label")["formulation_error"].max()  # in any quantity of the scene
    own = own[~(own["label"].map(beyond) > WRONG)]
    own = own.assign(error=own[["error", "formulation_error"]].max(axis=1))
    facts = own[["label", "value", "error", "uncertainty", "against"]]
    cells = table[(table["scene"] == scene) & (table["outcome"] == "converged")].merge(facts, on="label")
    cells = cells.rename(columns={column: f"cost.{name}" for name, column in COSTS.items()})
    if cells.empty:
        return []
    cells = cells.assign(error=_lasting(cells), price=cells[f"cost.{cost}"])
    cells = cells.assign(bound=cells["error"] + cells["uncertainty"])
    cells = cells.dropna(subset="price").sort_values("price", kind="stable")
    every, free = [], choices()
    for _, rows in cells.groupby(keys(cells, *free), sort=False):
        shared = {k: text_of(v) for k, v in rows["request"].iloc[0].settings.items() if k not in free}
        referred = rows["against"].str.startswith(REFERENCE)
        answered = rows[referred] if referred.any() else rows
        for against, same in answered.groupby("against", sort=False):
            every.append(Question(scene, quantity, str(against), cost, shared, same.reset_index(drop=True)))
    return sorted(every, key=lambda question: -len(question.cells))


def _lasting(cells: pd.DataFrame) -> pd.Series:
    """The largest error of each cell and of those that differ from it in a finer mesh alone, against the same value."""
    elements = cells["n1"].astype(float) * cells["n2"].astype(float)
    fine_first = cells.assign(elements=-elements, way=keys(cells, "mesh")).sort_values("elements", kind="stable")
    return fine_first.groupby(["way", "against"], sort=False)["error"].cummax().reindex(cells.index)


def cheapest_of(good: pd.DataFrame, error: str, price: str = "price") -> pd.Series:
    """Of cells that are good enough the one with the least price; of a tie the one with the least ``error``."""
    tied = good[good[price] <= (1 + TIE) * good[price].min()]
    return tied.sort_values([error, price], kind="stable").iloc[0]


def all_questions(table: pd.DataFrame, verified: pd.DataFrame) -> Iterator[Question]:
    """Of every scene and quantity that is judged, the headline of the scene first."""
    for scene in dict.fromkeys(table["scene"]):
        first = headline(table, scene)
        for name in dict.fromkeys([*([first] if first else []), *judged(table, scene)]):
            yield from questions(table, verified, scene, name, COST)


def asked_question(
    table: pd.DataFrame,
    verified: pd.DataFrame,
    scene: str,
    quantity: str | None = None,
    settings: Mapping[str, str] | None = None,
    cost: str = COST,
) -> Question:
    """The question that is meant: the largest one with these settings. Raises UsageError when there is none."""
    known_scene(scene, table["scene"])
    if COSTS.get(cost) not in table:
        raise UsageError(f"cost {cost!r} must be one of {', '.join(k for k, v in COSTS.items() if v in table)}")
    there = sorted(set(verified["quantity"][(verified["scene"] == scene) & verified["error"].notna()]))
    name = known_quantity(scene, quantity or headline(table, scene) or "", there)
    return meant(questions(table, verified, scene, name, cost), scene, settings or {})


def known_scene(scene: str, scenes: pd.Series) -> None:
    """Raises UsageError for a scene that was not solved."""
    if scene not in set(scenes):
        raise UsageError(f"scene {scene!r} is not in this campaign; it has {', '.join(sorted(set(scenes)))}")


def known_quantity(scene: str, name: str, there: list[str]) -> str:
    """The name; raises UsageError for one that was not verified."""
    if name not in there:
        raise UsageError(f"{scene} has no verified quantity {name!r}; it has {', '.join(there) or 'none'}")
    return name


def meant(candidates: list[Question], scene: str, settings: Mapping[str, str]) -> Question:
    """The first question with these settings; raises UsageError when there is none."""
    wanted = _parsed(scene, settings)
    for question in candidates:
        if wanted.items() <= question.settings.items():
            return question
    has = "; ".join(question.words for question in candidates)
    asked = " ".join(f"{key}={text}" for key, text in settings.items())
    raise UsageError(f"{scene} was not solved with {asked}; it was with: {has}")


def _parsed(scene: str, given: Mapping[str, str]) -> dict[str, str]:
    """The texts of settings as they are resolved; those that the scene does not have stay as they are."""
    known = _known(scene)
    return {key: text_of(known[key].parse(text)) if key in known else text for key, text in given.items()}


def _known(scene: str) -> dict[str, Setting]:
    """The settings of a scene by key; none of one that a campaign has brought."""
    return {setting.key: setting for setting in SCENES[scene].settings} if scene in SCENES else {}
