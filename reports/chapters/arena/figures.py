"""The figure of the arena: profiles of all solvers, the best of them named at the ends of their curves."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.figures.drawing import GREY, Look, canvas, looks, svg

NAMED = 9
APART = 0.05  # of the height, between two names
PANELS = {
    "the quickest": "time over that of the quickest",
    "a factorisation": "time in factorisations of the stiffness",
}


@svg
def profiles(found: pd.DataFrame) -> Figure:
    """Share of problems over cost, relative to the quickest and in factorisations, of one tolerance, kind and size."""
    figure, panels = canvas(len(PANELS), width=11.0, height=4.8, sharey=True)
    areas = found.groupby(["solver"], sort=False)["share"].sum().sort_values(ascending=False, kind="stable")
    named = looks(list(areas.index[:NAMED]))
    for axes, (of, words) in zip(panels, PANELS.items(), strict=True):
        own = found[found["of"] == of]
        curves = {str(name): each.sort_values("at") for name, each in own.groupby("solver", sort=False)}
        for name, curve in curves.items():
            if name not in named:
                axes.plot(curve["at"], curve["share"], color=GREY, linewidth=0.5, alpha=0.5)
        for name, style in named.items():
            axes.plot(curves[name]["at"], curves[name]["share"], **style.whole, markersize=3)
        axes.set(xscale="log", xlabel=words, ylim=(0, 1.02), xlim=(own["at"].min(), own["at"].max()))
        _labelled(axes, {name: float(curves[name]["share"].iloc[-1]) for name in named}, named)
    panels[0].set_ylabel("share of problems solved")
    return figure


def _labelled(axes: Axes, ends: Mapping[str, float], named: Mapping[str, Look]) -> None:
    """Names beside the ends of the curves, from above, none over another."""
    free = 1.0
    for name, end in sorted(ends.items(), key=lambda item: -item[1]):
        free = min(end, free)
        axes.annotate(
            name,
            (axes.get_xlim()[1], end),
            (1.02, free / axes.get_ylim()[1]),
            textcoords="axes fraction",
            color=named[name].colour,
            fontsize=8,
            va="center",
            arrowprops={"arrowstyle": "-", "color": named[name].colour, "linewidth": 0.5, "relpos": (0, 0.5)},
            annotation_clip=False,
        )
        free -= APART
