"""The page of extremes: how far each setting goes by measure and algorithm, and maps of outcomes over two settings."""

from __future__ import annotations

import numpy as np
import pandas as pd

from reports.chapter import Chapter
from reports.chapters.limits.causes import cause
from reports.chapters.limits.figures_extremes import LOOKS, PANELS, outcome_maps
from reports.formats import NOTHING, code, formatted, share
from reports.markdown import Part, commands, joined, machine, picture, prose, table
from reports.store.tables import Store

GOOD = ("converged", "converged, nothing touches")
ENOUGH = 0.01  # relative error within which a result counts as right
HALF = 0.5  # of the result


def extremes_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# {CHAPTER.title}

Where does solving stop, and where is what it returns no longer right? One setting after another is taken to its
extremes on small problems, then two at once. Everything that is called converged is judged.""")
    return joined(introduction, _limits(store.table("extremes_limits")), _maps(store))


def _limits(limits: pd.DataFrame) -> Part:
    """A line a setting for measures and one for algorithms."""
    text = prose("""## Limits by setting

*Goes to*: the last value on the way from an ordinary one to the bound that is searched at which a solve converges, is
certified and stable; the first failure is at most a factor of 1.26 farther. *Within 1 % to*: the last value up to which
the result, too, stays within 1 % of the reference. Both are grouped by value: beyond the second a certified result is
not a right one. Where the reference is a closed form, its error counts mesh and assumptions of the measure. Measures
are solved by `semismooth` (`regularised` for ε), algorithms with `exact`; a rotation is made in one step that is not
cut.""")
    heads = ["setting, searched", "of", "reference", "goes to", "within 1 % to", "fails because"]
    rows = [
        [f"{limit}, {own['symbol'].iloc[0]}: {_way(own)}", f"{part}s", own["reference"].iloc[0], *_line(own)]
        for (limit, part), own in limits.groupby(["limit", "part"], sort=False)
    ]
    shown = table("How far each setting goes", heads, rows, words=len(heads))
    return joined(text, machine(*filter(None, (shown, _false(limits)))), commands(_examples(limits)))


def _line(own: pd.DataFrame) -> list[str]:
    bound = own["bound"].astype(bool)
    reached = own["value"].map(_number).where(~bound, "the bound")
    right = own["right"].map(lambda value: _number(value) if value == value else "not at all")
    right = right.where(~(bound & (own["right"] == own["value"])), "the bound")
    beyond = own[~bound]
    why = _grouped(beyond["name"], beyond["reason"].map(cause)) if len(beyond) else NOTHING
    return [_grouped(own["name"], reached), _grouped(own["name"], right), why]


def _grouped(names: pd.Series, values: pd.Series) -> str:
    """The values with the names that have them; "all" for every name."""
    groups = list(names.groupby(values, sort=False))
    if len(groups) == 1:
        return f"{groups[0][0]} (all {len(names)})"
    ordered = sorted(groups, key=lambda each: len(each[1]), reverse=True)
    return "; ".join(f"{value}: {', '.join(map(code, own))}" for value, own in ordered)


def _number(value: float) -> str:
    return formatted(value, ".3g")


def _way(rows: pd.DataFrame) -> str:
    """From where to where is searched; two ends where measures and algorithms differ."""
    return f"{_number(rows['ordinary'].iloc[0])} to {_number(rows['searched_to'].iloc[0])}"


def _false(limits: pd.DataFrame) -> str:
    """Certified and yet far from right, at an end of a way that begins right."""
    wrong = limits[(limits["error"] > HALF) & (limits["error_ordinary"] < ENOUGH)]
    if wrong.empty:
        return ""
    names = "; ".join(
        f"{name} ({', '.join(map(code, own['name']))})" for name, own in wrong.groupby("limit", sort=False)
    )
    return f"Certified there, right at first, and wrong by half of the result or more: {names}."


def _examples(limits: pd.DataFrame) -> list[str]:
    """The command of the first name of each line."""
    return limits.drop_duplicates(["limit", "part"])["command"].astype(str).tolist()


def faults(store: Store) -> dict[str, int]:
    """How many solved points of all maps are of each class that is no success."""
    points = store.table("extremes")
    bad = points[points["asked"] & ~points["class"].isin(GOOD)]
    return {str(kind): int(count) for kind, count in bad["class"].value_counts().items()}


def _maps(store: Store) -> Part:
    """Counts and causes of every map, and the pictures of those with most failures."""
    points, maps = store.table("extremes"), store.table("extremes_maps")
    asked = points[points["asked"]]
    told = ", ".join(f"{count} {kind}" for kind, count in faults(store).items()) or "none"
    text = prose(f"""## Two settings at once

{points["map"].nunique()} maps of small solves, by `semismooth` unless the map goes by algorithm. Boundaries between
classes of outcomes are located by bisection: {len(asked)} of {len(points)} points are solved
({share(len(asked) / len(points), 0)}), and between solved points a colour is inferred. Solved without success: {told}.
*Unstable*: the tangent has negative eigenvalues on the motions that contact leaves free; *end of the path*: it shows a
limit point or a bifurcation; *not converged*: neither explains it; *wrong*: called converged, and refused by the
judge.{_budget(points)} {_passed(store)}""")
    kinds = [kind for kind in LOOKS if kind != GOOD[0] and (asked["class"] == kind).any()]
    own_of = {str(name): own for name, own in asked.groupby("map", sort=False)}
    rows, lines = [], []
    for labels in maps.to_dict("records"):
        own = own_of[str(labels["map"])]
        counts = own["class"].value_counts()
        why, command = _cause(own)
        lines += [command] if command else []
        rows.append(
            [labels["title"], f"{counts.get(GOOD[0], 0)} of {len(own)}", *(int(counts.get(k, 0)) for k in kinds), why]
        )
    heads = ["map", "converged", *(kind.removeprefix("converged, ") for kind in kinds), "cause"]
    shown = machine(table("Solved points of each map by class", heads, rows))
    chosen = _worst(points, maps)
    words = f"Outcomes over two settings: {'; '.join(chosen['title'])}"
    drawn = picture("extremes.svg", words, outcome_maps(points, chosen))
    return joined(text, drawn, shown, commands(lines) if lines else "")


def _budget(points: pd.DataFrame) -> str:
    spent = int((~points.groupby("map")["complete"].all()).sum())
    return f" On {spent} maps the budget was spent before the whole boundary was known." if spent else ""


def _cause(own: pd.DataFrame) -> tuple[str, str]:
    """The most frequent cause of what is neither a success nor merely unstable, and a command that shows it."""
    failed = own[~own["class"].isin((*GOOD, "converged, unstable"))]
    if failed.empty:
        return NOTHING, ""
    causes = failed["reason"].map(cause)
    first = str(causes.value_counts().index[0])
    same = failed[causes == first]
    return f"{first} ({len(same)} of {len(failed)})", str(same.iloc[len(same) // 2]["command"])


def _passed(store: Store) -> str:
    """What the search misses, where it was held against all points."""
    check = store.table("extremes_check")
    missed, of = int(check["unlike"].sum()), int(check["points"].sum())
    lost = int(np.isinf(check["distance"]).sum())
    away = f", with whole boundaries on {lost} maps" if lost else ""
    return (
        f"On {len(check)} maps solved at all points the search takes {missed} of {of} points for another class{away}."
    )


def _worst(points: pd.DataFrame, maps: pd.DataFrame) -> pd.DataFrame:
    """The maps of two settings with most points that fail, as many as there is room for, in their order."""
    bad = points[~points["class"].isin((*GOOD, "converged, unstable"))].groupby("map").size()
    pairs = maps[~maps["y_named"].astype(bool)]
    chosen = pairs["map"].map(bad).fillna(0).sort_values(ascending=False, kind="stable").index[:PANELS]
    return pairs.loc[sorted(chosen)]


CHAPTER = Chapter(
    "extremes",
    "Extremes",
    "how far each setting goes, where a certified answer is no longer right, and what stops a solve.",
    extremes_page,
    needs=("extremes", "extremes_maps", "extremes_check", "extremes_limits"),
    always=True,
)
