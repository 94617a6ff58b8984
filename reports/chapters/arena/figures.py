"""The figure of the arena: profiles of all solvers, the best of them and OSQP named."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import GREY, canvas, looks, svg

NAMED, ALWAYS = 7, "OSQP"
PANELS = {
    "the quickest": "time over that of the quickest",
    "a factorisation": "time in factorisations of the stiffness",
}


@svg
def profiles(found: pd.DataFrame) -> Figure:
    """Share of problems over cost, relative to the quickest and in factorisations, of one tolerance, kind and size."""
    figure, panels = canvas(len(PANELS), width=11.0, height=4.8, sharey=True)
    named = looks(shown_by_name(found))
    for axes, (of, words) in zip(panels, PANELS.items(), strict=True):
        own = found[found["of"] == of]
        curves = {str(name): each.sort_values("at") for name, each in own.groupby("solver", sort=False)}
        for name, curve in curves.items():
            if name not in named:
                axes.plot(curve["at"], curve["share"], color=GREY, linewidth=0.5, alpha=0.5)
        for name, style in named.items():
            axes.plot(curves[name]["at"], curves[name]["share"], **style.whole, markersize=3, label=name)
        axes.set(xscale="log", xlabel=words, ylim=(0, 1.02), xlim=(own["at"].min(), own["at"].max()))
    panels[0].set_ylabel("share of problems solved")
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside right upper", title="most solved first")
    return figure


def shown_by_name(found: pd.DataFrame) -> list[str]:
    """The solvers with the largest shares at the end of their curves, and OSQP, whatever it has."""
    ends = found.groupby("solver", sort=False)["share"].max().sort_values(ascending=False, kind="stable")
    best = [str(name) for name in ends.index[:NAMED]]
    return best + [ALWAYS] * (ALWAYS in ends.index and ALWAYS not in best)
