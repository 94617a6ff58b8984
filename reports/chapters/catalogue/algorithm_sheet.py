"""The sheet of a contact algorithm: what it solves, its parameters, what it solved, refused and cost, its limits."""

from __future__ import annotations

from reports.chapters.catalogue.words import TEXT, Catalogue, Sheet, about
from reports.markdown import Part, joined
from reports.store.tables import Store


def algorithm_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    store, name = catalogue.store, sheet.part
    summary = store.rows("contact_summary", algorithm=name).iloc[:1]
    solved = [TEXT("solves", **row, could=row["solved"] + row["failed"]) for _, row in summary.iterrows()]
    parts = {
        "first": joined(*solved),
        "about": about(sheet.about),
        "settings": catalogue.settings("algorithm", name),
        "cost": joined(*(TEXT("cost", **row) for _, row in summary.iterrows())),
        "outcomes": _outcomes(store, name),
        "limits": _limits(store, name),
        "source": f"## Source\n\n{sheet.source} In `{sheet.module}`." if sheet.source else "",
    }
    return TEXT("algorithm", sheet=sheet, **parts)


def _outcomes(store: Store, name: str) -> Part:
    own = store.rows("outcomes", axis="contact", name=name)
    return TEXT("outcomes", rows=own[own["scene"].fillna("") != ""]) if len(own) else Part()


def _limits(store: Store, name: str) -> Part:
    own = store.rows("extremes_limits", part="algorithm", name=name)
    if own.empty:
        return Part()
    return TEXT("algorithm-limits", rows=own.assign(reason=own["reason"].fillna("").map(_short)))


def _short(reason: str) -> str:
    """Its first clause, within a table."""
    return reason.partition(";")[0].replace("|", "/")[:120]
