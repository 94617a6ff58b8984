"""What a table shows unasked: settings that change nothing, and errors that stop at a wall.

A tolerance that changes neither a result nor a counter is not read, or there was nothing to stop early; both are said,
the second by the number of iterations. An error that stands still while the mesh goes on converging has met a wall:
the last digit of a printed reference, its uncertainty, or the formulation itself.
"""

from __future__ import annotations

import math
from decimal import Decimal

import pandas as pd

from studies.algorithm_settings import own_keys
from studies.analysis.cells.rows import keys, reference_rows
from studies.analysis.verify import CLAIMED, limits, siblings
from studies.request import text_of
from studies.result import SOLVED

FLAG_COLUMNS = ("flag", "scene", "subject", "cases", "of", "size", "cause", "label")
STANDS_STILL = 0.5  # of the error of the finest mesh: so much must be the wall for the error to count as standing
ALIKE = {
    "scene",
    "contact",
    "newton",
    "solver",
    "tolerance",
    "model",
    "steps",
    *own_keys(),
}  # another way to one answer
FEW_DIGITS = (4, 6)  # with so many a reference looks exact and is not; with less it is a round number


def flags(table: pd.DataFrame, references: pd.DataFrame | None = None) -> pd.DataFrame:
    """All flags with FLAG_COLUMNS: inert tolerances and inputs, walls; no row when there is nothing to say."""
    known = reference_rows(table) if references is None else references
    parts = [inert(table, "tolerance"), inert_inputs(table), walls(table, known)]
    return pd.concat([part for part in parts if len(part)] or [pd.DataFrame(columns=list(FLAG_COLUMNS))])


def inert(table: pd.DataFrame, setting: str) -> pd.DataFrame:
    """Algorithms on scenes in which a setting changes nothing at all, in any group of rows that differ in it only.

    subject: the contact algorithm and Newton's iteration, which should read it; cases, of: groups without any effect;
    size: the most Newton iterations there.
    """
    numbers = [str(name) for name in table if str(name).startswith(("q.", "c."))]
    groups = []
    for rows in siblings(table[table["outcome"].isin(CLAIMED)], setting):
        same = bool((rows[numbers].nunique(dropna=False) <= 1).all())
        iterations = float(rows["c.newton_iterations"].max()) if "c.newton_iterations" in rows else math.nan
        first = rows.iloc[0]
        groups.append((first["scene"], _who(first), same, iterations, first["label"]))
    frame = pd.DataFrame(groups, columns=["scene", "subject", "same", "iterations", "label"])
    found = []
    for (scene, subject), rows in frame.groupby(["scene", "subject"], sort=False):
        if rows["same"].all():
            most = rows["iterations"].max()
            cause = "one iteration: nothing to stop" if most <= 1 else "not read, or never what stops"
            found.append((f"inert {setting}", scene, subject, len(rows), len(rows), most, cause, rows["label"].iloc[0]))
    return pd.DataFrame(found, columns=list(FLAG_COLUMNS))


def inert_inputs(table: pd.DataFrame) -> pd.DataFrame:
    """Inputs of scenes that change no quantity in any group of converged rows that differ in them only, to the bit.

    Not those that are to change nothing: ALIKE. subject: the input; cases, of: groups without any effect; size: the
    most values in one of them.
    """
    solved = table[table["outcome"].isin(SOLVED)]
    numbers, found = [str(name) for name in solved if str(name).startswith("q.")], []
    for scene, rows in solved.groupby("scene", sort=False):
        names = dict.fromkeys(name for request in rows["request"] for name in request.values if name not in ALIKE)
        for name in names:
            values = rows["request"].map(lambda request, name=name: text_of(request.values.get(name)))
            groups = [own for _, own in rows.groupby(keys(rows, name), sort=False) if values[own.index].nunique() > 1]
            if groups and all(bool((own[numbers].nunique(dropna=False) <= 1).all()) for own in groups):
                most = max(values[own.index].nunique() for own in groups)
                first = groups[0]["label"].iloc[0]
                found.append(("inert input", scene, name, len(groups), len(groups), most, "no quantity changes", first))
    return pd.DataFrame(found, columns=list(FLAG_COLUMNS))


def _who(row: pd.Series) -> str:
    return " ".join(str(row[name]) for name in ("contact", "newton") if name in row and not pd.isna(row[name]))


def walls(table: pd.DataFrame, references: pd.DataFrame) -> pd.DataFrame:
    """References in front of which the error of a converging ladder stands still.

    size: the wall, relative: how far the limit of the ladder is from the reference.  cause: "digits" when that is no
    more than the last printed digit is worth, "uncertainty" when it is within the stated one, else "formulation".
    cases, of: ladders of one quantity and measure that stand, for this cause; label: the finest cell of the first one.
    """
    table = table[table["scene"].isin(table["scene"][table["label"].isin(references["label"])])]
    loose = {label for rows in siblings(table, "tolerance") for label in rows["label"].iloc[1:]}
    table = table[~table["label"].isin(loose)]  # their wall would be the solver's
    rows = limits(table).merge(references, on=["label", "quantity"])
    wall, error = (rows["limit"] - rows["value"]).abs(), (rows["finest"] - rows["value"]).abs()
    stands = rows["asymptotic"].astype(bool) & (wall >= STANDS_STILL * error) & (wall > rows["limit_uncertainty"])
    found = rows.assign(size=wall / rows["value"].abs(), subject=rows["quantity"] + " by " + rows["measure"])[stands]
    measured = found[["limit", "limit_uncertainty", "value", "uncertainty"]].to_numpy(float).tolist()
    found["cause"] = [_cause(*each) for each in measured]
    same = found.groupby(["scene", "subject", "cause"], sort=False, as_index=False).agg(
        cases=("label", "size"), of=("label", "size"), size=("size", "median"), label=("label", "first")
    )
    return same.assign(flag="wall")[list(FLAG_COLUMNS)]


def _cause(limit: float, limit_uncertainty: float, reference: float, uncertainty: float) -> str:
    off = abs(limit - reference)
    digits, last = printed(reference)
    if FEW_DIGITS[0] <= digits <= FEW_DIGITS[1] and off <= last + limit_uncertainty:
        return f"{digits} digits of the reference"
    return "uncertainty of the reference" if off <= uncertainty * abs(reference) else "formulation"


def printed(value: float) -> tuple[int, float]:
    """Number of significant digits of a value as it is written, and half of what the last one is worth.

    Zeros at the end are not known to be digits.
    """
    number = Decimal(repr(value)).normalize()
    exponent = number.as_tuple().exponent
    assert isinstance(exponent, int)
    return len(number.as_tuple().digits), 0.5 * 10.0**exponent
