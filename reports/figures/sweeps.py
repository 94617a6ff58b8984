"""The picture of a sweep: a quantity over one setting with what its limit lies between, or its map over two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from reports.figures.drawing import BLUE, GREY, VERMILION, canvas, shades, svg
from reports.files import write_texts
from reports.formats import quantity as in_words

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
