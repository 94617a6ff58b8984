"""The page of extremes: maps of outcomes, how their boundaries were found, and each kind of failure in one sentence."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.limits import figures_extremes
from reports.formats import fixed, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.tables import Store

INTRODUCTION = prose("""# Extremes

Where does solving stop? Each map takes two settings to their extremes and shows what comes of it. Every point is a
small solve of its own, by `semismooth` unless the map says otherwise, followed by the judge of contact. Colours and
hatches are classes of outcomes: *converged*; converged though *nothing touches*; *wrong*, which is what the algorithm
calls converged and the judge does not certify; the *end of the path*, where the tangent tells of a limit point or a
bifurcation; *not converged* without such a reason; *refused*, by the range of a setting or by the algorithm; and
*crashed*. Lines and small numbers are the cost in Newton iterations, all load steps and rejected attempts included. A
step is cut to a sixteenth of the load and no further.""")
GOOD = ("converged", "converged, nothing touches")
TANGENT = {  # what the end of a reason begins with, and what it says in short
    "limit point of the path": "the tangent shows a limit point",
    "bifurcation near": "the tangent shows a bifurcation",
    "no limit point": "the tangent gives no reason",
    "too few converged steps": "too few steps converged to tell why",
}


def extremes_page(store: Store) -> Part:
    """The whole page."""
    points, maps = store.table("extremes"), store.table("extremes_maps")
    each = (_map(points[points["map"] == labels["map"]], labels) for _, labels in maps.iterrows())
    return joined(INTRODUCTION, _overview(store), *each)


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
        counts = own["class"].value_counts().reindex(list(figures_extremes.LOOKS), fill_value=0)
        spent = "" if own["complete"].all() else " (budget spent)"
        title = titles[str(name)]
        rows.append([f"[{title}](#{_anchor(title)})", f"{share(own['asked'].mean(), 0)}{spent}", *counts])
    asked, whole = int(points["asked"].sum()), len(points)
    found = faults(store)
    told = ", ".join(f"{count} {kind}" for kind, count in found.items()) or "none"
    text = prose(f"""## All maps

{points["map"].nunique()} maps of {whole} points in all. Their boundaries are located by cutting blocks in four wherever
two classes meet, down to two cells of the grid: {asked} points were solved, {share(asked / whole, 0)} of them.
Of the points solved, those without success are: {told}. The counts of the table are of all points, solved or between
solved ones of the same class.""")
    header = ["map", "points solved", *figures_extremes.LOOKS]
    by_class = table("Points of each map by class", header, rows, words=2)
    check = store.table("extremes_check")
    met, lost = (check[np.isfinite(check["distance"]) == finite] for finite in (True, False))
    heads = "map | points | solved by the search | boundary off by at most [cells] | points of another class"
    line = "{map:name} | {points} | {asked} | {distance:off} | {unlike}"
    passed = ", ".join(f"*{titles[name]}*" for name in lost["map"])
    missed = f"""What is smaller than a block of the first grid can be missed: in {passed} a
class shows at {int(lost["unlike"].sum())} single points that the search passed by."""
    told = prose(f"""### Against all points

{len(check)} of the maps are cheap enough to be solved at all of their points. Where a boundary was met, it is nowhere
further than {fixed(float(met["distance"].max()), 1)} cells from the true one. {missed if len(lost) else ""}""")
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
    cut = "" if points["complete"].all() else " The budget was spent before the whole boundary was known."
    head = prose(f"""## {labels["title"]}

{len(asked)} of {len(points)} points solved ({share(points["asked"].mean(), 0)}); {labels["fixed"]}.{cut}""")
    words = f"Outcomes over {labels['x_label']} and {labels['y_label']}"
    shown = picture(f"extremes-{labels['map']}.svg", words, figures_extremes.outcome_map(points, labels))
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


def cause(reason: str) -> str:
    """What stopped a solve, and what the tangent says of it, without numbers, so that equal causes are counted."""
    first, *more = str(reason).split("; ")
    told = [short for clause in more for begin, short in TANGENT.items() if clause.startswith(begin)]
    return ", ".join([re.split(r" \(|, \d|: ", first)[0] if told else first, *told[:1]])


def _value(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"


CHAPTER = Chapter(
    "extremes",
    "Extremes",
    "where solving stops, as maps of outcomes over pairs of extreme settings.",
    extremes_page,
    needs=("extremes", "extremes_maps", "extremes_check"),
    always=True,
)
