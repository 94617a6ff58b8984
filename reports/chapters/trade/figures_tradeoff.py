"""Pictures of what accuracy costs: profiles, attribution, and advice for scenes left out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import PercentFormatter

from reports.figures.drawing import BLACK, BLUE, GREY, VERMILION, canvas, looks, svg, ticks

DEAR = 1.5  # times the least cost: what advice aims to stay below
WORST = 0.1  # relative error from which an answer is wrong
FACTORS = ("mesh", "measure", "contact", "tolerance", "newton", "element", "section", "load", "model")
BOTH: dict[str, Any] = {"facecolor": "white", "edgecolor": GREY, "hatch": "////", "linewidth": 0.4}
COST_WORDS = {
    "operations": "floating-point operations",
    "factorisations": "factorisations",
    "dofs": "unknowns",
    "seconds": "processor time [s]",
}


@svg
def profiles(data: pd.DataFrame, costs: Sequence[str]) -> Figure:
    """Share of problems within a factor of the best: a row an axis of comparison, a panel a cost, a line a competitor.

    At the right end stands the share that each solves, however dear.
    """
    kinds = list(dict.fromkeys(data["axis"]))
    figure, panels = canvas(len(kinds) * len(costs), columns=len(costs), width=10.0, height=4.4)
    for axes, (kind, cost) in zip(panels, product(kinds, costs), strict=True):
        own = data[(data["axis"] == kind) & (data["cost"] == cost)]
        drawn, ends = looks(own["competitor"]), []
        for name, line in own.groupby("competitor", sort=False):
            solved = float(line["solved"].iloc[0])
            words = f"{name} ({100 * solved:.0f} % solved)"
            (shown,) = axes.step(line["factor"], line["share"], where="post", label=words, **drawn[name].dashes)
            ends.append((solved, shown.get_color()))
        axes.set(xscale="log", ylim=(-0.02, 1.03), xlim=(1, own["factor"].max()))
        for solved, colour in ends:
            axes.plot([1.0, 1.03], [solved, solved], color=colour, clip_on=False, transform=axes.get_yaxis_transform())
        _factors(axes, (1, 2, 5, 10, 20))
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_title(f"{kind}, {own['problems'].iloc[0]} problems")
        axes.set(xlabel=f"{cost} over those of the best; right: solved at all", ylabel="share of problems")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, fontsize=8)
    return figure


def _factors(axes: Axes, places: Iterable[float]) -> None:
    places = sorted(places)
    ticks(axes, places, [f"{place:g}" for place in places])


@svg
def attribution(data: pd.DataFrame, responses: Sequence[str]) -> Figure:
    """Shares of the variance, a panel a response, a bar a scene or family, a colour a factor."""
    colours = {name: each.colour for name, each in looks(FACTORS).items() if (data["factor"] == name).any()}
    colours |= {"interactions": "#888888", "rest": "#DDDDDD"}
    said = {"rest": "rest, unexplained", "interactions": "pairs of factors"}
    names = list(dict.fromkeys(zip(data["scope"], data["name"], strict=True)))[::-1]
    words = [name if scope == "scene" else f"all {name}" for scope, name in names]
    figure, panels = canvas(len(responses), width=10.0, height=1.4 + 0.27 * len(names))
    for axes, response in zip(panels, responses, strict=True):
        own = data[data["response"] == response].set_index(["scope", "name", "factor"])["share"]
        for i, (scope, name) in enumerate(names):
            start = 0.0
            for factor, colour in colours.items():
                share = float(own.get((scope, name, factor), 0.0))
                axes.barh(i, share, left=start, color=colour, height=0.75, edgecolor="white", linewidth=0.4)
                start += share
            if start > 0.0:  # else nothing was told apart
                axes.barh(i, max(1.0 - start, 0.0), left=start, height=0.75, **BOTH)
        axes.set_yticks(range(len(names)), words if axes is panels[0] else [""] * len(names), fontsize=8)
        axes.set(xlim=(0, 1), xlabel="share of the variance", title=f"logarithm of {_article(response)}")
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.grid(visible=False, axis="y")
    keys = [Patch(color=colour, label=said.get(factor, factor)) for factor, colour in colours.items()]
    keys.append(Patch(**BOTH, label="by no factor alone"))
    figure.legend(handles=keys, loc="outside upper center", ncols=6)
    return figure


def _article(response: str) -> str:
    return "the verified error" if response == "error" else f"the {response}"


@svg
def held_out(cases: pd.DataFrame) -> Figure:
    """Advice for scenes left out: true error over tolerance, and how often the regret is below a value."""
    given = cases[cases["advised"] != ""]
    figure, (left, right) = canvas(2, width=10.0, height=4.0)
    for tolerance in sorted(set(given["tolerance"].astype(float))):
        own = given[given["tolerance"] == tolerance]
        own = own.assign(ratio=(own["true_error"] / tolerance).clip(lower=1e-3)).sort_values("ratio")
        ratio, scenes = own["ratio"].to_numpy(float), list(own["scene"])
        apart = 100 * tolerance * (1 + 0.4 * np.linspace(-0.5, 0.5, len(own)))  # beside one another, by size
        for far, colour, marker in ((False, BLUE, "o"), (True, VERMILION, "s")):
            shown = (ratio > 1) == far
            left.scatter(apart[shown], ratio[shown], s=16, color=colour, marker=marker, linewidths=0)
        for i in np.flatnonzero(ratio > 1):
            left.annotate(str(scenes[i]), (apart[i], ratio[i]), (4, 2), textcoords="offset points", fontsize=7)
    left.axhline(1.0, color=BLACK, linewidth=1, linestyle=":")
    left.set(xscale="log", yscale="log", xlabel="tolerance [%]", ylabel="true error over tolerance")
    left.scatter([], [], s=16, color=BLUE, marker="o", label="tolerance met")
    left.scatter([], [], s=16, color=VERMILION, marker="s", label="tolerance missed, with its scene")
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
            (DEAR, below),
            (12, -34),
            textcoords="offset points",
            fontsize=9,
        )
    axes.set(xscale="log", xlabel="cost of the advice over that of the best", ylabel="share of cases", ylim=(0, 1.03))
    _factors(axes, (0.5, 1, 2, 5, 10, 20, 50, 100))
    low, high = (min(0.9, regret[0]), 1.2 * regret[-1]) if len(regret) else (0.9, 10.0)
    axes.set_xlim(low, max(high, 10.0))
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
