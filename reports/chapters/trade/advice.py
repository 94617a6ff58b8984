"""The page of advice: the cheapest configuration for a tolerance, scene by scene, and what such advice is worth."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.formats import NOTHING, code, fixed, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

ENGINEER = 0.01  # the tolerance that is listed in full
AIM_REGRET, AIM_MET = 1.5, 0.95


def advice_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# Advice

The cheapest configuration whose upper confidence bound of the error, the verified error and what its reference is
uncertain by, meets a tolerance, over all cells of the campaign `{store.campaign}`. `footprint advise SCENE --error 1%`
answers the same for any tolerance and quantity. The cost is processor time, one run a cell: where two configurations
cost nearly the same, another run may advise the other one.""")
    return joined(introduction, _overview(store), _listed(store), _worth(store))


def _overview(store: Store) -> Part:
    """Rows: scenes; columns: tolerances."""
    data = store.analysis("advice")
    tolerances = sorted(data["tolerance"].unique(), reverse=True)
    rows = []
    for scene, own in data.groupby("scene", sort=False):
        by = {row["tolerance"]: row for row in own.to_dict("records")}
        rows.append([code(scene), code(own["quantity"].iloc[0]), *(_short(by[t]) for t in tolerances)])
    none = int((data["label"] == "").sum())
    text = prose(f"""## The cheapest mesh and measure

For {none} of {len(data)} pairs of scene and tolerance none qualifies (–): the mesh is too coarse, the formulation too
far off, or the reference too uncertain to show it.""")
    header = ["scene", "quantity", *(share(t, 1 if t < 0.01 else 0) for t in tolerances)]
    return joined(text, machine(table("Advice by tolerance", header, rows, words=2)))


def _short(row: dict) -> str:
    if row["label"] == "":
        return NOTHING
    measure, *_, mesh = row["configuration"].split(",")[0].split()
    return f"{mesh} {measure}"


def _listed(store: Store) -> Part:
    """All that is known at one tolerance."""
    data = store.analysis("advice")
    own = data[(data["tolerance"] - ENGINEER).abs() < 1e-12]
    heads = "scene | configuration | error at most | seconds | runner-up | its cost | next step"
    line = "`{scene}` | {configuration} | {bound:.2%} | {cost:#.2g} | {runner_up:said} | {runner_up_ratio:.2f} | "
    line += "{next_ratio:.2f}"
    none = own["label"] == ""
    nearest = own["bound"].map(lambda bound: f"none qualifies; nearest {share(bound)}")
    shown = own.assign(configuration=own["configuration"].where(~none, nearest))
    shown.loc[none, "runner_up"] = ""
    shown.loc[none, ["bound", "cost", "runner_up_ratio", "next_ratio"]] = math.nan
    heads_of_time = "scene | time [s] | 90 % of the cells within [s]"
    of_time = "`{scene}` | {seconds:.3f} | [{seconds_low:.3f}, {seconds_high:.3f}]"
    text = prose(f"""## In full, at {share(ENGINEER, 0)}

*Runner-up*: the cheapest of another measure, algorithm, iteration or element, and its cost over that of the advice;
*next step*: the cost of half the tolerance over that of the advice.""")
    listed = listing(f"Advice at {share(ENGINEER, 0)}", shown, heads, line, words=2)
    times = listing("Times by the law of its scene", own[~none], heads_of_time, of_time)
    return joined(text, machine(listed, times, commands(own["command"][~none])))


def _worth(store: Store) -> Part:
    """The advice on scenes that were left out."""
    cases = store.analysis("held_out")
    summary = store.analysis("held_out_summary")
    heads = "quantities | cases | advised | met | median regret | mean regret | "
    heads += "no advice, though some would do | nothing would do"
    line = "{quantities:which} | {cases} | {advised} | {met:.1%} | {median_regret:.2f} | {mean_regret:.2f} | "
    line += "{abstained} | {truly_none}"
    headline = summary[summary["quantities"] == "headline"].iloc[0]
    met, regret = float(headline["met"]), float(headline["median_regret"])
    verdict = "as was aimed at" if met >= AIM_MET and regret < AIM_REGRET else "short of the aim"
    failed = cases[(cases["advised"] != "") & (cases["met"] == 0.0)]
    dear = float((cases["regret"].dropna() > AIM_REGRET).mean())
    text = prose("""## What the advice is worth on a scene it does not know

Each scene is left out once: the adviser sees its values but no reference, and no mesh finer than the one it stops at.
It estimates the error from the last meshes, the distance of the measure from the exact one and of the tolerance from
the tightest one on a coarse mesh, and multiplies by a factor of safety that it has learnt from the references of the
other scenes. *Regret* is the cost of its advice over that of the cheapest cell that truly meets the tolerance.
Tolerances below twice the uncertainty of a reference decide nothing and are left out.""")
    told = prose(f"""For the headline quantities, {headline["cases"]} cases of {cases["scene"].nunique()} scenes, the
tolerance is met in {share(met, 1)} of the {headline["advised"]} that were advised, with a median regret
of {fixed(regret, 2)}: {verdict} ({share(AIM_MET, 0)}, {fixed(AIM_REGRET, 1)}); the mean is
{fixed(headline["mean_regret"], 2)}. Over all quantities {share(dear, 0)} of the advised cases cost more
than {fixed(AIM_REGRET, 1)} times the best. Factors of safety: {fixed(cases["factor"].min(), 2)} to
{fixed(cases["factor"].max(), 2)}.""")
    parts = [told, listing("Advice on scenes left out", summary, heads, line, which=_which)]
    if len(failed):
        parts.append(listing("Where the tolerance was missed", failed, *MISSED, words=2))
    scenes = [_by_scene(str(scene), own) for scene, own in cases.groupby("scene", sort=False)]
    header = ["scene", "cases", "advised", "met", "median regret", "largest regret"]
    parts.append(table("By scene, all quantities", header, scenes))
    words = "True error over tolerance, and regret, of advice on scenes left out"
    return joined(text, picture("advice-held-out.svg", words, figures_tradeoff.held_out(cases)), machine(*parts))


MISSED = (
    "scene | quantity | tolerance | true error | estimate | advised",
    "`{scene}` | `{quantity}` | {tolerance:.2%} | {true_error:.2%} | {estimate:.2%} | `{advised}`",
)


def _which(quantities: str) -> str:
    return "headline of each scene" if quantities == "headline" else "all quantities"


def _by_scene(scene: str, cases: pd.DataFrame) -> list[object]:
    given = cases[cases["advised"] != ""]
    regret = given["regret"].astype(float)
    met = share(given["met"].astype(float).mean(), 0)
    return [code(scene), len(cases), len(given), met, fixed(regret.median(), 2), fixed(regret.max(), 2)]


CHAPTER = Chapter(
    "advice",
    "Advice",
    "the cheapest configuration for a tolerance, and what such advice is worth.",
    advice_page,
    needs=("advice", "held_out", "held_out_summary"),
)
