"""The page "When is a shell not enough": from which thickness on, in which scene, why, and beside a measured ring."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.figures.drawing import BLACK, COLOURS, canvas, looks, svg
from reports.formats import digits, share
from reports.markdown import Part, Template, by_name, commands, filled, table
from reports.store import Store

TEXT = Template("shell-limits")
DEFAULT = "default"
PASSED = {"boundary_1": 0.01, "boundary_5": 0.05}
SMALLEST = 1e-5  # of an error that is drawn
SURFACES = "surfaces="
PARTS = ("mesh", "shell", "law", "friction", "reading", "remainder")
DRAWN = ("shell exact", "shell von-karman, ν = 0")
LAW = "solid hencky"


def limits_page(store: Store) -> Part:
    """The whole page."""
    boundaries, points = store.table("shell_boundaries"), store.table("shell_limits")
    headline = boundaries[boundaries["headline"]]
    usual = headline[headline["variant"] == DEFAULT]
    never, times = usual[usual["boundary_1"] == math.inf]["case"], usual["seconds_ratio"]
    within = f"; within the thicknesses solved the error stays below 1 % in: {', '.join(never)}" if len(never) else ""
    exact = usual[usual["judge"] == "closed form"]
    doubtful = boundaries[~boundaries["decided"].astype(bool) & (boundaries["variant"] == DEFAULT)]
    values = {
        **{"far": int((usual["boundary_5"] < math.inf).sum()), "scenes": len(usual), "never": within},
        **{"usual": _worded(usual), "exact": len(exact), "worst": exact.sort_values("solid_off").iloc[-1]},
        **{"quickest": times.min(), "slowest": times.max(), "median": times.median(), "timed": times.count()},
        "doubtful": ", ".join(filled("{case}, {quantity}", doubtful)) or "none",
    }
    parts = {
        "options": _options(headline),
        "surfaces": _surfaces(headline),
        "law": law_part(store),
        "ring": ring_part(store),
    }
    return TEXT("page", {"shell-limits.svg": errors(points, usual)}, **values, **parts)


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
    own = headline[~headline["variant"].str.startswith(SURFACES)]
    variants = [name for name in dict.fromkeys(own["variant"]) if name != DEFAULT]
    cases = (((case,), of_case) for case, of_case in own.groupby("case", sort=False))
    rows = by_name(cases, (DEFAULT, *variants), lambda row: _boundary(row["boundary_1"], row), "variant")
    return table("1 % is exceeded at, by option", ["scene", "usual", *variants], rows)


def _surfaces(headline: pd.DataFrame) -> Part:
    """How many surfaces a wall needs; nothing where none were tried."""
    own = headline[headline["variant"].str.startswith((DEFAULT, SURFACES))]
    counts = [name for name in dict.fromkeys(own["variant"]) if name != DEFAULT]
    if not counts:
        return Part()
    heads = ["2", *(name.removeprefix(SURFACES) for name in counts)]

    def rows(entry: Callable[[dict], object]) -> Iterator[list[object]]:
        cases = (((case,), of_case) for case, of_case in own.groupby("case", sort=False))
        return by_name(cases, (DEFAULT, *counts), entry, "variant")

    passed = table("1 % is exceeded at", ["scene", *heads], rows(lambda row: _boundary(row["boundary_1"], row)))
    thickest = table(
        "Error of the thickest wall solved, and seconds of the solid over those of the shell (median over the walls)",
        ["scene", *heads],
        rows(lambda row: f"{row['at_thickest']:+.2%}, {digits(row['seconds_ratio'], 2)}"),
    )
    enough = [own[(own["variant"] == name) & (own["boundary_1"] == math.inf)]["case"] for name in (DEFAULT, *counts)]
    counted = [f"{name} in {len(cases)}" for name, cases in zip(heads, enough, strict=True)]
    tried = [int((own["variant"] == name).sum()) for name in (DEFAULT, *counts)]
    words = [f"{each} of {n}" for each, n in zip(counted, tried, strict=True)]
    return TEXT("surfaces", enough="; ".join(words), passed=passed, thickest=thickest)


def ring_part(store: Store) -> Part:
    """Forces computed beside measured ones."""
    data, states = store.table("ring_budget"), store.table("ring_states")
    data["approach"] = 2 * data["delta_mm"]
    end = data[data["delta_mm"] == data["delta_mm"].max()]
    thick = end[end["body"] == LAW].iloc[0]
    widest = states[(states["state"] == "3d") & (states["delta_mm"] == states["delta_mm"].max())]["off"].iloc[0]
    known = dict(store.table("ring_inputs")[["input", "value"]].to_numpy())
    outer, inner = known["outer_mm"], known["inner_mm"]
    counts = data.groupby("body", sort=False)["within"].agg(["sum", "size"]).reset_index()
    values = {
        **{
            "known": known,
            "thick": thick,
            "over_radius": 2 * (outer - inner) / (outer + inner),
            "less": -float(widest),
        },
        **{"bodies": end.merge(counts, on="body"), "cancelling": _cancelling(data, thick)},
        "commands": commands(data["command"]),
    }
    return TEXT("ring", {"experiment.svg": draw_budget(data)}, **values)


def _cancelling(data: pd.DataFrame, thick: pd.Series) -> Part:
    """Agreement that is owed to errors of opposite sign."""
    others = data[data["wrong_reason"]]
    cancels = thick["friction"] * thick["remainder"] < 0
    first = [{**thick, "off": thick["limit_N"] / thick["measured_N"] - 1}] if cancels else []
    return TEXT("cancelling", thick=first, others=others) if first or len(others) else Part()


@svg
def draw_budget(data: pd.DataFrame) -> Figure:
    """Left: forces, measured dots and computed lines. Right: stacked parts with their signs, the dot is their sum."""
    figure, (forces, *budgets) = canvas(1 + len(DRAWN), width=13.0, height=5.0)
    names = list(dict.fromkeys(data["body"]))
    for name, look in looks(names).items():
        own = data[data["body"] == name]
        line = "-" if own["kind"].iloc[0] == "solid" else "--"
        forces.plot(own["approach"], own["force_N"], color=look.colour, linestyle=line, label=name)
    measured = data.drop_duplicates("approach")
    forces.plot(measured["approach"], measured["measured_N"], "o", color=BLACK, markersize=7, label="measured")
    forces.set(xlabel="approach of the plates [mm]", ylabel="force on half a plate [N]")
    forces.legend()
    ends = [_stacked(axes, data[data["body"] == name], name) for axes, name in zip(budgets, DRAWN, strict=True)]
    for axes in budgets:
        axes.set(ylim=(1.1 * min(low for low, _ in ends), 1.1 * max(high for _, high in ends)))
    budgets[-1].legend()
    return figure


def _stacked(axes: Axes, own: pd.DataFrame, name: str) -> tuple[float, float]:
    """Positive parts above zero and negative ones below; returns both ends."""
    places = np.arange(len(own))
    above, below = np.zeros(len(own)), np.zeros(len(own))
    for part, colour in zip(PARTS, COLOURS, strict=False):
        value = own[part].to_numpy()
        axes.bar(places, value, 0.6, bottom=np.where(value > 0, above, below), color=colour, label=part)
        above, below = above + np.maximum(value, 0), below + np.minimum(value, 0)
    axes.errorbar(
        places,
        own["difference_N"],
        own["u_val"],
        fmt="D",
        color=BLACK,
        capsize=4,
        label="computed minus measured, ± u_val",
    )
    axes.axhline(0.0, color=BLACK, linewidth=0.8)
    axes.set_xticks(places, [f"{value:g}" for value in own["approach"]])
    axes.set(xlabel="approach of the plates [mm]", ylabel="parts of the difference [N]", title=name)
    return float(below.min()), float(above.max())


def law_part(store: Store) -> Part:
    """Laws beside one another on bodies that carry in different ways."""
    rules = store.table("law_rules")
    worst = {str(kind): float(factor) for kind, factor in rules.groupby("carries")["factor"].max().items()}
    strains = {"stretched": 0.01 / worst["membrane"], "bent": 0.01 / worst["bending"]}
    return TEXT("law", cases=len(rules), **worst, **strains, rules=rules)


CHAPTER = chapter(
    TEXT,
    limits_page,
    needs=("shell_limits", "shell_boundaries", "ring_budget", "ring_inputs", "ring_states", "law_rules"),
    always=True,
)
