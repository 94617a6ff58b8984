"""The page of extremes: how far each setting goes by measure and algorithm, and maps of outcomes over two settings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from reports.chapter import chapter
from reports.chapters.limits.figures_extremes import LOOKS, PANELS, outcome_maps
from reports.formats import NOTHING, codes, formatted
from reports.markdown import Part, commands, picture, table
from reports.store.tables import Store
from reports.template import Template

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
    told = [short for clause in more for begin, short in TANGENT.items() if clause.startswith(begin)]
    return ", ".join([re.split(r" \(|, \d|: ", first)[0] if told else first, *told[:1]])


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
    """How many solved points of all maps are of each class that is no success."""
    points = store.table("extremes")
    bad = points[points["asked"] & ~points["class"].isin(GOOD)]
    return {str(kind): int(count) for kind, count in bad["class"].value_counts().items()}


def _maps(store: Store) -> dict[str, Any]:
    """Counts and causes of every map, and the pictures of those with most failures."""
    points, maps, check = (store.table(name) for name in ("extremes", "extremes_maps", "extremes_check"))
    asked = points[points["asked"]]
    spent, lost = int((~points.groupby("map")["complete"].all()).sum()), int(np.isinf(check["distance"]).sum())
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
        "budget": TEXT("budget", maps=spent) if spent else "",
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


CHAPTER = chapter(
    TEXT,
    extremes_page,
    needs=("extremes", "extremes_maps", "extremes_check", "extremes_limits"),
    always=True,
)
