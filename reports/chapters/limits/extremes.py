"""The page of extremes: maps of outcomes, how their boundaries were found, and each kind of failure in one sentence."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.limits.causes import cause
from reports.chapters.limits.figures_extremes import LOOKS, outcome_map
from reports.chapters.limits.limit_tables import limit_tables
from reports.formats import fixed, share
from reports.markdown import Part, commands, fold, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

INTRODUCTION = prose("""# Extremes

Where does solving stop? First a table of limits for every measure and every algorithm, with the error there; then maps.
Each map takes two settings to their extremes and shows what comes of it; its picture is in a fold. Every point is a
small solve of its own, by `semismooth` unless the map says otherwise, followed by the judge of contact. Colours and
hatches are classes of outcomes: *converged*; converged though *nothing touches*; *converged, unstable*, where the
tangent has negative eigenvalues on the motions that contact leaves free; *wrong*, which is what the algorithm calls
converged and the judge does not certify; the *end of the path*, where the tangent shows a limit point or a
bifurcation; *not converged* without such a reason; *refused*, by the range of a setting or by the algorithm; and
*crashed*. Small numbers are the cost in Newton iterations, all load steps and rejected attempts included; between
solved points a colour is inferred from those around.""")
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
    found = machine("\n".join(failures)) if failures else "Every solved point is a success."
    return joined(head, found, fold("The map", shown, commands(lines) if lines else ""))


def _seen(labels: pd.Series) -> str:
    """What the map cannot have missed, and what it can."""
    if labels["stride"] == 1:
        return "Nothing was passed by."
    across = "on a line" if labels["y_named"] else "each way"
    return f"The first grid has blocks of {labels['stride']} cells {across}; what is smaller may have been passed by."


def _value(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"


CHAPTER = Chapter(
    "extremes",
    "Extremes",
    "where solving stops, as maps of outcomes over pairs of extreme settings.",
    extremes_page,
    needs=("extremes", "extremes_maps", "extremes_check", "extremes_limits"),
    always=True,
)
