"""Pictures of comparisons, each drawn from one table: cost ratios of a card, and error over seconds of a choice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from reports.figures.drawing import GREY, VERMILION, canvas, looks, svg

MARKS = {"false claim": ("X", "false claim"), "refused": ("_", "refused")}
LOST = ("x", "not solved")
DECADE = (1.0, 2.0, 5.0)  # of a decade, with a number
BELOW = 0.8  # of what the reference leaves, where the axis ends


@svg
def cost_ratios(table: pd.DataFrame, name: str, reference: str) -> Figure:
    """A point a problem, sorted by the ratio of ``name``; what it does not solve stands in a strip of its own above.

    table: who, problem, ended, ratio (NaN where it has none) and cost, the same word in every row.
    """
    figure, (axes,) = canvas(width=8.0, height=3.8)
    own = table[table["who"] == name].drop_duplicates("problem").sort_values(["ratio", "problem"], na_position="last")
    place = {problem: i for i, problem in enumerate(own["problem"])}
    others = table[(table["who"] != name) & table["ratio"].notna() & table["problem"].isin(place)]
    axes.plot(others["problem"].map(place), others["ratio"], ".", color=GREY, alpha=0.5, ms=4, label="others of ours")
    solved = own[own["ratio"].notna()]
    axes.plot(solved["problem"].map(place), solved["ratio"], "o", color=VERMILION, label=name)
    axes.axhline(1.0, color="black", linewidth=0.8)
    highest = float(table["ratio"].max()) if table["ratio"].notna().any() else 1.0
    lost = own[own["ratio"].isna() & (own["ended"] != "solved")]
    for ended, rows in lost.groupby(lost["ended"].where(lost["ended"].isin(MARKS), LOST[1]), sort=False):
        marker, label = MARKS.get(str(ended), LOST)
        axes.plot(rows["problem"].map(place), [2 * max(highest, 1.0)] * len(rows), marker, color=VERMILION, label=label)
    axes.set_yscale("log")
    axes.set_xlim(-1, max(len(place), 1))
    axes.set_xlabel(f"{len(place)} problems, by the ratio of {name}")
    axes.set_ylabel(f"{own['cost'].iloc[0]} over those of {reference}")
    figure.legend(loc="outside upper center", ncols=5)
    return figure


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
        axis.set_major_locator(LogLocator(subs=DECADE))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("CPU time of the path on a grid, started from the grid before [s]")
    axes.set_ylabel(f"error of {quantity}, at most [%]")
    figure.legend(loc="outside right center")
    return figure
