"""The gallery: every scene in a small picture with a link to its sheet, and the lists of measures and algorithms."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import partial

from reports.chapter import Chapter, relative
from reports.chapters.catalogue.pictures import thumbnails
from reports.chapters.catalogue.sheets import algorithm_sheet, measure_sheet, pressed, scene_sheet
from reports.chapters.catalogue.words import NEEDS, TEXT, Catalogue, Sheet
from reports.markdown import Part, joined, picture
from reports.store.tables import Store

NAMED = r"(`{part}`|\| {part} \||footprint solve {part} |--(measure|contact) {part} )"
MOST = 12  # scenes of a picture
RENDERED = {"scene": scene_sheet, "measure": measure_sheet, "algorithm": algorithm_sheet}


def gallery(store: Store) -> Part:
    """The page."""
    catalogue = Catalogue.of(store)
    parts = {f"{kind}s": list(catalogue.sheets(kind)) for kind in RENDERED}
    counts = {f"{kind}_count": len(parts[f"{kind}s"]) for kind in RENDERED}
    drawn = [(each.part, body) for each in parts["scenes"] if (body := catalogue.body(each.part)) is not None]
    shown = []
    for number, first in enumerate(range(0, len(drawn), MOST), start=1):
        bodies = drawn[first : first + MOST]
        words = f"Deformed shapes: {', '.join(name for name, _ in bodies)}"
        shown.append(picture(f"gallery-{number}.svg", words, thumbnails(bodies)))
    return TEXT("gallery", **parts, **counts, drawn=len(drawn), pictures=joined(*shown), pressed=pressed(catalogue))


def sheets(store: Store) -> list[Chapter]:
    """A page for each part of the catalogues, as the tables have them; none without those tables."""
    if not CHAPTER.applies(store):
        return []
    catalogue = Catalogue.of(store)
    return [
        Chapter(each.name, each.title, each.meaning, partial(_rendered, catalogue, each), NEEDS, under=CHAPTER.name)
        for each in catalogue.sheets(*RENDERED)
    ]


def _rendered(catalogue: Catalogue, sheet: Sheet, store: Store) -> Part:
    """Of the store whose tables these are."""
    return RENDERED[sheet.kind](catalogue, sheet)


def with_appearances(texts: Mapping[str, str], chapters: Iterable[Chapter]) -> dict[str, str]:
    """The pages, every sheet with links to those that name its part: as code, in a table, or in a command."""
    known = list(chapters)
    own = {each.file: each for each in known if each.under == CHAPTER.name}
    others = {each.file: each.title for each in known if each.file not in own and each.name != CHAPTER.name}
    found = dict(texts)
    for file, sheet in own.items():
        _, _, part = sheet.name.partition("/")[2].partition("-")
        named = re.compile(NAMED.format(part=re.escape(part)))
        links = [f"[{title}]({relative(page, file)})" for page, title in others.items() if named.search(texts[page])]
        found[file] += f"\n## On other pages\n\n{' · '.join(links) if links else 'None names it.'}\n"
    return found


CHAPTER = Chapter(
    "gallery",
    "Gallery",
    "every scene, measure and algorithm with its data, pictures and targets, a sheet each.",
    gallery,
    needs=NEEDS,
)
