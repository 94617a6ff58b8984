"""What a cell costs, and how far off its formulation is: the names of costs, and when two of them are equal."""

from __future__ import annotations

import pandas as pd

from studies.analysis.cells.rows import PRICES

WRONG = 0.1  # relative error from which an answer is none
TIE = 0.05  # of a cost: two that differ by less are equal
COSTS = {"dofs": "c.dofs", **PRICES}


def priced(table: pd.DataFrame) -> pd.DataFrame:
    """A collected table whose costs have the names of COSTS: ``cost.NAME``."""
    return table.rename(columns={column: f"cost.{name}" for name, column in COSTS.items()})


def beyond_reference(verified: pd.DataFrame) -> pd.Series:
    """By label, how far off the formulation is in any quantity of the scene; NaN where that is not known."""
    return verified.groupby("label")["formulation_error"].max()
