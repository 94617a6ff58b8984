"""The page of other programs: the same problems solved by them, from our decks or their own, values and times."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from reports.chapter import chapter
from reports.figures.drawing import BLACK, canvas, lines, svg
from reports.formats import NOTHING, fixed, number, percent, quantity, share
from reports.markdown import Part, Template, commands
from reports.store import Store

LEAST = 1e-5  # below it an error is chance
OURS = "footprint"
MEASURED = "footprint bench peers --table .footprint/store/tables/peers.csv"
DECKS = "footprint bench programs --store .footprint/store"
PARTS = {"start": "mesh and start", "assembly": "elements", "factorisation": "factorisation"}
MESH, PLIES = "mesh", "plies"  # reasons, as the table has them


def _why(value: object) -> str:
    return {MESH: "mesh", PLIES: "one direction of plies a brick", "open": "open"}.get(str(value), NOTHING)


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
    told = [{"sentence": sentence} for sentence in factors_said(others)]
    drawn = {"cost-peers.svg": work_precision(data[~linear])}
    beside = TEXT("linear", rows=list(_beside(data[linear]))) if linear.any() else Part()
    return TEXT("peers", drawn, said=told, factors=others, linear=beside, commands=commands([MEASURED]))


def _beside(linear: pd.DataFrame) -> Iterator[dict[str, Any]]:
    """A line a problem and mesh with the errors of both programs."""
    for (problem, mesh), own in linear.groupby(["problem", "mesh"], sort=False):
        errors = dict(zip(own["program"], own["error"], strict=True))
        known = {"problem": problem, "mesh": mesh, "uncertainty": own["uncertainty"].iloc[0]}
        yield known | {"ours": errors[OURS], "theirs": errors["kratos"]}


def factors_said(factors: pd.DataFrame) -> list[str]:
    """Of each problem and peer: how many times our time it takes, whether that is the bar, and where time goes."""
    said = []
    for problem, own in factors.groupby("problem", sort=False):
        ours = own[(own["program"] == OURS) & own["cheapest"]]
        for program, lines_of in own[own["program"] != OURS].groupby("program", sort=False):
            best = lines_of[lines_of["cheapest"]]
            within = share(float(own["within"].iloc[0]))
            if ours.empty or best.empty:
                who = " nor ".join(f"`{name}`" for name, of in ((OURS, ours), (program, best)) if of.empty)
                said.append(f"{problem}, within {within}: no line of {who} gets and stays there.")
            else:
                told = _compared(str(program), ours.iloc[0], best.iloc[0])
                said.append(f"{problem}, within {within}: {told}{_others(lines_of[~lines_of['cheapest']])}")
    return said


def _compared(program: str, ours: pd.Series, peer: pd.Series) -> str:
    took = f"`{program}` ({peer['family']}, {peer['mesh']}) takes {fixed(peer['factor'], 1)} times the time of "
    took += f"`{OURS}` ({ours['family']}, {ours['mesh']})"
    bar = peer["bar"]
    if pd.isna(bar):
        return f"{took}."
    if peer["factor"] >= bar:
        return f"{took}; the bar of {number(bar)} is met."
    floor = "would be met" if peer["bare"] >= bar else "would be missed"
    told = {"took": took, "program": program, "ours": _shares(ours), "theirs": _shares(peer), "floor": floor}
    return str(TEXT("floor", **told, bar=bar, bare=peer["bare"]))


def _others(lines_of: pd.DataFrame) -> str:
    """The factors of the lines that are not the cheapest of their program."""
    there = lines_of[lines_of["factor"].notna()].sort_values("factor", kind="stable")
    listed = ", ".join(f"{row['family']} {fixed(row['factor'], 1)}" for row in there.to_dict("records"))
    return f" Its other lines: {listed} times." if listed else ""


def _shares(line: pd.Series) -> str:
    parts = {text: float(line[f"share_{part}"]) for part, text in PARTS.items()}
    parts["the rest"] = 1 - sum(parts.values())
    ordered = sorted(parts.items(), key=lambda item: -item[1])
    return ", ".join(f"{text} {round(100 * value)} %" for text, value in ordered)


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
    finest = store.table("program_agreement")
    return TEXT("programs", finest=finest, agreements=" ".join(agreements(finest)), commands=commands([DECKS]))


def agreements(finest: pd.DataFrame) -> list[str]:
    """On how many scenes and quantities each program agrees, and what does not, with the reason."""
    said = []
    for (program, version), own in finest.groupby(["program", "version"], sort=False):
        near = own[own["within"]]
        said.append(
            f"{program} ({version}) runs {own['case'].nunique()} scenes from our decks; on the finest mesh of each, "
            f"{len(near)} of {len(own)} values (scenes: {near['case'].nunique()}) are within 1 % of ours."
        )
        said += [_beyond(row) for row in own[~own["within"]].to_dict("records")]
    return said


def _beyond(row: Mapping[Hashable, Any]) -> str:
    told = f"{quantity(row['quantity'])} of {row['case']} differs by {percent(row['difference'])}"
    if row["reason"] == PLIES:
        rule = "a deck has one direction of plies a brick, and our own solid under that rule is"
        return f"{told}: {rule} {percent(row['held_difference'])} from it on the same mesh."
    if row["reason"] == MESH:
        return f"{told}, which falls with the mesh at the rate {fixed(row['rate'], 1)}."
    return f"{told}, for a reason that is not known."


CHAPTER = chapter(TEXT, programs_page, needs=("programs", "program_agreement"))
