"""The page of all findings: every sentence of conclusion with what it rests on and what it holds for."""

from __future__ import annotations

from reports.chapter import Chapter
from reports.markdown import Part, joined, machine, prose
from reports.store.statements import TABLES, statements
from reports.store.tables import Store


def findings_page(store: Store) -> Part:
    """The whole page."""
    found = statements(store)
    text = prose(f"""# All findings

{len(found)} sentences of conclusion are made of the tables of this campaign; pages print them from one place, so that a
number is the same wherever it stands. *Problems*: how many solved problems, or cases, a sentence rests on. *Holds for*:
its scope; outside of it nothing is said.""")
    parts = []
    for timed in (False, True):
        own = [each for each in found if each.machine == timed]
        if own:
            title = "Findings that depend on the machine" if timed else "Findings"
            lines = (
                f"- {each.text} *Rests on {each.problems}; holds for {each.scope}.* [{each.page}]({each.page}.md)"
                for each in own
            )
            made = "\n".join([f"## {title}", "", *lines])
            parts.append(machine(made) if timed else made)
    return joined(text, *parts)


CHAPTER = Chapter(
    "findings",
    "All findings",
    "every sentence of conclusion, with how many problems it rests on and what it holds for.",
    findings_page,
    needs=TABLES,
)
