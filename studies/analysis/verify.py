"""The verified error of every cell, and how much of it is the mesh's, the solver's, the formulation's, the reference's.

A cell is verified against the scene's reference where one holds for its settings, else against the Richardson limit of
the finest ladder of the same request: all that was asked but the mesh and how it is solved. The ladder is one with
the exact measure, where there is one: another measure is an approximation of it, and what it loses is an error; else
one of its own measure. Which one it is, is said. Errors are relative.

    |value - reference| <= mesh + solver + formulation + reference
    mesh         |value - limit of the cell's own ladder|
    solver       |value - that with the tightest tolerance|; of the tightest one, what the law of the tolerances leaves
    formulation  |limit of the same with the tightest tolerance - reference|, where more than both are uncertain by
    reference    its stated uncertainty
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from studies.algorithm_settings import own_keys
from studies.analysis.richardson import Limit, limit_of
from studies.analysis.rows import STEP_KEYS, keys, ladders, quantities, reference_rows
from studies.campaigns.ladder_cells import LADDERS
from studies.scenes import SCENES

CLAIMED = ("converged", "wrong")  # outcomes with a value that somebody might believe
HOW = ("mesh", "contact", "newton", "steps", "model", "sector_deg", "tolerance", "solver", "epsilon")
ELEMENT = ("element", "interpolation", "thickness_strain", "membrane")
PARTS = ("mesh", "solver", "formulation", "reference")
COLUMNS = (
    *("label", "scene", "quantity", "value", "against", "reference", "uncertainty", "error"),
    *("mesh_error", "order", "asymptotic", "solver_error", "formulation_error", "reference_error", "largest"),
)
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
    named = dict.fromkeys(name for ladder in LADDERS if ladder.scene == scene for name in ladder.quantities)
    if not named and scene in SCENES:
        named = dict.fromkeys(reference.quantity for reference in SCENES[scene].references)
    return [name for name in named if name in there] or [name for name in there if not name.endswith("asymmetry")]


def questions(table: pd.DataFrame) -> pd.Series:
    """What each cell was asked: its request without all that may be chosen to answer it."""
    return keys(table, *choices())


def main_questions(table: pd.DataFrame) -> pd.Series:
    """Whether a cell belongs to the question that its scene was asked most often."""
    asked = questions(table)
    most = {scene: own.value_counts().index[0] for scene, own in asked.groupby(table["scene"], sort=False)}
    return asked == table["scene"].map(most)


def family_of(scene: str) -> str:
    """The family of a scene, as on the page of convergence."""
    return next((ladder.family for ladder in LADDERS if ladder.scene == scene), scene)


def verified(table: pd.DataFrame, references: pd.DataFrame | None = None) -> pd.DataFrame:
    """One row a quantity of a cell that claims an answer, with COLUMNS; NaN where a part is not known.

    references: as of reference_rows, which is asked when they are not given.
    """
    claimed = table[table["outcome"].isin(CLAIMED)]
    known = reference_rows(table) if references is None else references
    by_cell = {(row["label"], row["quantity"]): row for row in known.to_dict("records")}
    own, best = limits(table)
    solver, tightest = _solver_parts(claimed), _tightest(table)
    names = {scene: judged(table, scene) for scene in claimed["scene"].unique()}
    rows, free = [], (*how(), "measure")
    for cell in claimed.to_dict("records"):
        ladder, asked = cell["request"].key(("mesh",)), cell["request"].key(free)
        tight_ladder = tightest[cell["request"].key(("mesh", "tolerance"))]
        for name in names[cell["scene"]]:
            value = float(cell.get(f"q.{name}", math.nan))
            if not math.isnan(value):
                limit = own.get((ladder, name))
                tight = own.get((tight_ladder, name), limit)
                limits_there = (best.get((asked, measure, name)) for measure in (EXACT, str(cell["measure"])))
                against = _against(by_cell.get((cell["label"], name)), next(filter(None, limits_there), None))
                left = solver.get((cell["label"], name), math.nan)
                rows.append(_row(cell, name, value, against, (limit, tight), left))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _against(reference: dict[Any, Any] | None, limit: tuple[str, Limit] | None) -> tuple[str, float, float]:
    """What a cell is verified against in words, its value, its relative uncertainty; NaN when there is nothing."""
    if reference is not None:
        return f"{REFERENCE}: {reference['kind']}", float(reference["value"]), float(reference["uncertainty"])
    if limit is None or limit[1].value == 0.0:
        return "", math.nan, math.nan
    label, found = limit
    return f"{LIMIT} of {label}", found.value, found.uncertainty / abs(found.value)


def _row(
    cell: dict[Any, Any],
    name: str,
    value: float,
    against: tuple[str, float, float],
    limits_there: tuple[Limit | None, Limit | None],
    solver: float,
) -> list[object]:
    """limits_there: of the cell's own ladder, and of the same with the tightest tolerance."""
    words, reference, uncertainty = against
    own, tight = limits_there
    scale = abs(reference) if words else abs(own.value) if own is not None else abs(value)
    mesh = math.nan if own is None else abs(value - own.value) / scale
    parts = {"mesh": mesh, "solver": solver / scale if scale else math.nan, "reference": uncertainty}
    if words and tight is not None:
        off = abs(tight.value - reference) / scale
        parts["formulation"] = off if off > uncertainty + tight.uncertainty / scale else 0.0
    present = {part: size for part, size in parts.items() if not math.isnan(size)}
    return [
        *(cell["label"], cell["scene"], name, value, words, reference, uncertainty),
        abs(value - reference) / scale if words else math.nan,
        mesh,
        math.nan if own is None else own.order,
        bool(own is not None and own.asymptotic),
        *(parts.get(part, math.nan) for part in PARTS[1:]),
        max(present, key=lambda part: present[part]) if present else "",
    ]


def limits(table: pd.DataFrame) -> tuple[dict[tuple[str, str], Limit], dict[tuple[str, str, str], tuple[str, Limit]]]:
    """Limits of each ladder by its key without the mesh, and of the finest ladder of each request and measure.

    Of ladders with the same finest mesh the one with the tightest tolerance counts, and of those the stiffest contact.
    """
    own: dict[tuple[str, str], Limit] = {}
    best: dict[tuple[str, str, str], tuple[str, Limit]] = {}
    ranks: dict[tuple[str, str, str], tuple[float, ...]] = {}
    names: dict[str, list[str]] = {}
    free = (*how(), "measure")
    for rungs in ladders(table):
        finest = rungs.iloc[-1]
        rank = (float(finest["size"]), _number(finest, "tolerance", 0.0), -_number(finest, "epsilon", math.inf))
        scene = str(finest["scene"])
        if scene not in names:
            names[scene] = judged(table, scene)
        for name in names[scene]:
            values = rungs[f"q.{name}"].to_numpy(float)
            if np.isnan(values).any():
                continue
            limit = limit_of(rungs["size"].tolist(), values.tolist())
            own[finest["request"].key(("mesh",)), name] = limit
            key = finest["request"].key(free), str(finest["measure"]), name
            if key not in ranks or rank < ranks[key]:
                ranks[key], best[key] = rank, (str(finest["label"]), limit)
    return own, best


def _tightest(table: pd.DataFrame) -> dict[str, str]:
    """By the key without mesh and tolerance, the one without mesh that has the tightest tolerance."""
    tolerance = (
        pd.to_numeric(table["tolerance"], errors="coerce") if "tolerance" in table else pd.Series(0.0, table.index)
    )
    ordered = table.iloc[np.argsort(-tolerance.fillna(0.0).to_numpy(float), kind="stable")]
    return dict(zip(keys(ordered, "mesh", "tolerance"), keys(ordered, "mesh"), strict=True))


def _number(row: pd.Series, name: str, default: float) -> float:
    """A setting of a row; the default where the scene has none."""
    value = pd.to_numeric(row.get(name, default), errors="coerce")
    return default if pd.isna(value) else float(value)


def _solver_parts(claimed: pd.DataFrame) -> dict[tuple[str, str], float]:
    """By label and quantity, the distance to the answer with the tightest tolerance, in the unit of the quantity.

    What is left in the tightest one itself: errors proportional to the tolerance, from its distance to the next one.
    """
    return {
        (str(label), name): distance
        for _, own in claimed.groupby("scene", sort=False)
        for name in judged(own, str(own["scene"].iloc[0]))
        for rows in siblings(own.dropna(subset=[f"q.{name}"]), "tolerance")
        for label, distance in _distances(rows, name)
    }


def siblings(table: pd.DataFrame, setting: str) -> Iterator[pd.DataFrame]:
    """Rows that differ in one numerical setting only, at least two of its values, sorted by it."""
    if setting not in table:
        return
    rows = table.assign(**{setting: pd.to_numeric(table[setting], errors="coerce")}).dropna(subset=[setting])
    for _, group in rows.groupby(keys(rows, setting), sort=False):
        if group[setting].nunique() > 1:
            yield group.sort_values(setting)


def _distances(rows: pd.DataFrame, name: str) -> Iterator[tuple[str, float]]:
    values, tolerances = rows[f"q.{name}"].to_numpy(float), rows["tolerance"].to_numpy(float)
    off = np.abs(values - values[0])
    looser = tolerances > tolerances[0]  # one request may stand in several rows
    share = tolerances[0] / tolerances[looser][0]
    off[~looser] = off[looser][0] * share / (1 - share)
    yield from zip(rows["label"], off.tolist(), strict=True)
