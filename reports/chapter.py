"""A page of the report as one record: its file, its title, the question it answers, the tables it is made of.

One list of chapters (reports.contents) makes the index, the line of links of every page, the README's list and the
check of the tables. What is on a page is not known here, but for the sentences of conclusion: they were computed with
the tables and are filled in here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from posixpath import dirname, relpath
from typing import Any

from reports.files import StoreError
from reports.formats import Line
from reports.markdown import Part, Template, machine, prose
from reports.store import Store

ALL = "all"  # what a campaign says whose cells are those of all pages
INDEX, INDEX_TITLE = "index.md", "Results"
TEXT = Template("statements")
TABLES = ("statements", "statement_values")
OPENING = "opening"


@dataclass(frozen=True)
class Chapter:
    """One page; ``render`` is a function of the store, whose text begins with the heading of the page: its title.

    name: of the file, with its folder if it has one. needs: names of tables. always: a page of the whole report, where
    a missing table is an error; any other page is made for each campaign that has its tables. group: that it is listed
    in. under: the name of the page that lists it instead, as a catalogue lists its sheets.
    """

    name: str
    title: str
    question: str
    render: Callable[[Store], Part]
    needs: tuple[str, ...] = ()
    always: bool = False
    group: str = "More"
    under: str = ""

    @property
    def file(self) -> str:
        """Name of the page's file."""
        return f"{self.name}.md"

    def applies(self, store: Store) -> bool:
        """Is there such a page of this store? Raises StoreError when a table is missing that must be there."""
        if self.always and store.pages == ALL:
            try:
                for name in self.needs:
                    store.table(name)
            except StoreError as error:
                raise StoreError(f"{error}, which {self.file} needs") from None
            return True
        return not self.always and all(map(store.has, self.needs))


def chapter(
    text: Template, render: Callable[[Store], Part], needs: tuple[str, ...] = (), always: bool = False
) -> Chapter:
    """The chapter of a template: its title is the heading of the block ``page``, and one block is its question."""
    title = text.blocks["page"][0][0].removeprefix("# ")
    return Chapter(text.name, title, str(text("question")), render, needs, always)


def grouped(chapters: Iterable[Chapter]) -> dict[str, list[Chapter]]:
    """The chapters of each group, but for those that a page lists."""
    groups: dict[str, list[Chapter]] = {}
    for each in chapters:
        if not each.under:
            groups.setdefault(each.group, []).append(each)
    return groups


def link_line(chapters: Iterable[Chapter], page: str) -> str:
    """Links to all pages but this one, by group, on one line; from a page that another one lists, to that one first."""
    known = list(chapters)
    above = next((each.under for each in known if each.file == page), "")
    up = [f"up: {_linked(each.file, each.title, page)}" for each in known if above and each.name == above]
    lines = [" · ".join([_linked(INDEX, INDEX_TITLE, page), *up])]
    for group, pages in grouped(known).items():
        links = [_linked(each.file, each.title, page) for each in pages if each.file != page]
        lines += [f"**{group}:** {' · '.join(links)}"] if links else []
    return " — ".join(lines)


def _linked(file: str, title: str, page: str) -> str:
    return f"[{title}]({relative(file, page)})"


def relative(file: str, page: str) -> str:
    """The way from a page to a file, both named from the folder of the report."""
    return relpath(file, dirname(page) or ".")


def listed(chapters: Iterable[Chapter], folder: str = "") -> str:
    """A list item a page under its group: its link and its question."""
    return "\n\n".join(
        "\n".join([f"### {group}\n", *(f"- [{each.title}]({folder}{each.file}): {each.question}" for each in pages)])
        for group, pages in grouped(chapters).items()
    )


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


def of_page(store: Store, page: str) -> str:
    """The statements that a page opens with, each a paragraph."""
    return "\n\n".join(each.block for each in statements(store) if (each.page, each.role) == (page, OPENING))


def conclusions(store: Store, page: str) -> Part:
    """All else that is concluded from a page, as the section that it ends with; nothing where there is nothing."""
    sentences = [each for each in statements(store) if each.page == page and each.role != OPENING]
    return TEXT("conclusions", **by_machine(sentences)) if sentences else Part()


def by_machine(sentences: Iterable[Said]) -> dict[str, list[Said]]:
    """Sentences that are the same on every machine, and those that are not."""
    known = list(sentences)
    return {name: [each for each in known if each.machine == timed] for name, timed in (("steady", 0), ("timed", 1))}
