"""Parts of the page of algorithms: do all give the same contact set and force, and how they fare in the arena.

There public solvers and our algorithms meet on frozen contact problems; how to enter one's own.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from reports.figures.drawing import GREY, canvas, looks, svg
from reports.formats import NOTHING, code
from reports.markdown import Part, Template, commands
from reports.store import Store

TEXT = Template("algorithms", signed=lambda count: f"{count:+.0f}")
REFUSAL = " does not apply: "  # before its reason
REFUSED = "unsupported"


def agreement_part(store: Store) -> Part:
    """The pressed tyre by every algorithm, a line each, and problems of the campaign with several answers."""
    agreement = store.table("algorithm_agreement")
    plain = agreement["algorithm"].map(code)
    agreement = agreement.assign(named=plain.where(agreement["way"] == "", plain + ", " + agreement["way"]))
    put = agreement[agreement["exact"] & ~agreement["reference"]]
    solved, refused = put[put["outcome"] != REFUSED], put[put["outcome"] == REFUSED]
    first = agreement.iloc[0]
    alike = (agreement["way"] == "") & (agreement["load"] == first["load"]) & (agreement["section"] == first["section"])
    values = {
        "first": first,
        "cases": len(agreement.drop_duplicates(["load", "section"])),
        "agree": int(solved["agrees"].sum()),
        "solved": len(solved),
        "refused": len(refused),
        "commands": commands(agreement[alike]["command"]),
    }
    rows = {
        "ways": [_row(way, own) for way, own in put.groupby("named", sort=False)],
        "odd": solved[~solved["agrees"].astype(bool)],
    }
    finite = _finite(agreement[~agreement["exact"] & (agreement["outcome"] != REFUSED)])
    parts = {"finite": finite, "refusals": _refused(refused), "answers": _answers(store)}
    return TEXT("agreement", rules=store.rules(), **values, **rows, **parts)


def _row(way: object, own: pd.DataFrame) -> dict[str, object]:
    solved = own[own["outcome"] != REFUSED]
    agree = f"{int(solved['agrees'].sum())} of {len(solved)}" if len(solved) else ""
    counts = {"cases": len(own), "refused": len(own) - len(solved)}
    return {"way": way, "agree": agree, "off": solved["off"].max(), "nodes": solved["nodes"].max(), **counts}


def _refused(refused: pd.DataFrame) -> Part:
    """Who refuses what, the first reason of each."""
    rows = []
    for name, own in refused.groupby("algorithm", sort=False):
        reason = str(own["reason"].iloc[0])
        rows.append({"name": name, "count": len(own), "reason": reason.partition(REFUSAL)[2] or reason})
    return TEXT("refusals", rows=rows) if rows else Part("No request is refused.")


def _finite(soft: pd.DataFrame) -> Part:
    """What a finite epsilon, the default of some algorithms, changes."""
    if soft.empty:
        return Part()
    stiffness = ", ".join(f"{epsilon:g}" for epsilon in soft["epsilon"].unique())
    most = {"off": soft["off"].max(), "depth": soft["penetration_mm"].max()}
    return TEXT("finite", stiffness=stiffness, count=len(soft), **most)


def _answers(store: Store) -> Part:
    """Problems of the whole campaign to which it has more than one certified answer."""
    if not store.has("disagreements"):
        return Part()
    disagreements = store.table("disagreements")
    rows = [
        {"why": why, "answers": len(own), "scenes": dict.fromkeys(own["scene"]), "difference": own["difference"].max()}
        for why, own in disagreements.groupby("why", sort=False)
    ]
    return TEXT("answers", count=len(disagreements), rows=rows)


RUN = "footprint bench solvers --problems problems --out .footprint/store"
MAKE = "footprint problems make --out problems"
NEEDED = ("problems", "problems_left_out")
CONVEX, ALL = "convex", "all"
FORMS = ("scaled", "condensed")  # of the programme that a public solver is given
CYCLES, SIZE = "the contact set repeats itself", "too many"  # in what is said of a step that was left out
REASONS = {  # in what is said, the first that fits: why no answer is certified
    CYCLES: "`semismooth` cycles and its pivots do not resolve the cycle",
    "kernels of BLAS": "other BLAS kernels lead to another path",
    "singular": "the equations are singular to working precision",
    "presses other candidates": "the interior point finds another contact set",
    "wrong sign": "a force or gap has the wrong sign on the computed set",
}
OTHER = "another condition of the certificate fails"
NAMED, ALWAYS = 7, "OSQP"
PANELS = {
    "the quickest": "time over that of the fastest",
    "a factorisation": "time in factorisations of the stiffness",
}


def arena_part(store: Store) -> Part:
    """The whole part; nothing where the campaign has no collection."""
    if not all(map(store.has, NEEDED)):
        return Part()
    parts = {
        "ranked": "" if store.has("solver_summary") else TEXT("unranked", run=RUN),
        "ranking": _ranking(store),
        "profiles": _profiles(store),
        "osqp": _osqp(store),
        "left_out": _left_out(store),
        "limits": _limits(store),
    }
    return TEXT("arena", **parts)


def _ranking(store: Store) -> Part:
    """Who solves how many in which time, and who claims too much: a line a solver, in the form that suits it best."""
    if not store.has("solver_summary"):
        return Part()
    whole = store.table("solver_summary")
    whole = whole[whole["size"] == ALL]
    every, summary = whole[whole["kind"] == CONVEX], _middle(whole)
    convex = summary[(summary["kind"] == CONVEX) & (summary["refused"] < summary["problems"])]
    others = summary[summary["kind"] != CONVEX].groupby("solver")[["problems", "solved", "refused", "false"]].sum()
    kinds = store.table("solver_problems")["kind"].value_counts()
    strictest = every["tolerance"].min()
    strict = every[every["tolerance"] == strictest].set_index("solver")
    return TEXT(
        "ranking",
        count=kinds.sum(),
        kinds=", ".join(f"{count} {kind}" for kind, count in kinds.items()),
        tolerance=summary["tolerance"].iloc[0],
        strict=strictest,
        rows=list(_ranked(convex, others, strict)),
    )


def _middle(summary: pd.DataFrame) -> pd.DataFrame:
    """The rows of the middle tolerance."""
    asked = sorted(summary["tolerance"].unique(), reverse=True)
    return summary[summary["tolerance"] == asked[len(asked) // 2]]


def _ranked(convex: pd.DataFrame, others: pd.DataFrame, strict: pd.DataFrame) -> Iterator[dict[Any, Any]]:
    """Most solutions first, then the quickest; strict: the strictest tolerance, by solver."""
    parts = convex["solver"].str.rpartition(", ")
    formed = parts[2].isin(FORMS)
    named = convex.assign(bare=parts[0].where(formed, convex["solver"]), form=parts[2].where(formed, NOTHING))
    ordered = named.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable")
    for _, own in ordered.groupby("bare", sort=False):
        best, *rest = own.to_dict("records")
        row = {**best, "beyond": "refused", "beyond_false": "", "strict": strict.loc[best["solver"]]}
        if best["solver"] in others.index:
            other = others.loc[best["solver"]]
            if other["refused"] < other["problems"]:
                row |= {"beyond": f"{other['solved']:.0f}/{other['problems']:.0f}"}
                row |= {"beyond_false": f"{other['false']:.0f}"}
        yield row | {f"rest_{name}": ", ".join(str(each[name]) for each in rest) for name in ("solved", "false")}


def _profiles(store: Store) -> Part:
    """Profiles at the middle tolerance."""
    own = _convex(store, "solver_profiles")
    return TEXT("profiles", {"arena-profiles.svg": profiles(own)}) if len(own) else Part()


def _convex(store: Store, name: str) -> pd.DataFrame:
    """The rows of convex problems of all sizes at the middle tolerance; none without the table."""
    if not store.has(name):
        return pd.DataFrame()
    middle = _middle(store.table(name))
    return middle[(middle["kind"] == CONVEX) & (middle["size"] == ALL)]


def _osqp(store: Store) -> Part:
    """Which setting of OSQP helps, and which harms."""
    own = _convex(store, "osqp_effects")
    if own.empty or (own["setting"] == "defaults").all():
        return Part()
    changed = own[own["setting"] != "defaults"]
    changed = changed.sort_values(["more_solved", "time_ratio"], ascending=[False, True], kind="stable")
    rows = pd.concat([changed.head(3), changed.tail(2)]).drop_duplicates()
    return TEXT("osqp", problems=own["problems"].max(), count=len(changed), rows=rows)


def _left_out(store: Store) -> Part:
    """What the rule would have taken and nobody certifies."""
    rows = store.table("problems_left_out")
    if rows.empty:
        return TEXT("nothing-left-out")
    large = rows["why"].str.contains(SIZE)
    causes = rows.loc[~large, "why"].map(_cause)
    counts = {"count": len(rows), "large": large.sum(), "uncertified": (~large).sum()}
    named = [{"why": why, "steps": steps} for why, steps in causes.value_counts(sort=True).items()]
    cycles = (causes == REASONS[CYCLES]).sum()
    return TEXT("left-out", **counts, cycles=cycles, causes=named, commands=commands([MAKE]))


def _cause(why: str) -> str:
    first = why.split(";")[0]
    return next((words for part, words in REASONS.items() if part in first), OTHER)


def _limits(store: Store) -> Part:
    """What bounds all this, and the machine."""
    if not store.has("solver_run"):
        return Part()
    about = dict(store.table("solver_run").astype(str).itertuples(index=False, name=None))
    limit, whole = float(about.pop("limit_s")), store.table("solver_summary")
    asked = whole[whole["size"] == ALL]
    killed = float(asked["timed_out"].sum() / asked["problems"].sum())
    conditions = ", ".join(f"{name} {value}" for name, value in about.items())
    shown = commands([RUN, f"{RUN} --ablation"])
    return TEXT("limits", limit_s=limit, killed=killed, conditions=conditions, commands=shown)


@svg
def profiles(shares: pd.DataFrame) -> Figure:
    """Share of problems over cost, relative to the quickest and in factorisations, of one tolerance, kind and size."""
    figure, panels = canvas(len(PANELS), width=11.0, height=4.8, sharey=True)
    named = looks(shown_by_name(shares))
    for axes, (of, words) in zip(panels, PANELS.items(), strict=True):
        own = shares[shares["of"] == of]
        curves = {str(name): each.sort_values("at") for name, each in own.groupby("solver", sort=False)}
        for name, curve in curves.items():
            if name not in named:
                axes.plot(curve["at"], curve["share"], color=GREY, linewidth=0.5, alpha=0.5)
        for name, style in named.items():
            axes.plot(curves[name]["at"], curves[name]["share"], **style.whole, markersize=3, label=name)
        axes.set(xscale="log", xlabel=words, ylim=(0, 1.02), xlim=(own["at"].min(), own["at"].max()))
    panels[0].set_ylabel("share of problems solved")
    handles, names = panels[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside right upper", title="most solved first")
    return figure


def shown_by_name(rows: pd.DataFrame) -> list[str]:
    """The solvers with the largest shares at the end of their curves, and OSQP, whatever it has."""
    ends = rows.groupby("solver", sort=False)["share"].max().sort_values(ascending=False, kind="stable")
    best = [str(name) for name in ends.index[:NAMED]]
    return best + [ALWAYS] * (ALWAYS in ends.index and ALWAYS not in best)
