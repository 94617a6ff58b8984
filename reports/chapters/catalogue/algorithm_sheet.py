"""The sheet of a contact algorithm: what it solves, its parameters, what it solved, refused and cost, its limits."""

from __future__ import annotations

import pandas as pd

from reports.chapters.catalogue.words import Catalogue, Sheet, about
from reports.formats import fixed, said, share
from reports.markdown import Part, joined, listing, machine, prose
from reports.store.tables import Store

OUTCOME_HEADS = "scene | put to it | solved | path ends | failed | refused | cause"
OUTCOME_LINE = (
    "{scene:code} | {planned:.0f} | {solved:.0f} | {path_ends:.0f} | {failed:.0f} | {refused:.0f} | {cause:said}"
)
LIMIT_HEADS = "limit | last certified | error there | fails at | kind | reason"
LIMIT_LINE = "{limit} | {value:.3g} | {error:.2e} | {fails:.3g} | {kind:said} | {reason:said}"


def algorithm_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    summary = _summary(catalogue.store, sheet.part)
    return joined(
        prose(f"# {sheet.title}\n\n{sheet.meaning} {_first(summary)}"),
        about(sheet.about),
        catalogue.settings("algorithm", sheet.part),
        _cost(summary),
        _outcomes(catalogue.store, sheet.part),
        _limits(catalogue.store, sheet.part),
        f"## Source\n\n{sheet.source} In `{sheet.module}`." if sheet.source else "",
    )


def _summary(store: Store, name: str) -> pd.Series | None:
    own = store.rows("contact_summary", algorithm=name)
    return None if own.empty else own.iloc[0]


def _first(summary: pd.Series | None) -> str:
    """What it has solved, in one sentence."""
    if summary is None:
        return ""
    could = summary["solved"] + summary["failed"]
    return (
        f"It solves {summary['solved']:.0f} of the {could:.0f} problems that it was put to and that have an answer, "
        f"{share(summary['solved_share'], 0)}; {summary['refused']:.0f} more it refuses."
    )


def _cost(summary: pd.Series | None) -> Part | str:
    if summary is None:
        return ""
    base = summary["default"]
    ratios = [_ratio(summary, cost) for cost in ("seconds", "operations")]
    on = f"medians on the {summary['both']:.0f} problems of {summary['both_scenes']:.0f} scenes that both solve"
    text = f"""## Cost

Over `{base}`: {" and ".join(ratios)}, {on}; the intervals are those of drawing scenes."""
    causes = said("" if pd.isna(summary["causes"]) else str(summary["causes"]))
    refusals = said("" if pd.isna(summary["refusals"]) else str(summary["refusals"]))
    return machine(prose(f"{text}\n\nFailures: {causes}. Refusals: {refusals}."))


def _ratio(summary: pd.Series, cost: str) -> str:
    middle, low, high = (fixed(summary[f"{cost}_{end}"]) for end in ("ratio", "low", "high"))
    return f"{middle} [{low}, {high}] of its {cost}"


def _outcomes(store: Store, name: str) -> str:
    own = store.rows("outcomes", axis="contact", name=name)
    if own.empty:
        return ""
    own = own[own["scene"].fillna("") != ""]
    shown = listing("Outcomes by scene", own.assign(cause=own["cause"].fillna("")), OUTCOME_HEADS, OUTCOME_LINE)
    return f"## What it solves and refuses\n\n{shown}"


def _limits(store: Store, name: str) -> str:
    own = store.rows("extremes_limits", part="algorithm", name=name)
    if own.empty:
        return ""
    own = own.assign(kind=own["kind"].fillna(""), reason=[_short(each) for each in own["reason"].fillna("")])
    told = "The last value of a setting on its way to an extreme at which a solve is certified; see *Extremes*."
    return f"## Limits\n\n{told}\n\n{machine(listing('Limits', own, LIMIT_HEADS, LIMIT_LINE))}"


def _short(reason: str) -> str:
    """Its first clause, within a table."""
    return reason.partition(";")[0].replace("|", "/")[:120]
