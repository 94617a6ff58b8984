"""The picture of a choice: the most that values are off over the seconds of their path, grid by grid.

It is drawn from rows of a table; what is enough is decided where they were made.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from reports.figures.drawing import GREY, canvas, looks, svg

MARKS = (1.0, 2.0, 5.0)  # of a decade, with a number
BELOW = 0.8  # of what the reference leaves, where the axis ends


@svg
def error_over_seconds(rows: Sequence[Mapping[str, Any]], quantity: str, error: float, uncertainty: float) -> Figure:
    """A line a variant; below the dashed line is the error asked for, in the grey band what the reference leaves.

    rows: name, error_at_most (a share), path_seconds [s] and enough of every grid, coarse to fine. Marks are filled
    where a grid and all finer ones are enough.
    """
    figure, (axes,) = canvas(width=8.0, height=4.5)
    table = pd.DataFrame(rows)
    for name, look in looks(table["name"]).items():
        own = table[table["name"] == name]
        error_here = 100 * own["error_at_most"]
        axes.plot(own["path_seconds"], error_here, **look.whole, markerfacecolor="white", label=name)
        enough = own["enough"].astype(bool)
        axes.plot(own["path_seconds"][enough], error_here[enough], **look.points, linestyle="none")
    axes.axhline(100 * error, color="black", linestyle="--", linewidth=1.0, label=f"{100 * error:g} % asked for")
    axes.set_xscale("log")
    axes.set_yscale("log")
    bottom = min(axes.get_ylim()[0], BELOW * 100 * uncertainty) or axes.get_ylim()[0]
    axes.axhspan(bottom, max(100 * uncertainty, bottom), color=GREY, alpha=0.2, linewidth=0, label="known no better")
    axes.set_ylim(bottom=bottom)
    for axis in (axes.xaxis, axes.yaxis):  # less than a decade has marks, too
        axis.set_major_locator(LogLocator(subs=MARKS))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("CPU time of the path on a grid, started from the grid before [s]")
    axes.set_ylabel(f"error of {quantity}, at most [%]")
    figure.legend(loc="outside right center")
    return figure
