"""What is said of solvers on frozen contact problems."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import OPENING, Statement


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


MAKERS = (arena,)
