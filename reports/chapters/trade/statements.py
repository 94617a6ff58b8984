"""The part of stated errors: whether what ``--error`` states holds, how wide it is, and what it costs."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import share
from reports.markdown import Part, commands
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("cost")
COMMAND = "footprint run statements"


def statements_part(store: Store) -> Part:
    """The whole part; no campaign of a report measures it by itself, for it takes an hour."""
    if not (store.has_table("error_coverage") and store.has_analysis("error_statements")):
        return Part()
    data, stated = store.table("error_coverage"), store.analysis("stated_errors")
    found = store.analysis("error_statements")
    rows = {
        "errors": found[found["asked"].notna()],
        "wrong": stated[stated["value_inside"].eq(False) | stated["inside"].eq(False)],
        "missed": data[data["reached"].eq(False)],
    }
    drawn = {"cost-statements.svg": errors_stated(stated)}
    told = {"rules": store.rules(), "whole": found[found["asked"].isna()].iloc[0], "commands": commands([COMMAND])}
    return TEXT("statements", drawn, **told, **rows)


@svg
def errors_stated(data: pd.DataFrame) -> Figure:
    """What each decided error is over the most that is stated of it; on the line both are the same."""
    decided = data[data["value_decided"].eq(True)]
    figure, (axes,) = canvas(1, width=6.0, height=5.0)
    for asked, each in looks(sorted(map(float, decided["asked"].unique()), reverse=True)).items():
        own = decided[decided["asked"] == asked]
        axes.plot(own["high"], own["value_error"], linestyle="none", label=share(asked, 1), **each.points)
    ends = np.array([decided["high"].min(), decided["high"].max()]) if len(decided) else np.ones(2)
    axes.plot(ends, ends, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="the most that is stated", ylabel="relative error")
    legend_above(figure, axes)
    return figure
