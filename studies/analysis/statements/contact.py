"""What is said of contact: do algorithms agree, when has a set settled, the arena, closed forms, the tyre's force."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pandas as pd

from studies.analysis import ladders
from studies.analysis.outcomes import DEFAULT
from studies.analysis.statements.record import ANSWER, FINDING, OPENING, Statement
from studies.run.campaigns.report_cells import agreement
from studies.run.cells.answers import Answer, Answers

AGREE = 1e-7  # relative difference of forces up to which two algorithms agree
CASE = ("load", "section")  # settings that change the problem
CONTACT_SCENES = ("strip-contact", "plate-contact", "ring", "heavy-strip")  # with a closed form
MESHES = ("28x26", "42x40", "84x80")


def agree(answers: Answers) -> Iterator[Statement]:
    """Every solve with the exact condition against the reference of its case."""
    found = (each for each in answers.those(agreement()) if each.steps)  # what was refused has no state to compare
    solved = [each for each in found if each.settings["epsilon"] in ("inf", math.inf)]
    references = {_case(each): each for each in solved if each.label.startswith(f"agreement {DEFAULT} ")}
    others = [each for each in solved if _case(each) in references and each is not references[_case(each)]]
    pairs = [_unlike(each, references[_case(each)]) for each in others]
    if not pairs:
        return
    offs = [off for off, _ in pairs]
    same = sum(off <= AGREE and nodes == 0 for off, nodes in pairs)
    values = {"agree": float(same), "of": float(len(pairs)), "off": max(offs), "bound": AGREE}
    values |= {"ways": float(len({each.label.removeprefix("agreement ").rsplit(" ", 3)[0] for each in others}))}
    text = (
        "{agree:.0f} of {of:.0f} other solves of the pressed tyre, by {ways:.0f} algorithms and settings, have the "
        "contact set of `semismooth` node by node; forces differ by at most {off:.0e} of their value."
    )
    scope = "the exact condition, where both end, on the paper's tyre; a finite ε solves other equations"
    yield Statement("algorithms-agree", "algorithms", text, values, len(pairs), scope, OPENING)


def _case(answer: Answer) -> tuple[str, ...]:
    return tuple(str(answer.settings[key]) for key in CASE)


def _unlike(answer: Answer, other: Answer) -> tuple[float, int]:
    """The largest relative difference of forces, and of nodes in contact in one only, over the travels of both."""
    forces = [{step["delta_mm"]: step["force_N"] for step in each.steps} for each in (answer, other)]
    common = [delta for delta in forces[0] if delta in forces[1]]
    off = max((abs(forces[0][delta] / forces[1][delta] - 1) for delta in common), default=math.inf)
    tables = [each.table("contact") for each in (answer, other)]
    sets = [table[table["delta_mm"].isin(common)]["active"].to_numpy() for table in tables]
    return off, int(np.sum(sets[0] != sets[1])) if len(sets[0]) == len(sets[1]) else -1


def settled(answers: Answers) -> Iterator[Statement]:
    """When an active set has settled."""
    ways = ("semismooth", "semismooth, settle 1")
    found = {way: [answers.get(f"one step {way} {mesh}") for mesh in MESHES] for way in ways}
    known = {way: [each for each in own if each is not None] for way, own in found.items()}
    if any(len(own) < len(MESHES) for own in known.values()):
        return
    ours, theirs = (sum(each.converged and not each.record["cuts"] for each in known[way]) for way in ways)
    values = {"meshes": float(len(MESHES)), "ours": float(ours), "theirs": float(theirs)}
    text = (
        "Pressed by 20 mm in one step on {meshes:.0f} meshes, `semismooth`, which updates the contact set on one "
        "linearisation until few nodes change, converges without a cut on {ours:.0f}; with a linearisation for every "
        "set (settle 1) on {theirs:.0f}. Either has converged only when no node changes any more."
    )
    scope = "half of the paper's tyre"
    yield Statement("settling", "algorithms", text, values, 2 * len(MESHES), scope, ANSWER)


def arena(solver_summary: pd.DataFrame, solver_run: pd.DataFrame) -> Iterator[Statement]:
    """Who solves most of the convex problems to the middle tolerance, and how many claim too much."""
    whole = solver_summary[(solver_summary["size"] == "all") & (solver_summary["kind"] == "convex")]
    whole = whole[whole["refused"] < whole["problems"]]
    if whole.empty:
        return
    asked = sorted(whole["tolerance"].unique(), reverse=True)
    middle, strict = (whole[whole["tolerance"] == each] for each in (asked[len(asked) // 2], asked[-1]))
    best = middle.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable").iloc[0]
    limit = float(dict(zip(solver_run["name"], solver_run["value"], strict=True))["limit_s"])
    values: dict[str, float | str] = {"best": str(best["solver"]), "convex": float(best["problems"])}
    values |= {"tolerance": float(best["tolerance"]), "limit": limit, "solvers": float(len(middle))}
    values |= {"solved": float(best["solved"]), "mean": float(best["mean_s"]), "claims": float(middle["claimed"].sum())}
    values |= {"false": float(middle["false"].sum()), "wrong": float((middle["false"] > 0).sum())}
    text = (
        "{best} solves most of {convex:.0f} convex problems to {tolerance:.0e}: {solved:.0f}, in {mean:.3f} s on "
        "average (a failure costs {limit:g} s). Of {claims:.0f} claims of {solvers:.0f} solvers and forms {false:.0f}, "
        "by {wrong:.0f} of them, are false."
    )
    own, hard = (each[each["solver"] == DEFAULT] for each in (middle, strict))
    if len(own) and len(hard):
        values |= {"ours": float(own["false"].iloc[0]), "ours_solved": float(own["solved"].iloc[0])}
        values |= {"strict": asked[-1], "ours_strict": float(hard["false"].iloc[0])}
        values |= {"worst": float(hard["worst_claim"].iloc[0])}
        text += f" `{DEFAULT}`, the default here, solves {{ours_solved:.0f}} and makes {{ours:.0f}} false claims, "
        text += "{ours_strict:.0f} when asked for {strict:.0e}"
        text += " (the worst {worst:.2g} times that)." if values["ours_strict"] else "."
    scope = "one linearised problem at a time, from rest, one thread; defaults of the solvers but for the tolerance"
    yield Statement("arena", "algorithms", text, values, int(best["problems"]), scope, FINDING, machine=True)


def closed_forms(convergence: pd.DataFrame, convergence_errors: pd.DataFrame) -> Iterator[Statement]:
    """Contact problems with a closed form."""
    own = convergence[convergence["scene"].isin(CONTACT_SCENES) & (convergence["element"] == ladders.DEFAULT)]
    own = own.drop_duplicates("sequence")
    pairs = convergence_errors[
        convergence_errors["sequence"].isin(own["sequence"]) & (convergence_errors["kind"] == "exact")
    ]
    pairs = pairs.drop_duplicates(["sequence", "reference"], keep="last")
    if pairs.empty:
        return
    off = pairs["error"].abs()
    values = {
        "cases": float(len(pairs)),
        "scenes": float(own["scene"].nunique()),
        "off": off.max(),
        "middle": off.median(),
    }
    text = (
        "On the finest meshes of {scenes:.0f} contact problems with a closed form {cases:.0f} quantities err by at "
        "most {off:.2%}, {middle:.3%} in the median."
    )
    scope = "beams and rings on rigid planes; there is no Hertz problem of solids"
    yield Statement("closed-forms", "convergence", text, values, len(pairs), scope, ANSWER)


CHANGES = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}


def force_known(work_precision: pd.DataFrame, tyre_budget: pd.DataFrame) -> Iterator[Statement]:
    """How far the force is known: by its grids, and by what its model leaves out."""
    row, changes = work_precision.iloc[0], tyre_budget.set_index("changed")
    values = {"force": row["reference_N"], "known": row["known"]}
    text = "The force of the paper's tyre at 20 mm is {force:.1f} N in the limit of its grids, known to {known:.2%}"
    said = []
    for name, words in CHANGES.items():
        if name in changes.index:
            own = changes.loc[[name]].iloc[-1]
            key = name.split()[0].replace("-", "_")
            values |= {key: float(own["change"]), f"{key}_known": float(own["within"])}
            said.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
    values |= {
        "total": sum(float(values[name.split()[0].replace("-", "_")]) for name in CHANGES if name in changes.index)
    }
    text += f"; that is the error of the mesh alone: {', '.join(said)}" if said else ""
    text += ", {total:+.0%} if all are added: the model decides, not the mesh" if len(said) > 1 else ""
    text += ". Beyond 14.5 mm short waves beside the patch cost no energy: finer grids may leave this path."
    scope = "dead load, mid-surface area, exact measure; a follower load or a solid has another force"
    yield Statement("force-known", "cost", text, values, len(work_precision), scope)
