"""The page of the trade: what accuracy costs, what solves most, which axis explains it, and what is suspicious."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.chapters.trade.figures_precision import work_precision
from reports.formats import code, share
from reports.markdown import Part, commands, filled, folded, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COST = "seconds"  # of processor time; other runs and machines have others
OPERATIONS = "operations"  # of all kinds, the same on every machine
LARGEST = ("mesh", "solver", "formulation", "reference")
FEW = 12  # rows of a family's front


def tradeoff_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# Cost and accuracy

Every cell of the campaign `{store.campaign}` is verified: against the scene's reference where one holds for its
settings, else against the limit of a ladder of meshes by the exact measure, so that what a measure loses is an error.
Costs are seconds of processor time of a whole cell, one run each: they differ from machine to machine and from run to
run, and with them what is on a front. Floating-point operations stand beside them where said; they are the same
everywhere, but count the factorisations alone, neither assembly nor pivots nor iterations of a quadratic programme.""")
    parts = (_split, _fronts, _families, _solved, _profiles, _attribution, _flags)
    return joined(introduction, *(part(store) for part in parts))


def _split(store: Store) -> Part:
    """Whose error it is, per scene."""
    fronts, split = store.analysis("fronts"), store.analysis("verified")
    own = split.merge(fronts[["label", "quantity"]], on=["label", "quantity"])
    rows = []
    for scene, cells in own.groupby("scene", sort=False):
        referred = cells["against"].str.startswith("reference").sum()
        counts = cells["largest"].value_counts().reindex(LARGEST, fill_value=0)
        named = [code(scene), code(cells["quantity"].iloc[0])]
        rows.append([*named, len(cells), referred, cells["asymptotic"].astype(bool).sum(), *counts])
    text = prose("""## Whose error it is

The error of a cell has four parts: what its mesh leaves (Richardson on its own ladder), what its solver leaves
(against the tightest tolerance), what its formulation loses (limit against reference), and what the reference is
uncertain by. The table counts which one is the largest; *asymptotic*: two successive observed orders agree.""")
    header = ["scene", "quantity", "answers", "with a reference", "asymptotic", *LARGEST]
    return joined(text, table("Largest part of the error", header, rows, words=2))


def _fronts(store: Store) -> Part:
    """Fronts per scene, drawn and listed."""
    data = store.analysis("fronts")
    data = data[data["main"].astype(bool)]
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["scene", f"cost.{COST}"], kind="stable")
    wrong = int((data["flag"] == "wrong").sum())
    heads = "scene | measure | contact | mesh | tolerance | error | reference known to | seconds"
    line = "`{scene}` | `{measure}` | `{contact}` | {mesh} | {tolerance:.0e} | {error:.3%} | {uncertainty:.3%} | "
    line += f"{{cost.{COST}:.1e}}"
    text = prose(f"""## Cost against verified error

Of {len(data)} planned cells those compete that were asked the same question; shown is the one that each scene was asked
most often. On the front of its scene is a cell to which nobody is both cheaper and more accurate. An error below what
the reference is uncertain by (the grey band) counts as that. {wrong} answers are wrong by more than
{share(figures_tradeoff.WORST, 0)}, or rest on a formulation that is: however cheap, they are on no
front.""")
    listed = folded("The fronts as a table", listing("Fronts per scene", front, heads, line, words=3))
    found = machine(f"{len(front)} cells are on the front of their scene.", listed, commands(front["command"]))
    drawn = (
        picture(f"tradeoff-{name}.svg", f"Verified error over {words}, a line a measure", work_precision(data, cost))
        for name, words, cost in (("precision", "processor time", COST), ("unknowns", "unknowns", "dofs"))
    )
    return joined(text, *drawn, found)


def _families(store: Store) -> Part:
    """Fronts over all scenes of a family."""
    data = store.analysis("family_fronts")
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["family", f"cost.{COST}"], kind="stable")
    front = front.groupby("family", sort=False).head(FEW)
    names = [name for name in ("measure", "contact", "newton", "element") if name in front]
    heads = " | ".join(["family", "scenes", *names, "mesh", "error", "cost"])
    coded = " | ".join(f"{{{name}:code}}" for name in names)
    line = f"{{family}} | {{scenes}} | {coded} | {{rung:.0f}} | {{error:.3%}} | {{cost.{COST}:.1f}}"
    text = prose("""## Fronts of families

Configurations that have solved all scenes of a family, none wrongly: geometric means over its scenes of the error and
of the cost, the latter over the cheapest cell of each scene. *Mesh*: 1 is the coarsest of each scene.""")
    front = front.assign(rung=front["rung"] + 1)
    return joined(text, machine(listing("Fronts per family", front, heads, line, words=2 + len(names))))


def _solved(store: Store) -> Part:
    """Solved and failed, by algorithm and iteration."""
    data = store.analysis("solved")
    if data.empty:
        return Part("## Solved and failed\n\nNo problem was put to two algorithms.")
    heads = "algorithm | scene | put to it | solved | path ends | share of the rest | how the others ended"
    line = "`{competitor}` | {where} | {asked} | {solved} | {ends} | {share:.1%} | {ended:said}"
    where = data["scene"].map(code).where(data["scene"] != "", "all")
    ends = data["path_ends"].astype(str) + (", " + data["beyond"].astype(str) + " passed").where(data["beyond"] > 0, "")
    share = data["solved"] / (data["asked"] - data["path_ends"]).where(data["asked"] > data["path_ends"])
    data = data.assign(where=where, ends=ends, share=share)
    shown = data[(data["scene"] == "") | (data["solved"] < data["asked"])]
    text = prose("""## Solved and failed

Of the problems that were put to two algorithms, or iterations, at least: how many each has solved, in all, and in each
scene in which it has not solved them all. What an algorithm refuses, and what is not solved yet, is not put to it. The
*path ends* where it turns back, or branches, before the load asked for: arc length has passed that point, or an
eigenvalue of the tangent falls to zero by its law. There is no state of that path for the load, which is no failure of
the algorithm, and the share is that of the rest. *Passed*: another algorithm has a state for that load all the same; a
large step has taken it over the end, to one that a load that grows does not lead to.""")
    return joined(text, listing("Problems solved", shown, heads, line, words=2), *_causes(store))


def _causes(store: Store) -> list[str]:
    """What the path of each cell that was not solved ends at, and why the others have failed."""
    data = store.analysis("unsolved")
    end = data["path_end"].fillna("") != ""
    heads = "scene | measure | mesh | the path ends at | parameter | found by | cells | algorithms"
    line = "`{scene}` | `{measure}` | {mesh} | {path_end} | {at:.5g} | {found_by} | {cells} | {contacts}"
    parts = [folded("Where paths end", listing("Ends of paths", data[end], heads, line, words=3))] if end.any() else []
    if end.all():
        return [*parts, "No cell has failed without such an end."]
    heads = "scene | measure | mesh | algorithms | cells | class | reason of the first"
    line = "`{scene}` | `{measure}` | {mesh} | {contacts} | {cells} | {outcome} | {why}"
    return [*parts, machine(listing("Failures", data[~end], heads, line, words=4), commands(data[~end]["command"]))]


def _profiles(store: Store) -> Part:
    """Profiles, pairs, flips."""
    data, pairs, flips = (store.analysis(name) for name in ("profiles", "pairs", "flips"))
    if flips.empty:
        return Part("## Compared in cost\n\nNo axis of this campaign has two competitors.")
    lines = [_ranking(str(axis), own) for axis, own in flips[flips["cost"] == COST].groupby("axis", sort=False)]
    text = prose("""## Compared in cost

Contact algorithms and Newton iterations solve the same problem; measures and elements are compared by the least cost
to reach an error. The profile is the share of problems within a factor of the best: it ends at the share that is
solved, and depends on the whole field. So pairs are compared alone, too, on the problems that both solve, and the
ranking (by the share within twice the best) is repeated without each competitor. Problems of one scene are alike: the
intervals are those of drawing scenes. Fewer than five problems make no comparison.""")
    words = "Share of problems within a factor of the best"
    return joined(
        text,
        machine("\n".join(lines)),
        picture("tradeoff-profiles.svg", words, figures_tradeoff.profiles(data, COST)) if len(data) else "",
        machine(_pairs(pairs, COST)),
        folded("Pairs by operations of the factorisations", _pairs(pairs, OPERATIONS)),
    )


def _ranking(axis: str, checked: pd.DataFrame) -> str:
    whole = checked[checked["removed"] == ""].iloc[0]
    if not whole["ranking"]:
        return f"- {axis}: not ranked: problems in common: {whole['problems']}."
    found = "; ".join(filled("without `{removed}`: {flips}", checked[checked["flips"] != ""]))
    verdict = f"not stable, {found} change places" if found else "the same without any one of them"
    return f"- {axis}, {whole['problems']} problems: {whole['ranking']}; {verdict}."


def _pairs(pairs: pd.DataFrame, cost: str) -> str:
    """The pairs with enough problems in common, the largest ratio first within each axis."""
    own = pairs[(pairs["cost"] == cost) & pairs["ratio"].notna()]
    heads = "axis | a | b | put to both | both solve | scenes | a cheaper | b cheaper | median of b over a [95 %]"
    line = "{axis} | `{a}` | `{b}` | {problems} | {both} | {scenes} | {a_better} | {b_better} | "
    line += "{ratio:.2f} [{ratio_low:.2f}, {ratio_high:.2f}]"
    if own.empty:
        return f"No pair has enough problems in common ({cost})."
    return listing(f"Pairs, {cost}", own, heads, line, words=3)


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
    text = prose(f"""## Which axis explains it

Shares of the variance of the logarithm of error and operations (type II, with 95 % bootstrap intervals).
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
        "verified",
        "flags",
        "fronts",
        "family_fronts",
        "profiles",
        "pairs",
        "flips",
        "solved",
        "unsolved",
        "attribution",
    ),
)
