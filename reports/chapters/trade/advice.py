"""The page of advice: the cheapest configuration for a tolerance, scene by scene, and what such advice is worth."""

from __future__ import annotations

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.trade import figures_tradeoff
from reports.markdown import NOTHING, Part, commands, digits, fixed, joined, machine, percent, picture, prose, table
from reports.tables import Store

HELD_OUT = "advice-held-out.svg"
ENGINEER = 0.01  # the tolerance that is listed in full
AIM_REGRET, AIM_MET = 1.5, 0.95


def advice_page(store: Store) -> Part:
    """The whole page."""
    introduction = prose(f"""# Which configuration

The cheapest configuration whose upper confidence bound of the error, the verified error and what its reference is
uncertain by, meets a tolerance, over all cells of the campaign `{store.campaign}`. `footprint advise SCENE --error 1%`
answers the same for any tolerance and quantity. The cost is processor time, one run a cell: where two configurations
cost nearly the same, another run may advise the other one.""")
    return joined([Part(introduction), _overview(store), _listed(store), _worth(store)])


def _overview(store: Store) -> Part:
    """Rows: scenes; columns: tolerances."""
    data = store.analysis("advice")
    tolerances = sorted(data["tolerance"].unique(), reverse=True)
    rows = []
    for scene, own in data.groupby("scene", sort=False):
        by = {row["tolerance"]: row for row in own.to_dict("records")}
        rows.append([f"`{scene}`", f"`{own['quantity'].iloc[0]}`", *(_short(by[t]) for t in tolerances)])
    none = int((data["label"] == "").sum())
    text = prose(f"""## The cheapest mesh and measure

For {none} of {len(data)} pairs of scene and tolerance none qualifies (–): the mesh is too coarse, the formulation too
far off, or the reference too uncertain to show it.""")
    header = ["scene", "quantity", *(percent(t, 1 if t < 0.01 else 0, sign=False) for t in tolerances)]
    return Part(f"{text}\n\n{machine(table('Advice by tolerance', header, rows, words=2))}")


def _short(row: dict) -> str:
    if row["label"] == "":
        return NOTHING
    measure, *_, mesh = row["configuration"].split(",")[0].split()
    return f"{mesh} {measure}"


def _listed(store: Store) -> Part:
    """All that is known at one tolerance."""
    data = store.analysis("advice")
    own = data[(data["tolerance"] - ENGINEER).abs() < 1e-12]
    rows, times = [], []
    for row in own.to_dict("records"):
        named = [f"`{row['scene']}`"]
        if row["label"] == "":
            rows.append([*named, f"none qualifies; nearest {percent(row['bound'], 2, sign=False)}", *[NOTHING] * 5])
            continue
        rows.append(
            [
                *named,
                row["configuration"],
                percent(row["bound"], 2, sign=False),
                digits(row["cost"], 2),
                row["runner_up"] or NOTHING,
                fixed(row["runner_up_ratio"], 2),
                fixed(row["next_ratio"], 2),
            ]
        )
        interval = f"[{fixed(row['seconds_low'], 3)}, {fixed(row['seconds_high'], 3)}]"
        times.append([*named, fixed(row["seconds"], 3), interval])
    text = prose(f"""## In full, at {percent(ENGINEER, 0, sign=False)}

*Runner-up*: the cheapest of another measure, algorithm, iteration or element, and its cost over that of the advice;
*next step*: the cost of half the tolerance over that of the advice.""")
    header = ["scene", "configuration", "error at most", "seconds", "runner-up", "its cost", "next step"]
    title = f"Advice at {percent(ENGINEER, 0, sign=False)}"
    spent = table("Times by the law of its scene", ["scene", "time [s]", "90 % of the cells within [s]"], times)
    body = [table(title, header, rows, words=2), spent, commands(own["command"][own["command"] != ""])]
    shown = "\n\n".join(body)
    return Part(f"{text}\n\n{machine(shown)}")


def _worth(store: Store) -> Part:
    """The advice on scenes that were left out."""
    cases = store.analysis("held_out")
    summary = store.analysis("held_out_summary")
    rows = [
        [
            "headline of each scene" if row["quantities"] == "headline" else "all quantities",
            str(row["cases"]),
            str(row["advised"]),
            percent(row["met"], 1, sign=False),
            fixed(row["median_regret"], 2),
            fixed(row["mean_regret"], 2),
            str(row["abstained"]),
            str(row["truly_none"]),
        ]
        for row in summary.to_dict("records")
    ]
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
tolerance is met in {percent(met, 1, sign=False)} of the {headline["advised"]} that were advised, with a median regret
of {fixed(regret, 2)}: {verdict} ({percent(AIM_MET, 0, sign=False)}, {fixed(AIM_REGRET, 1)}); the mean is
{fixed(headline["mean_regret"], 2)}. Over all quantities {percent(dear, 0, sign=False)} of the advised cases cost more
than {fixed(AIM_REGRET, 1)} times the best. Factors of safety: {fixed(cases["factor"].min(), 2)} to
{fixed(cases["factor"].max(), 2)}.""")
    header = [
        "quantities",
        "cases",
        "advised",
        "met",
        "median regret",
        "mean regret",
        "no advice, though some would do",
    ]
    parts = [told, table("Advice on scenes left out", [*header, "nothing would do"], rows)]
    if len(failed):
        missed = (_missed(row) for row in _records(failed))
        parts.append(table("Where the tolerance was missed", MISSED, missed, words=2))
    scenes = [_by_scene(str(scene), own) for scene, own in cases.groupby("scene", sort=False)]
    parts.append(table("By scene, all quantities", BY_SCENE, scenes))
    shown = picture(HELD_OUT, "True error over tolerance, and regret, of advice on scenes left out")
    found = machine("\n\n".join(parts))
    return Part(f"{text}\n\n{shown}\n\n{found}", {HELD_OUT: figures_tradeoff.held_out(cases)})


MISSED = ["scene", "quantity", "tolerance", "true error", "estimate", "advised"]
BY_SCENE = ["scene", "cases", "advised", "met", "median regret", "largest regret"]


def _records(cases: pd.DataFrame) -> list[dict]:
    return list(cases.to_dict("records"))


def _missed(row: dict) -> list[str]:
    numbers = (percent(row[name], 2, sign=False) for name in ("tolerance", "true_error", "estimate"))
    return [f"`{row['scene']}`", f"`{row['quantity']}`", *numbers, f"`{row['advised']}`"]


def _by_scene(scene: str, cases: pd.DataFrame) -> list[str]:
    given = cases[cases["advised"] != ""]
    regret = given["regret"].astype(float)
    met = percent(float(given["met"].mean()), 0, sign=False) if len(given) else NOTHING
    return [f"`{scene}`", str(len(cases)), str(len(given)), met, fixed(regret.median(), 2), fixed(regret.max(), 2)]


CHAPTER = Chapter(
    "advice",
    "Advice",
    "the cheapest configuration for a tolerance, and what such advice is worth.",
    advice_page,
    needs=("advice", "held_out", "held_out_summary"),
)
