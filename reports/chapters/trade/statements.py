"""The part of stated errors: whether what ``--error`` states holds, how wide it is, and what it costs."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import fixed, share
from reports.markdown import Part, commands, joined, listing, picture, prose
from reports.store.tables import Store

WORDS = ("settings", "reason")
COMMAND = "footprint run statements"
CASE, OF_CASE = "scene | settings | quantity | asked", "`{scene}` | {settings:said} | `{quantity}` | {asked:.1%}"


def statements_part(store: Store) -> Part:
    """The whole part; no campaign of a report measures it by itself, for it takes an hour."""
    heading = "## What an error that is asked for is worth"
    if not (store.has_table("error_coverage") and store.has_analysis("error_statements")):
        return Part("")
    data, stated = _worded(store.table("error_coverage")), _worded(store.analysis("stated_errors"))
    found = store.analysis("error_statements")
    whole = found[found["asked"].isna()].iloc[0]
    errors = found[found["asked"].notna()]
    text = prose(f"""`footprint solve SCENE --error E --of QUANTITY` solves grids of twice the unknowns each until the
limit of the quantity is known to E, and states an interval for the error on the last grid. Of
{whole["decided"]:.0f} different statements on {whole["scenes"]:.0f} scenes whose true error is known well enough,
{whole["inside"]:.0f} contain it; the interval is {fixed(float(whole["wide"]), 1)} times as wide as the error in the
median. The extrapolated limit is within its stated uncertainty in {whole["limit_inside"]:.0f} of
{whole["limit_decided"]:.0f}; the uncertainty is {fixed(float(whole["limit_wide"]), 1)} times its error in the median.

An answer costs {fixed(float(whole["cost"]), 1)} times the CPU time of the cheapest grid known to be as good, in the
median, and more than {store.rules()["expensive"]:g} times in {whole["expensive"]:.0f} of {whole["priced"]:.0f}. Which
grid that is, nobody knows beforehand: it was searched for among all that were solved, from rest, with the error of the
value itself.

What counts for true are uniform grids far beyond, extrapolated; a statement is decided where their limit is known to a
third of what is stated, or is outside whatever it is.""")
    heads = "asked | asked for | reached | cost | expensive | decided | inside | wide"
    heads += " | of the limit: decided | inside | wide"
    line = "{asked:.1%} | {asked_for} | {reached} | {cost:.1f} | {expensive} | {decided} | {inside} | {wide:.1f}"
    line += " | {limit_decided} | {limit_inside} | {limit_wide:.1f}"
    body = listing("Statements by the error asked for", errors, heads, line, words=0)
    drawn = picture(
        "cost-statements.svg", "Errors over the ends of the intervals stated of them", errors_stated(stated)
    )
    return joined(heading, text, body, drawn, *_outside(stated), *_missed(data), commands([COMMAND]))


def _worded(data: pd.DataFrame) -> pd.DataFrame:
    """With empty words where a table has nothing."""
    return data.assign(**{name: data[name].astype(object).where(data[name].notna(), "") for name in WORDS})


@svg
def errors_stated(data: pd.DataFrame) -> Figure:
    """What each decided error is over the most that is stated of it; on the line both are the same."""
    decided = data[data["value_decided"].eq(True)]
    figure, (axes,) = canvas(1, width=6.0, height=5.0)
    for asked, each in looks(sorted(map(float, decided["asked"].unique()), reverse=True)).items():
        own = decided[decided["asked"] == asked]
        axes.plot(own["high"], own["value_error"], linestyle="none", label=share(asked, 1), **each.points)
    ends = np.array([decided["high"].min(), decided["high"].max()]) if len(decided) else np.ones(2)
    axes.plot(ends, ends, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="the most that is stated", ylabel="relative error")
    legend_above(figure, axes)
    return figure


def _outside(data: pd.DataFrame) -> tuple[str, ...]:
    """The statements that do not hold."""
    wrong = data[data["value_inside"].eq(False) | data["inside"].eq(False)]
    if wrong.empty:
        return ()
    heads = f"{CASE} | error | stated | limit off | stated"
    line = OF_CASE + " | {value_error:.2%} | {low:.2%} to {high:.2%} | {off:.2%} | {uncertainty:.2%}"
    return (listing("Statements that do not hold", wrong, heads, line, words=3),)


def _missed(data: pd.DataFrame) -> tuple[str, ...]:
    """What was asked for and not reached, and why."""
    missed = data[data["reached"].eq(False)]
    if missed.empty:
        return ()
    return (listing("Errors that were not reached", missed, f"{CASE} | why", OF_CASE + " | {reason}", words=5),)
