"""The sheet of a strain measure: its terms and what it drops, what rigid motions leave, where it holds, its cost."""

from __future__ import annotations

import pandas as pd

from reports.chapters.catalogue.words import Catalogue, Sheet, about
from reports.formats import fixed, number, percent, share
from reports.markdown import Part, joined, listing, machine, prose, table
from reports.store.tables import Store

TERMS = """## Strains

Strains of a face by the gradients l, w and t = lam, om and th over zeta of its displacement and the director's change
beta = (v+ - v-)/h; l is the elongation, w the rotation in the surface, t the slope of a line."""
LAWS = """## Rigid motions

The strain that a rigid motion leaves on a face, by the law that the measure declares; the page *Rigid motions* measures
it. Amount or angle theta; zeta is the stretch of the face by the curvature."""
HEADS = "regime | largest error | in | solved | seconds over exact | operations over exact | both solve"
LINE = (
    "{regime} | {error:off} | {where} | {solved_share:share} | {seconds_ratio:ratio}"
    " | {operations_ratio:ratio} | {both:.0f}"
)
LIMIT_HEADS = "scene | error above 1 % from | above 5 % from | largest error | at"
LIMIT_LINE = "{scene:code} | {first_1:load} | {first_5:load} | {largest:off} | {largest_at:g}"


def measure_sheet(catalogue: Catalogue, sheet: Sheet) -> Part:
    """The whole page."""
    return joined(
        prose(
            f"# {sheet.title}\n\n{sheet.meaning[:1].upper()}{sheet.meaning[1:]}. {_first(catalogue.store, sheet.part)}"
        ),
        about(sheet.about),
        _terms(catalogue, sheet.part),
        _laws(catalogue, sheet.part),
        _regimes(catalogue.store, sheet.part),
        _curves(catalogue.store, sheet.part),
        f"## Source\n\n{sheet.source}; in `{sheet.module}`." if sheet.source else "",
    )


def _first(store: Store, name: str) -> str:
    """Where it is worst, in one sentence."""
    found = store.rows("regimes", measure=name, scene="")
    known = found if found.empty else found[found["error"].notna()]
    if known.empty:
        return ""
    each = [f"{row['regime']} {percent(row['error'], 1)}" for _, row in known.iterrows()]
    return f"Largest error by regime: {', '.join(each)}."


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


def _regimes(store: Store, name: str) -> Part | str:
    own = store.rows("regimes", measure=name, scene="")  # of all scenes together
    if own.empty:
        return ""
    where = [_where(row) for _, row in own.iterrows()]
    shown = listing("Regimes", own.assign(where=where), HEADS, LINE, off=_off, share=_share, ratio=_ratio)
    told = """## Where it holds

The largest error with its sign, against the exact measure on the same mesh (of `exact`: against the reference), and
medians of what it costs over the exact measure on the problems that both solve; *solved* is its share of those that it
was put to and that have an answer."""
    return joined(prose(told), machine(shown))


def _where(row: pd.Series) -> str:
    if not isinstance(row["error_scene"], str) or pd.isna(row["error"]):
        return "–"
    return f"`{row['error_scene']}` at {row['load_key']} = {number(row['error_load'])}"


def _curves(store: Store, name: str) -> str:
    own = store.rows("measure_limits", measure=name)
    if own.empty:
        return ""
    told = "Loads at which the error first exceeds 1 and 5 % of the exact answer; a dash where it never does."
    shown = listing("Loads", own, LIMIT_HEADS, LIMIT_LINE, off=_off, load=_load)
    return joined(told, shown).text


def _off(error: float) -> str:
    return percent(error, 1)


def _share(solved: float) -> str:
    return share(solved, 0)


def _ratio(over: float) -> str:
    return fixed(over, 2)


def _load(value: float) -> str:
    return "the first load" if value == 0 else number(value)
