"""What is said of frozen contact problems, and of solvers on them."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import OPENING, Statement


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
    yield Statement("problems", "arena", text, values, len(problems), scope, OPENING)


def arena(solver_summary: pd.DataFrame, solver_problems: pd.DataFrame, solver_run: pd.DataFrame) -> Iterator[Statement]:
    """Who solves most of the convex problems to the strictest tolerance, and how many claim too much."""
    whole = solver_summary[(solver_summary["size"] == "all") & (solver_summary["kind"] == "convex")]
    strict = whole[(whole["tolerance"] == whole["tolerance"].min()) & (whole["refused"] < whole["problems"])]
    if strict.empty:
        return
    best = strict.sort_values(["solved", "mean_s"], ascending=[False, True], kind="stable").iloc[0]
    limit = float(dict(zip(solver_run["name"], solver_run["value"], strict=True))["limit_s"])
    values: dict[str, float | str] = {"best": str(best["solver"])}
    values |= {"problems": float(len(solver_problems)), "convex": float(strict["problems"].max())}
    values |= {"tolerance": float(strict["tolerance"].iloc[0]), "limit": limit, "solvers": float(len(strict))}
    values |= {"solved": float(best["solved"]), "mean": float(best["mean_s"]), "claims": float(strict["claimed"].sum())}
    values |= {"false": float(strict["false"].sum()), "wrong": float((strict["false"] > 0).sum())}
    text = (
        "Of {problems:.0f} frozen contact problems {convex:.0f} are convex programmes. Of {solvers:.0f} solvers that "
        "are asked for {tolerance:.0e} and have {limit:g} s, {best} has the most solutions, {solved:.0f}, in "
        "{mean:.3f} s on average; {false:.0f} of {claims:.0f} claims, by {wrong:.0f} solvers, are false."
    )
    scope = "one linearised problem at a time, from rest, one thread; defaults of the solvers but for the tolerance"
    yield Statement("arena", "arena", text, values, int(strict["problems"].max()), scope, OPENING, machine=True)


MAKERS = (collection, arena)
