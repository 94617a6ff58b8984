"""The part of advice from stored campaigns: what it is worth on a scene that it does not know."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from reports.figures.drawing import BLACK, BLUE, VERMILION, canvas, svg, ticks
from reports.markdown import Part
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("cost")
DEAR = 1.5  # times the least cost: what advice aims to stay below


def advice_part(store: Store) -> Part:
    """Scenes that were left out, one after the other; nothing where a campaign has too few."""
    cases, headline = store.rows("held_out"), store.rows("held_out_summary", quantities="headline")
    if cases.empty or headline.empty:
        return Part()
    missed = cases[(cases["advised"] != "") & (cases["met"] == 0.0)]
    drawn = {"advice-held-out.svg": held_out(cases)}
    return TEXT("advice", drawn, **headline.iloc[0], missed=missed)


@svg
def held_out(cases: pd.DataFrame) -> Figure:
    """Advice for scenes left out: true error over tolerance, and how often the regret is below a value."""
    given = cases[cases["advised"] != ""]
    figure, (left, right) = canvas(2, width=10.0, height=4.0)
    for tolerance in sorted(set(given["tolerance"].astype(float))):
        own = given[given["tolerance"] == tolerance]
        own = own.assign(ratio=(own["true_error"] / tolerance).clip(lower=1e-3)).sort_values("ratio")
        ratio = own["ratio"].to_numpy(float)
        apart = 100 * tolerance * (1 + 0.4 * np.linspace(-0.5, 0.5, len(own)))  # beside one another, by size
        for far, colour, marker in ((False, BLUE, "o"), (True, VERMILION, "s")):
            shown = (ratio > 1) == far
            left.scatter(apart[shown], ratio[shown], s=16, color=colour, marker=marker, linewidths=0)
    left.axhline(1.0, color=BLACK, linewidth=1, linestyle=":")
    left.set(xscale="log", yscale="log", xlabel="tolerance [%]", ylabel="true error over tolerance")
    left.scatter([], [], s=16, color=BLUE, marker="o", label="tolerance met")
    left.scatter([], [], s=16, color=VERMILION, marker="s", label="tolerance missed")
    _factors(left, set(100 * given["tolerance"]))
    _regret(right, np.sort(given["regret"].dropna().to_numpy(float)))
    left.legend(loc="lower left", fontsize=8)
    return figure


def _regret(axes: Axes, regret: np.ndarray) -> None:
    """How often the cost of the advice is at most a multiple of the least one."""
    if len(regret):
        share = np.arange(1, len(regret) + 1) / len(regret)
        axes.step([*regret, max(10.0, 1.2 * regret[-1])], [*share, 1.0], where="post", color=BLUE)
        below = float((regret <= DEAR).mean())
        axes.plot([DEAR, DEAR, axes.get_xlim()[0]], [0, below, below], color=BLACK, linewidth=1, linestyle=":")
        axes.annotate(
            f"{100 * below:.0f} % of the cases cost\nat most {DEAR:g} times the best",
            (0.97, 0.3),
            xycoords="axes fraction",
            ha="right",
            fontsize=9,
        )
    axes.set(xscale="log", xlabel="cost of the advice over that of the best", ylabel="share of cases", ylim=(0, 1.03))
    _factors(axes, (0.5, 1, 2, 5, 10, 20, 50, 100))
    low, high = (min(0.9, regret[0]), 1.2 * regret[-1]) if len(regret) else (0.9, 10.0)
    axes.set_xlim(low, max(high, 10.0))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))


def _factors(axes: Axes, places: Iterable[float]) -> None:
    places = sorted(places)
    ticks(axes, places, [f"{place:g}" for place in places])
