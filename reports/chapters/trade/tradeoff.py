"""The page of the trade: what accuracy costs, what solves most, which axis explains it, and what is suspicious."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.chapters.trade.compared import contacts_part, measures_part, profiles_part
from reports.chapters.trade.figures_precision import work_precision
from reports.chapters.trade.solved_and_failed import solved_and_failed
from reports.formats import code, share
from reports.markdown import Part, commands, folded, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COST = "seconds"  # of processor time; other runs and machines have others
OPERATIONS = "operations"  # of all kinds, the same on every machine
LARGEST = ("mesh", "solver", "formulation", "reference", "unknown")
FEW = 12  # rows of a family's front


def tradeoff_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# Cost and accuracy

Every cell of the campaign `{store.campaign}` is verified: against the scene's reference where one holds for its
settings, else against the limit of a ladder of meshes by the exact measure, so that what a measure loses is an error.
A cost is what a user pays for a whole cell: seconds of processor time, of the timing lane where the cell was timed,
else of its one run, which differ by some per cent from run to run and by more from machine to machine; beside them all
floating-point operations, of assembly, factorisations, solutions, pivots and quadratic programmes, the same
everywhere.""")
    parts = (measures_part, contacts_part, solved_and_failed, _fronts, profiles_part, _attribution, _split, _flags)
    return joined(introduction, *(part(store) for part in parts))


def _split(store: Store) -> Part:
    """Whose error it is, per scene."""
    fronts, split = store.analysis("fronts"), store.analysis("verified")
    own = split.merge(fronts[["label", "quantity"]], on=["label", "quantity"])
    rows = []
    for scene, cells in own.groupby("scene", sort=False):
        referred = cells["against"].str.startswith("reference").sum()
        counts = cells["largest"].value_counts().reindex(LARGEST, fill_value=0)
        rows.append([code(scene), code(cells["quantity"].iloc[0]), len(cells), referred, *counts])
    text = prose("""## Whose error it is

The error of a cell has four parts: what its mesh leaves (Richardson on its own ladder), what its solver leaves
(against the tightest tolerance), what its formulation loses (limit against reference), and what the reference is
uncertain by. The table counts which one is the largest; *unknown* where the cell's mesh is on no ladder of three.""")
    header = ["scene", "quantity", "answers", "with a reference", *LARGEST]
    listed = table("Largest part of the error", header, rows, words=2)
    return joined(text, folded("Largest part of the error, by scene", listed))


def _fronts(store: Store) -> Part:
    """Fronts per scene, drawn and listed."""
    data = store.analysis("fronts")
    data = data[data["main"].astype(bool)]
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["scene", f"cost.{COST}"], kind="stable")
    wrong = int((data["flag"] == "wrong").sum())
    heads = "scene | measure | contact | mesh | tolerance | error | known to | seconds | operations"
    line = "`{scene}` | `{measure}` | `{contact}` | {mesh} | {tolerance:.0e} | {shown:.3%} | {uncertainty:.3%} | "
    line += f"{{cost.{COST}:.1e}} | {{cost.{OPERATIONS}:.1e}}"
    text = prose(f"""## Cost against verified error

Of {len(data)} planned cells those compete that were asked the same question; shown is the one that each scene was asked
most often. On the front of its scene is a cell to which no other is both cheaper, or equal within 5 %, and more
accurate. An error below what the reference is uncertain by (the grey band) counts as that, and one below what the
formulation is off by as that. {wrong} answers are wrong by more than
{share(figures_tradeoff.WORST, 0)}, or rest on a formulation that is: however cheap, they are on no
front.""")
    listed = folded("The fronts as a table", listing("Fronts per scene", front, heads, line, words=3))
    found = machine(f"{len(front)} cells are on the front of their scene.", listed, commands(front["command"]))
    drawn = (
        picture(
            f"tradeoff-{name}.svg", f"Error over {words}: all answers, and a line a measure", work_precision(data, cost)
        )
        for name, words, cost in (("precision", "processor time", COST), ("unknowns", "unknowns", "dofs"))
    )
    return joined(text, *drawn, found, _families(store))


def _families(store: Store) -> str:
    """Fronts over all scenes of a family, folded."""
    data = store.analysis("family_fronts")
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["family", f"cost.{COST}"], kind="stable")
    front = front.groupby("family", sort=False).head(FEW)
    names = [name for name in ("measure", "contact", "newton", "element") if name in front]
    heads = " | ".join(["family", "scenes", *names, "mesh", "error", "cost"])
    coded = [f"{{{name}:code}}" for name in names]  # of what varies; none, where nothing does
    line = " | ".join(["{family}", "{scenes}", *coded, "{rung:.0f}", "{error:.3%}", f"{{cost.{COST}:.1f}}"])
    text = prose("""
Configurations that have solved all scenes of a family, none wrongly: geometric means over its scenes of the error and
of the cost, the latter over the cheapest cell of each scene. *Mesh*: 1 is the coarsest of each scene.""")
    front = front.assign(rung=front["rung"] + 1)
    listed = listing("Fronts per family", front, heads, line, words=2 + len(names))
    return machine(folded("Fronts of families of scenes", f"{text}\n\n{listed}"))


def _attribution(store: Store) -> Part:
    """Which axis explains what."""
    data = store.analysis("attribution")
    if data.empty:
        return Part("## Which axis explains it\n\nToo few cells of any scene differ.")
    said = []
    for response, words in (("error", "the error"), (OPERATIONS, "the operations")):
        own = data[(data["response"] == response) & ~data["factor"].isin(("interactions", "rest"))]
        best = own.loc[own.groupby(["scope", "name"], sort=False)["share"].idxmax()]
        counts = best["factor"].value_counts()
        top = best.sort_values("share", ascending=False).iloc[0]
        said.append(
            f"Of {words}, the {counts.index[0]} explains the most in {counts.iloc[0]} of {len(best)} scenes and "
            f"families (in `{top['name']}` {top['factor']} alone {explained(top)})."
        )
    rows = []
    for (_, name), own in data[data["response"].isin(("error", OPERATIONS))].groupby(["scope", "name"], sort=False):
        for of, each in own.groupby("response", sort=False):
            shown = [f"{row['factor']} {explained(row)}" for row in each.to_dict("records") if row["share"] >= 0.005]
            rows.append([code(name), of, each["cells"].iloc[0], ", ".join(shown)])
    rest = data[(data["factor"] == "rest") & (data["response"] == "error")]["share"]
    text = prose(f"""## Which axis explains it

Shares of the variance of the logarithm of error and operations (type II, with 95 % bootstrap intervals). They are those
of a *designed* grid: a coarser mesh put into it raises the share of the mesh, another poor measure that of the measure.
So they say which of the levels that were chosen here differ most, not what matters in a problem of its own, and no
ranking is read from them. What no factor and no pair of factors explains is drawn, too: of the error
{share(rest.median(), 0)} in the median of {len(rest)} scenes and families, at most {share(rest.max(), 0)}.
{" ".join(said)}""")
    listed = table("Shares of the variance", ["scene or family", "of", "cells", "explained by"], rows, words=4)
    shown_picture = picture(
        "tradeoff-shares.svg",
        "Shares of the variance by axis",
        figures_tradeoff.attribution(data, ("error", OPERATIONS)),
    )
    return joined(text, shown_picture, folded("The shares as a table", listed))


def explained(row: pd.Series | Mapping[Any, Any]) -> str:
    """The share of a factor, and its interval."""
    return f"{100 * row['share']:.0f} % [{100 * row['low']:.0f}, {100 * row['high']:.0f}]"


def _flags(store: Store) -> Part:
    """What is suspicious."""
    data = store.analysis("flags")
    inert, inputs, walls = (data[data["flag"] == flag] for flag in ("inert tolerance", "inert input", "wall"))
    lost = walls["cause"].eq("formulation") & ~walls["subject"].str.endswith(" by exact")
    text = prose("""## What is suspicious

A tolerance that changes neither a result nor a counter is not read, or there was nothing to stop early. An input of a
scene that was varied and changes no quantity to the last bit is not read, or does not belong there. An error that
stands still while the mesh goes on converging has met a wall: digits of the reference, its uncertainty, or the
formulation itself.""")
    without = "scene | algorithm | without effect | most iterations | cause"
    inert_line = "`{scene}` | {subject} | {cases:.0f} of {of:.0f} | {size:.0f} | {cause}"
    wall, line = (
        "scene | quantity | wall | cause | finest cell",
        "`{scene}` | {subject} | {size:.3%} | {cause} | `{label}`",
    )
    parts = ["Every tolerance has an effect somewhere."]
    if len(inert):
        parts = [listing("Tolerances without effect", inert, without, inert_line, words=2)]
    if len(inputs):
        heads = "scene | input | without effect | values"
        input_line = "`{scene}` | {subject} | {cases:.0f} of {of:.0f} | {size:.0f}"
        parts.append(listing("Inputs without effect", inputs, heads, input_line, words=2))
    if not lost.all():
        parts.append(listing("Walls", walls[~lost], wall, line, words=2))
    if lost.any():
        shown = listing("Walls of measures that approximate", walls[lost], wall, line, words=2)
        parts.append(folded("What other measures than the exact one lose on scenes with a reference", shown))
    return joined(text, *parts)


CHAPTER = Chapter(
    "tradeoff",
    "Cost and accuracy",
    "what accuracy costs, by measure, algorithm and mesh, and which axis explains it.",
    tradeoff_page,
    needs=(
        *("verified", "flags", "fronts", "family_fronts", "profiles", "pairs", "flips", "unsolved", "attribution"),
        *("outcomes", "contact_summary", "equal_accuracy", "cheaper_measures"),
    ),
)
