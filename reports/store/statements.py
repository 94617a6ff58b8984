"""Sentences of conclusion as they stand in the store: computed there, filled in here, printed where they belong."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from reports.formats import Line
from reports.markdown import Part, machine, prose
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("statements")
TABLES = ("statements", "statement_values")
OPENING = "opening"


@dataclass(frozen=True)
class Said:
    """A statement with its numbers in it; ``values``: them, by name."""

    name: str
    page: str
    role: str
    text: str
    problems: int
    scope: str
    machine: bool
    values: Mapping[str, Any]

    @property
    def block(self) -> str:
        """The sentence as a paragraph, marked where it depends on the machine."""
        return machine(prose(self.text)) if self.machine else prose(self.text)


@lru_cache(maxsize=8)
def statements(store: Store) -> tuple[Said, ...]:
    """All of a campaign, in their order; none where it has not been analysed. Read once a store."""
    return tuple(_read(store))


def _read(store: Store) -> Iterator[Said]:
    if not all(map(store.has, TABLES)):
        return
    table, numbers = (store.table(name) for name in TABLES)
    numbers["word"] = numbers["word"].astype(object).where(numbers["word"].notna(), "")
    values: dict[str, dict[str, Any]] = {}
    for row in numbers.to_dict("records"):
        values.setdefault(row["statement"], {})[row["field"]] = row["word"] or row["number"]
    for row in table.to_dict("records"):
        own = values.get(row["statement"], {})
        text = Line({}).filled(row["text"], own) if own else row["text"]
        name, page, role, scope = (str(row[key]) for key in ("statement", "page", "role", "scope"))
        yield Said(name, page, role, text, int(row["problems"]), scope, bool(row["machine"]), own)


def of_page(store: Store, page: str, role: str = OPENING) -> str:
    """The statements of a page that have a role, each a paragraph."""
    return "\n\n".join(each.block for each in statements(store) if (each.page, each.role) == (page, role))


def conclusions(store: Store, page: str) -> Part:
    """All else that is concluded from a page, as the section that it ends with; nothing where there is nothing."""
    found = [each for each in statements(store) if each.page == page and each.role != OPENING]
    return TEXT("conclusions", **by_machine(found)) if found else Part()


def by_machine(found: Iterable[Said]) -> dict[str, list[Said]]:
    """Sentences that are the same on every machine, and those that are not."""
    known = list(found)
    return {name: [each for each in known if each.machine == timed] for name, timed in (("steady", 0), ("timed", 1))}
