"""The page of contact algorithms: do they agree, what do they cost, who claims too much, which ε, when not."""

from __future__ import annotations

import math
from collections.abc import Iterator
from math import prod

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, NullLocator

from reports.chapter import chapter
from reports.chapters.arena import agreement_part, arena_part
from reports.chapters.measures import CHOICES, PROBLEM, problem
from reports.figures.drawing import BLACK, GREY, canvas, legend_above, looks, svg
from reports.formats import NOTHING, code, digits, scientific, share
from reports.markdown import Part, Template, by_name, commands, table
from reports.store import Store

EXACT = 1e-9  # an error below it is not an error
PAPER = 1e4  # MPa/mm
SOFTEST = 1e-2  # of E/h: what fails below that fails for another reason than the penalty
PANELS = (  # column, words, what is drawn of it
    ("force_error", "relative error of the force", (1e-11, 1e1)),
    ("growth", "condition number over that of exact contact", (3e-1, 1e12)),
)
ALONE = "alone"  # in the name of a solver that is taken at its word
USUAL, CONVERGED = "semismooth", "converged"
NEEDS = (
    *("algorithm_agreement", "cycles", "false_success", "epsilon", "epsilon_laws"),
    *("membrane", "greco_plate", CHOICES),
)
NOT_SOLVED = ("refused", "not tried")  # verdicts without seconds of their own


def _error(error: float) -> str:
    return f"under {scientific(EXACT, 0)}" if error < EXACT else scientific(error, 0)


def _fails(value: float) -> str:
    return NOTHING if math.isnan(value) else "any ε" if value < SOFTEST else f"{value:.2g} E/h"


TEXT = Template("algorithms", error=_error, fails=_fails)


def algorithms_page(store: Store) -> Part:
    """The whole page."""
    parts = {
        "agreement": agreement_part(store),
        "costs": costs_part(store),
        "claims": _claims(store),
        "cycles": _cycles(store),
        "penalty": _penalty(store),
        "when_not": when_not_table(),
        "known": _known(store),
        "arena": arena_part(store),
    }
    return TEXT("page", **parts)


def _claims(store: Store) -> Part:
    """Who says that it has solved a problem, and has not."""
    claims = store.table("false_success")
    alone = claims["contender"].str.contains(ALONE)
    ours = claims[~alone]
    values = {
        "problems": claims["problems"].max(),
        "count": len(ours),
        "ours": "; ".join(map(_quoted, ours["contender"])),
        "claims": ours["claimed"].sum(),
        "wrong": ours["false"].sum(),
        "versions": ", ".join(sorted(set(claims["version"].dropna()))),
    }
    return TEXT("claims", **values, alone=claims[alone], arena=_in_the_arena(store))


def _quoted(way: str) -> str:
    name, comma, setting = way.partition(",")
    return f"`{name}`{comma}{setting}"


def _in_the_arena(store: Store) -> Part:
    """The false claims of the default algorithm on harder problems."""
    if not store.has("solver_summary"):
        return Part()
    summary = store.table("solver_summary")
    strictest = summary["tolerance"] == summary["tolerance"].min()
    rows = summary[(summary["solver"] == USUAL) & (summary["size"] == "all") & strictest]
    if rows.empty:
        return Part()
    sums = rows[["claimed", "problems", "false"]].sum()
    counts = {"claimed": sums["claimed"], "problems": sums["problems"], "wrong": sums["false"]}
    return TEXT("claims-in-the-arena", tolerance=rows["tolerance"].min(), **counts)


def _cycles(store: Store) -> str:
    """Sets that repeat themselves."""
    cycles = store.table("cycles")
    ways = list(cycles.columns[2:])
    rows = [
        [line["problem"], _period(line["plain_period"]), *(line[way] for way in ways)]
        for line in cycles.to_dict("records")
    ]
    header = ["problem", "textbook", *map(_quoted, ways)]
    return table("From the starting set of the textbook", header, rows, words=len(header))


def _period(period: int) -> str:
    return f"cycles, period {period}" if period else "converged"


def when_not_table() -> Part:
    """What not to use, when, and why."""
    return TEXT("when-not")


def _known(store: Store) -> Part:
    """Contact of other bodies than shells, with known answers."""
    return TEXT("known", membrane=_membrane(store.table("membrane")), plate=_plate(store.table("greco_plate")))


def _membrane(data: pd.DataFrame) -> Part:
    """A membrane over a sphere, whose contact radius is known."""
    finest = data[data["level"] == data.groupby(["element", "algorithm"])["level"].transform("max")]
    counts = {"algorithms": data["algorithm"].nunique(), "apart": data["apart"].max()}
    return TEXT("membrane", **counts, finest=finest[finest["algorithm"] == USUAL])


def _plate(data: pd.DataFrame) -> Part:
    """The GRECO plate without friction."""
    largest = {"error": data["pressure_error"].max(), "apart": data["apart"].max()}
    return TEXT("plate", algorithms=data["algorithm"].nunique(), **largest)


def _penalty(store: Store) -> Part:
    """The recommendation, the problems that it rests on, and the paper's ε."""
    data, laws = store.table("epsilon"), store.table("epsilon_laws")
    sides, slopes = laws["element_over_h"], laws["force_slope"]
    values = {
        **{"smallest": sides.min(), "largest": sides.max(), "flattest": slopes.min(), "steepest": slopes.max()},
        **{"count": len(laws), "laws": laws, "paper": _paper(data, laws), "no_dearer": _no_dearer(data)},
        "commands": commands(data["command"][data["epsilon"] == PAPER]),
    }
    return TEXT("penalty", {"epsilon.svg": draw_penalty(data, laws)}, **values)


def _no_dearer(data: pd.DataFrame) -> int:
    """In how many problems exact contact takes no more iterations than the paper's epsilon."""
    kept = data[data["form"] == "multiplier"]
    exact, paper = (kept[kept["epsilon"] == at].set_index("case")["iterations"] for at in (np.inf, PAPER))
    return int((exact <= paper).sum())


def _paper(data: pd.DataFrame, laws: pd.DataFrame) -> Part:
    """The paper's epsilon on its tyre."""
    known = laws[laws["case"] == "tyre"]
    rows = data[(data["case"] == "tyre") & (data["form"] == "displacement") & (data["epsilon"] == PAPER)]
    if known.empty or rows.empty:
        return Part()
    row = rows.iloc[0]
    return TEXT("paper", **row, over_wall=PAPER / known["wall"].iloc[0], off=abs(row["force_error"]))


@svg
def draw_penalty(data: pd.DataFrame, laws: pd.DataFrame) -> Figure:
    """A penalty method over ε h/E, a colour a problem; hollow: the tolerance is not reached. Dotted: ε = E/h.

    What is not even of the size of the answer is left out.
    """
    exact = data[~np.isfinite(data["epsilon"])].set_index("case")["condition"]
    own = data[(data["form"] == "displacement") & (data["force_error"].abs() < 1)]
    own = own.assign(
        at=own["epsilon"] / own["case"].map(laws.set_index("case")["wall"]),
        growth=own["condition"] / own["case"].map(exact),
    )
    drawn, (figure, every) = looks(own["case"]), canvas(len(PANELS), width=10.0, height=4.4)
    for axes, (column, label, limits) in zip(every, PANELS, strict=True):
        for case, look in drawn.items():
            rows = own[own["case"] == case]
            value, converged = rows[column].abs(), rows["outcome"] == "converged"
            axes.loglog(rows["at"], value, **look.dashes)
            axes.plot([], [], **look.whole, label=case)
            for fill, chosen in (("full", converged), ("none", ~converged)):
                axes.loglog(rows["at"], value.where(chosen), **look.points, linestyle="none", fillstyle=fill)
        axes.axvline(1.0, color=BLACK, linestyle=":", linewidth=1)
        axes.set(xlabel="ε over E/h", ylabel=label, ylim=limits)
    every[0].plot([], [], "o", color=BLACK, fillstyle="none", label="residual above 1e-9")
    legend_above(figure, every[0], columns=5)
    return figure


def costs_part(store: Store) -> Part:
    """What they cost, under its heading."""
    data = _solves(store)
    errors = " and of ".join(share(error, 0) for error in sorted(data["asked"].unique(), reverse=True))
    names = sorted(dict.fromkeys(data["name"]), key=lambda name: name != USUAL)
    meshes = (((problem(first), first["mesh"]), tried) for first, tried in _meshes(data))
    rows = by_name(meshes, names, _spent)
    shown = table("Seconds and iterations by algorithm and mesh", ["problem", "mesh", *map(code, names)], rows, words=2)
    return TEXT("costs", errors=errors, rules=store.rules(), table=shown)


def costs_picture(store: Store) -> Part:
    """Who solves what at which cost."""
    data = _solves(store)
    return TEXT("costs-picture", {"index-algorithms.svg": seconds_by_algorithm(data)}, rules=store.rules())


def _solves(store: Store) -> pd.DataFrame:
    data = store.table(CHOICES)
    return data[data["row"] == "algorithm"].drop_duplicates([*PROBLEM, "mesh", "name"], keep="last")


def _meshes(data: pd.DataFrame) -> Iterator[tuple[dict, pd.DataFrame]]:
    """The solves of each problem on each of its meshes, the coarsest first, behind the first of them."""
    data = data.assign(elements=[prod(map(int, mesh.split("x"))) for mesh in data["mesh"]])
    for _, solved in data.groupby(PROBLEM, sort=False):
        for _, tried in solved.groupby("elements"):
            yield tried.iloc[0].to_dict(), tried


def _spent(row: dict) -> str:
    if row["verdict"] != CONVERGED:
        return str(row["verdict"])
    return f"{digits(row['seconds'], 2)} ({row['iterations']:.0f})"


@svg
def seconds_by_algorithm(data: pd.DataFrame) -> Figure:
    """A line a problem and mesh, a mark an algorithm, hollow where it did not converge in time."""
    lines = [(first, tried.set_index("name")) for first, tried in _meshes(data)]
    lines = [(first, tried) for first, tried in lines if tried["verdict"].get(USUAL) == CONVERGED]
    looked = looks(name for name in dict.fromkeys(data["name"]) if name != USUAL)
    figure, (axes,) = canvas(width=8.0, height=1.2 + 0.38 * len(lines), head=0.6)
    labels = []
    for place, (first, tried) in enumerate(lines):
        usual = tried["seconds"][USUAL]
        settings = f" {first['settings']}" if first["settings"] else ""
        labels.append(f"{first['scene']}{settings}\n{first['mesh']}, {digits(usual, 2)} s")
        for rank, (name, style) in enumerate(looked.items()):
            if name not in tried.index:
                continue
            own, height = tried.loc[name], place + 0.12 * (rank - (len(looked) - 1) / 2)
            if own["verdict"] not in NOT_SOLVED:
                face = style.colour if own["verdict"] == CONVERGED else "none"
                axes.plot([own["seconds"] / usual], [height], linestyle="", **style.points, markerfacecolor=face)
    for name, style in looked.items():
        axes.plot([], [], linestyle="", **style.points, label=name)
    axes.axvline(1.0, color=GREY, linewidth=1.0)
    axes.set(xscale="log", xlabel=f"seconds over those of {USUAL}", ylim=(len(lines) - 0.5, -0.5))
    axes.set_yticks(range(len(lines)), labels, fontsize=8)
    axes.set_xticks([0.5, 0.7, 1.0, 1.4, 2.0], ["0.5", "0.7", "1", "1.4", "2"])
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_formatter(NullFormatter())
    legend_above(figure, axes, columns=3)
    return figure


CHAPTER = chapter(TEXT, algorithms_page, needs=NEEDS, always=True)
