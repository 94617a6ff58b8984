"""The page of advice: the cheapest configuration for a tolerance, scene by scene, and what such advice is worth."""

from __future__ import annotations

import math

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.formats import NOTHING, code, digits, fixed, share
from reports.markdown import Part, commands, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

ENGINEER = 0.01  # the tolerance that is listed in full
AIM_MET, AIM_MEDIAN, AIM_MEAN = 0.95, 1.2, 2.0


def advice_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# Advice

The cheapest configuration whose upper confidence bound of the error, the verified error and what its reference is
uncertain by, meets a tolerance, over all cells of the campaign `{store.campaign}`. `footprint advise SCENE --error 1%`
answers the same for any tolerance and quantity, at once, from the tables that are shipped. The price is processor time;
where two prices differ by less than 5 %, the smaller error decides, for another run may turn them.""")
    return joined(introduction, _overview(store), _listed(store), _worth(store))


def _headline(store: Store) -> dict:
    summary = store.analysis("held_out_summary")
    return dict(summary[summary["quantities"] == "headline"].to_dict("records")[0])


def _overview(store: Store) -> Part:
    """Rows: scenes; columns: tolerances."""
    data = store.analysis("advice")
    tolerances = sorted(data["tolerance"].unique(), reverse=True)
    rows = []
    for scene, own in data.groupby("scene", sort=False):
        by = {row["tolerance"]: row for row in own.to_dict("records")}
        rows.append([code(scene), code(own["quantity"].iloc[0]), *(_short(by[t]) for t in tolerances)])
    none = int((data["label"] == "").sum())
    text = prose(f"""## What a tolerance costs

Processor time in seconds and, in brackets, unknowns of the cheapest cell. For {none} of {len(data)} pairs of scene and
tolerance none qualifies (–): the mesh is too coarse, the formulation too far off, or the reference too uncertain to
show it.""")
    header = ["scene", "quantity", *(share(t, 1 if t < 0.01 else 0) for t in tolerances)]
    return joined(text, machine(table("Seconds (unknowns) by tolerance", header, rows, words=2)))


def _short(row: dict) -> str:
    return NOTHING if row["label"] == "" else f"{digits(row['seconds'], 2)} ({row['unknowns']:.0f})"


def _listed(store: Store) -> Part:
    """All that is known at one tolerance."""
    data = store.analysis("advice")
    own = data[(data["tolerance"] - ENGINEER).abs() < 1e-12]
    heads = "scene | configuration | error at most | seconds | unknowns | operations | runner-up | its seconds"
    line = "`{scene}` | {configuration} | {bound:.2%} | {seconds:#.2g} | {unknowns:.0f} | {operations:.1e} | "
    line += "{runner_up:said} | {runner_up_ratio:.2f}"
    none = own["label"] == ""
    nearest = own["bound"].map(lambda bound: f"none qualifies; nearest {share(bound)}")
    shown = own.assign(configuration=own["configuration"].where(~none, nearest))
    shown.loc[none, "runner_up"] = ""
    shown.loc[none, "bound"] = math.nan
    counted = own[~none & (own["by_operations"] != own["configuration"])]
    text = prose(f"""## In full, at {share(ENGINEER, 0)}

*Runner-up*: the cheapest of another measure, algorithm, iteration or element, and its seconds over those of the
advice. Of cells that were timed repeatedly the median is shown, with its interval.""")
    ranked = prose(f"""Ranked by operations instead of seconds, {len(own[~none]) - len(counted)} of {len(own[~none])}
scenes have the same advice; the others are listed with the seconds of that choice over those of the advice.""")
    listed = listing(f"Advice at {share(ENGINEER, 0)}", shown, heads, line, words=2)
    heads_counted = "scene | fewest operations | its seconds over the advice"
    by_count = listing("Otherwise by operations", counted, heads_counted, COUNTED, words=2) if len(counted) else ""
    timed = own[own["seconds_low"].notna()]
    heads_timed, line_timed = "scene | seconds | 95 % interval [s]", "`{scene}` | {seconds:.3f} | "
    line_timed += "[{seconds_low:.3f}, {seconds_high:.3f}]"
    times = listing("Repeated timings of the advised cells", timed, heads_timed, line_timed) if len(timed) else ""
    blocks = [block for block in (listed, ranked, by_count, times, commands(own["command"][~none])) if block]
    return joined(text, machine(*blocks))


COUNTED = "`{scene}` | {by_operations} | {operations_seconds_ratio:.2f}"


def _worth(store: Store) -> Part:
    """The advice on scenes that were left out."""
    cases = store.analysis("held_out")
    summary, headline = store.analysis("held_out_summary"), _headline(store)
    heads = "quantities | scenes | cases | advised | met | scenes all met | median regret | mean | worst | above "
    heads += f"{headline['dear']:g} | scenes above | no advice, though some would do | nothing would do"
    line = "{quantities:which} | {scenes} | {cases} | {advised} | {met:.1%} | {scenes_met} | {median_regret:.2f} | "
    line += "{mean_regret:.2f} | {worst_regret:.1f} | {share_above:.0%} | {scenes_above} | {abstained} | "
    line += "{truly_none}"
    aimed = {"met": headline["met"] >= AIM_MET, "median": headline["median_regret"] <= AIM_MEDIAN}
    aimed["mean"] = headline["mean_regret"] <= AIM_MEAN
    short = [name for name, held in aimed.items() if not held]
    verdict = f"short of the aim in the {', '.join(short)}" if short else "as was aimed at"
    failed = cases[(cases["advised"] != "") & (cases["met"] == 0.0)]
    text = prose("""## What the advice is worth on a scene it does not know

Each scene is left out once: the adviser sees its values but no reference, and no mesh finer than the one it stops at.
It estimates the error from the last meshes, the distance of the measure from the exact one and of the tolerance from
the tightest one on a coarse mesh, and multiplies by a factor of safety that it has learnt from the references of the
other scenes. *Regret* is the seconds of its advice over those of the cheapest cell that truly meets the tolerance.
Tolerances below twice the uncertainty of a reference decide nothing and are left out. Cases of one scene are alike:
scenes are counted, too.""")
    told = prose(f"""For the headline quantities, {headline["cases"]} cases of {headline["scenes"]} scenes, the
tolerance is met in {share(headline["met"], 1)} of the {headline["advised"]} that were advised, and in all of them on
{headline["scenes_met"]} scenes. The regret is {fixed(headline["median_regret"], 2)} in the median,
{fixed(headline["mean_regret"], 2)} in the mean and {fixed(headline["worst_regret"], 1)} at worst;
{share(headline["share_above"], 0)} of the cases, and {headline["scenes_above"]} scenes in their median, are above
{headline["dear"]:g}: {verdict} (met {share(AIM_MET, 0)}, median {AIM_MEDIAN:g}, mean {AIM_MEAN:g}). On
{headline["scenes_abstained"]} scenes it gave no advice for a tolerance that some cell would have met, in
{headline["abstained"]} cases. Factors of safety: {fixed(cases["factor"].min(), 2)} to
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
