"""The page of claims: sentences that are repeated in print, and what this campaign says of each."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from reports.chapter import Chapter
from reports.formats import NOTHING
from reports.markdown import Part, commands, joined, machine, prose, table
from reports.store.tables import Store

CLAIMS = "claims"
STATUSES = ("confirmed", "qualified", "refuted", "untested")
ORDER = ("refuted", "qualified", "confirmed", "untested")
HEADS = ["status", "claim", "source", "tested on", "measured", "problems"]


def claims_page(store: Store) -> Part:
    """The whole page: counts, a table a subject, how to read a status."""
    found = store.analysis(CLAIMS)
    counts = found["status"].value_counts()
    said = ", ".join(f"{counts.get(status, 0)} {status}" for status in STATUSES)
    text = prose(f"""# Claims

{len(found)} sentences that papers, manuals and users repeat, some of them once our own: {said}.

A status rests on an interval: of one number with its uncertainty, or of one number over many problems. Inside the band
that the claim allows it is *confirmed*, outside *refuted*, across its edge *qualified*. A tendency is confirmed where
it is true of all problems and refuted where of fewer than half; a law without exception falls with its first one.
*Untested*: the campaign has no such table, or the suite no such case. All with their intervals are in
[data/claims.csv](data/claims.csv).""")
    return joined(text, *(part for _, own in found.groupby("subject", sort=False) for part in _subject(own)))


def _subject(own: pd.DataFrame) -> Iterator[Part | str]:
    """Tables of a subject, refuted ones first; those of times apart, as another machine has others."""
    ordered = own.assign(rank=own["status"].map(ORDER.index)).sort_values("rank", kind="stable")
    name = str(own["subject"].iloc[0])
    yield f"## {name[0].upper()}{name[1:]}"
    timed = ordered["machine"].astype(bool)
    if not timed.all():
        yield table("Claims", HEADS, map(_row, ordered[~timed].to_dict("records")), words=5)
    if timed.any():
        yield machine(
            table("Claims of times and of rounding", HEADS, map(_row, ordered[timed].to_dict("records")), words=5)
        )
    yield commands(ordered["command"].dropna().loc[lambda each: each != ""])


def _row(row: dict) -> list[object]:
    measured = row["measured"] if isinstance(row["measured"], str) and row["measured"] else NOTHING
    return [row["status"], row["sentence"], row["source"], row["regime"], measured, row["problems"] or NOTHING]


CHAPTER = Chapter(
    "claims",
    "Claims",
    "sentences of papers and manuals, each confirmed, qualified or refuted, with the interval that decides.",
    claims_page,
    needs=(CLAIMS,),
    always=True,
)
