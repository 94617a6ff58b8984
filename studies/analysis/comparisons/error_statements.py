"""How honest stated errors are, how wide, and what they cost: over all statements, and for each error asked for."""

from __future__ import annotations

import math

import pandas as pd

ROUNDING = 1e-9  # relative: a smaller uncertainty is no statement about a grid
TIMES = 4.0  # the CPU time of the cheapest grid as good, above which a statement counts as expensive
STATEMENT = ["scene", "settings", "quantity", "unknowns"]  # larger errors may end at one and the same grid
COLUMNS = (
    *("asked", "asked_for", "reached", "statements", "priced", "cost", "expensive"),
    *("scenes", "decided", "inside", "wide", "limit_decided", "limit_inside", "limit_wide"),
)


def error_statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """COLUMNS, a row an error asked for, and a last one for all, where asked is NaN and equal statements count once.

    coverage: of error_coverage.  statements: those that were reached, but for ROUNDING.  cost:
    median of the CPU time over that of the cheapest grid known to be as good, of those priced; expensive: how many take
    more than TIMES.  decided, on so many scenes: those whose true error of the last grid's value is known well enough;
    inside: where it is as stated; wide: median of the width of the stated interval over that error.  limit_*: the same
    of the extrapolated limit and its uncertainty.
    """
    rows = [_row(own, asked) for asked, own in coverage.groupby("asked", sort=False)]
    return pd.DataFrame([*rows, _row(coverage.drop_duplicates(STATEMENT), math.nan)], columns=list(COLUMNS))


def statements(coverage: pd.DataFrame) -> pd.DataFrame:
    """The rows of a coverage that state something."""
    return coverage[coverage["reached"].eq(True) & (coverage["uncertainty"] > ROUNDING)]


def _row(coverage: pd.DataFrame, asked: object) -> dict[str, object]:
    made = statements(coverage)
    of_value, of_limit = (made[made[name].eq(True)] for name in ("value_decided", "decided"))
    return {
        "asked": asked,
        "asked_for": len(coverage),
        "reached": int(coverage["reached"].sum()),
        "statements": len(made),
        "priced": int(made["cost"].notna().sum()),
        "cost": made["cost"].median(),
        "expensive": int((made["cost"] > TIMES).sum()),
        "scenes": of_value["scene"].nunique(),
        "decided": len(of_value),
        "inside": int(of_value["value_inside"].sum()),
        "wide": ((of_value["high"] - of_value["low"]) / of_value["value_error"]).median(),
        "limit_decided": len(of_limit),
        "limit_inside": int(of_limit["inside"].sum()),
        "limit_wide": (of_limit["uncertainty"] / of_limit["off"]).median(),
    }
