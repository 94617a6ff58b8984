"""The picture of maps of extremes: classes of outcomes in colours and hatches, points solved, plain ticks."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from reports.figures.drawing import BLACK, canvas, svg

LOOKS: dict[str, tuple[str, str]] = {  # class: colour, hatch
    "converged": ("#CCE5F2", ""),
    "converged, nothing touches": ("#F5F5F5", ".."),
    "converged, unstable": ("#009E73", "||"),
    "wrong": ("#D55E00", "xx"),
    "end of the path": ("#F0E442", "//"),
    "not converged": ("#CC79A7", "\\\\"),
    "refused": ("#999999", "--"),
    "crashed": ("#000000", ""),
}


PANELS, COLUMNS = 6, 3
TICKS = 5  # of an axis, about


@svg
def outcome_maps(points: pd.DataFrame, maps: pd.DataFrame) -> Figure:
    """A panel a map: ``points`` has all rows of all maps; ``maps`` a line for each one to draw, of two settings."""
    figure, panels = canvas(len(maps), min(COLUMNS, len(maps)), width=12.0, height=3.4, head=0.6)
    seen: set[str] = set()
    for axes, labels in zip(panels, maps.to_dict("records"), strict=True):
        own = points[points["map"] == labels["map"]]
        classes = np.full((int(own["i"].max()) + 1, int(own["j"].max()) + 1), "", dtype=object)
        classes[own["i"], own["j"]] = own["class"]
        names = [name for name in LOOKS if (classes == name).any()]
        seen.update(names)
        axes.grid(visible=False)
        _filled(axes, classes, names)
        asked = own[own["asked"].astype(bool)]
        _dotted(axes, asked[["j", "i"]].to_numpy(float))
        for axis, index, value in ((axes.xaxis, "j", "x"), (axes.yaxis, "i", "y")):
            numbers = own.drop_duplicates(index).sort_values(index)[value]
            axis.set_ticks(*plain_ticks(numbers.to_numpy(float)))
        axes.set(xlabel=labels["x_label"], ylabel=labels["y_label"])
        axes.set_title(labels["title"], fontsize=9)
    handles: list[Artist] = [
        Patch(facecolor=LOOKS[n][0], hatch=LOOKS[n][1], edgecolor="#444444", label=n) for n in LOOKS if n in seen
    ]
    handles.append(Line2D([], [], color=BLACK, marker=".", linestyle="none", label="solved"))
    figure.legend(handles=handles, loc="outside upper center", ncols=4, fontsize=8)
    return figure


def _filled(axes: Axes, classes: np.ndarray, names: list[str]) -> None:
    """Colour and hatch of each class over its cells: runs of rows, in one path a class."""
    for name in names:
        colour, hatch = LOOKS[name]
        runs = []
        for i, row in enumerate(classes == name):
            ends = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]]).astype(int)))
            for begin, end in zip(ends[::2], ends[1::2], strict=True):
                left, right, low, high = begin - 0.5, end - 0.5, i - 0.5, i + 0.5
                runs.append(Path([(left, low), (right, low), (right, high), (left, high), (left, low)], closed=True))
        every = Path.make_compound_path(*runs)
        axes.add_patch(PathPatch(every, facecolor=colour, edgecolor=colour, linewidth=0.5))
        if hatch:
            axes.add_patch(PathPatch(every, facecolor="none", edgecolor="#777777", linewidth=0, hatch=hatch))
    axes.set(xlim=(-0.5, classes.shape[1] - 0.5), ylim=(-0.5, classes.shape[0] - 0.5))


def _dotted(axes: Axes, places: np.ndarray) -> None:
    """Dots (n, 2) as short strokes of one path: a marker each would be half of the file."""
    strokes = (places[:, None] + [[-0.02, 0.0], [0.02, 0.0]]).reshape(-1, 2)
    path = Path(strokes, [Path.MOVETO, Path.LINETO] * len(places))
    axes.add_patch(PathPatch(path, facecolor="none", edgecolor=BLACK, linewidth=1.2, capstyle="round"))


def plain_ticks(values: np.ndarray) -> tuple[list[float], list[str]]:
    """Places among the numbers of the lines, and their labels, all different.

    Powers of ten where there are several, or round numbers where the lines are even; else some lines by their digits.
    """
    lines, step = np.arange(len(values)), np.diff(values)
    order = np.argsort(values)
    if len(values) > 2 and values.min() > 0 and np.ptp(step) > 0.1 * abs(step).max():
        powers = np.arange(math.ceil(np.log10(values.min()) - 1e-9), math.floor(np.log10(values.max()) + 1e-9) + 1)
        chosen = 10.0 ** powers[:: max(1, math.ceil(len(powers) / TICKS))]
        if len(chosen) > 1:
            places = np.interp(np.log10(chosen), np.log10(values[order]), lines[order])
            return list(places), [_power(each) for each in chosen]
    elif len(values) > 2 and np.ptp(step) < 1e-6 * abs(step).max():
        chosen = np.asarray(MaxNLocator(TICKS, steps=[1, 2, 5, 10]).tick_values(values.min(), values.max()))
        chosen = chosen[(chosen >= values.min() - 1e-12) & (chosen <= values.max() + 1e-12)]
        return list(np.interp(chosen, values[order], lines[order])), [f"{each + 0.0:g}" for each in chosen]
    few = lines[:: max(1, (len(values) - 1) // (TICKS - 1))]
    labels = ([f"{values[place]:.{count}g}" for place in few] for count in range(3, 17))
    told = next((each for each in labels if _tell_apart(each, values)), [f"{values[place]!r}" for place in few])
    return [float(place) for place in few], told


def _tell_apart(labels: list[str], values: np.ndarray) -> bool:
    """Are they all different, and none rounded beyond the ends?"""
    near = 1e-12 * float(np.max(np.abs(values)))
    within = (values.min() - near <= float(label) <= values.max() + near for label in labels)
    return len(set(labels)) == len(labels) and all(within)


def _power(value: float) -> str:
    """1e-05 as a power, what is near one as it is."""
    exponent = round(math.log10(value))
    return f"{value:g}" if -3 <= exponent <= 3 else f"$10^{{{exponent}}}$"
