"""Solved, failed and refused: every contact algorithm and every measure on every scene, and over all scenes."""

from __future__ import annotations

import pandas as pd

from studies.analysis.findings.states import AXES, FAILED, PATH_ENDS, REFUSED, SOLVED_STATE, counted, states

OUTCOME_COLUMNS = (
    *("axis", "name", "scene", "planned", "solved", "path_ends", "failed", "refused", "solved_share", "cause"),
    "command",
)


def outcomes(table: pd.DataFrame) -> pd.DataFrame:
    """OUTCOME_COLUMNS, a row a competitor and scene, and one of all scenes, whose name is empty.

    planned: problems that were put to two competitors at least, and are solved or not by now.  path_ends: of which the
    path itself ends before the load that was asked for.  solved_share: of those that are neither refused nor end so,
    NaN where there is none.  cause: of all that are not solved.  command: of the first failure, or the first such path.
    """
    rows: list[tuple[object, ...]] = []
    for axis in AXES:
        for name, own in states(table, axis).groupby("name", sort=False):
            for scene, cells in [("", own), *own.groupby("scene", sort=False)]:
                rows.append((axis, name, scene, *totals(cells), counted(cells["cause"]), _first(cells)))
    return pd.DataFrame(rows, columns=list(OUTCOME_COLUMNS))


def totals(cells: pd.DataFrame) -> tuple[int, int, int, int, int, float]:
    """Problems, solved, path ends, failed, refused, and the share that is solved of those that could be."""
    counts = cells["state"].value_counts()
    solved, ends, failed, refused = (int(counts.get(s, 0)) for s in (SOLVED_STATE, PATH_ENDS, FAILED, REFUSED))
    share = solved / (solved + failed) if solved + failed else float("nan")
    return len(cells), solved, ends, failed, refused, share


def _first(cells: pd.DataFrame) -> str:
    for state in (FAILED, PATH_ENDS):
        own = cells[cells["state"] == state]
        if len(own):
            return str(own["command"].iloc[0])
    return ""
