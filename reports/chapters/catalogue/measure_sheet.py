"""The sheet of a strain measure: its terms and what it drops, what rigid motions leave, where it holds, its cost."""

from __future__ import annotations

from reports.chapters.catalogue.words import Catalogue, Sheet, about
from reports.chapters.overview.decision import choices_of, limit_error, problem
from reports.formats import number, share
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.store.tables import Store

TERMS = """## Strains

Strains of a face by the gradients l, w and t = lam, om and th over zeta of its displacement and the director's change
beta = (v+ - v-)/h; l is the elongation, w the rotation in the surface, t the slope of a line."""
LAWS = """## Rigid motions

The strain that a rigid motion leaves on a face, by the law that the measure declares; the page *What must not
matter* measures it. Amount or angle theta; zeta is the stretch of the face by the curvature."""
HEADS = "problem | in the limit of the meshes | within | verdict | mesh | error at most"
LINE = "{problem} | {off} | {asked:share} | {verdict} | {mesh:said} | {error_at_most:share}"


def measure_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    return joined(
        f"# {sheet.title}\n\n{sheet.meaning[:1].upper()}{sheet.meaning[1:]}.",
        about(sheet.about),
        _terms(catalogue, sheet.part),
        _laws(catalogue, sheet.part),
        _limits(catalogue.store, sheet.part),
        f"## Source\n\n{sheet.source}; in `{sheet.module}`." if sheet.source else "",
    )


def _terms(catalogue: Catalogue, name: str) -> str:
    own = catalogue.own("terms", measure=name).fillna("")
    if own.empty:
        return ""
    rows = [(f"`{row['strain']}`", row["formula"], row["dropped"] or "nothing") for _, row in own.iterrows()]
    shown = table("Terms", ["strain", "is", "the exact one has beside that"], rows, words=3)
    return f"{prose(TERMS)}\n\n{shown}"


def _laws(catalogue: Catalogue, name: str) -> str:
    own = catalogue.own("laws", measure=name)
    rows = [(row["motion"].replace("_", " "), row["law"], number(row["at_tenth"])) for _, row in own.iterrows()]
    return f"{prose(LAWS)}\n\n" + table("Laws", ["motion", "strain", "at 0.1, zeta = 1.05"], rows, words=2)


def _limits(store: Store, name: str) -> Part | str:
    data = choices_of(store, "measure_limits")
    own = data[data["name"] == name] if len(data) else data
    if own.empty:
        return ""
    rows = [{**row, "problem": problem(row), "off": limit_error(row)} for row in own.to_dict("records")]
    told = """## Where it is enough

Its error in the limit of the meshes, against the exact measure. The mesh is the coarsest
from which on its value is surely within the error given. †: as on the page of measures."""
    return joined(prose(told), machine(listing("Problems", rows, HEADS, LINE, share=_share)))


def _share(error: float) -> str:
    return share(error, 1)
