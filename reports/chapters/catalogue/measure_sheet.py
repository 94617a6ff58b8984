"""The sheet of a strain measure: its terms and what it drops, what rigid motions leave, where it holds, its cost."""

from __future__ import annotations

from reports.chapters.catalogue.words import TEXT, Catalogue, Sheet, about
from reports.chapters.overview.decision import choices_of, limit_error, problem
from reports.markdown import Part
from reports.store.tables import Store


def measure_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    terms = catalogue.own("terms", measure=sheet.part).fillna("")
    laws = catalogue.own("laws", measure=sheet.part)
    parts = {
        "about": about(sheet.about),
        "terms": TEXT("terms", rows=terms.replace({"dropped": {"": "nothing"}})) if len(terms) else "",
        "laws": laws.assign(motion=laws["motion"].str.replace("_", " ")),
        "limits": _limits(catalogue.store, sheet.part),
        "source": f"## Source\n\n{sheet.source}; in `{sheet.module}`." if sheet.source else "",
    }
    return TEXT("measure", sheet=sheet, meaning=f"{sheet.meaning[:1].upper()}{sheet.meaning[1:]}", **parts)


def _limits(store: Store, name: str) -> Part:
    data = choices_of(store, "measure_limits")
    own = data[data["name"] == name] if len(data) else data
    rows = [{**row, "problem": problem(row), "off": limit_error(row)} for row in own.to_dict("records")]
    return TEXT("measure-limits", rows=rows) if rows else Part()
