"""The picture of a card: cost over that of a part of ours, problem by problem, with the others behind it.

It is drawn from one table; whose card it is, and over whom, are words.
"""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import GREY, VERMILION, canvas, svg

MARKS = {"false claim": ("X", "false claim"), "refused": ("_", "refused")}
LOST = ("x", "not solved")


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
