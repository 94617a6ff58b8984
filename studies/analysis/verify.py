"""The verified error of every cell, and how much of it is the formulation's.

A cell is verified against the scene's reference where one holds for its settings, else against the Richardson limit of
the finest ladder of the same request: all that was asked but the mesh and how it is solved. The ladder is one with
the exact measure, where there is one: another measure is an approximation of it, and what it loses is an error; else
one of its own measure. Which one it is, is said. Errors are relative. The formulation's is the distance of the limit
of the cell's own ladder, with the tightest tolerance, from the reference, where more than both are uncertain by.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.ask.scene import judged_of
from studies.ask.settings import own_keys
from studies.run.answers import answers, keys, ladders, quantities, reference_rows
from studies.scenes import SCENES
from studies.scenes.complete import STEP_KEYS
from studies.solving.refinement.richardson import limit_of
from studies.solving.result import SOLVED, WRONG

CLAIMED = (*SOLVED, WRONG)  # outcomes with a value that somebody might believe
HOW = (
    "mesh",
    "lines",
    "grading",
    "contact",
    "newton",
    "steps",
    "model",
    "sector_deg",
    "tolerance",
    "solver",
    "epsilon",
)
ELEMENT = ("element", "interpolation", "thickness_strain", "membrane")
COLUMNS = ("label", "scene", "quantity", "value", "against", "uncertainty", "error", "formulation_error")
LIMIT_NAMES = ("ladder", "asked", "quantity", "scene", "measure", "label")
LIMIT_NUMBERS = ("size", "tolerance", "epsilon", "limit", "limit_uncertainty")
REFERENCE, LIMIT = "reference", "limit"
EXACT = "exact"  # the measure that the others approximate


def how() -> tuple[str, ...]:
    """What is not solved, but how: with the parameters of every algorithm of the catalogue."""
    return (*HOW, *own_keys())


def choices() -> tuple[str, ...]:
    """What may be chosen to answer; all else is the question."""
    return ("measure", *ELEMENT, *how())


def headline(table: pd.DataFrame, scene: str) -> str | None:
    """The quantity by which a scene is judged when none is named: the first of its ladder, else the first it has."""
    known = judged(table, scene)
    return known[0] if known else None


def judged(table: pd.DataFrame, scene: str) -> list[str]:
    """The quantities of a scene that are verified: those of its ladders, else those with references, else all."""
    rows = table[table["scene"] == scene]
    there = [name for name in quantities(table) if name not in STEP_KEYS and rows[f"q.{name}"].notna().any()]
    named = judged_of(SCENES[scene]) if scene in SCENES else ()
    return [name for name in named if name in there] or [name for name in there if not name.endswith("asymmetry")]


def questions(table: pd.DataFrame) -> pd.Series:
    """What each cell was asked: its request without all that may be chosen to answer it."""
    return keys(table, *choices())


def verified(table: pd.DataFrame, references: pd.DataFrame | None = None) -> pd.DataFrame:
    """One row a quantity of a cell that claims an answer, with COLUMNS; NaN where one is not known.

    references: as of reference_rows, which is asked when they are not given.
    """
    rows = _claims(table)
    limit, known = limits(table), reference_rows(table) if references is None else references
    # of ladders that were asked the same: the finest mesh, then the tightest tolerance, then the stiffest contact
    ranked = limit.sort_values(
        ["size", "tolerance", "epsilon"], ascending=[True, True, False], na_position="first", kind="stable"
    )
    own = _beside(rows, limit, "ladder", "quantity")
    tight = _beside(rows.assign(ladder=rows["tight"]), limit, "ladder", "quantity").fillna(own)
    exact, best = (_beside(each, ranked, "asked", "measure", "quantity") for each in (rows.assign(measure=EXACT), rows))
    best = exact.fillna(best)
    best = best.where(best["limit"] != 0)  # errors are relative
    reference = _beside(rows, known, "label", "quantity")

    words = (f"{REFERENCE}: " + reference["kind"]).fillna(f"{LIMIT} of " + best["label"]).fillna("")
    wanted = reference["value"].fillna(best["limit"])
    uncertainty = reference["uncertainty"].fillna(best["limit_uncertainty"] / best["limit"].abs())
    scale = wanted.abs().fillna(own["limit"].abs()).fillna(rows["value"].abs())
    scale = scale.where(scale > 0)
    off, within = (tight["limit"] - wanted).abs() / scale, uncertainty + tight["limit_uncertainty"] / scale
    checked = rows.assign(
        **{"against": words, "uncertainty": uncertainty, "error": (rows["value"] - wanted).abs() / scale},
        formulation_error=off.where(~(off <= within), 0.0),
    )
    return checked[list(COLUMNS)]


def _claims(table: pd.DataFrame) -> pd.DataFrame:
    """One row a judged quantity of a cell with an answer: its value, and the keys of what it is compared with.

    ladder: all that was asked but the mesh.  tight: that with the tightest tolerance.  asked: the question.
    """
    claimed = table[table["outcome"].isin(CLAIMED)]
    ordered = table.sort_values("tolerance", ascending=False, na_position="first", kind="stable")
    tightest = dict(zip(keys(ordered, "mesh", "tolerance"), keys(ordered, "mesh"), strict=True))
    rows = claimed[["label", "scene", "measure", "tolerance"]].assign(
        ladder=keys(claimed, "mesh"),
        tight=keys(claimed, "mesh", "tolerance").map(tightest),
        asked=keys(claimed, *how(), "measure"),
        quantity=claimed["scene"].map({scene: judged(table, scene) for scene in claimed["scene"].unique()}),
    )
    return rows.explode("quantity").merge(answers(claimed), on=["label", "quantity"])


def _beside(rows: pd.DataFrame, other: pd.DataFrame, *by: str) -> pd.DataFrame:
    """For each row the first one of the other table that agrees in some columns; NaN where there is none."""
    first = other.drop_duplicates(list(by)).set_index(list(by))
    return first.reindex(pd.MultiIndex.from_frame(rows[list(by)])).set_axis(rows.index)


def limits(table: pd.DataFrame) -> pd.DataFrame:
    """One row a judged quantity of a ladder, with LIMIT_NAMES and LIMIT_NUMBERS: its limit.

    label: the cell on the finest mesh.  ladder, asked: the keys of what it was asked, the second one without all that
    may be chosen to answer, but the measure.
    """
    rows: list[tuple[object, ...]] = []
    names = {scene: judged(table, scene) for scene in table["scene"].unique()}
    for rungs in ladders(table):
        last = rungs.iloc[-1]
        asked = last["request"].key(("mesh",)), last["request"].key((*how(), "measure"))
        who = [last[name] for name in LIMIT_NAMES[3:]] + [last.get(name, math.nan) for name in LIMIT_NUMBERS[:3]]
        for name in names[last["scene"]]:
            values = rungs[f"q.{name}"].astype(float).tolist()
            if not np.isnan(values).any():
                limit = limit_of(rungs["size"].tolist(), values)
                rows.append((*asked, name, *who, limit.value, limit.uncertainty))
    return pd.DataFrame(rows, columns=[*LIMIT_NAMES, *LIMIT_NUMBERS]).astype(dict.fromkeys(LIMIT_NUMBERS, float))
