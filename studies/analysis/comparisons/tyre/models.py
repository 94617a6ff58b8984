"""What a part of the tyre saves and whether it gives the whole, and which grids reach an error of the force."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.run.campaigns.report_cells import MODELS
from studies.run.cells.answers import HERE, Answer, Answers
from studies.run.cells.rows import holds_from

DELTA = 20.0  # mm
SAME = 1e-9  # relative difference below which a part of the tyre gives the whole
BEHIND = 2  # finer grids that a grid needs to have reached an error
WITHIN = (0.01, 0.002)  # errors of the force that an engineer asks for
COLUMNS = ("plies", "model", "mesh", "force_off", "pressure_off", "same", "operations_share", "label", "command")
FOUND = ("mesh", "unknowns", "force_N", "error", "own_s", "total_s")  # of a grid that reaches an error
REACHING_COLUMNS = ("within", "element", "family", *FOUND, "share")


def tyre_models(answers: Answers) -> pd.DataFrame:
    """COLUMNS, a row a model: force and largest nodal pressure relative to those of the whole; operations over its.

    pressure_off: infinite for another contact set; NaN where DELTA was not reached.
    """
    found = answers.those(MODELS)
    wholes = {_plies(each): each for each in found if each.record["model"] == "full"}
    rows: list[list[object]] = []
    for each in found:
        if (whole := wholes.get(_plies(each))) is None:
            continue
        off = differences(each, whole)
        share = _operations(each) / _operations(whole)
        named = [_plies(each), each.record["model"], each.record["mesh"]]
        rows.append([*named, *off, max(off) <= SAME, share, each.label, each.command])
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _operations(answer: Answer) -> float:
    """Of all that was computed, the same on every machine; NaN where a record has none."""
    return float(answer.record["counters"].get("operations") or math.nan)


def _plies(answer: Answer) -> str:
    return "isotropic" if "E_MPa" in answer.settings else "angle plies"


def differences(part: Answer, whole: Answer) -> tuple[float, float]:
    """Force and largest nodal pressure at DELTA relative to the whole."""
    force = abs(part.value("force_N", delta_mm=DELTA) / whole.value("force_N", delta_mm=DELTA) - 1)
    if math.isnan(force):
        return math.nan, math.nan
    tables = (each.table("contact") for each in (part, whole))
    own, other = (table[(table["delta_mm"] - DELTA).abs() < HERE] for table in tables)
    if not np.array_equal(own["active"], other["active"]):
        return force, math.inf
    pressures = own["pressure_MPa"].to_numpy(), other["pressure_MPa"].to_numpy()
    return force, float(np.max(np.abs(pressures[0] - pressures[1])) / np.max(pressures[1]))


def grids_reaching(grids: pd.DataFrame) -> pd.DataFrame:
    """REACHING_COLUMNS, a row an error of WITHIN, element and family: the smallest grid that reaches it, or NaN.

    grids: of work_precision_study.  share: of the unknowns of the uniform grid that reaches the same.
    """
    rows = []
    for within in WITHIN:
        for element, own in grids.groupby("element", sort=False):
            found = {str(family): reaching(each, within) for family, each in own.groupby("family", sort=False)}
            uniform = found.get("uniform")
            for family, grid in found.items():
                row = {} if grid is None else grid.to_dict()
                if grid is not None and uniform is not None:
                    row["share"] = grid["unknowns"] / uniform["unknowns"]
                rows.append({**row, "within": within, "element": element, "family": family})
    return pd.DataFrame(rows, columns=list(REACHING_COLUMNS))


def reaching(grids: pd.DataFrame, error: float) -> pd.Series | None:
    """The smallest grid from which on it and every larger one, BEHIND at the least, stay below the error; None if none.

    A force goes up and down with the place of the rim of the patch between the lines: one good grid may be chance, and
    the last grid of a family has nothing behind it.
    """
    rows = grids.sort_values("unknowns")
    first = holds_from(~(rows["error"].abs() > error))
    return rows.iloc[first] if first + BEHIND < len(rows) else None
