"""The page of claims: sentences that are repeated in print, and what this campaign says of each."""

from __future__ import annotations

import pandas as pd

from reports.chapter import chapter
from reports.markdown import Part, Template, commands, joined
from reports.store import Store

TEXT = Template("claims")
CLAIMS = "claims"
STATUSES = ("confirmed", "qualified", "refuted", "untested")
ORDER = ("refuted", "qualified", "confirmed", "untested")


def claims_page(store: Store) -> Part:
    """The whole page: counts, a table a subject, how to read a status."""
    claims = store.table(CLAIMS)
    counts = claims["status"].value_counts()
    counted = ", ".join(f"{counts.get(status, 0)} {status}" for status in STATUSES)
    subjects = joined(*(_subject(str(name), own) for name, own in claims.groupby("subject", sort=False)))
    return TEXT("page", count=len(claims), told=counted, subjects=subjects)


def _subject(name: str, own: pd.DataFrame) -> Part:
    """Tables of a subject, refuted ones first; those of times apart, as another machine has others."""
    ordered = own.assign(rank=own["status"].map(ORDER.index)).sort_values("rank", kind="stable")
    timed = ordered["machine"].astype(bool)
    shown = commands(ordered["command"].dropna().loc[lambda each: each != ""])
    name = f"{name[0].upper()}{name[1:]}"
    return TEXT("subject", name=name, steady=ordered[~timed], timed=ordered[timed], commands=shown)


CHAPTER = chapter(TEXT, claims_page, needs=(CLAIMS,), always=True)
