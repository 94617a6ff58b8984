"""Maps of outcomes: a colour and a symbol for each class, lines of equal cost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.tri import Triangulation

from reports.drawing import BLACK, canvas, svg

LOOKS: dict[str, tuple[str, str, str]] = {  # class: colour, hatch, marker of a point that was solved
    "converged": ("#CCE5F2", "", "."),
    "converged, nothing touches": ("#F5F5F5", "..", "."),
    "wrong": ("#D55E00", "xx", "X"),
    "end of the path": ("#F0E442", "//", "^"),
    "not converged": ("#CC79A7", "\\\\", "x"),
    "refused": ("#999999", "--", "_"),
    "crashed": ("#000000", "", "*"),
}
COSTS = (5, 10, 20, 50, 100, 200, 500)  # Newton iterations at which a line is drawn


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
    for name in names:
        own = asked[asked["class"] == name]
        axes.plot(own["j"], own["i"], linestyle="none", marker=LOOKS[name][2], color=BLACK, markersize=4)
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
    handles.append(Line2D([], [], color=BLACK, marker=".", linestyle="none", label="solved"))
    if not named:
        handles.append(Line2D([], [], color="#555555", linewidth=1, label="Newton iterations"))
    figure.legend(handles=handles, loc="outside upper center", ncols=4, fontsize=8)
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
    """Lines of equal Newton iterations between the points that converged."""
    if len(solved) < 4 or solved["i"].nunique() < 2 or solved["j"].nunique() < 2:
        return
    low, high = solved["iterations"].min(), solved["iterations"].max()
    levels = [level for level in COSTS if low < level < high]
    if levels:
        triangles = Triangulation(solved["j"], solved["i"])
        lines = axes.tricontour(triangles, solved["iterations"], levels=levels, colors="#555555", linewidths=0.9)
        axes.clabel(lines, fontsize=7, fmt="%d")


def _ticks(axes: Axes, points: pd.DataFrame, named: bool) -> None:
    """Values at every fourth line; names at every row."""
    for axis, index, value in ((axes.xaxis, "j", "x"), (axes.yaxis, "i", "y")):
        values = points.drop_duplicates(index).sort_values(index)[value]
        step = 1 if named and index == "i" else max(1, (len(values) - 1) // 8)
        places = list(range(0, len(values), step))
        axis.set_ticks(places, _tick_labels([str(values.iloc[k]) for k in places]))


def _tick_labels(texts: list[str]) -> list[str]:
    """Values in as few digits as tell them apart; names as they are."""
    try:
        numbers = [float(text) for text in texts]
    except ValueError:
        return texts
    return [_short(n, min((abs(n - m) for m in numbers if m != n), default=1.0)) for n in numbers]


def _short(number: float, gap: float) -> str:
    """Three digits, or as many as keep it from being taken for a neighbour at the distance ``gap``."""
    words = next(w for w in (f"{number:.{digits}g}" for digits in range(3, 18)) if abs(float(w) - number) <= gap / 20)
    return words.replace("e-0", "e-").replace("e+0", "e")
