"""What became of every problem that was put to more than one measure, or to more than one contact algorithm.

A problem is all that was asked but the competitor: scene, mesh, settings, tolerance. It may stand in several cells,
which differ in a parameter of the algorithm alone; then the best of them counts.
"""

from __future__ import annotations

import re

import pandas as pd

from studies.analysis.cells.rows import PRICES
from studies.analysis.ranking.profiles import problem_of
from studies.result import CAP_HIT, CRASH, MEMORY, NOT_CONVERGED, SOLVED, TIME, UNSUPPORTED, WRONG

SOLVED_STATE, PATH_ENDS, FAILED, REFUSED = "solved", "path ends", "failed", "refused"
STATES = (SOLVED_STATE, PATH_ENDS, FAILED, REFUSED)  # the best first
AXES = ("contact", "measure")
SOLVES = "contact"  # whose competitors solve the same problem: each measure has a path of its own
PASSED = ", which another passes"
COLUMNS = ("axis", "name", "scene", "problem", "state", "cause", "dofs", *PRICES, "label", "command")
CAUSES = {  # of a failure, by its outcome
    CAP_HIT: "iteration limit",
    NOT_CONVERGED: "steps too small",
    WRONG: "refused by the judge",
    TIME: "time limit",
    MEMORY: "memory limit",
    CRASH: "process died",
}
HOW_MUCH = re.compile(r" by \d\S* of its size")  # told apart by it, all refusals were unlike
DOES_NOT_APPLY = " does not apply: "  # before the reason of a refusal


def states(table: pd.DataFrame, axis: str) -> pd.DataFrame:
    """COLUMNS, a row a problem and competitor; cells that are not solved yet are left out.

    cause: kind of the end of the path, what a failure ended at, or why the problem was refused.  A path that ends is a
    failure where another algorithm certifies the load by the same measure.  table: of collect.
    """
    rows = table[table["outcome"] != "missing"].dropna(subset=[axis])
    rows = rows.assign(problem=[problem_of(request, axis) for request in rows["request"]], name=rows[axis], axis=axis)
    rows = rows[rows.groupby(["scene", "problem"])["name"].transform("nunique") > 1]
    if rows.empty:
        return pd.DataFrame(columns=list(COLUMNS))
    ends = rows.reindex(columns=["path_end"])["path_end"].astype(object)
    ends = ends.where(ends.notna(), "")
    reasons = rows.reindex(columns=["reason"])["reason"].astype(object)
    told = [_told(*each) for each in zip(rows["outcome"], ends, reasons.where(reasons.notna(), ""), strict=True)]
    rows = _passed(rows.assign(state=[state for state, _ in told], cause=[cause for _, cause in told]))
    costs = rows.reindex(columns=["c.dofs", *PRICES.values()]).set_axis(["dofs", *PRICES], axis=1).astype(float)
    rows = rows.drop(columns=[name for name in costs if name in rows]).join(costs)
    order = rows["state"].map(STATES.index)
    best = rows.assign(order=order).sort_values("order", kind="stable")
    return best.drop_duplicates(["name", "scene", "problem"]).sort_index()[list(COLUMNS)]


def _passed(rows: pd.DataFrame) -> pd.DataFrame:
    """A path that ends where another algorithm certifies the load is a failure: there is such a state."""
    same = [problem_of(request, SOLVES) for request in rows["request"]]
    passed = (rows["state"] == SOLVED_STATE).groupby([rows["scene"], same]).transform("any")
    lost = passed & (rows["state"] == PATH_ENDS)
    return rows.assign(state=rows["state"].mask(lost, FAILED), cause=rows["cause"].mask(lost, rows["cause"] + PASSED))


def _told(outcome: str, end: str, reason: str) -> tuple[str, str]:
    """State and cause of a cell."""
    if outcome in SOLVED:
        return SOLVED_STATE, ""
    if outcome == UNSUPPORTED:
        return REFUSED, HOW_MUCH.sub("", reason.partition(DOES_NOT_APPLY)[2] or reason)
    if end:
        return PATH_ENDS, end
    return FAILED, CAUSES.get(outcome, outcome)


def counted(causes: pd.Series) -> str:
    """Each cause with its number, the most frequent first."""
    return "; ".join(f"{count} {cause}" for cause, count in causes[causes != ""].value_counts().items())
