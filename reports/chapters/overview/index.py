"""The first page: a picture, the answers, the other pages, and what the numbers do not cover."""

from __future__ import annotations

from reports.chapter import INDEX_TITLE
from reports.chapters.answers.sections import answers, limitations
from reports.chapters.catalogue.scene_sheet import filmstrip_of
from reports.chapters.catalogue.words import NEEDS, Catalogue
from reports.chapters.tyre.paper import patch_picture
from reports.markdown import Part, joined, prose
from reports.origin import origin
from reports.store.tables import Store


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    introduction = prose(f"""Interchangeable strain measures and contact algorithms on one and the same shell element:
what each is worth, from {len(store.planned)} solved or refused requests over {len({c.scene for c in store.planned})}
scenes. Every number is computed from the stored results; [all findings](findings.md) says how many problems a sentence
rests on, [questions](questions.md) what users of other solvers ask, and the [glossary](glossary.md) what a word means.
Below is the paper's tyre, pressed on the plane.""")
    head = joined(f"# {INDEX_TITLE}", introduction, _tyre(store))
    return joined(head, *answers(store), "## Pages", contents, limitations(store), origin(store))


def _tyre(store: Store) -> Part:
    """In space at growing travel; its patch, where no cell of the sheets was solved."""
    strip = filmstrip_of(Catalogue.of(store)) if all(map(store.has_analysis, NEEDS)) else None
    return strip or patch_picture(store)
