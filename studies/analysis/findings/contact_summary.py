"""The contact algorithms in one table: what each solves, and what it costs over the default one where both solve."""

from __future__ import annotations

import math

import pandas as pd

from studies.analysis.findings.outcomes import totals
from studies.analysis.findings.ratios import RATIO_COLUMNS, ratios
from studies.analysis.findings.states import FAILED, PATH_ENDS, REFUSED, counted, states

DEFAULT = "semismooth"  # what the others are held against
SUMMARY_COLUMNS = (
    *("algorithm", "scenes", "problems", "solved", "path_ends", "failed", "refused", "solved_share"),
    *("causes", "worst_scene", "worst_failed", "worst_put", "refusals", "default", *RATIO_COLUMNS),
)


def contact_summary(table: pd.DataFrame) -> pd.DataFrame:
    """SUMMARY_COLUMNS, a row an algorithm, the one that solves most first.

    causes: of failures, with the scenes.  worst_scene: with the most failures, of worst_put problems that it could have
    solved.  refusals: why it was not tried.
    """
    rows: list[tuple[object, ...]] = []
    found = states(table, "contact")
    for name, own in found.groupby("name", sort=False):
        could = own[~own["state"].isin((REFUSED, PATH_ENDS))]
        lost = could[could["state"] == FAILED]
        most = lost["scene"].value_counts()
        worst = str(most.index[0]) if len(most) else ""
        in_worst = (int(most.iloc[0]), int((could["scene"] == worst).sum())) if worst else (0, 0)
        causes = counted(lost["cause"] + " in " + lost["scene"])
        refusals = counted(own.loc[own["state"] == REFUSED, "cause"])
        over = ratios(found, str(name), DEFAULT)
        told = (own["scene"].nunique(), *totals(own), causes, worst, *in_worst, refusals, DEFAULT)
        rows.append((name, *told, *(over.get(column, math.nan) for column in RATIO_COLUMNS)))
    summary = pd.DataFrame(rows, columns=list(SUMMARY_COLUMNS))
    return summary.sort_values(["solved_share", "seconds_ratio"], ascending=[False, True], ignore_index=True)
