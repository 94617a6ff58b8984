"""The picture of a map of extremes: classes of outcomes in colours and hatches, points solved, plain ticks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator

from reports.figures.drawing import BLACK, canvas, svg

LOOKS: dict[str, tuple[str, str, str]] = {  # class: colour, hatch, marker of a point that was solved
    "converged": ("#CCE5F2", "", "."),
    "converged, nothing touches": ("#F5F5F5", "..", "."),
    "converged, unstable": ("#009E73", "||", "v"),
    "wrong": ("#D55E00", "xx", "X"),
    "end of the path": ("#F0E442", "//", "^"),
    "not converged": ("#CC79A7", "\\\\", "x"),
    "refused": ("#999999", "--", "_"),
    "crashed": ("#000000", "", "*"),
}


@svg
def outcome_map(points: pd.DataFrame, labels: pd.Series) -> Figure:
    """One map: ``points`` has all of its rows; ``labels`` its line of the table of maps."""
    rows, columns = int(points["i"].max()) + 1, int(points["j"].max()) + 1
    named = bool(labels["y_named"])
    classes = np.full((rows, columns), "", dtype=object)
    classes[points["i"], points["j"]] = points["class"]
    names = [name for name in LOOKS if (classes == name).any()]
    figure, (axes,) = canvas(width=8.0, height=0.34 * rows + 1.9 if named else 4.9)
    axes.grid(visible=False)
    _filled(axes, classes, names)
    asked = points[points["asked"].astype(bool)]
    marked: dict[str, str] = {}
    for name in names:
        own = asked[asked["class"] == name]
        axes.plot(own["j"], own["i"], linestyle="none", marker=LOOKS[name][2], color=BLACK, markersize=4)
        if len(own):
            marked[LOOKS[name][2]] = f"{marked[LOOKS[name][2]]}, {name}" if LOOKS[name][2] in marked else name
    if named:
        for _, row in asked[asked["iterations"] > 0].iterrows():
            axes.annotate(f"{row['iterations']:.0f}", (row["j"], row["i"]), (0, 4), **_SMALL)
    else:
        _costs(axes, asked[asked["class"].str.startswith("converged")])
    _ticks(axes, points, named)
    axes.set(xlabel=labels["x_label"], ylabel="" if named else labels["y_label"])
    handles: list[Artist] = [
        Patch(facecolor=LOOKS[n][0], hatch=LOOKS[n][1], edgecolor="#444444", label=n) for n in names
    ]
    handles += [
        Line2D([], [], color=BLACK, marker=marker, linestyle="none", label=f"solved: {words}")
        for marker, words in marked.items()
    ]
    handles.append(Line2D([], [], color="#333333", marker="$9$", linestyle="none", label="Newton iterations"))
    figure.legend(handles=handles, loc="outside upper center", ncols=3, fontsize=8)
    return figure


_SMALL: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "fontsize": 6, "color": "#333333"}


def _filled(axes: Axes, classes: np.ndarray, names: list[str]) -> None:
    """Colour and hatch of each class over its cells, row by row in runs."""
    for name in names:
        colour, hatch, _ = LOOKS[name]
        for i, row in enumerate(classes == name):
            ends = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
            for begin, end in zip(ends[::2], ends[1::2], strict=True):
                place = ((begin - 0.5, i - 0.5), end - begin, 1)
                axes.add_patch(Rectangle(*place, facecolor=colour, edgecolor=colour, linewidth=0.5))
                if hatch:
                    axes.add_patch(Rectangle(*place, facecolor="none", edgecolor="#777777", linewidth=0, hatch=hatch))
    axes.set(xlim=(-0.5, classes.shape[1] - 0.5), ylim=(-0.5, classes.shape[0] - 0.5))


def _costs(axes: Axes, solved: pd.DataFrame) -> None:
    """Newton iterations beside the points that converged, at as many as there is room for."""
    apart = 1 + int(max(solved["i"].max(), solved["j"].max()) // 12) if len(solved) else 1
    for row in solved.to_dict("records"):
        if row["i"] % apart == 0 and row["j"] % apart == 0:
            axes.annotate(f"{row['iterations']:.0f}", (row["j"], row["i"]), (0, 4), **_SMALL)


def _ticks(axes: Axes, points: pd.DataFrame, named: bool) -> None:
    """Names at every row; numbers as plain ones, at powers of ten where a setting goes by factors."""
    for axis, index, value in ((axes.xaxis, "j", "x"), (axes.yaxis, "i", "y")):
        values = points.drop_duplicates(index).sort_values(index)[value]
        if named and index == "i":
            axis.set_ticks(range(len(values)), [str(each) for each in values])
            continue
        numbers = pd.to_numeric(values, errors="coerce").to_numpy(float)
        if np.isnan(numbers).any():
            step = max(1, (len(values) - 1) // 8)
            axis.set_ticks(range(0, len(values), step), [str(each) for each in values.iloc[::step]])
        else:
            places, words = plain_ticks(numbers)
            axis.set_ticks(places, words)


def plain_ticks(values: np.ndarray) -> tuple[list[float], list[str]]:
    """Places among the numbers of the lines, and their labels: powers of ten, or round numbers, in between them."""
    lines, step = np.arange(len(values)), np.diff(values)
    if len(values) > 2 and values.min() > 0 and np.ptp(step) > 0.1 * abs(step).max():
        powers = np.arange(math.ceil(np.log10(values.min()) - 1e-9), math.floor(np.log10(values.max()) + 1e-9) + 1)
        chosen = 10.0 ** powers[:: max(1, len(powers) // 8)]
        order = np.argsort(values)
        return list(np.interp(np.log10(chosen), np.log10(values[order]), lines[order])), [
            _power(each) for each in chosen
        ]
    if len(values) > 2 and np.ptp(step) < 1e-6 * abs(step).max():
        chosen = np.asarray(MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(values.min(), values.max()))
        chosen = chosen[(chosen >= values.min() - 1e-12) & (chosen <= values.max() + 1e-12)]
        order = np.argsort(values)
        return list(np.interp(chosen, values[order], lines[order])), [f"{each + 0.0:g}" for each in chosen]
    few = lines[:: max(1, (len(values) - 1) // 8)]
    return [float(place) for place in few], [f"{values[place]:.3g}" for place in few]


def _power(value: float) -> str:
    """1e-05 as a power, what is near one as it is."""
    exponent = round(math.log10(value))
    return f"{value:g}" if -3 <= exponent <= 3 else f"$10^{{{exponent}}}$"
