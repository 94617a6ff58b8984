"""The page of contact algorithms: do they agree, what do they cost, who claims too much, which ε, when not."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.chapters.contact.agreement import agreement_part
from reports.chapters.contact.arena import arena_part
from reports.chapters.contact.costs import USUAL, costs_part
from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import NOTHING, scientific
from reports.markdown import Part, commands, table
from reports.store.tables import Store
from reports.template import Template

EXACT = 1e-9  # an error below it is no error
PAPER = 1e4  # MPa/mm
SOFTEST = 1e-2  # of E/h: what fails below that fails for another reason than the penalty
PANELS = (  # column, words, what is drawn of it
    ("force_error", "relative error of the force", (1e-11, 1e1)),
    ("growth", "condition over that of exact contact", (3e-1, 1e12)),
)
ALONE = "alone"  # in the name of a solver that is taken at its word


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
    found = store.table("false_success")
    alone = found["contender"].str.contains(ALONE)
    ours = found[~alone]
    told = {
        "problems": found["problems"].max(),
        "count": len(ours),
        "ours": "; ".join(map(_quoted, ours["contender"])),
        "claims": ours["claimed"].sum(),
        "wrong": ours["false"].sum(),
        "versions": ", ".join(sorted(set(found["version"].dropna()))),
    }
    return TEXT("claims", **told, alone=found[alone], arena=_in_the_arena(store))


def _quoted(way: str) -> str:
    name, comma, setting = way.partition(",")
    return f"`{name}`{comma}{setting}"


def _in_the_arena(store: Store) -> Part:
    """The false claims of the default algorithm on harder problems."""
    if not store.has("solver_summary"):
        return Part()
    found = store.table("solver_summary")
    strictest = found["tolerance"] == found["tolerance"].min()
    rows = found[(found["solver"] == USUAL) & (found["size"] == "all") & strictest]
    if rows.empty:
        return Part()
    sums = rows[["claimed", "problems", "false"]].sum()
    counts = {"claimed": sums["claimed"], "problems": sums["problems"], "wrong": sums["false"]}
    return TEXT("claims-in-the-arena", tolerance=rows["tolerance"].min(), **counts)


def _cycles(store: Store) -> str:
    """Sets that repeat themselves."""
    found = store.table("cycles")
    ways = list(found.columns[2:])
    rows = [
        [line["problem"], _period(line["plain_period"]), *(line[way] for way in ways)]
        for line in found.to_dict("records")
    ]
    header = ["problem", "textbook", *map(_quoted, ways)]
    return table("From the set that the textbook begins with", header, rows, words=len(header))


def _period(period: int) -> str:
    return f"cycles, period {period}" if period else "converged"


def when_not_table() -> Part:
    """What not to use, when, and why."""
    return TEXT("when-not")


def _known(store: Store) -> Part:
    """Contact of other bodies than shells, with known answers; older stores have none."""
    parts = {name: part(store) for name, part in (("membrane", _membrane), ("plate", _plate))}
    return TEXT("known", **parts) if any(map(str, parts.values())) else Part()


def _membrane(store: Store) -> Part:
    """A membrane over a sphere, whose contact radius is known."""
    if not store.has("membrane"):
        return Part()
    data = store.table("membrane")
    finest = data[data["level"] == data.groupby(["element", "algorithm"])["level"].transform("max")]
    counts = {"algorithms": data["algorithm"].nunique(), "apart": data["apart"].max()}
    return TEXT("membrane", **counts, finest=finest[finest["algorithm"] == USUAL])


def _plate(store: Store) -> Part:
    """The GRECO plate without friction."""
    if not store.has("greco_plate"):
        return Part()
    data = store.table("greco_plate")
    largest = {"error": data["pressure_error"].max(), "apart": data["apart"].max()}
    return TEXT("plate", algorithms=data["algorithm"].nunique(), **largest)


def _penalty(store: Store) -> Part:
    """The recommendation, the problems that it rests on, and the paper's ε."""
    data, laws = store.table("epsilon"), store.table("epsilon_laws")
    sides, slopes = laws["element_over_h"], laws["force_slope"]
    told = {
        **{"smallest": sides.min(), "largest": sides.max(), "flattest": slopes.min(), "steepest": slopes.max()},
        **{"count": len(laws), "laws": laws, "paper": _paper(data, laws), "no_dearer": _no_dearer(data)},
        "commands": commands(data["command"][data["epsilon"] == PAPER]),
    }
    return TEXT("penalty", {"epsilon.svg": draw_penalty(data, laws)}, **told)


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


CHAPTER = chapter(
    TEXT,
    algorithms_page,
    needs=("cycles", "false_success", "epsilon", "epsilon_laws"),
    always=True,
)
