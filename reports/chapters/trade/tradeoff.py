"""The page of the trade: what accuracy costs, who wins how often, which axis explains it, and what is suspicious."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.markdown import (
    NOTHING,
    Part,
    commands,
    fixed,
    folded,
    joined,
    machine,
    percent,
    picture,
    prose,
    scientific,
    table,
)
from reports.tables import Store

COST = "seconds"  # of processor time; other runs and machines have others
OPERATIONS = "flops"  # of the factorisations only, the same on every machine
PRECISION, PROFILES, SHARES = "tradeoff-precision.svg", "tradeoff-profiles.svg", "tradeoff-shares.svg"
LARGEST = {"mesh": "mesh", "solver": "solver", "formulation": "formulation", "reference": "reference"}
FEW = 12  # rows of a family's front


def tradeoff_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# What accuracy costs

Every cell of the campaign `{store.campaign}` is verified: against the scene's reference where one holds for its
settings, else against the limit of a ladder of meshes by the exact measure, so that what a measure loses is an error.
Costs are seconds of processor time of a whole cell, one run each: they differ from machine to machine and from run to
run, and with them what is on a front. Floating-point operations stand beside them where said; they are the same
everywhere, but count the factorisations alone, neither assembly nor pivots nor iterations of a quadratic programme.""")
    parts = (_split, _fronts, _families, _solved, _profiles, _attribution, _flags)
    return joined([Part(introduction), *(part(store) for part in parts)])


def _split(store: Store) -> Part:
    """Whose error it is, per scene."""
    fronts, split = store.analysis("fronts"), store.analysis("verified")
    own = split.merge(fronts[["label", "quantity"]], on=["label", "quantity"])
    rows = []
    for scene, cells in own.groupby("scene", sort=False):
        referred = cells["against"].str.startswith("reference").sum()
        counts = cells["largest"].value_counts()
        asymptotic = cells["asymptotic"].astype(bool).sum()
        numbers = [len(cells), referred, asymptotic, *(counts.get(name, 0) for name in LARGEST)]
        rows.append([f"`{scene}`", f"`{cells['quantity'].iloc[0]}`", *map(str, numbers)])
    text = prose("""## Whose error it is

The error of a cell has four parts: what its mesh leaves (Richardson on its own ladder), what its solver leaves
(against the tightest tolerance), what its formulation loses (limit against reference), and what the reference is
uncertain by. The table counts which one is the largest; *asymptotic*: two successive observed orders agree.""")
    header = ["scene", "quantity", "answers", "with a reference", "asymptotic", *LARGEST.values()]
    return Part(f"{text}\n\n{table('Largest part of the error', header, rows, words=2)}")


def _fronts(store: Store) -> Part:
    """Fronts per scene, drawn and listed."""
    data = store.analysis("fronts")
    data = data[data["main"].astype(bool)]
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["scene", f"cost.{COST}"], kind="stable")
    wrong = int((data["flag"] == "wrong").sum())
    rows = [
        [
            f"`{row['scene']}`",
            f"`{row['measure']}`",
            f"`{row['contact']}`",
            row["mesh"],
            scientific(row["tolerance"], 0),
            percent(row["error"], 3, sign=False),
            percent(row["uncertainty"], 3, sign=False),
            scientific(row[f"cost.{COST}"]),
        ]
        for row in front.to_dict("records")
    ]
    text = prose(f"""## Cost against verified error

Of {len(data)} planned cells those compete that were asked the same question; shown is the one that each scene was asked
most often. On the front of its scene is a cell to which nobody is both cheaper and more accurate. An error below what
the reference is uncertain by (the grey band) counts as that. {wrong} answers are wrong by more than
{percent(figures_tradeoff.WORST, 0, sign=False)}, or rest on a formulation that is: however cheap, they are on no
front.""")
    header = ["scene", "measure", "contact", "mesh", "tolerance", "error", "reference known to", "seconds"]
    listed = folded("The fronts as a table", table("Fronts per scene", header, rows, words=3))
    shown = picture(PRECISION, "Verified error over cost, by scene")
    found = machine(f"{len(front)} cells are on the front of their scene.\n\n{listed}\n\n{commands(front['command'])}")
    return Part(f"{text}\n\n{shown}\n\n{found}", {PRECISION: figures_tradeoff.work_precision(data, COST)})


def _families(store: Store) -> Part:
    """Fronts over all scenes of a family."""
    data = store.analysis("family_fronts")
    front = data[data[f"front.{COST}"].astype(bool)].sort_values(["family", f"cost.{COST}"], kind="stable")
    front = front.groupby("family", sort=False).head(FEW)
    names = [name for name in ("measure", "contact", "newton", "element") if name in front]
    rows = [
        [
            row["family"],
            str(row["scenes"]),
            *(f"`{row[name]}`" if row[name] else NOTHING for name in names),
            f"{int(row['rung']) + 1}",
            percent(row["error"], 3, sign=False),
            fixed(row[f"cost.{COST}"], 1),
        ]
        for row in front.to_dict("records")
    ]
    text = prose("""## Fronts of families

Configurations that have solved all scenes of a family, none wrongly: geometric means over its scenes of the error and
of the cost, the latter over the cheapest cell of each scene. *Mesh*: 1 is the coarsest of each scene.""")
    header = ["family", "scenes", *names, "mesh", "error", "cost"]
    return Part(f"{text}\n\n{machine(table('Fronts per family', header, rows, words=2 + len(names)))}")


def _solved(store: Store) -> Part:
    """Solved and failed, by algorithm and iteration."""
    data = store.analysis("solved")
    if data.empty:
        return Part("## Solved and failed\n\nNo problem was put to two algorithms.")
    shown = data[(data["scene"] == "") | (data["solved"] < data["asked"])]
    rows = [
        [
            f"`{row['competitor']}`",
            f"`{row['scene']}`" if row["scene"] else "all",
            str(row["asked"]),
            str(row["solved"]),
            percent(row["solved"] / row["asked"], 1, sign=False),
            row["ended"] or NOTHING,
        ]
        for row in shown.to_dict("records")
    ]
    text = prose("""## Solved and failed

Of the problems that were put to two algorithms, or iterations, at least: how many each has solved, in all, and in each
scene in which it has failed. What an algorithm refuses, and what is not solved yet, is not put to it.""")
    header = ["algorithm", "scene", "put to it", "solved", "share", "how the others ended"]
    return Part(f"{text}\n\n{table('Problems solved', header, rows, words=2)}")


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
    parts = [text, machine("\n".join(lines))]
    pictures = {}
    if len(data):
        parts.append(picture(PROFILES, "Share of problems within a factor of the best"))
        pictures = {PROFILES: figures_tradeoff.profiles(data, COST)}
    parts += [
        machine(_pairs(pairs, COST)),
        folded("Pairs by operations of the factorisations", _pairs(pairs, OPERATIONS)),
    ]
    return Part("\n\n".join(parts), pictures)


def _ranking(axis: str, checked: pd.DataFrame) -> str:
    whole = checked[checked["removed"] == ""].iloc[0]
    if not whole["ranking"]:
        return f"- {axis}: not ranked: problems in common: {whole['problems']}."
    turned = checked[checked["flips"] != ""].to_dict("records")
    found = "; ".join(f"without `{row['removed']}`: {row['flips']}" for row in turned)
    verdict = f"not stable, {found} change places" if found else "the same without any one of them"
    return f"- {axis}, {whole['problems']} problems: {whole['ranking']}; {verdict}."


def _pairs(pairs: pd.DataFrame, cost: str) -> str:
    """The pairs with enough problems in common, the largest ratio first within each axis."""
    own = pairs[(pairs["cost"] == cost) & pairs["ratio"].notna()]
    rows = [_pair(row) for row in own.to_dict("records")]
    header = [
        "axis",
        "a",
        "b",
        "put to both",
        "both solve",
        "scenes",
        "a cheaper",
        "b cheaper",
        "median of b over a [95 %]",
    ]
    return (
        table(f"Pairs, {cost}", header, rows, words=3) if rows else f"No pair has enough problems in common ({cost})."
    )


def _pair(row: dict) -> list[str]:
    ratio = f"{fixed(row['ratio'], 2)} [{fixed(row['ratio_low'], 2)}, {fixed(row['ratio_high'], 2)}]"
    counts = (str(row[name]) for name in ("problems", "both", "scenes", "a_better", "b_better"))
    return [row["axis"], f"`{row['a']}`", f"`{row['b']}`", *counts, ratio]


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
            f"families (in `{top['name']}` {top['factor']} alone {_interval(top)})."
        )
    rows = []
    for (_, name), own in data[data["response"].isin(("error", OPERATIONS))].groupby(["scope", "name"], sort=False):
        for of, each in own.groupby("response", sort=False):
            shown = [f"{row['factor']} {_interval(row)}" for row in each.to_dict("records") if row["share"] >= 0.005]
            rows.append([f"`{name}`", str(of), str(each["cells"].iloc[0]), ", ".join(shown)])
    text = prose(f"""## Which axis explains it

Shares of the variance of the logarithm of error and operations (type II, with 95 % bootstrap intervals).
{" ".join(said)}""")
    listed = table("Shares of the variance", ["scene or family", "of", "cells", "explained by"], rows, words=4)
    shown_picture = picture(SHARES, "Shares of the variance by axis")
    return Part(
        f"{text}\n\n{shown_picture}\n\n{folded('The shares as a table', listed)}",
        {SHARES: figures_tradeoff.attribution(data, ("error", OPERATIONS))},
    )


def _interval(row: pd.Series | dict) -> str:
    return f"{100 * row['share']:.0f} % [{100 * row['low']:.0f}, {100 * row['high']:.0f}]"


def _flags(store: Store) -> Part:
    """What is suspicious."""
    data = store.analysis("flags")
    own = [data[data["flag"] != "wall"], data[data["flag"] == "wall"]]
    text = prose("""## What is suspicious

A tolerance that changes neither a result nor a counter is not read, or there was nothing to stop early. An error that
stands still while the mesh goes on converging has met a wall: digits of the reference, its uncertainty, or the
formulation itself.""")
    inert = [
        [f"`{row['scene']}`", row["subject"], f"{row['cases']} of {row['of']}", _count(row["size"]), row["cause"]]
        for row in own[0].to_dict("records")
    ]
    lost = own[1]["cause"].eq("formulation") & ~own[1]["subject"].str.endswith(" by exact")
    walls, losses = ([_wall(row) for row in each.to_dict("records")] for each in (own[1][~lost], own[1][lost]))
    header = ["scene", "algorithm", "without effect", "most iterations", "cause"]
    parts = [text]
    parts.append(
        table("Tolerances without effect", header, inert, words=2)
        if inert
        else "Every tolerance has an effect somewhere."
    )
    if walls:
        parts.append(table("Walls", WALL, walls, words=2))
    if losses:
        shown = table("Walls of measures that approximate", WALL, losses, words=2)
        parts.append(folded("What other measures than the exact one lose on scenes with a reference", shown))
    return Part("\n\n".join(parts))


WALL = ["scene", "quantity", "wall", "cause", "finest cell"]


def _wall(row: dict) -> list[str]:
    size = percent(row["size"], 3, sign=False)
    return [f"`{row['scene']}`", row["subject"], size, row["cause"], f"`{row['label']}`"]


def _count(value: float) -> str:
    return "–" if math.isnan(value) else str(int(value))


CHAPTER = Chapter(
    "tradeoff",
    "Cost and accuracy",
    "what accuracy costs, by measure, algorithm and mesh, and which axis explains it.",
    tradeoff_page,
    needs=("verified", "flags", "fronts", "family_fronts", "profiles", "pairs", "flips", "solved", "attribution"),
)
