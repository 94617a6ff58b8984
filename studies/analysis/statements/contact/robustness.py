"""What is said of robustness: false success, cycles, regularisation, and limits of the algorithms."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.statements.record import FINDING, LIMIT, OPENING, Statement

PAPER_EPSILON = 1e4


def claims(false_success: pd.DataFrame) -> Iterator[Statement]:
    """Who says solved and is wrong."""
    wrong = false_success[false_success["false"] > 0].sort_values("false", ascending=False, kind="stable")
    ours = false_success[~false_success["contender"].str.contains("alone")]
    usual = false_success[false_success["contender"].str.contains("osqp alone, defaults")]
    if not usual.empty:
        row = usual.iloc[0]
        values = {"claimed": row["claimed"], "false": row["false"], "version": str(row["version"])}
        values |= {"own": row["false_own"], "bound": row["bound"], "error": row["largest_error"]}
        values |= {"ours": float(ours["false"].sum()), "of": float(ours["claimed"].sum())}
        text = (
            'OSQP alone ({version}, its defaults) says "solved" on {claimed:.0f} contact problems; {false:.0f} of '
            "these answers fail the judge at {bound:.0e}, {own:.0f} of them also at the tolerance of OSQP itself; the "
            "worst is {error:.0e} off. Of {of:.0f} answers of the algorithms here, which check what a solver returns, "
            "{ours:.0f} are false."
        )
        scope = "a collection of small contact problems; a tighter tolerance of the solver changes the counts"
        yield Statement(
            "false-solved", "algorithms", text, values, int(false_success["problems"].max()), scope, OPENING
        )
    names = ", ".join(f"`{row['contender']}` {row['false']} of {row['claimed']}" for _, row in wrong.iterrows())
    values = {"names": names or "none", "contenders": float(len(false_success))}
    text = 'False among the answers that were called "solved", of {contenders:.0f} contenders: {names}.'
    yield Statement("false-by-contender", "algorithms", text, values, int(false_success["problems"].max()), "as above")


def cycles(cycles: pd.DataFrame) -> Iterator[Statement]:
    """Where active sets cycle."""
    cycling = cycles[cycles["plain_period"] > 0]
    caught = cycling["trial-and-error"].astype(str).str.startswith("converged").sum()
    values = {"cycling": float(len(cycling)), "of": float(len(cycles)), "caught": float(caught)}
    text = (
        "The textbook's active set cycles on {cycling:.0f} of {of:.0f} published problems; with the detector of cycles "
        "`trial-and-error` ends on {caught:.0f} of them."
    )
    yield Statement("cycles", "algorithms", text, values, len(cycles), "published problems, small and linear")


def regularisation(epsilon: pd.DataFrame, epsilon_laws: pd.DataFrame) -> Iterator[Statement]:
    """The paper's epsilon."""
    own = epsilon[(epsilon["form"] == "multiplier") & (epsilon["epsilon"] == PAPER_EPSILON)].set_index("case")
    laws = epsilon_laws.set_index("case")
    if "tyre" not in own.index or "tyre" not in laws.index:
        return
    row = own.loc["tyre"]
    values = {"epsilon": PAPER_EPSILON, "off": abs(row["force_error"]), "penetration": row["penetration_mm"]}
    values |= {"slope": laws.loc["tyre", "force_slope"], "breaks": float(laws["breaks_at"].min())}
    text = (
        "The paper's ε = {epsilon:g} MPa/mm changes the tyre's force at 20 mm by {off:.0e} of itself. "
        "The error falls as ε to the {slope:.1f}; in the form without a multiplier the solve breaks down from "
        "ε = {breaks:g} on in one of the two problems."
    )
    if math.isnan(values["breaks"]):
        text = text.partition("; in the form")[0] + "."
    scope = "two problems; how large ε may be depends on the stiffness of the body"
    yield Statement("epsilon", "epsilon", text, values, len(epsilon), scope, OPENING, machine=True)


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
        else "Pressing a ring ends at h/R = {best:.2g} for the best contact algorithm and at {worst:.2g} for {name}"
    )
    text += ", with an error of at most {error:.2%} there."
    scope = "a ring of 32 elements in double precision; steps of a tenth of a decade"
    yield Statement("thinnest", "extremes", text, values, len(thin), scope, OPENING, machine=True)
    text = "A ring thinner than h/R = {best:.2g} is pressed to the end by no contact algorithm."
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


MAKERS = (claims, cycles, regularisation, limits, maps)
