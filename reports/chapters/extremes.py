"""The page of extremes: how far each setting goes by measure and algorithm, and maps of outcomes over two settings.

In the picture of maps classes are colours and hatches, and points that were solved are dots.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from reports.chapter import chapter
from reports.figures.drawing import BLACK, canvas, svg
from reports.formats import NOTHING, codes, formatted
from reports.markdown import Part, Template, commands, picture, table
from reports.store import Store

TEXT = Template("extremes")
GOOD = ("converged", "converged, nothing touches")
ENOUGH = 0.01  # relative error within which a result counts as right
HALF = 0.5  # of the result
TANGENT = {  # what the end of a reason begins with, and what it says in short
    "limit point of the path": "the tangent shows a limit point",
    "bifurcation near": "the tangent shows a bifurcation",
    "no limit point": "the tangent gives no reason",
    "too few converged steps": "too few steps converged to tell why",
}
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


def extremes_page(store: Store) -> Part:
    """The whole page."""
    limits = store.table("extremes_limits")
    examples = limits.drop_duplicates(["limit", "part"])["command"]  # of the first name of each line
    parts = {"limits": list(_limits(limits)), "false": _false(limits), "commands": commands(examples)}
    return TEXT("page", **parts, **_maps(store))


def cause(reason: str) -> str:
    """What stopped a solve, and what the tangent says of it, without numbers, so that equal causes are counted."""
    first, *more = str(reason).split("; ")
    for begin, short in TANGENT.items():
        if first.startswith(begin):
            return short
    tangent = [short for clause in more for begin, short in TANGENT.items() if clause.startswith(begin)]
    return ", ".join([re.split(r" \(|, \d|: ", first)[0] if tangent else first, *tangent[:1]])


def _limits(limits: pd.DataFrame) -> Iterator[dict[Any, Any]]:
    """A line a setting for measures and one for algorithms: how far it goes, how far it is right, why it fails."""
    for _, own in limits.groupby(["limit", "part"], sort=False):
        bound = own["bound"].astype(bool)
        reached = own["value"].map(_number).where(~bound, "the bound")
        right = own["right"].map(lambda value: _number(value) if value == value else "not at all")
        right = right.where(~(bound & (own["right"] == own["value"])), "the bound")
        beyond = own[~bound]
        why = _grouped(beyond["name"], beyond["reason"].map(cause)) if len(beyond) else ""
        ends = {"reached": _grouped(own["name"], reached), "right": _grouped(own["name"], right), "why": why}
        yield {**own.iloc[0], **ends}


def _grouped(names: pd.Series, values: pd.Series) -> str:
    """The values with the names that have them; "all" for every name."""
    groups = list(names.groupby(values, sort=False))
    if len(groups) == 1:
        return f"{groups[0][0]} (all {len(names)})"
    ordered = sorted(groups, key=lambda each: len(each[1]), reverse=True)
    return "; ".join(f"{value}: {codes(own)}" for value, own in ordered)


def _number(value: float) -> str:
    return formatted(value, ".3g")


def _false(limits: pd.DataFrame) -> Part:
    """Certified and yet far from right, at an end of a way that begins right."""
    wrong = limits[(limits["error"] > HALF) & (limits["error_ordinary"] < ENOUGH)]
    named = "; ".join(f"{name} ({codes(own)})" for name, own in wrong.groupby("limit", sort=False)["name"])
    return TEXT("false", names=named) if named else Part()


def faults(store: Store) -> dict[str, int]:
    """How many solved points of all maps are of each class that is not a success."""
    points = store.table("extremes")
    bad = points[points["asked"] & ~points["class"].isin(GOOD)]
    return {str(kind): int(count) for kind, count in bad["class"].value_counts().items()}


def _maps(store: Store) -> dict[str, Any]:
    """Counts and causes of every map, and the pictures of those with most failures."""
    points, maps, check = (store.table(name) for name in ("extremes", "extremes_maps", "extremes_check"))
    asked = points[points["asked"]]
    lost = int(np.isinf(check["distance"]).sum())
    away = f", with whole boundaries on {lost} maps" if lost else ""
    missed = {"missed": int(check["unlike"].sum()), "points": int(check["points"].sum())}
    shown, examples = _counted(asked, maps)
    chosen = _worst(points, maps)
    words = f"Outcomes over two settings: {'; '.join(chosen['title'])}"
    return {
        "maps": points["map"].nunique(),
        "asked": len(asked),
        "points": len(points),
        "asked_share": len(asked) / len(points),
        "faults": ", ".join(f"{count} {kind}" for kind, count in faults(store).items()) or "none",
        "passed": TEXT("passed", maps=len(check), **missed, away=away),
        "pictures": picture("extremes.svg", words, outcome_maps(points, chosen)),
        "table": shown,
        "examples": commands(examples),
    }


def _counted(asked: pd.DataFrame, maps: pd.DataFrame) -> tuple[str, list[str]]:
    """A line a map: its solved points by class, and their most frequent cause, with a command that shows it."""
    kinds = [kind for kind in LOOKS if kind != GOOD[0] and (asked["class"] == kind).any()]
    own_of = {str(name): own for name, own in asked.groupby("map", sort=False)}
    rows, examples = [], []
    for labels in maps.to_dict("records"):
        own = own_of[str(labels["map"])]
        counts = own["class"].value_counts()
        why, command = _cause(own)
        examples += [command] if command else []
        good = f"{counts.get(GOOD[0], 0)} of {len(own)}"
        rows.append([labels["title"], good, *(int(counts.get(kind, 0)) for kind in kinds), why])
    heads = ["map", "converged", *(kind.removeprefix("converged, ") for kind in kinds), "cause"]
    return table("Solved points of each map by class", heads, rows), examples


def _cause(own: pd.DataFrame) -> tuple[str, str]:
    """The most frequent cause of what is neither a success nor merely unstable, and a command that shows it."""
    failed = own[~own["class"].isin((*GOOD, "converged, unstable"))]
    if failed.empty:
        return NOTHING, ""
    causes = failed["reason"].map(cause)
    first = str(causes.value_counts().index[0])
    same = failed[causes == first]
    return f"{first} ({len(same)} of {len(failed)})", str(same.iloc[len(same) // 2]["command"])


def _worst(points: pd.DataFrame, maps: pd.DataFrame) -> pd.DataFrame:
    """The maps of two settings with most points that fail, as many as there is room for, in their order."""
    bad = points[~points["class"].isin((*GOOD, "converged, unstable"))].groupby("map").size()
    pairs = maps[~maps["y_named"].astype(bool)]
    chosen = pairs["map"].map(bad).fillna(0).sort_values(ascending=False, kind="stable").index[:PANELS]
    return pairs.loc[sorted(chosen)]


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
    shown = next((each for each in labels if _tell_apart(each, values)), [f"{values[place]!r}" for place in few])
    return [float(place) for place in few], shown


def _tell_apart(labels: list[str], values: np.ndarray) -> bool:
    """Are they all different, and none rounded beyond the ends?"""
    near = 1e-12 * float(np.max(np.abs(values)))
    within = (values.min() - near <= float(label) <= values.max() + near for label in labels)
    return len(set(labels)) == len(labels) and all(within)


def _power(value: float) -> str:
    """1e-05 as a power, what is near one as it is."""
    exponent = round(math.log10(value))
    return f"{value:g}" if -3 <= exponent <= 3 else f"$10^{{{exponent}}}$"


CHAPTER = chapter(
    TEXT, extremes_page, needs=("extremes", "extremes_maps", "extremes_check", "extremes_limits"), always=True
)
