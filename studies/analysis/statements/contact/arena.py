"""What is said of frozen contact problems, and of solvers on them."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.findings.contact_summary import DEFAULT
from studies.analysis.statements.record import FINDING, Statement


def collection(problems: pd.DataFrame) -> Iterator[Statement]:
    """How many problems there are, how large they are, and by how many ways their answers are certified."""
    ways = problems["confirmed_by"].str.count(" and ") + 2  # what found it, and what confirms it
    values: dict[str, float | str] = {"problems": float(len(problems)), "families": float(problems["family"].nunique())}
    values |= {"smallest": float(problems["unknowns"].min()), "largest": float(problems["unknowns"].max())}
    values |= {"most": float(problems["candidates"].max()), "size": float(problems["bytes"].sum() / 1e6)}
    values |= {"two": float((problems["confirmed_by"] != "").sum()), "three": float((ways > 2).sum())}
    text = (
        "The collection has {problems:.0f} frozen contact problems of {families:.0f} families, {smallest:.0f} to "
        "{largest:.0f} unknowns and up to {most:.0f} candidates, in {size:.0f} MB. The answers of {two:.0f} are "
        "certified by two ways, of {three:.0f} by a third one, too."
    )
    scope = "what no way certifies is not in the collection, and listed"
    yield Statement("problems", "algorithms", text, values, len(problems), scope, FINDING)


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


MAKERS = (arena, collection)
