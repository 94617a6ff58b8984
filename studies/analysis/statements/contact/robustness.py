"""What is said of robustness: false success, cycles, and limits of the algorithms."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import FINDING, LIMIT, OPENING, Statement


def claims(false_success: pd.DataFrame) -> Iterator[Statement]:
    """Who says solved and is wrong."""
    wrong = false_success[false_success["false"] > 0].sort_values("false", ascending=False, kind="stable")
    ours = false_success[~false_success["contender"].str.contains("alone")]
    usual = false_success[false_success["contender"].str.contains("osqp alone, defaults")]
    if not usual.empty:
        row = usual.iloc[0]
        values = {"claimed": row["claimed"], "false": row["false"], "version": str(row["version"])}
        values |= {"kept": row["claimed"] - row["false_own"], "bound": row["bound"], "error": row["largest_error"]}
        values |= {"ours": float(ours["false"].sum()), "of": float(ours["claimed"].sum())}
        text = (
            'At its default tolerance OSQP alone ({version}) says "solved" on {claimed:.0f} small contact problems. By '
            "its own criterion {kept:.0f} of these answers are right, yet {false:.0f} fail the judge at {bound:.0e}, "
            "and displacements have errors of up to {error:.0%}. Of {of:.0f} answers of the algorithms here, which "
            "check what a solver returns, {ours:.0f} are false."
        )
        scope = "small problems; a tighter tolerance changes the counts, and the arena has harder problems"
        yield Statement(
            "false-solved", "algorithms", text, values, int(false_success["problems"].max()), scope, OPENING
        )
    names = ", ".join(
        f"`{row['contender']}` {row['false']} of {row['claimed']} (errors of up to {row['largest_error']:.1g})"
        for row in wrong.to_dict("records")
    )
    values = {"names": names or "none", "contenders": float(len(false_success))}
    text = 'Answers called "solved" that the judge refuses, of {contenders:.0f} solvers and settings: {names}.'
    yield Statement("false-by-contender", "algorithms", text, values, int(false_success["problems"].max()), "as above")


def cycles(cycles: pd.DataFrame) -> Iterator[Statement]:
    """Where active sets cycle."""
    cycling = cycles[cycles["plain_period"] > 0]
    caught = cycling["trial-and-error"].astype(str).str.startswith("converged").sum()
    values = {"cycling": float(len(cycling)), "of": float(len(cycles)), "caught": float(caught)}
    text = (
        "The textbook's active set, which is the paper's, cycles on {cycling:.0f} of {of:.0f} published problems; our "
        "`trial-and-error` detects cycles and converges on {caught:.0f} of these {cycling:.0f}."
    )
    yield Statement("cycles", "algorithms", text, values, len(cycles), "published problems, small and linear")


def limits(extremes_limits: pd.DataFrame) -> Iterator[Statement]:
    """How thin, how far: the limits that are met first."""
    own = extremes_limits[extremes_limits["part"] == "algorithm"]
    thin = own[own["limit"] == "thinnest shell"]
    if thin.empty:
        return
    worst, best = (thin.iloc[int(at)] for at in (thin["value"].argmax(), thin["value"].argmin()))
    values = {"worst": worst["value"], "best": best["value"], "name": f"`{worst['name']}`"}
    values |= {"error": thin["error"].max()}
    same = worst["value"] == best["value"]
    text = (
        "Every contact algorithm presses a ring down to a thickness of h/R = {best:.2g}"
        if same
        else "The best contact algorithm presses a ring down to h/R = {best:.2g}, {name} to {worst:.2g}"
    )
    text += ", with an error of at most {error:.2%} there."
    scope = "a ring of 32 elements in double precision; steps of a tenth of a decade"
    yield Statement("thinnest", "extremes", text, values, len(thin), scope, OPENING, machine=True)
    text = "No contact algorithm presses a ring thinner than h/R = {best:.2g} to the full travel."
    values = {"best": best["value"]}
    yield Statement("thin-walls", "extremes", text, values, len(thin), scope, LIMIT, machine=True)


def maps(extremes: pd.DataFrame) -> Iterator[Statement]:
    """Maps of outcomes: what the judge refuses, and what crashes."""
    asked = extremes[extremes["asked"].astype(bool)]
    counts = asked["class"].value_counts()
    values = {"asked": float(len(asked)), "maps": float(extremes["map"].nunique())}
    values |= {"wrong": float(counts.get("wrong", 0)), "crashed": float(counts.get("crashed", 0))}
    values |= {"failed": float(counts.get("not converged", 0))}
    text = (
        "Of {asked:.0f} solves on {maps:.0f} maps of extreme settings {crashed:.0f} crash and {wrong:.0f} are called "
        "converged where the judge disagrees; {failed:.0f} do not converge without a limit point that would explain it."
    )
    scope = "pairs of settings; blocks that touch no boundary are not searched further"
    yield Statement("extreme-maps", "extremes", text, values, len(asked), scope, FINDING, machine=True)


MAKERS = (claims, cycles, limits, maps)
