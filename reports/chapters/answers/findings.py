"""The part of findings: every sentence of conclusion with what it rests on and what it is true of."""

from __future__ import annotations

from reports.markdown import Part, joined, machine, prose
from reports.store.statements import Said, statements
from reports.store.tables import Store


def findings_part(store: Store) -> Part:
    """The whole part; those that depend on the machine come last."""
    found = statements(store)
    if not found:
        return Part("")
    text = prose(f"""## Findings

{len(found)} sentences of conclusion, computed from the tables of this campaign; pages print them from one place. Behind
each: the number of solved problems, or cases, that it rests on, and its scope.""")
    steady, timed = ([_line(each) for each in found if each.machine == kind] for kind in (False, True))
    return joined(text, "\n".join(steady), machine("\n".join(timed)) if timed else "")


def _line(each: Said) -> str:
    return f"- {each.text} *{each.problems}; {each.scope}.* [{each.page}]({each.page}.md)"
