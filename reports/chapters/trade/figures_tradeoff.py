"""Pictures of what accuracy costs: fronts, profiles, attribution, and advice for scenes left out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullFormatter, PercentFormatter

from reports.drawing import BLACK, Look, canvas, looks, svg, ticks

GREY = "#BBBBBB"
PANELS, MOST = 3, 12  # beside one another, and in all
MARGIN = 3.0  # how much dearer than the dearest cell of the front a loser may be, to be drawn
LEAST_SPAN = 12.0  # of an axis, so that a power of ten is on it
WORST = 0.1  # relative error from which an answer is wrong
FACTORS = ("mesh", "measure", "contact", "tolerance", "newton", "element", "section", "load", "model")
COST_WORDS = {
    "operations": "floating-point operations",
    "factorisations": "factorisations",
    "dofs": "unknowns",
    "seconds": "processor time [s]",
}


@svg
def work_precision(fronts: pd.DataFrame, cost: str) -> Figure:
    """Verified error over cost, a panel a scene, a colour a measure, a marker a contact algorithm.

    The MOST scenes with the most answers. The line is the front; grey: beaten in both. The axes are those of the front;
    how many lie outside is said.
    """
    fronts = fronts[fronts["scene"].isin(fronts["scene"][fronts[f"front.{cost}"].astype(bool)])]
    answers = fronts.groupby("scene", sort=False)["error"].count().sort_values(ascending=False, kind="stable")
    fronts = fronts[fronts["scene"].isin(answers.index[:MOST])]
    scenes = fronts.groupby("scene", sort=False)
    measures, contacts = looks(fronts["measure"]), looks(fronts["contact"])
    figure, panels = canvas(len(scenes), columns=PANELS, width=10.0, head=0.8, height=2.7)
    for axes, (scene, own) in zip(panels, scenes, strict=True):
        _scene(axes, str(scene), own, cost, measures, contacts)
    for axes in panels[::PANELS]:
        axes.set_ylabel("relative error")
    for axes in panels[-PANELS:]:
        axes.set_xlabel(COST_WORDS[cost] if len(COST_WORDS[cost]) < 20 else cost)
    keys = [_key(each.colour, "o", name) for name, each in measures.items()]
    keys += [_key(BLACK, each.marker, name) for name, each in contacts.items()] if len(contacts) > 1 else []
    figure.legend(handles=keys, loc="outside upper center", ncols=5)
    return figure


def _key(colour: str, marker: str, name: str) -> Line2D:
    return Line2D([], [], color=colour, marker=marker, linestyle="", label=name)


def _scene(
    axes: Axes, scene: str, rows: pd.DataFrame, cost: str, measures: Mapping[str, Look], contacts: Mapping[str, Look]
) -> None:
    good = rows[(rows["flag"] == "") & rows[f"cost.{cost}"].notna()]
    shown = good.assign(shown=np.maximum(good["error"], good["uncertainty"]), price=good[f"cost.{cost}"].astype(float))
    front = shown[shown[f"front.{cost}"].astype(bool)].sort_values("price")
    right, low = MARGIN * front["price"].max(), min(0.5 * front["shown"].min(), WORST / LEAST_SPAN)
    left = 0.6 * front["price"].min()
    right = max(right, LEAST_SPAN * left)
    inside = shown[(shown["price"] <= right) & (shown["shown"] <= WORST)]
    beaten = inside[~inside[f"front.{cost}"].astype(bool)]
    for contact, own in beaten.groupby("contact", sort=False):
        axes.scatter(own["price"], own["shown"], s=9, color=GREY, marker=contacts[str(contact)].marker, linewidths=0.6)
    axes.plot(front["price"], front["shown"], color=BLACK, linewidth=0.8, drawstyle="steps-post")
    for (measure, contact), own in front.groupby(["measure", "contact"], sort=False):
        colour, marker = measures[str(measure)].colour, contacts[str(contact)].marker
        axes.scatter(own["price"], own["shown"], s=30, zorder=3, color=colour, marker=marker)
    axes.set(xscale="log", yscale="log", xlim=(left, right), ylim=(low, 1.4 * WORST))
    known = float(front["uncertainty"].median())
    if known > low:
        axes.axhspan(low, known, color="#EEEEEE", zorder=0)
    answers = int(rows["error"].notna().sum())
    outside = answers - len(inside)
    axes.set_title(f"{scene}: {front['quantity'].iloc[0]}\n{outside} of {answers} answers outside", fontsize=8)
    axes.tick_params(labelsize=8)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())


@svg
def profiles(data: pd.DataFrame, cost: str) -> Figure:
    """Share of problems within a factor of the best, a panel an axis of comparison, a line a competitor."""
    kinds = data[data["cost"] == cost].groupby("axis", sort=False)
    figure, panels = canvas(len(kinds), columns=2, width=10.0, height=4.4)
    for axes, (kind, own) in zip(panels, kinds, strict=True):
        drawn = looks(own["competitor"])
        for name, line in own.groupby("competitor", sort=False):
            words = f"{name} ({100 * line['solved'].iloc[0]:.0f} % solved)"
            axes.step(line["factor"], line["share"], where="post", label=words, **drawn[name].dashes)
        axes.set(xscale="log", ylim=(-0.02, 1.03), xlim=(1, own["factor"].max()))
        _factors(axes, (1, 2, 5, 10, 20))
        axes.yaxis.set_major_formatter(PercentFormatter(1.0))
        axes.set_title(f"{kind}, {own['problems'].iloc[0]} problems")
        axes.set(xlabel=f"{cost} over those of the best", ylabel="share of problems")
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
        axes.set_yticks(range(len(names)), words if axes is panels[0] else [""] * len(names), fontsize=8)
        axes.set(xlim=(0, 1), xlabel="share of the variance", title=f"logarithm of {_article(response)}")
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
        axes.grid(visible=False, axis="y")
    keys = [Patch(color=colour, label=factor) for factor, colour in colours.items()]
    figure.legend(handles=keys, loc="outside upper center", ncols=6)
    return figure


def _article(response: str) -> str:
    return "the verified error" if response == "error" else f"the {response}"


@svg
def held_out(cases: pd.DataFrame) -> Figure:
    """Advice for scenes left out: true error over tolerance, and how often the regret is below a value."""
    given = cases[cases["advised"] != ""]
    drawn = looks(given["scene"])
    figure, (left, right) = canvas(2, width=10.0, height=4.0)
    for i, (scene, own) in enumerate(given.groupby("scene", sort=False)):
        ratio = (own["true_error"] / own["tolerance"]).clip(lower=1e-3)
        shift = 1 + 0.5 * (i / len(drawn) - 0.5)  # points of one tolerance beside one another
        left.scatter(100 * own["tolerance"] * shift, ratio, s=22, label=scene, **drawn[scene].points)
    left.axhline(1.0, color=BLACK, linewidth=1, linestyle=":")
    left.set(xscale="log", yscale="log", xlabel="tolerance [%]", ylabel="true error over tolerance")
    _factors(left, set(100 * given["tolerance"]))
    regret = np.sort(given["regret"].dropna().to_numpy(float))
    share = np.arange(1, len(regret) + 1) / max(len(regret), 1)
    right.step([*regret, max(10.0, 1.2 * regret[-1])] if len(regret) else [], [*share, 1.0][: len(regret) + 1])
    right.axvline(1.5, color=BLACK, linewidth=1, linestyle=":")
    right.set(xscale="log", xlabel="cost of the advice over that of the best", ylabel="share of cases", ylim=(0, 1.03))
    _factors(right, (0.5, 1, 1.5, 2, 5, 10, 20))
    right.yaxis.set_major_formatter(PercentFormatter(1.0))
    figure.legend(loc="outside upper center", ncols=5, fontsize=8)
    return figure
