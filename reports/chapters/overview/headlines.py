"""Page one in short: what is compared, what it solves and costs, with intervals, and what can be trusted."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable

import pandas as pd
from scipy.stats import binomtest

from reports.chapters.trade.tradeoff import explained
from reports.formats import fixed, interval, share
from reports.markdown import filled, machine, prose
from reports.origin import completeness_line
from reports.store.tables import Store

COST = "seconds"  # of processor time
DEFAULT = "semismooth"  # the contact algorithm that the others are held against
CONFIDENCE = 0.95
LEFT = ("interactions", "rest")  # what is no axis
NEEDED = ("attribution", "pairs", "solved", "held_out_summary", "verified")


def headlines(store: Store) -> str:
    """The three questions of a newcomer; shares and costs once the campaign has been analysed."""
    cells = store.cells
    compared = prose(f"""**What is compared?** Strain measures ({_list(c.result["measure"] for c in cells)}), contact
algorithms ({_list(c.result["contact"] for c in cells)}) and Newton iterations
({_list(c.result["newton"] for c in cells)}) on one and the same shell element, over {len({c.scene for c in cells})}
scenes. Every sentence with a number in it is computed from the stored results.""")
    parts = [compared]
    if all(map(store.has_analysis, NEEDED)):
        parts += [_algorithms(store), machine(_advice(store)), _axes(store.analysis("attribution"))]
    return "\n\n".join([*parts, _trust(store)])


def _list(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in dict.fromkeys(names))


def _axes(data: pd.DataFrame) -> str:
    """What explains the error where shells touch and where they do not."""
    own = data[(data["response"] == "error") & (data["scope"] == "family") & ~data["factor"].isin(LEFT)]
    said = []
    for family, each in own.groupby("name", sort=False):
        first = each.sort_values("share", ascending=False, kind="stable").iloc[0]
        said.append(f"{family}: the {first['factor']} {explained(first)}")
    return prose(f"""**Look at the axis that matters.** Share of the variance of the (log) error explained by the first
axis of each family of scenes: {"; ".join(said) or "not enough cells"}. [More](tradeoff.md#which-axis-explains-it)""")


def _algorithms(store: Store) -> str:
    """What each contact algorithm solves, and what it costs over the default one on the problems that both solve."""
    solved = store.analysis("solved")
    own = solved[(solved["axis"] == "contact") & (solved["scene"] == "")].sort_values("solved", ascending=False)
    if own.empty:
        return "**Contact algorithms.** No problem was put to two of them."
    shares = [_share(row, solved) for row in own.to_dict("records")]
    told = prose(f"""**Contact algorithms: solved.** Of the problems put to at least two of them, but for those
whose path ends before the load: {"; ".join(shares)}.
[Which failed where](tradeoff.md#solved-and-failed)""")
    pairs = store.analysis("pairs")
    pairs = pairs[(pairs["axis"] == "contact") & (pairs["cost"] == COST)]
    over = [(row["b"], row, 1) for row in pairs[pairs["a"] == DEFAULT].to_dict("records")]
    over += [(row["a"], row, -1) for row in pairs[pairs["b"] == DEFAULT].to_dict("records")]
    few = [f"`{name}` not ranked: {row['both']} problems" for name, row, _ in over if math.isnan(row["ratio"])]
    ranked = sorted((each for each in over if not math.isnan(each[1]["ratio"])), key=lambda e: -(e[1]["ratio"] ** e[2]))
    solves = {row["competitor"]: _solved(row) for row in own.to_dict("records")}
    said = [_pair(name, row, power, solves.get(name, "")) for name, row, power in ranked] + few
    cost = prose(f"""**Contact algorithms: cost.** Processor time over that of `{DEFAULT}`, the most expensive
first; medians over the problems that both solve, the 95 % interval of drawing scenes, and, because most problems are
small, the median of the five largest: {"; ".join(said) or "none in common"}.
[More](tradeoff.md#compared-in-cost)""")
    return f"{told}\n\n{machine(cost)}"


def _solved(row: dict) -> str:
    left = row["asked"] - row["path_ends"]
    return share(row["solved"] / left, 0 if row["solved"] == left else 1) if left else "none"


def _share(row: dict, solved: pd.DataFrame) -> str:
    """The share of an algorithm, and the scenes in which it has failed."""
    own = (solved["competitor"] == row["competitor"]) & (solved["scene"] != "") & (solved["axis"] == row["axis"])
    left = solved["asked"] - solved["path_ends"]
    lost = solved[own].assign(failed=left - solved["solved"], left=left)
    lost = lost[lost["failed"] > 0].sort_values("failed", ascending=False, kind="stable")
    where = ", ".join(filled("{failed} of {left} in {scene}", lost))
    told = f"`{row['competitor']}` {_solved(row)} of {row['asked'] - row['path_ends']}"
    return told + (f" (failed: {where})" if where else "")


def _pair(name: str, row: dict, power: int, solves: str) -> str:
    ratio, largest, *ends = (row[f"ratio{of}"] ** power for of in ("", "_largest", "_low", "_high"))
    both = f"both solve {row['both']}, of {row['scenes']} scenes; solves {solves}"
    return f"`{name}` {fixed(ratio, 2)} {interval(sorted(ends))}, {fixed(largest, 2)} ({both})"


def _advice(store: Store) -> str:
    """What advice is worth on scenes that it has not seen."""
    summary = store.analysis("held_out_summary")
    own = summary[summary["quantities"] == "headline"].iloc[0]
    met, n = float(own["met"]), int(own["advised"])
    low, high = binomtest(round(met * n), n).proportion_ci(CONFIDENCE, method="wilson")
    return prose(f"""**Which configuration is enough?** `footprint advise` says it. On scenes left out of what it learnt
from, its advice meets the tolerance in {share(met, 0)} [{share(low, 0)},
{share(high, 0)}] of {n} cases and costs {fixed(own["median_regret"], 2)} times the best in the median,
{fixed(own["mean_regret"], 2)} in the mean.
[More](advice.md)""")


def _trust(store: Store) -> str:
    counts = Counter(each.ended for each in store.planned)
    judged = counts["converged"] + counts["unstable"] + counts["wrong"]
    text = f"""**What can I trust?** {completeness_line(store)}. A judge that trusts no algorithm recomputes the
residuals and balances of every answer: of {judged} that claim convergence it refuses {counts["wrong"]}."""
    if store.has_analysis("verified"):
        verified = store.analysis("verified")
        own = verified.drop_duplicates("label")
        against = int(own["against"].str.startswith("reference").sum())
        text += f""" {against} cells have a printed, exact or independently computed reference; the others are held
against the limit of their own meshes."""
    return prose(f"{text} What is not covered: [known limitations](#known-limitations).")
