"""What sentences on contact rest on: when has a set settled, the arena, the tyre."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.outcomes import DEFAULT
from studies.analysis.statements.record import Values
from studies.run.answers import Answers

MESHES = ("28x26", "42x40", "84x80")
CHANGES = {  # what of the model changes the force, by its name in the budget
    "follower": "a pressure that follows the inner face",
    "full-3d": "the full three-dimensional law",
    "shell instead of a solid": "a solid (of an isotropic tyre)",
}


def settled(answers: Answers) -> Iterator[Values]:
    """On how many meshes the pressed tyre converges without a cut, by either rule of when an active set has settled."""
    counts = []
    for way in ("semismooth", "semismooth, settle 1"):
        solved = [answers.get(f"one step {way} {mesh}") for mesh in MESHES]
        if None in solved:
            return
        counts.append(sum(each is not None and each.converged and not each.record["cuts"] for each in solved))
    ours, theirs = counts
    yield {"meshes": len(MESHES), "ours": ours, "theirs": theirs, "_problems": 2 * len(MESHES)}


def arena(solver_summary: pd.DataFrame, solver_run: pd.DataFrame) -> Iterator[Values]:
    """Who solves most of the convex problems to the middle tolerance, and how many claim too much."""
    whole = solver_summary[(solver_summary["size"] == "all") & (solver_summary["kind"] == "convex")]
    whole = whole[whole["refused"] < whole["problems"]]
    if whole.empty:
        return
    asked = sorted(whole["tolerance"].unique(), reverse=True)
    middle, strict = (whole[whole["tolerance"] == each] for each in (asked[len(asked) // 2], asked[-1]))
    best = middle.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable").iloc[0]
    limit = dict(zip(solver_run["name"], solver_run["value"], strict=True))["limit_s"]
    values: Values = {"best": str(best["solver"]), "convex": best["problems"], "tolerance": best["tolerance"]}
    values |= {"limit": float(limit), "solvers": len(middle), "solved": best["solved"], "mean": best["mean_s"]}
    values |= {"claims": middle["claimed"].sum(), "false": middle["false"].sum(), "wrong": (middle["false"] > 0).sum()}
    own, hard = (each[each["solver"] == DEFAULT] for each in (middle, strict))
    values |= {"_problems": best["problems"], "_default": DEFAULT, "_strict": -1}
    if len(own) and len(hard):
        values |= {"ours": own["false"].iloc[0], "ours_solved": own["solved"].iloc[0], "strict": asked[-1]}
        values |= {"ours_strict": hard["false"].iloc[0], "worst": hard["worst_claim"].iloc[0]}
        values["_strict"] = values["ours_strict"]
    yield values


def force_known(work_precision: pd.DataFrame, tyre_budget: pd.DataFrame) -> Iterator[Values]:
    """How far the force of the tyre is known: by its grids, and by what its model leaves out."""
    row, changes = work_precision.iloc[0], {each["changed"]: each for each in tyre_budget.to_dict("records")}
    values: Values = {"force": row["reference_N"], "known": row["known"]}
    clauses, total = [], 0.0
    for name, words in CHANGES.items():
        if name in changes:
            key, own = name.split()[0].replace("-", "_"), changes[name]
            values |= {key: own["change"], f"{key}_known": own["within"]}
            clauses.append(f"{words} changes it by {{{key}:+.1%}} ± {{{key}_known:.1%}}")
            total += own["change"]
    yield values | {
        "total": total,
        "_told": ", ".join(clauses),
        "_changes": len(clauses),
        "_problems": len(work_precision),
    }
