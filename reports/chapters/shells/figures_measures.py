"""The picture of the strain measures: signed errors over a load that grows, with the first crossings of 1 and 5 %."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from reports.figures.drawing import BLACK, GREY, canvas, legend_above, looks, svg

LEVELS, LINEAR = (1.0, 5.0), 1.0  # per cent: levels, and up to where the axis is linear
TICKS = (0, 1, 5, 20, 100, 500, 2000)  # per cent, and their negatives
ROWS = 3  # panels beside one another


@svg
def errors_over_load(data: pd.DataFrame, limits: pd.DataFrame, loads: Mapping[str, str]) -> Figure:
    """Errors in per cent with their signs, one panel a scene; a ring where a curve first passes a level.

    data: scene, measure, load, error.  limits: scene, measure, first_1 and first_5.  loads: words of the axis by scene.
    """
    drawn, scenes = looks(data["measure"]), dict(iter(data.groupby("scene", sort=False)))
    columns = math.ceil(len(scenes) / math.ceil(len(scenes) / ROWS))
    figure, panels = canvas(len(scenes), columns, width=10.0, head=0.9, height=3.2)
    for axes, (scene, own) in zip(panels, scenes.items(), strict=True):
        for name, curve in own.groupby("measure", sort=False):
            error, each = 100 * curve["error"], drawn[name]
            axes.plot(curve["load"], error, **each.whole, label=name, markersize=3.5, markevery=(0.1, 0.25), lw=1.3)
            where = limits[(limits["scene"] == scene) & (limits["measure"] == name)]
            _crossings(
                axes, curve["load"].to_numpy(), error.to_numpy(), where[["first_1", "first_5"]].to_numpy().ravel()
            )
        axes.set(title=scene, xlabel=loads.get(str(scene), "load"), xlim=(0, None))
        _per_cent(axes)
    for axes in panels[::columns]:
        axes.set_ylabel("error against exact [%]")
    panels[0].plot([], [], "o", color=BLACK, fillstyle="none", markersize=7, label="first above 1 % or 5 %")
    legend_above(figure, panels[0], columns=5)
    return figure


def _crossings(axes: Axes, load: np.ndarray, error: np.ndarray, first: np.ndarray) -> None:
    there = ~np.isnan(error)
    first = first[~np.isnan(first)]
    axes.plot(first, np.interp(first, load[there], error[there]), "o", color=BLACK, fillstyle="none", markersize=6)


def _per_cent(axes: Axes) -> None:
    """Linear between the first levels, logarithmic beyond; dotted levels."""
    axes.set_yscale("symlog", linthresh=LINEAR, linscale=0.6)
    low, high = axes.get_ylim()
    low, high = min(low, -2 * LEVELS[-1]), max(high, 2 * LEVELS[-1])
    places = sorted({sign * tick for tick in TICKS for sign in (-1, 1) if low <= sign * tick <= high})
    axes.set_yticks(places, [f"{place:+g}" if place else "0" for place in places])
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_ylim(low, high)
    for level in LEVELS:
        for sign in (-1, 1):
            axes.axhline(sign * level, color=GREY, linewidth=0.8, linestyle=":")
    axes.axhline(0, color=BLACK, linewidth=0.6)
