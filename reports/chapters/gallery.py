"""The gallery of scenes, measures and algorithms, and a sheet of each: what it is, and what is known of its answers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

import pandas as pd

from reports.chapter import Chapter, relative
from reports.chapters.catalogue import NEEDS, TEXT, Catalogue, about
from reports.chapters.measures import limit_error, problem
from reports.figures.sheets import filmstrip, sheet_picture, thumbnails
from reports.formats import number, percent
from reports.markdown import Part, joined, picture
from reports.store import Store

NAMED = r"(`{part}`|\| {part} \||footprint solve {part} |--(measure|contact) {part} )"
MOST = 12  # scenes of a picture
SOLVED = ("converged", "unstable")
NO_REFERENCE = "No reference applies at these settings."


def gallery(store: Store) -> Part:
    """The page."""
    catalogue = Catalogue.of(store)
    parts = {f"{kind}s": list(catalogue.sheets(kind)) for kind in RENDERED}
    counts = {f"{kind}_count": len(parts[f"{kind}s"]) for kind in RENDERED}
    drawn = [(each.part, body) for each in parts["scenes"] if (body := catalogue.body(each.part)) is not None]
    shown = []
    for count, first in enumerate(range(0, len(drawn), MOST), start=1):
        bodies = drawn[first : first + MOST]
        words = f"Deformed shapes: {', '.join(name for name, _ in bodies)}"
        shown.append(picture(f"gallery-{count}.svg", words, thumbnails(bodies)))
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


def _rendered(catalogue: Catalogue, sheet: Any, store: Store) -> Part:
    """Of the store whose tables these are."""
    return RENDERED[sheet.kind](catalogue, sheet)


def with_appearances(texts: Mapping[str, str], chapters: Iterable[Chapter]) -> dict[str, str]:
    """The pages, every sheet with links to those that name its part: as code, in a table, or in a command."""
    known = list(chapters)
    own = {each.file: each for each in known if each.under == CHAPTER.name}
    others = {each.file: each.title for each in known if each.file not in own and each.name != CHAPTER.name}
    pages = dict(texts)
    for file, sheet in own.items():
        _, _, part = sheet.name.partition("/")[2].partition("-")
        named = re.compile(NAMED.format(part=re.escape(part)))
        links = [f"[{title}]({relative(page, file)})" for page, title in others.items() if named.search(texts[page])]
        pages[file] += f"\n## On other pages\n\n{' · '.join(links) if links else 'No page names it.'}\n"
    return pages


def scene_sheet(catalogue: Catalogue, sheet: Any) -> Part:
    """Sketch and picture, what it is made of, what is asked, and what is known of the answer."""
    name = sheet.part
    answer = catalogue.own("answers", scene=name).iloc[0]
    own = catalogue.own("values", scene=name)
    defined, known = own.drop_duplicates("quantity"), own[own["target"].notna()]
    limits = defined[defined["limit"].notna()]
    tables = {
        "quantities": defined,
        "unknown": NO_REFERENCE if known.empty else "",
        "targets": known,
        "limits": limits.assign(off=limits["value"] / limits["limit"] - 1),
    }
    parts = {
        "first": _first(own, answer),
        "picture": _pictures(catalogue, name),
        "about": about(sheet.about),
        "problem": _facts(catalogue, name),
        "ending": _ending(answer),
        "command": answer["command"],
        "pressed": pressed(catalogue) if name == "tyre" else "",
        "settings": catalogue.settings("scene", name),
    }
    return TEXT("scene", sheet=sheet, **parts, **tables)


def _first(own: pd.DataFrame, answer: pd.Series) -> str:
    """The answer of the page in one sentence."""
    shown = own[own["headline"].astype(bool) & own["value"].notna()]
    if answer["outcome"] not in SOLVED:
        return f"The outcome here is {answer['outcome']}."
    if shown.empty:
        return "It has no headline quantity."
    best = shown.sort_values("uncertainty", kind="stable").iloc[0]
    unit = "" if best["unit"] == "1" else f" {best['unit']}"
    value = f"`{best['quantity']}` = {number(best['value'])}{unit} on {answer['mesh']}"
    if pd.isna(best["target"]):
        return f"Here {value}; no reference applies at these settings."
    known = f"{best['kind']} target {number(best['target'])}"
    off = "" if best["target"] == 0 else f", error {percent(best['error'])}"
    return f"Here {value}; {known}{off}."


def _pictures(catalogue: Catalogue, name: str) -> Part | str:
    body = catalogue.body(name)
    if body is None:
        return "No picture: the cell of this sheet has no fields."
    words = f"{name}: at rest with supports and loads, and deformed with its displacement"
    return picture(f"scene-{name}.svg", words, sheet_picture(body, catalogue.own("marks", scene=name)))


def _facts(catalogue: Catalogue, name: str) -> Part:
    """What it is made of, a table a section, and its plies."""
    sections = catalogue.own("facts", scene=name).groupby("section", sort=False)
    facts = joined(*(TEXT("facts", section=section, rows=rows) for section, rows in sections))
    return TEXT("problem", facts=facts, plies=catalogue.own("plies", scene=name)) if len(sections) else Part()


def _ending(answer: pd.Series) -> str:
    if pd.isna(answer["mesh"]) or answer["mesh"] == "":
        return "The cell of this sheet is not solved."
    counts = f"{answer['unknowns']:.0f} unknowns, {answer['iterations']:.0f} Newton iterations"
    how = f"Here: mesh {answer['mesh']}, measure `{answer['measure']}`, model {answer['model']}, {counts}"
    return f"{how}; {answer['outcome']}" + (f": {answer['reason']}." if answer["outcome"] != "converged" else ".")


def filmstrip_of(catalogue: Catalogue) -> Part:
    """The tyre at growing travel; nothing without its cells."""
    words = "The tyre pressed, from below: contact pressure at growing travel"
    return picture("tyre-filmstrip.svg", words, filmstrip(catalogue.frames)) if catalogue.frames else Part()


def pressed(catalogue: Catalogue) -> Part:
    """The same under a heading."""
    return joined("## The tyre pressed", filmstrip_of(catalogue)) if catalogue.frames else Part()


def measure_sheet(catalogue: Catalogue, sheet: Any) -> Part:
    """Its terms and what it drops, what rigid motions leave, where it is enough."""
    terms = catalogue.own("terms", measure=sheet.part).fillna("")
    laws = catalogue.own("laws", measure=sheet.part)
    parts = {
        "about": about(sheet.about),
        "terms": TEXT("terms", rows=terms.replace({"dropped": {"": "nothing"}})) if len(terms) else "",
        "laws": laws.assign(motion=laws["motion"].str.replace("_", " ")),
        "limits": _formulation(catalogue.store, sheet.part),
        "source": f"## Source\n\n{sheet.source}; in `{sheet.module}`." if sheet.source else "",
    }
    return TEXT("measure", sheet=sheet, meaning=f"{sheet.meaning[:1].upper()}{sheet.meaning[1:]}", **parts)


def _formulation(store: Store, name: str) -> Part:
    data = store.rows("measure_limits")
    own = data[data["name"] == name] if len(data) else data
    rows = [{**row, "problem": problem(row), "off": limit_error(row)} for row in own.to_dict("records")]
    return TEXT("measure-limits", rows=rows) if rows else Part()


def algorithm_sheet(catalogue: Catalogue, sheet: Any) -> Part:
    """What it solves, its parameters, what it solved, refused and cost, its limits."""
    store, name = catalogue.store, sheet.part
    summary = store.rows("contact_summary", algorithm=name).iloc[:1]
    solved = [TEXT("solves", **row, could=row["solved"] + row["failed"]) for _, row in summary.iterrows()]
    parts = {
        "first": joined(*solved),
        "about": about(sheet.about),
        "settings": catalogue.settings("algorithm", name),
        "cost": joined(*(TEXT("cost", **row) for _, row in summary.iterrows())),
        "outcomes": _outcomes(store, name),
        "limits": _extremes(store, name),
        "source": f"## Source\n\n{sheet.source} In `{sheet.module}`." if sheet.source else "",
    }
    return TEXT("algorithm", sheet=sheet, **parts)


def _outcomes(store: Store, name: str) -> Part:
    own = store.rows("outcomes", axis="contact", name=name)
    return TEXT("outcomes", rows=own[own["scene"].fillna("") != ""]) if len(own) else Part()


def _extremes(store: Store, name: str) -> Part:
    own = store.rows("extremes_limits", part="algorithm", name=name)
    if own.empty:
        return Part()
    return TEXT("algorithm-limits", rows=own.assign(reason=own["reason"].fillna("").map(_short)))


def _short(reason: str) -> str:
    """Its first clause, within a table."""
    return reason.partition(";")[0].replace("|", "/")[:120]


RENDERED = {"scene": scene_sheet, "measure": measure_sheet, "algorithm": algorithm_sheet}
CHAPTER = Chapter(
    "gallery",
    "Gallery",
    "every scene, measure and algorithm with its data, pictures and targets, a sheet each.",
    gallery,
    needs=NEEDS,
)
