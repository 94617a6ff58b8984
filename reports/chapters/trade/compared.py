"""Who costs what over whom: measures at equal error, contact algorithms where both solve, profiles and pairs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from reports.chapters.trade import figures_tradeoff
from reports.formats import NOTHING, code, fixed, interval, share
from reports.markdown import Part, commands, filled, folded, joined, listing, machine, picture, prose, table
from reports.store.tables import Store

COSTS = ("seconds", "operations")
OF_AXIS = {"contact": "Contact algorithms", "measure": "Measures", "newton": "Newton iterations", "element": "Elements"}


def measures_part(store: Store) -> Part:
    """What a measure costs to reach the same error."""
    data = store.analysis("equal_accuracy")
    text = prose("""## Measures at equal error

A problem is a scene and an error to reach: 10, 3, 1, 0.3 and 0.1 %, in the scenes in which all measures compete, on the
meshes and by the algorithms that all were given. Each measure reaches it at the cheapest of these, or does not: an
error below what its formulation is off by in the limit of its meshes does not count, there two errors have cancelled.
Ratios are over `exact`, medians over the problems that both reach, with the 95 % interval of drawing scenes; fewer than
five make none. *Cheaper*: by more than 5 %, or where `exact` does not get there at all.""")
    if data.empty:
        return joined(text, "No two measures compete here.")
    by = {(row["measure"], row["cost"]): row for row in data.to_dict("records")}
    rows = []
    for name in dict.fromkeys(data["measure"]):
        first = by[name, COSTS[0]] if (name, COSTS[0]) in by else by[name, COSTS[1]]
        named = [code(name), first["kind"]] if name else ["all of them", first["kind"]]
        put = f"{share(first['solved'], 0)} of {first['problems']}"
        both = f"{first['both']} ({first['both_scenes']})"
        ratios = [_ratio(by.get((name, cost))) for cost in COSTS]
        cheaper = ", ".join(_cheaper(by.get((name, cost))) for cost in COSTS)
        rows.append([*named, put, both, *ratios, f"{cheaper}, {first['cheaper_both']}"])
    heads = ["measure", "kind", "reaches", "both (scenes)", "seconds", "operations", "cheaper: s, ops, both"]
    shown = table("Cost over that of the exact measure, to reach the same error", heads, rows, words=2)
    return joined(text, machine(shown, *_cheaper_ones(store)))


def _ratio(row: Mapping[Any, Any] | None) -> str:
    if row is None or math.isnan(row["ratio"]):
        return NOTHING
    return f"{fixed(row['ratio'], 2)} {interval((row['low'], row['high']))}"


def _cheaper(row: Mapping[Any, Any] | None) -> str:
    return NOTHING if row is None else f"{row['cheaper'] + row['alone']}"


def _cheaper_ones(store: Store) -> list[str]:
    """Where another measure is cheaper than the exact one."""
    data = store.analysis("cheaper_measures")
    if data.empty:
        return ["No measure is cheaper than `exact` for any of them."]
    heads = "cost | measure | kind | scene | error | spent | exact spends | ratio"
    line = "{cost} | `{measure}` | {kind} | `{scene}` | {tolerance:.1%} | {spent:.2e} | {exact_spent:.2e} | {ratio:.2f}"
    data = data.assign(exact_spent=data["exact_spent"].where(data["exact_spent"] < math.inf))
    listed = listing("Where another measure is cheaper", data, heads, line, words=4)
    return [folded("Where another measure is cheaper than the exact one", listed), commands(data["command"])]


def contacts_part(store: Store) -> Part:
    """What each contact algorithm solves, and costs over the default one."""
    data = store.analysis("contact_summary")
    if data.empty:
        return Part("## Contact algorithms\n\nNo problem was put to two of them.")
    text = prose(f"""## Contact algorithms

Of the problems that each could solve (not refused, no end of the path before the load) the share that it solves, and
where it fails most. Ratios are over `{data["default"].iloc[0]}`, medians over the problems that both solve, with the
95 % interval of drawing scenes: the problems of one scene are alike. Fewer than five make no ratio. Most of
these problems are small: over the size of the problem the ratios change.""")
    rows = [
        [
            *(
                code(row["algorithm"]),
                row["problems"],
                f"{share(row['solved_share'], 1)} of {row['put']}",
                row["refused"],
            ),
            f"{code(row['worst_scene'])} {row['worst_failed']}/{row['worst_put']}" if row["worst_scene"] else NOTHING,
            f"{row['both']} ({row['both_scenes']})",
            *(_ratio({end: row[f"{cost}_{end}"] for end in ("ratio", "low", "high")}) for cost in COSTS),
        ]
        for row in data.assign(put=data["solved"] + data["failed"]).to_dict("records")
    ]
    heads = ["algorithm", "put", "solves", "refused", "fails most", "both (scenes)", "seconds", "operations"]
    shown = table("Solved, and the cost over the default where both solve", heads, rows)
    refused = data[data["refusals"] != ""].sort_values("algorithm")  # in one order, whatever the machine
    refusals = filled("- `{algorithm}` refuses: {refusals}", refused)
    return joined(text, machine(shown), "\n".join(refusals))


def profiles_part(store: Store) -> Part:
    """Profiles, the check of the ranking, and each two alone."""
    data, pairs, flips = (store.analysis(name) for name in ("profiles", "pairs", "flips"))
    if flips.empty:
        return Part("## Each against each\n\nNo axis of this campaign has two competitors.")
    lines = [_ranking(str(axis), own) for axis, own in flips[flips["cost"] == COSTS[0]].groupby("axis", sort=False)]
    text = prose("""## Each against each

The profile is the share of problems within a factor of the best: it ends at the share that is solved, and depends on
the whole field. So each two are compared alone, too, on the problems that both solve, and the ranking (by the share
within twice the best) is repeated without each competitor. No ranking is made of fewer than five problems.""")
    words = "Share of problems within a factor of the best, ending at the share that is solved"
    drawn = [picture("tradeoff-profiles.svg", words, figures_tradeoff.profiles(data, COSTS))] if len(data) else []
    matrices = [_matrix(str(axis), own) for axis, own in pairs.groupby("axis", sort=False)]
    listed = "\n\n".join(_pairs(pairs, cost) for cost in COSTS)
    told = "Each two with intervals, the share that each solves, and how often each is cheaper"
    return joined(text, machine("\n".join(lines)), *drawn, machine(*matrices, folded(told, listed)))


def _ranking(axis: str, checked: pd.DataFrame) -> str:
    whole = checked[checked["removed"] == ""].iloc[0]
    if not whole["ranking"]:
        return f"- {axis}: not ranked: problems in common: {whole['problems']}."
    found = "; ".join(filled("without `{removed}`: {flips}", checked[checked["flips"] != ""]))
    verdict = f"not stable, {found} change places" if found else "the same without any one of them"
    return f"- {axis}, {whole['problems']} problems: {whole['ranking']}; {verdict}."


def _matrix(axis: str, pairs: pd.DataFrame) -> str:
    """Cost of the row over that of the column: seconds above the diagonal, operations below."""
    names = list(dict.fromkeys([*pairs["a"], *pairs["b"]]))
    by = {(row["cost"], row["a"], row["b"]): row for row in pairs.to_dict("records")}
    if not pairs["ratio"].notna().any():
        return f"{OF_AXIS.get(axis, axis)}: no two have five problems in common that both solve."

    def entry(i: int, j: int) -> str:
        if i == j:
            return ""
        row = by.get((COSTS[0] if i < j else COSTS[1], names[min(i, j)], names[max(i, j)]))
        if row is None or math.isnan(row["ratio"]):
            return NOTHING
        return f"{fixed(row['ratio'] if i > j else 1 / row['ratio'], 2)} ({row['both']})"

    rows = [[code(name), *(entry(i, j) for j in range(len(names)))] for i, name in enumerate(names)]
    title = f"{OF_AXIS.get(axis, axis)}: row over column (both solve), seconds above the diagonal, operations below"
    return table(title, ["", *map(code, names)], rows)


def _pairs(pairs: pd.DataFrame, cost: str) -> str:
    """The pairs with enough problems in common."""
    own = pairs[(pairs["cost"] == cost) & pairs["ratio"].notna()]
    heads = "axis | a | b | a solves | b solves | both (scenes) | a cheaper, tie, b cheaper | b over a [95 %] | largest"
    line = "{axis} | `{a}` | `{b}` | {a_solved:.0%} of {problems} | {b_solved:.0%} | {both} ({scenes}) | "
    line += "{a_better}, {ties}, {b_better} | {ratio:.2f} [{ratio_low:.2f}, {ratio_high:.2f}] | {ratio_largest:.2f}"
    if own.empty:
        return f"No pair has enough problems in common ({cost})."
    return listing(f"Pairs, {cost}", own, heads, line, words=3)
