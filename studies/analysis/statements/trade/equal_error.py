"""What is said of measures at equal error, and of contact algorithms where both solve."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from studies.analysis.findings.equal_accuracy import CLASSICAL
from studies.analysis.statements.record import OPENING, Statement


def at_equal_error(equal_accuracy: pd.DataFrame) -> Iterator[Statement]:
    """Is any classical nonlinear measure worth it?"""
    whole = equal_accuracy[equal_accuracy["measure"].isna() | (equal_accuracy["measure"] == "")]
    by = {row["cost"]: row for row in whole[whole["kind"] == CLASSICAL].to_dict("records")}
    if not {"seconds", "operations"} <= set(by):
        return
    seconds, operations = by["seconds"], by["operations"]
    values = {"problems": seconds["problems"], "scenes": seconds["scenes"], "both": seconds["both"]}
    values |= {"alone": seconds["exact_alone"], "ratio": seconds["ratio"], "ops": operations["ratio"]}
    values |= {cost: row["cheaper"] + row["alone"] for cost, row in by.items()} | {"clear": seconds["cheaper_both"]}
    text = (
        "To reach a given error no classical nonlinear measure is cheaper than `exact`"
        if values["clear"] == 0
        else "To reach a given error a classical nonlinear measure is cheaper than `exact` in {clear:.0f} comparisons"
    )
    text += (
        " by more than 5 % in seconds and in operations (in one of them: {seconds:.0f} and {operations:.0f} of "
        "{problems:.0f}; scenes: {scenes:.0f}): "
    )
    text += "in {alone:.0f} only `exact` gets there"
    if not math.isnan(seconds["ratio"]):
        text += (
            "; where both do ({both:.0f}), it takes {ratio:.2f} times the seconds and {ops:.2f} times the operations"
        )
    scope = "errors of 10 to 0.1 %, each measure at its cheapest mesh and algorithm; medians where both get there"
    yield Statement(
        "equal-error", "tradeoff", text + ".", values, int(seconds["problems"]), scope, OPENING, machine=True
    )


def contacts(contact_summary: pd.DataFrame) -> Iterator[Statement]:
    """Which contact algorithm solves most, and which is fastest where both solve."""
    rows = contact_summary.dropna(subset=["solved_share"])
    others = rows[(rows["algorithm"] != rows["default"]) & rows["seconds_ratio"].notna()]
    usual = rows[rows["algorithm"] == rows["default"]]
    if others.empty or usual.empty:
        return
    first, default = others.iloc[int(others["seconds_ratio"].argmin())], usual.iloc[0]
    values: dict[str, float | str] = {
        **{"default": f"`{default['algorithm']}`", "share": default["solved_share"]},
        **{"put": float(default["solved"] + default["failed"]), "name": f"`{first['algorithm']}`"},
        **{"ratio": first["seconds_ratio"], "low": first["seconds_low"], "high": first["seconds_high"]},
        **{"ops": first["operations_ratio"], "both": first["both"], "scenes": first["both_scenes"]},
        **{"own": first["solved_share"]},
    }
    text = (
        "{default} solves {share:.1%} of {put:.0f} contact problems; the fastest beside it, {name}, solves {own:.1%} "
        "of its own and takes {ratio:.2f} [{low:.2f}, {high:.2f}] times the seconds and {ops:.2f} times the operations "
        "on the {both:.0f} problems, of {scenes:.0f} scenes, that both solve."
    )
    scope = "medians, intervals of drawing scenes; most of these problems are small, large ones have other ratios"
    yield Statement("contact-trade", "tradeoff", text, values, int(first["both"]), scope, OPENING, machine=True)


MAKERS = (at_equal_error, contacts)
