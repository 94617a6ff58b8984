"""Pictures of comparisons, each drawn from one table: cost ratios of a card, error over seconds of a choice.

And that of a sweep: a quantity over one setting with what its limit lies between, or its map over two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from reports.figures.drawing import BLUE, GREY, VERMILION, canvas, looks, shades, svg
from reports.files import write_texts
from reports.formats import quantity as in_words

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
    axes.plot(others["problem"].map(place), others["ratio"], ".", color=GREY, alpha=0.5, ms=4, label="others")
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
    axes.axhspan(
        bottom, max(100 * uncertainty, bottom), color=GREY, alpha=0.2, linewidth=0, label="reference uncertainty"
    )
    axes.set_ylim(bottom=bottom)
    for axis in (axes.xaxis, axes.yaxis):  # less than a decade has marks, too
        axis.set_major_locator(LogLocator(subs=DECADE))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("CPU time of the path on a grid, started from the previous grid [s]")
    axes.set_ylabel(f"error of {quantity}, at most [%]")
    figure.legend(loc="outside right center")
    return figure


PICTURE = "figures/sweep.svg"
LEVELS = 7  # lines of equal value, about
MISSING: dict[str, Any] = {"facecolor": "white", "edgecolor": GREY, "hatch": "////", "linewidth": 0.0}
UNSTABLE = "unstable"  # the verdict


def draw_sweep(
    directory: Path,
    rows: Sequence[Mapping[str, Any]],
    over: Mapping[str, Sequence[float]],
    quantity: str,
    error: float | None,
) -> list[str]:
    """Draw the picture into a directory; returns its name there, none where nothing was solved."""
    if not quantity:
        return []
    write_texts(directory, {PICTURE: swept(rows, over, quantity, error)()})
    return [PICTURE]


@svg
def swept(
    rows: Sequence[Mapping[str, Any]], over: Mapping[str, Sequence[float]], quantity: str, error: float | None
) -> Figure:
    """The quantity of the members; those without an answer are hatched, unstable ones marked.

    rows: in the order of the values of ``over``, the last setting fastest: verdict, the quantity, None where there is
    none, and low, high and error where these are known.  error: the one asked for, relative.
    """
    figure, (axes,) = canvas(width=7.5, height=5.2)
    places = [np.array(values) for values in over.values()]
    shape = [len(values) for values in places]
    value, low, high, off = (_numbers(rows, name, shape) for name in (quantity, "low", "high", "error"))
    ends = [np.concatenate([[v[0]], (v[1:] + v[:-1]) / 2, [v[-1]]]) for v in places]
    if len(places) == 1:
        _line(axes, places[0], value, low, high)
        axes.set_ylabel(in_words(quantity))
        bottom, top = axes.get_ylim()
    else:
        colours = axes.pcolormesh(*ends, value.T, cmap=shades("viridis"))
        figure.colorbar(colours, ax=axes, label=in_words(quantity))
        _contours(axes, places, value, 100 * off, error)
        axes.set_ylabel(in_words(list(over)[1]))
        axes.grid(visible=False)
    axes.set_xlabel(in_words(next(iter(over))))
    for i, *j in np.argwhere(np.isnan(value)):
        y = ends[1][j[0] : j[0] + 2] if j else (bottom, top)
        axes.add_patch(Rectangle((ends[0][i], y[0]), ends[0][i + 1] - ends[0][i], y[1] - y[0], **MISSING))
    unstable = np.argwhere(np.reshape([row["verdict"] == UNSTABLE for row in rows], shape))
    if len(unstable):
        at = [v[k] for v, k in zip(places, unstable.T, strict=True)] + (
            [value[unstable[:, 0]]] if len(places) == 1 else []
        )
        axes.plot(*at, "^", ms=8, color=VERMILION, markerfacecolor="white", label="unstable")
    handles = axes.get_legend_handles_labels()[0] + [Patch(**MISSING, label="no answer")] * bool(np.isnan(value).any())
    if handles:
        figure.legend(handles=handles, loc="outside upper center", ncols=4)
    return figure


def _numbers(rows: Sequence[Mapping[str, Any]], name: str, shape: Sequence[int]) -> np.ndarray:
    """Values of the members in the shape of the ranges, NaN where there is none."""
    return np.array([row.get(name) for row in rows], float).reshape(shape)


def _line(axes: Axes, x: np.ndarray, value: np.ndarray, low: np.ndarray, high: np.ndarray) -> None:
    axes.plot(x, value, "o-", color=BLUE, label="on this grid")
    if not np.isnan(low).all():
        axes.fill_between(x, low, high, color=BLUE, alpha=0.2, linewidth=0, label="its limit lies between")


def _contours(
    axes: Axes, places: Sequence[np.ndarray], value: np.ndarray, off: np.ndarray, error: float | None
) -> None:
    """Lines of equal value, and the one where the error [%] is that asked for."""
    least, most = np.nanmin(value, initial=np.inf), np.nanmax(value, initial=-np.inf)
    if least < most:
        levels = [level for level in MaxNLocator(LEVELS).tick_values(least, most) if least < level < most]
        seen = ["white" if level < (least + most) / 2 else "black" for level in levels]  # against the colours below
        masked = np.ma.masked_invalid(value).T
        axes.clabel(axes.contour(*places, masked, levels=levels, colors=seen, linewidths=0.8), fontsize=8)
    if error is not None and np.nanmin(off, initial=np.inf) < 100 * error < np.nanmax(off, initial=-np.inf):
        masked = np.ma.masked_invalid(off).T
        axes.contour(*places, masked, levels=[100 * error], colors=VERMILION, linewidths=1.6, linestyles="--")
        axes.plot([], [], "--", color=VERMILION, label=f"error {100 * error:g} %")
