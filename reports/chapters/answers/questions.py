"""The part of questions: what users of other solvers ask in public, and where the answer stands."""

from __future__ import annotations

from reports.markdown import Part, joined, listing, prose
from reports.store.statements import statements
from reports.store.tables import Store

GITHUB = "https://github.com"


def questions_part(store: Store) -> Part:
    """A row a question: its threads, the sentences that answer it by their place, the command, what is missing."""
    if not store.has_analysis("asks"):
        return Part("")
    pages, asks = {each.name: each.page for each in statements(store)}, store.analysis("asks")
    rows = []
    for row in asks.astype(object).fillna("").to_dict("records"):
        places = dict.fromkeys(pages[name] for name in _names(row["answers"]) if name in pages)
        answers = ", ".join(f"[{page}]({page}.md)" for page in places)
        threads = ", ".join(map(_thread, row["threads"].split(", ")))
        rows.append({**row, "where": answers or "–", "threads": threads, "missing": row["missing"] or "–"})
    text = prose(f"""## What users ask

{int(asks["answered"].sum())} of {len(asks)} questions that users of other solvers ask in public are answered by
sentences that are computed from this campaign.""")
    heads, line = "question | asked in | answered on | missing", "{question} | {threads} | {where} | {missing}"
    return joined(text, listing("Questions", rows, heads, line, words=4))


def _names(answers: str) -> list[str]:
    return answers.split(", ") if answers else []


def _thread(name: str) -> str:
    """A link to a thread by repository and number; words that are none stay words."""
    repository, _, number = name.partition("#")
    return f"[{name}]({GITHUB}/{repository}/issues/{number})" if number.isdigit() else name
