"""A page of the report as one record: its file, its title, the question it answers, the tables it is made of.

One list of chapters (reports.contents) makes the index, the line of links of every page, the README's list and the
check of the tables. What is on a page is not known here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from reports.markdown import Part
from reports.store.reading import StoreError
from reports.store.tables import Store

ALL = "all"  # what a campaign says whose cells are those of all pages
INDEX, INDEX_TITLE = "index.md", "All results"


@dataclass(frozen=True)
class Chapter:
    """One page; ``render`` is a function of the store, whose text begins with the heading of the page.

    needs: names of tables. always: a page of the whole report, where a missing table is an error; any other page is
    made for each campaign that has its tables.
    """

    name: str
    title: str
    question: str
    render: Callable[[Store], Part]
    needs: tuple[str, ...] = ()
    always: bool = False

    @property
    def file(self) -> str:
        """Name of the page's file."""
        return f"{self.name}.md"

    def applies(self, store: Store) -> bool:
        """Is there such a page of this store? Raises StoreError when a table is missing that must be there."""
        if self.always and store.pages == ALL:
            for name in self.needs:
                if not store.has_table(name):
                    raise StoreError(f"{store.path / 'tables' / name}.csv: missing, which {self.file} needs")
            return True
        return not self.always and all(map(store.has_analysis, self.needs))


def link_line(chapters: Iterable[Chapter], page: str) -> str:
    """Links to all pages but this one, on one line."""
    titles = {INDEX: INDEX_TITLE, **{each.file: each.title for each in chapters}}
    return " · ".join(f"[{title}]({name})" for name, title in titles.items() if name != page)


def listed(chapters: Iterable[Chapter], folder: str = "") -> str:
    """A list item a page: its link and its question."""
    return "\n".join(f"- [{each.title}]({folder}{each.file}): {each.question}" for each in chapters)
