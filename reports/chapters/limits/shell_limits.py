"""The page "When is a shell not enough": from which thickness on, in which scene, why, and beside a measured ring."""

from __future__ import annotations

import math

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import Chapter
from reports.chapters.limits.ring_part import law_part, ring_part
from reports.figures.drawing import BLACK, canvas, looks, svg
from reports.formats import NOTHING, digits, share
from reports.markdown import Part, filled, table
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("shell-limits")
DEFAULT = "default"
PASSED = {"boundary_1": 0.01, "boundary_5": 0.05}
SMALLEST = 1e-5  # of an error that is drawn


def limits_page(store: Store) -> Part:
    """The whole page."""
    found, points = store.analysis("shell_boundaries"), store.table("shell_limits")
    headline = found[found["headline"]]
    usual = headline[headline["variant"] == DEFAULT]
    never, times = usual[usual["boundary_1"] == math.inf]["case"], usual["seconds_ratio"]
    within = f"; within what was solved the error stays below 1 % in: {', '.join(never)}" if len(never) else ""
    exact = usual[usual["judge"] == "closed form"]
    doubtful = found[~found["decided"].astype(bool) & (found["variant"] == DEFAULT)]
    told = {
        **{"far": int((usual["boundary_5"] < math.inf).sum()), "scenes": len(usual), "never": within},
        **{"usual": _worded(usual), "exact": len(exact), "worst": exact.sort_values("solid_off").iloc[-1]},
        **{"quickest": times.min(), "slowest": times.max(), "median": times.median(), "timed": times.count()},
        "doubtful": ", ".join(filled("{case}, {quantity}", doubtful)) or "none",
    }
    parts = {"options": _options(headline), "law": law_part(store), "ring": ring_part(store)}
    return TEXT("page", {"shell-limits.svg": errors(points, usual)}, title=CHAPTER.title, **told, **parts)


@svg
def errors(points: pd.DataFrame, usual: pd.DataFrame) -> Figure:
    """|error| over thickness, both logarithmic, with the levels of 1 and 5 per cent."""
    figure, (axes,) = canvas(width=8.5, height=5.5)
    chosen = points[points["variant"] == DEFAULT].merge(usual[["case", "quantity"]])
    for name, look in looks(usual["case"]).items():
        own = chosen[(chosen["case"] == name) & (chosen["error"].abs() > chosen["known_to"])]
        axes.loglog(own["ratio"], own["error"].abs(), **look.points, linestyle=look.line, label=name)
    for level in PASSED.values():
        axes.axhline(level, color=BLACK, linewidth=0.8, linestyle="--")
        axes.annotate(
            share(level, 0),
            (1.0, level),
            xycoords=("axes fraction", "data"),
            xytext=(3, -3),
            textcoords="offset points",
        )
    axes.set(xlabel="thickness over radius or span [-]", ylabel="error of the shell [-]", ylim=(SMALLEST, 1.0))
    figure.legend(loc="outside upper center", ncols=3)
    return figure


def _worded(rows: pd.DataFrame) -> pd.DataFrame:
    """Boundaries as words: not passed, passed from the thinnest on, or the thickness."""
    words = {name: [_boundary(row[name], row) for row in rows.to_dict("records")] for name in PASSED}
    return rows.assign(**words)


def _boundary(at: float, row: dict) -> str:
    if at == math.inf:
        return f"not up to {row['thickest']:g}"
    return f"below {row['thinnest']:g}" if at == 0 else digits(at, 2)


def _options(headline: pd.DataFrame) -> str:
    """The same boundary with other options of the shell."""
    own = headline[~headline["variant"].str.startswith("solid")]
    variants = [name for name in dict.fromkeys(own["variant"]) if name != DEFAULT]
    rows = []
    for case, of_case in own.groupby("case", sort=False):
        by = {row["variant"]: _boundary(row["boundary_1"], row) for row in of_case.to_dict("records")}
        rows.append([str(case), *(by.get(name, NOTHING) for name in (DEFAULT, *variants))])
    return table("1 % is passed at, by option", ["scene", "usual", *variants], rows)


CHAPTER = Chapter(
    "shell-limits",
    "When is a shell not enough",
    "from which thickness on, scene by scene, what a solid costs, the law at large strains, and a measured ring.",
    limits_page,
    needs=("shell_limits", "shell_boundaries", "ring_budget", "ring_inputs", "ring_states", "law_rules"),
    always=True,
)
