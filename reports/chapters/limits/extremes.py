"""The page of extremes: maps of outcomes, how their boundaries were found, and each kind of failure in one sentence."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.tri import Triangulation

from reports.chapter import Chapter
from reports.chapters.limits.causes import cause
from reports.chapters.limits.limit_tables import limit_tables
from reports.drawing import BLACK, canvas, svg
from reports.formats import fixed, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

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
COSTS = (5, 10, 20, 50, 100, 200, 500)  # Newton iterations at which a line is drawn
INTRODUCTION = prose("""# Extremes

Where does solving stop? First a table of limits for every measure and every algorithm, with the error there; then maps.
Each map takes two settings to their extremes and shows what comes of it. Every point is a
small solve of its own, by `semismooth` unless the map says otherwise, followed by the judge of contact. Colours and
hatches are classes of outcomes: *converged*; converged though *nothing touches*; *converged, unstable*, where the
tangent has negative eigenvalues on the motions that contact leaves free; *wrong*, which is what the algorithm calls
converged and the judge does not certify; the *end of the path*, where the tangent tells of a limit point or a
bifurcation; *not converged* without such a reason; *refused*, by the range of a setting or by the algorithm; and
*crashed*. Lines and small numbers are the cost in Newton iterations, all load steps and rejected attempts included.""")
GOOD = ("converged", "converged, nothing touches")


def extremes_page(store: Store) -> Part:
    """The whole page."""
    points, maps = store.table("extremes"), store.table("extremes_maps")
    each = (_map(points[points["map"] == labels["map"]], labels) for _, labels in maps.iterrows())
    return joined(INTRODUCTION, limit_tables(store), _overview(store), *each)


def faults(store: Store) -> dict[str, int]:
    """How many solved points of all maps are of each class that is no success."""
    points = store.table("extremes")
    bad = points[points["asked"] & ~points["class"].isin(GOOD)]
    return {str(kind): int(count) for kind, count in bad["class"].value_counts().items()}


def _overview(store: Store) -> Part:
    """What was found, and at what share of the points."""
    points = store.table("extremes")
    titles = store.table("extremes_maps").astype(str).set_index("map")["title"].to_dict()
    rows = []
    for name, own in points.groupby("map", sort=False):
        counts = own["class"].value_counts().reindex(list(LOOKS), fill_value=0)
        spent = "" if own["complete"].all() else " (budget spent)"
        title = titles[str(name)]
        rows.append([f"[{title}](#{_anchor(title)})", f"{share(own['asked'].mean(), 0)}{spent}", *counts])
    asked, whole = int(points["asked"].sum()), len(points)
    found = faults(store)
    told = ", ".join(f"{count} {kind}" for kind, count in found.items()) or "none"
    text = prose(f"""## All maps

{points["map"].nunique()} maps of {whole} points in all. Their boundaries are located by cutting blocks in four wherever
two classes meet, down to single cells of the grid: {asked} points were solved, {share(asked / whole, 0)} of them.
Of the points solved, those without success are: {told}. The counts of the table are of all points, solved or between
solved ones of the same class. Of a boundary that was met both sides are solved; what is smaller than a block of the
first grid, whose size stands beside each map, and touches no such boundary, is not seen and not counted.""")
    header = ["map", "points solved", *LOOKS]
    by_class = table("Points of each map by class", header, rows, words=2)
    check = store.table("extremes_check")
    heads = "map | points | solved by the search | points of another class | boundary off by at most [cells]"
    line = "{map:name} | {points} | {asked} | {unlike} | {distance:off}"
    missed, of = int(check["unlike"].sum()), int(check["points"].sum())
    passed = ", ".join(f"*{titles[name]}*" for name in check["map"][check["unlike"] > 0])
    where = f": away from the boundaries it met and smaller than a block of the first grid, in {passed}"
    told = prose(f"""### Against all points

{len(check)} of the maps are cheap enough to be solved at all of their points, and are shown so. The search, by which
the others were made, takes {missed} of their {of} points for another class{where if missed else ""}.""")
    title, named = "Boundaries found against brute force", titles.__getitem__
    return joined(text, by_class, told, listing(title, check, heads, line, name=named, off=_distance))


def _distance(cells: float) -> str:
    return fixed(cells, 1) if np.isfinite(cells) else "missed"


def _anchor(title: str) -> str:
    """The fragment of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def _map(points: pd.DataFrame, labels: pd.Series) -> Part:
    """One map: its picture and its failures."""
    asked = points[points["asked"]]
    seen = _seen(labels)
    seen += "" if points["complete"].all() else " The budget was spent before the whole boundary was known."
    head = prose(f"""## {labels["title"]}

{len(asked)} of {len(points)} points solved ({share(points["asked"].mean(), 0)}); {labels["fixed"]}. {seen}""")
    words = f"Outcomes over {labels['x_label']} and {labels['y_label']}"
    shown = picture(f"extremes-{labels['map']}.svg", words, outcome_map(points, labels))
    failures, lines = [], []
    for kind, own in asked[~asked["class"].isin(GOOD)].groupby("class", sort=False):
        causes = [group for _, group in own.groupby(own["reason"].map(cause), sort=False)]
        told = []
        for group in sorted(causes, key=len, reverse=True):
            one = group.iloc[len(group) // 2]
            told.append(f"{cause(one['reason'])} ({len(group)}, as at {_value(one['x'])}, {_value(one['y'])})")
            lines.append(str(one["command"]))
        points_of = "point" if len(own) == 1 else "points"
        failures.append(f"- *{kind}* at {len(own)} solved {points_of}: {'; '.join(told)}.")
    return joined(head, shown, *((machine("\n".join(failures)), commands(lines)) if failures else ()))


def _seen(labels: pd.Series) -> str:
    """What the map cannot have missed, and what it can."""
    if labels["stride"] == 1:
        return "Nothing was passed by."
    across = "on a line" if labels["y_named"] else "each way"
    return f"The first grid has blocks of {labels['stride']} cells {across}; what is smaller may have been passed by."


def _value(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"


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


CHAPTER = Chapter(
    "extremes",
    "Extremes",
    "where solving stops, as maps of outcomes over pairs of extreme settings.",
    extremes_page,
    needs=("extremes", "extremes_maps", "extremes_check", "extremes_limits"),
    always=True,
)
