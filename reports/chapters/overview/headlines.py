"""Page one in short: what is compared, who wins when, with intervals, and what can be trusted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import pandas as pd
from scipy.stats import binomtest

from reports.chapters.overview.outcomes import completeness_line
from reports.markdown import fixed, percent, prose
from reports.tables import Store

COST = "flops"  # the same on every machine
DEFAULT = "semismooth"  # the contact algorithm that the others are held against
CONFIDENCE = 0.95
NEEDED = ("attribution", "pairs", "held_out_summary", "verified")


def headlines(store: Store) -> str:
    """The three questions of a newcomer; who wins is told when the campaign has been analysed."""
    cells = store.cells.values()
    compared = prose(f"""**What is compared?** Strain measures ({_list(c.result["measure"] for c in cells)}), contact
algorithms ({_list(c.result["contact"] for c in cells)}) and Newton iterations
({_list(c.result["newton"] for c in cells)}) on one and the same shell element, over {len({c.scene for c in cells})}
scenes. Every sentence with a number in it is computed from the stored results.""")
    parts = [compared]
    if all(map(store.has_analysis, NEEDED)):
        found = (_axes(store.analysis("attribution")), _algorithms(store.analysis("pairs")), _advice(store))
        told = "\n".join(f"{i}. {text}" for i, text in enumerate(found, start=1))
        parts.append(f"**Who wins, and when?** Brackets are 95 % intervals.\n\n{told}")
    return "\n\n".join([*parts, _trust(store)])


def _list(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in dict.fromkeys(names))


def _axes(data: pd.DataFrame) -> str:
    """What explains the error where shells touch and where they do not."""
    own = data[(data["response"] == "error") & (data["scope"] == "family") & ~data["factor"].isin(_LEFT)]
    said = []
    for family, each in own.groupby("name", sort=False):
        first = each.sort_values("share", ascending=False, kind="stable").iloc[0]
        said.append(f"{family}: the {first['factor']} {_interval(first)}")
    return prose(f"""**Look at the axis that matters.** Share of the variance of the (log) error explained by the first
axis of each family of scenes: {"; ".join(said) or "not enough cells"}. [More](tradeoff.md#which-axis-explains-it)""")


_LEFT = ("interactions", "rest")


def _algorithms(data: pd.DataFrame) -> str:
    """What each contact algorithm costs over the default one, on the problems that both solve."""
    own = data[(data["axis"] == "contact") & (data["cost"] == COST)]
    said = [_pair(row["b"], row, 1.0) for row in own[own["a"] == DEFAULT].to_dict("records")]
    said += [_pair(row["a"], row, -1.0) for row in own[own["b"] == DEFAULT].to_dict("records")]
    return prose(f"""**Contact algorithms.** Operations in factorisations over those of `{DEFAULT}`, medians over the
problems that were put to all: {"; ".join(said) or "none in common"}. Pivots of `lcp` and iterations inside `qp` come on
top. [More](tradeoff.md#who-wins-how-often)""")


def _pair(name: str, row: dict, power: float) -> str:
    ratio, *ends = (row[key] ** power for key in ("ratio", "ratio_low", "ratio_high"))
    return f"`{name}` {fixed(ratio, 2)} [{fixed(min(ends), 2)}, {fixed(max(ends), 2)}] ({row['problems']})"


def _advice(store: Store) -> str:
    """What advice is worth on scenes that it has not seen."""
    summary = store.analysis("held_out_summary")
    own = summary[summary["quantities"] == "headline"].iloc[0]
    met, n = float(own["met"]), int(own["advised"])
    low, high = binomtest(round(met * n), n).proportion_ci(CONFIDENCE, method="wilson")
    return prose(f"""**Which configuration is enough?** `footprint advise` says it. On scenes left out of what it learnt
from, its advice meets the tolerance in {percent(met, 0, sign=False)} [{percent(low, 0, sign=False)},
{percent(high, 0, sign=False)}] of {n} cases and costs {fixed(own["median_regret"], 2)} times the best in the median.
[More](advice.md)""")


def _interval(row: pd.Series) -> str:
    return f"{100 * row['share']:.0f} % [{100 * row['low']:.0f}, {100 * row['high']:.0f}]"


def _trust(store: Store) -> str:
    counts = Counter(each.ended for each in store.planned)
    judged = counts["converged"] + counts["wrong"]
    text = f"""**What can I trust?** {completeness_line(store)}. A judge that trusts no algorithm recomputes the
residuals and balances of every answer: of {judged} that claim convergence it refuses {counts["wrong"]}."""
    if store.has_analysis("verified"):
        verified = store.analysis("verified")
        own = verified.drop_duplicates("label")
        against = int(own["against"].str.startswith("reference").sum())
        text += f""" {against} cells have a printed, exact or independently computed reference; the others are held
against the limit of their own meshes."""
    return prose(f"{text} What is not covered: [known limitations](#known-limitations).")
