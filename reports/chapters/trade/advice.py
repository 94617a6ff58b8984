"""The part of advice from stored campaigns: what it is worth on a scene that it does not know."""

from __future__ import annotations

from reports.chapters.trade import figures_advice
from reports.formats import fixed, share
from reports.markdown import Part, joined, listing, machine, picture, prose
from reports.store.tables import Store

MISSED = (
    "scene | quantity | tolerance | true error | estimate | advised",
    "`{scene}` | `{quantity}` | {tolerance:.2%} | {true_error:.2%} | {estimate:.2%} | `{advised}`",
)


def advice_part(store: Store) -> Part:
    """Scenes that were left out, one after the other; nothing where a campaign has too few."""
    if not (store.has_analysis("held_out") and store.has_analysis("held_out_summary")):
        return Part("")
    cases, summary = store.analysis("held_out"), store.analysis("held_out_summary")
    headline = summary[summary["quantities"] == "headline"].to_dict("records")[0]
    text = prose("""## What advice from stored campaigns is worth

`footprint advise SCENE --error 1%` answers at once from the tables of a campaign. To see what that is worth each scene
is left out once: the adviser sees its values but no reference, and no mesh finer than the one it stops at. It estimates
the error and multiplies it by a factor of safety learnt from the other scenes. *Regret*: the seconds of its advice over
those of the cheapest cell that truly meets the tolerance. For a problem of your own `footprint choose` is surer, and
takes a minute.""")
    told = prose(f"""For the headline quantities, {headline["cases"]} cases of {headline["scenes"]} scenes, the
tolerance is met in {share(headline["met"], 1)} of the {headline["advised"]} that were advised. The regret is
{fixed(headline["median_regret"], 2)} in the median, {fixed(headline["mean_regret"], 2)} in the mean and
{fixed(headline["worst_regret"], 1)} at worst; {share(headline["share_above"], 0)} of the cases are above
{headline["dear"]:g}. In {headline["abstained"]} cases it gave no advice though some cell would have met the
tolerance.""")
    failed = cases[(cases["advised"] != "") & (cases["met"] == 0.0)]
    parts = [
        told,
        *([listing("Where the tolerance was missed, all quantities", failed, *MISSED, words=2)] if len(failed) else []),
    ]
    words = "True error over tolerance, and regret, of advice on scenes left out"
    return joined(text, picture("advice-held-out.svg", words, figures_advice.held_out(cases)), machine(*parts))
