"""Cells that were put to an algorithm and not solved, each with its cause: what its path ends at, or what failed."""

from __future__ import annotations

import pandas as pd

from studies.analysis.ranking.profiles import NOT_ASKED
from studies.result import SOLVED

COLUMNS = ("scene", "measure", "mesh", "outcome", "path_end", "at", "at_low", "at_high", "found_by", "cells")
UNSOLVED_COLUMNS = (*COLUMNS, "contacts", "why", "command")
ALIKE = 3  # digits to which the parameters of two ends are the same


def unsolved(table: pd.DataFrame) -> pd.DataFrame:
    """One row for all cells of a scene, measure and mesh that end alike: UNSOLVED_COLUMNS.

    path_end: kind of the end of the path of the problem itself, empty for a failure; at, at_low, at_high: its parameter
    in the unit of the path; found_by: arc length, or the tangent.  contacts: the algorithms, with a comma.  why: the
    reason of the first cell, and ``command`` what solves it.  table: of collect.collect.
    """
    rows = table.reindex(columns=[*table.columns.union(["path_end", "path_end_at", "path_end_by", "reason"])])
    rows = rows[~rows["outcome"].isin((*SOLVED, *NOT_ASKED))]
    words = {name: rows[name].astype(object).fillna("") for name in ("path_end", "path_end_by", "reason")}
    rows = rows.assign(**words, near=[f"{at:.{ALIKE}g}" for at in rows["path_end_at"].astype(float)])
    # those whose path ends are told apart by where, the others by what they say
    rows = rows.assign(alike=rows["near"].where(rows["path_end"] != "", rows["contact"] + rows["reason"]))
    found = []
    keys = ["scene", "measure", "mesh", "outcome", "path_end", "path_end_by", "alike"]
    for (scene, measure, mesh, outcome, end, by, _), own in rows.groupby(keys, sort=False):
        at = own["path_end_at"].astype(float)
        contacts = ", ".join(own["contact"].unique())
        where = (at.median(), at.min(), at.max())
        first = own.iloc[0]
        found.append((scene, measure, mesh, outcome, end, *where, by, len(own), contacts, first.reason, first.command))
    return pd.DataFrame(found, columns=list(UNSOLVED_COLUMNS))
