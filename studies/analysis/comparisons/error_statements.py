"""How honest stated errors are, how wide, and what they cost: over all statements, and for each error asked for."""

from __future__ import annotations

import math

import pandas as pd

ROUNDING = 1e-9  # relative: a smaller uncertainty is no statement about a grid
TIMES = 3.0  # the last grid's CPU time, above which a statement counts as expensive
STATEMENT = ["scene", "settings", "quantity", "unknowns"]  # larger errors may end at one and the same grid
COLUMNS = (
    *("asked", "scenes", "asked_for", "reached", "statements", "decided", "inside", "wide", "wide_value"),
    *("cost", "expensive"),
)


def error_statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row an error asked for, and a last one for all, where asked is NaN and equal statements count once.

    coverage: of studies.experiments.error_coverage.  statements: those that were reached, but for ROUNDING; decided:
    those whose true limit is known well enough.  wide: uncertainty over what the limit is off, wide_value: what the
    error of the last grid's value may be over what it is, medians of the decided.  cost: median of the CPU time over
    that of the last grid alone; expensive: how many take more than TIMES.
    """
    rows = [_row(own, asked) for asked, own in coverage.groupby("asked", sort=False)]
    return pd.DataFrame([*rows, _row(coverage.drop_duplicates(STATEMENT), math.nan)], columns=list(COLUMNS))


def statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """The rows of a coverage that state something."""
    return coverage[coverage["reached"].astype(bool) & (coverage["uncertainty"] > ROUNDING)]


def _row(coverage: pd.DataFrame, asked: object) -> dict[str, object]:
    made = statements(coverage)
    decided = made[made["decided"].astype(bool)]
    return {
        "asked": asked,
        "scenes": decided["scene"].nunique(),
        "asked_for": len(coverage),
        "reached": int(coverage["reached"].sum()),
        "statements": len(made),
        "decided": len(decided),
        "inside": int(decided["inside"].sum()),
        "wide": (decided["uncertainty"] / decided["off"]).median(),
        "wide_value": (decided["high"] / decided["value_error"]).median(),
        "cost": made["cost"].median(),
        "expensive": int((made["cost"] > TIMES).sum()),
    }
