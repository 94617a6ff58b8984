"""The page of other programs: the same problems solved by them, from our decks or their own, values and times."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.figures.drawing import BLACK, canvas, lines, svg
from reports.formats import NOTHING
from reports.markdown import Part, Template, commands
from reports.store import Store

LEAST = 1e-5  # below it an error is chance
OURS = "footprint"
MEASURED = "footprint bench peers --table .footprint/store/tables/peers.csv"
DECKS = "footprint bench programs --store .footprint/store"
WHY = {"mesh": "mesh", "plies": "one direction of plies a brick", "open": "open"}  # reasons, as the table has them


def _why(value: object) -> str:
    return WHY.get(str(value), NOTHING)


TEXT = Template("programs", why=_why)


def programs_page(store: Store) -> Part:
    """The whole page: of the tables that were made, which take those programs."""
    return TEXT("page", peers=_peers(store), programs=_programs(store))


def _peers(store: Store) -> Part:
    """Work to an equal error beside NGSolve and Kratos; nothing where they were not run."""
    if not (store.has("peers") and store.has("peer_factors")):
        return Part()
    data, factors = store.table("peers"), store.table("peer_factors")
    linear = data["linear"].astype(bool)
    others = factors[~factors["problem"].isin(data["problem"][linear])]
    drawn = {"cost-peers.svg": work_precision(data[~linear])}
    beside = TEXT("linear", rows=list(_beside(data[linear]))) if linear.any() else Part()
    return TEXT("peers", drawn, factors=others, linear=beside, commands=commands([MEASURED]))


def _beside(linear: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A line a problem and mesh with the errors of both programs."""
    for (problem, mesh), own in linear.groupby(["problem", "mesh"], sort=False):
        errors = dict(zip(own["program"], own["error"], strict=True))
        known = {"problem": problem, "mesh": mesh, "uncertainty": own["uncertainty"].iloc[0]}
        yield known | {"ours": errors[OURS], "theirs": errors["kratos"]}


@svg
def work_precision(data: pd.DataFrame) -> Figure:
    """Error over units, a panel a problem; dotted what is asked for, grey below what the reference is known to."""
    groups = data.groupby("problem", sort=False)
    figure, panels = canvas(len(groups), columns=2, width=11.0, height=4.6)
    for axes, (problem, own) in zip(panels, groups, strict=True):
        own = own.assign(error=own["error"].abs().clip(lower=LEAST))
        named = own.groupby(["program", "family"], sort=False)
        lines(axes, {", ".join(map(str, key)): (each["units"], each["error"]) for key, each in named})
        axes.axhline(own["within"].iloc[0], color=BLACK, linewidth=1, linestyle=":")
        axes.axhspan(LEAST / 2, max(own["uncertainty"].iloc[0], LEAST / 2), color=BLACK, alpha=0.08, linewidth=0)
        axes.set(title=str(problem), xlabel="processor time [factorisations of 9840 unknowns]", ylabel="relative error")
        axes.set(xscale="log", yscale="log", ylim=(LEAST / 2, None))
        axes.legend(fontsize="small")
    return figure


def _programs(store: Store) -> Part:
    """Scenes in other programs from our decks, without an edit; nothing where they were not run."""
    if not (store.has("programs") and store.has("program_agreement")):
        return Part()
    return TEXT("programs", finest=store.table("program_agreement"), commands=commands([DECKS]))


CHAPTER = chapter(TEXT, programs_page, needs=("programs", "program_agreement"))
