"""The part of stated errors: whether what ``--error`` states holds, how wide it is, and what it costs."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reports.drawing import BLACK, canvas, legend_above, looks, svg
from reports.formats import fixed, share
from reports.markdown import Part, commands, joined, listing, picture, prose
from reports.tables import Store

WORDS = ("settings", "reason")  # a table has nothing where they are empty
COMMAND = "footprint run statements"
CASE, OF_CASE = "scene | settings | quantity | asked", "`{scene}` | {settings:said} | `{quantity}` | {asked:.1%}"


def statements_part(store: Store) -> Part:
    """The whole part; no campaign of a report measures it by itself, for it takes an hour."""
    heading = "## What an error that is asked for is worth"
    if not (store.has_table("error_coverage") and store.has_analysis("error_statements")):
        return joined(heading, f"Not measured here; `{COMMAND}` does.")
    data = store.table("error_coverage")
    data = data.assign(**{name: data[name].astype(object).where(data[name].notna(), "") for name in WORDS})
    found = store.analysis("error_statements")
    whole = found[found["asked"].isna()].iloc[0]
    errors = found[found["asked"].notna()]
    text = prose(f"""`footprint solve SCENE --error E --of QUANTITY` refines a grid where the quantity is decided until
its limit is known to E. Of {whole["decided"]:.0f} different statements on {whole["scenes"]:.0f} scenes whose true limit
is known well enough, {whole["inside"]:.0f} contain it. In the median the stated uncertainty is
{fixed(float(whole["wide"]), 1)} times what the stated limit is off, and what is stated of the error on the last grid
{fixed(float(whole["wide_value"]), 1)} times that error. A statement costs {fixed(float(whole["cost"]), 1)} times the
CPU time of its last grid alone in the median, and more than {store.rules()["expensive"]:g} times in
{whole["expensive"]:.0f} of {whole["statements"]:.0f}.

What counts for true are uniform grids far beyond, extrapolated; a statement is decided where their limit is known to a
third of what is stated, or is outside whatever it is.""")
    heads = "asked | asked for | reached | decided | inside | wide | wide, of the value | cost | expensive"
    line = "{asked:.1%} | {asked_for} | {reached} | {decided} | {inside} | {wide:.1f} | {wide_value:.1f} | {cost:.1f}"
    body = listing("Statements by the error asked for", errors, heads, line + " | {expensive}", words=0)
    drawn = picture("cost-statements.svg", "What limits are off over what is stated of them", offsets(data))
    return joined(heading, text, body, drawn, *_outside(data), *_missed(data), commands([COMMAND]))


@svg
def offsets(data: pd.DataFrame) -> Figure:
    """What each decided limit is off over what is stated of it; on the line both are the same."""
    decided = data[data["decided"].astype(bool) & data["reached"].astype(bool)]
    figure, (axes,) = canvas(1, width=6.0, height=5.0)
    for asked, each in looks(sorted(map(float, decided["asked"].unique()), reverse=True)).items():
        own = decided[decided["asked"] == asked]
        axes.plot(own["uncertainty"], own["off"], linestyle="none", label=share(asked, 1), **each.points)
    ends = np.array([decided["uncertainty"].min(), decided["uncertainty"].max()]) if len(decided) else np.ones(2)
    axes.plot(ends, ends, color=BLACK, linewidth=1, linestyle=":")
    axes.set(xscale="log", yscale="log", xlabel="stated uncertainty, relative", ylabel="limit off, relative")
    legend_above(figure, axes)
    return figure


def _outside(data: pd.DataFrame) -> tuple[str, ...]:
    """The statements that do not hold."""
    wrong = data[data["decided"].astype(bool) & ~data["inside"].astype(bool) & data["reached"].astype(bool)]
    if wrong.empty:
        return ()
    heads, line = f"{CASE} | stated | uncertainty | true", OF_CASE + " | {stated:.6g} | {uncertainty:.2%} | {true:.6g}"
    return (listing("Statements that do not contain the true limit", wrong, heads, line, words=3),)


def _missed(data: pd.DataFrame) -> tuple[str, ...]:
    """What was asked for and not reached, and why."""
    missed = data[~data["reached"].astype(bool)]
    if missed.empty:
        return ()
    return (listing("Errors that were not reached", missed, f"{CASE} | why", OF_CASE + " | {reason}", words=5),)
