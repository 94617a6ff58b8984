"""The page of the strain measures, and what to use: the configuration recommended for each problem and error.

All of the latter is read from the table ``choices``; what is enough was decided where that was made.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from reports.chapter import chapter
from reports.figures.drawing import GREY, canvas, legend_above, looks, svg
from reports.formats import code, codes, digits, fixed, formatted, percent, share
from reports.markdown import Part, Template, by_name, commands, filled, table
from reports.store import Store

TEXT = Template("measures")
LABEL, SIDES = "hemisphere {n} {options}", (8, 16, 32)  # of the cells of an option of the element, and its meshes
CHOICES, EXACT = "choices", "exact"
PROBLEM = ["scene", "settings"]
NO_OFFER = {**dict.fromkeys(("measure", "element", "contact", "spent"), ""), "error_at_most": None}
PANELS = 6  # of a picture
FORMULATION = "Formulation error in the limit of the meshes"
LEAST = 0.001  # relative, below which an error is not told


def measures_page(store: Store) -> Part:
    """The whole page: the limits, and the hemisphere on three meshes by the options of the element."""
    known = store.table("convergence_errors")
    known = known[(known["ladder"] == "hemisphere") & (known["quantity"] == "inward_mm") & (known["kind"] == "read")]
    reference = float(known["value"].iloc[0])
    rows, lines, start = [], [], LABEL.format(n=SIDES[0], options="")
    for options in (each.label.removeprefix(start) for each in store.planned if each.label.startswith(start)):
        cells = [store.cell(LABEL.format(n=n, options=options)) for n in SIDES]
        values = [cell.value("inward_mm", load_fraction=1.0) for cell in cells]
        rows.append([*options.split(), *(f"{fixed(v, 3)} ({percent(v / reference - 1)})" for v in values)])
        lines += [cell.command for cell in cells]
    header = ["interpolation", "thickness strain", "membrane", *(f"{n}x{n}" for n in SIDES)]
    options_table = table("Inward displacement of the hemisphere", header, rows, words=3)
    shown = {"limits": limits_part(store), "options": options_table, "commands": commands(lines)}
    return TEXT("page", reference=reference, **shown)


def smallest(rows: pd.DataFrame) -> pd.DataFrame:
    """Of each problem, what was found for the smallest error asked for."""
    return rows[rows["asked"] == rows.groupby(PROBLEM)["asked"].transform("min")]


def decision_part(store: Store) -> Part:
    """A line a problem and error: what is recommended, and what it takes."""
    data = store.table(CHOICES)
    offers = data[data["row"] == "offer"].drop_duplicates([*PROBLEM, "asked"])
    records = [{**row, **_offer(row)} for row in offers.to_dict("records")]
    lost = offers[(offers["mesh"] == "") & (offers["said"] != "")]
    unanswered = " ".join(filled("No configuration for `{scene}` within {asked:.0%}: {said}.", lost))
    scenes = codes(dict.fromkeys(offers[offers["command"].str.contains("grading=adapted")]["scene"]))
    adapted = f"The grid lines of {scenes} follow an error estimate, whose time is included." if scenes else ""
    lines = commands(filter(None, offers["command"]))
    return TEXT("recommended", adapted=adapted, unanswered=unanswered, offers=records, commands=lines)


def _offer(row: dict) -> dict[str, Any]:
    """The problem, and the words for what is recommended; none where nothing is."""
    if not row["mesh"]:
        return {"problem": problem(row), **NO_OFFER}
    measure, element = (row["name"], "default") if row["axis"] == "measure" else (EXACT, row["name"])
    wall = row["name"] if row["axis"] == "surfaces" else row.get("surfaces", "")
    wall = wall if isinstance(wall, str) else ""  # a table has gaps where there is none
    element = f"surfaces={wall}" if row["axis"] == "surfaces" else f"{element}, surfaces={wall}" if wall else element
    spent = digits(row["seconds"], 2) if str(row["tried"]) == "True" else f"about {digits(row['seconds'], 2)}"
    chosen = {"measure": code(measure), "element": element, "contact": code(row["contact"]), "spent": spent}
    return {"problem": problem(row), **chosen}


def problem(row: dict) -> str:
    """A problem in words: its scene, settings and quantity."""
    named = f"`{row['scene']}`" + (f" at {row['settings']}" if row["settings"] else "")
    return named + (f": {row['quantity']}" if row["quantity"] else "")


def limits_part(store: Store) -> Part:
    """The error of each measure in the limit of the meshes, with its interval."""
    own = store.table("measure_limits")
    two_faces = own[own["name"] == EXACT]["formulation_error"].abs() >= LEAST
    without = "" if two_faces.any() else EXACT  # which is in error where two faces are
    return TEXT("limits", table=by_problem(FORMULATION, own, limit_error, without))


def by_problem(title: str, own: pd.DataFrame, entry: Callable[[dict], str], without: str = "") -> str:
    """A table with a line a problem and a column a name."""
    names = [name for name in dict.fromkeys(own["name"]) if name != without]
    problems = (((problem(each.iloc[0].to_dict()),), each) for _, each in own.groupby(PROBLEM, sort=False))
    rows = by_name(problems, names, entry)
    return table(title, ["problem", *map(code, names)], rows)


def limit_error(row: dict) -> str:
    """The formulation error of a row with its interval, or the word of its verdict where it is not known."""
    error, within = row["formulation_error"], row["within"]
    if error is None or math.isnan(error):
        return row["verdict"]
    if abs(error) + within < LEAST:
        return f"below {formatted(LEAST, '.1%')}"
    if within > abs(error):
        return f"not settled, at most {formatted(abs(error) + within, '.1%')}"
    form = ".2%" if within < LEAST / 2 else ".1%"
    return f"{formatted(error, '+' + form)} ± {formatted(within, form)}" + " †" * bool(row["coarse"])


def measures_picture(store: Store) -> Part:
    """The error of measures over seconds, a panel a problem."""
    return TEXT("measures", {"index-measures.svg": errors_over_seconds(store.table(CHOICES))})


@svg
def errors_over_seconds(data: pd.DataFrame) -> Figure:
    """A panel a problem, of the smallest error asked for; the dotted line is that error."""
    own = smallest(data[(data["row"] == "grid") & (data["axis"] == "measure")])
    shown, looked = list(_shown(own)), looks(own["name"])
    figure, panels = canvas(max(len(shown), 1), columns=2, width=8.0, head=0.9, height=2.8)
    for axes, each in zip(panels, shown, strict=False):
        for name, rows in each.groupby("name", sort=False):
            total = rows["seconds"].cumsum()
            axes.plot(total, 100 * rows["error_at_most"], **looked[name].whole, linewidth=1.2, markersize=4)
        axes.axhline(100 * each["asked"].min(), color=GREY, linewidth=1.0, linestyle=":")
        axes.set(xscale="log", yscale="log")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1.0, 3.0), numticks=6))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())
        first = each.iloc[0]
        axes.set_title(f"{first['scene']} {first['settings']}\n{first['quantity']}", fontsize=9)
    for axes in panels[::2]:
        axes.set_ylabel("error at most [%]")
    for axes in panels[-2:]:
        axes.set_xlabel("accumulated processor time of the grids [s]")
    for name, own_look in looked.items():
        panels[0].plot([], [], **own_look.whole, label=name)
    legend_above(figure, panels[0], columns=4)
    return figure


def _shown(rows: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """The last problem of each regime, the others from the last on, as many as there is room for; in their order."""
    problems = [each for _, each in rows.groupby(PROBLEM, sort=False)]
    last = {each["regime"].iloc[0]: n for n, each in enumerate(problems)}
    first = sorted(last.values())
    chosen = [*first, *(n for n in reversed(range(len(problems))) if n not in first)][:PANELS]
    yield from (problems[n] for n in sorted(chosen))


def options_part(store: Store) -> Part:
    """Options of the element: what the cheapest mesh of each takes, folded."""
    data = store.table(CHOICES)
    own = data[(data["row"] == "variant") & (data["axis"] == "element")]
    if own.empty:
        return Part()
    own = own[own["asked"] == own["asked"].min()]
    title = f"The mesh from which on the error is certainly within {share(own['asked'].min(), 0)}"
    return TEXT("options", table=by_problem(title, own, _mesh))


def _mesh(row: dict) -> str:
    return f"{row['mesh']} ({digits(row['seconds'], 2)} s)" if row["mesh"] else row["verdict"]


CHAPTER = chapter(TEXT, measures_page, needs=("convergence_errors", CHOICES, "measure_limits"), always=True)
