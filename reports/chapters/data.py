"""The page of claims; and the appendix: outcomes, questions, findings, words, every cell and answer as files."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from reports.chapter import ALL, chapter, statements
from reports.markdown import Part, Template, commands, joined
from reports.origin import machines, origin, outcomes_part
from reports.store import Store

CLAIMED = Template("claims")
CLAIMS = "claims"
STATUSES = ("confirmed", "qualified", "refuted", "untested")
ORDER = ("refuted", "qualified", "confirmed", "untested")


def claims_page(store: Store) -> Part:
    """The whole page: counts, a table a subject, how to read a status."""
    claims = store.table(CLAIMS)
    counts = claims["status"].value_counts()
    counted = ", ".join(f"{counts.get(status, 0)} {status}" for status in STATUSES)
    subjects = joined(*(_subject(str(name), own) for name, own in claims.groupby("subject", sort=False)))
    return CLAIMED("page", count=len(claims), told=counted, subjects=subjects)


def _subject(name: str, own: pd.DataFrame) -> Part:
    """Tables of a subject, refuted ones first; those of times apart, as another machine has others."""
    ordered = own.assign(rank=own["status"].map(ORDER.index)).sort_values("rank", kind="stable")
    timed = ordered["machine"].astype(bool)
    shown = commands(ordered["command"].dropna().loc[lambda each: each != ""])
    name = f"{name[0].upper()}{name[1:]}"
    return CLAIMED("subject", name=name, steady=ordered[~timed], timed=ordered[timed], commands=shown)


LEDGER = chapter(CLAIMED, claims_page, needs=(CLAIMS,), always=True)


DATA = "data"
TEXT = Template(DATA)
FILES = {  # beside the pages, of tables by these names; those of many rows are compressed when they are written
    "cells.csv.gz": ("data_cells", "a row a cell of the plan, whatever became of it"),
    "answers.csv.gz": ("data_answers", "a row a quantity of a cell"),
    "columns.csv": ("data_columns", "a row a column of the other two: its unit and what it is"),
    "claims.csv": ("claims", "a row a claim: status, interval, command"),
}
NEEDED = ("data_cells", "data_answers", "data_columns")
AS_ASKED = ("converged", "unstable", "unsupported")
GITHUB = "https://github.com"


def data_files(store: Store) -> dict[str, str]:
    """The tables to be taken away as CSV, by file name."""
    return {
        f"{DATA}/{name}": store.table(table).drop(columns="campaign").to_csv(index=False, float_format="%.10g")
        for name, table, _ in _files(store)
    }


def appendix(store: Store) -> Part:
    """The whole page."""
    failed = [each for each in store.planned if each.ended not in AS_ASKED]
    files = [{"name": name, "rows": len(store.table(table)), "words": words} for name, table, words in _files(store)]
    cells, answers, *_ = (each["rows"] for each in files)
    parts = {"outcomes": outcomes_part(store), "questions": _questions(store), "findings": _findings(store)}
    made = {"origin": origin(store), "machines": machines(store)}
    return TEXT("page", **parts, cells=cells, answers=answers, files=files, count=len(failed), failed=failed, **made)


def _files(store: Store) -> Iterator[tuple[str, str, str]]:
    """Names, tables and what they are; a part of the report has too few tables to judge claims."""
    for name, (table, words) in FILES.items():
        if table in NEEDED or (store.pages == ALL and store.has(table)):
            yield name, table, words


def _questions(store: Store) -> Part:
    """What users of other solvers ask in public: threads, the sentences that answer by their place, what is missing."""
    if not store.has("asks"):
        return Part()
    pages, asks = {each.name: each.page for each in statements(store)}, store.table("asks")
    rows = asks.astype(object).fillna("").to_dict("records")
    for row in rows:
        places = dict.fromkeys(pages[name] for name in row["answers"].split(", ") if name in pages)
        row["where"] = ", ".join(f"[{page}]({page}.md)" for page in places)
        row["threads"] = ", ".join(map(_thread, row["threads"].split(", ")))
    return TEXT("questions", answered=int(asks["answered"].sum()), count=len(asks), rows=rows)


def _thread(name: str) -> str:
    """A link to a thread by repository and number; words that are none stay words."""
    repository, _, number = name.partition("#")
    return f"[{name}]({GITHUB}/{repository}/issues/{number})" if number.isdigit() else name


def _findings(store: Store) -> Part:
    """Every sentence of conclusion with what it rests on; those that depend on the machine come last."""
    sentences = statements(store)
    steady, timed = ([each for each in sentences if each.machine == kind] for kind in (False, True))
    return TEXT("findings", count=len(sentences), steady=steady, timed=timed) if sentences else Part()


CHAPTER = chapter(TEXT, appendix, needs=NEEDED)
