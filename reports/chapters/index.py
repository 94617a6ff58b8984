"""The first page: what to use, why, and how sure that is; or, of a campaign of a user, what any campaign supports.

And the page of claims, and the appendix: outcomes, questions, findings, words, every cell and answer as files.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd

from reports.chapter import ALL, INDEX_TITLE, by_machine, chapter, statements
from reports.chapters.algorithms import costs_picture, when_not_table
from reports.chapters.catalogue import Catalogue
from reports.chapters.gallery import filmstrip_of
from reports.chapters.measures import decision_part, limits_part, measures_picture
from reports.chapters.tyre import model_table
from reports.markdown import Part, Template, commands, joined
from reports.origin import completeness, machines, origin, outcomes_part, refusals
from reports.store import Cell, Store

TEXT = Template("index")
STRAINS = ("measures-small", "measures-large", "measures-contact", "measures-cost", "cheapest-measure", "tyre-measure")
CONTACT = ("which-algorithm", "trial-and-error-ends", "false-solved", "epsilon-range")
SPARED = ("parts-of-the-tyre", "grids-of-the-tyre", "one-per-cent")
FORCE = ("force-known", "printed-excluded", "origin-of-travel")
SURE = ("convergence", "manufactured", "algorithms-agree", "symmetry", "random-cases", "advice")
ABOVE = (*FORCE, "tyre-mesh-and-load")  # limitations that stand there
GOOD = ("converged", "unstable")
COUNTERS = ("newton_iterations", "factorisations", "assemblies", "operations")


def index_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages."""
    contact = TEXT("algorithms", when_not=when_not_table(), costs=costs_picture(store))
    sections = {
        "decision": decision_part(store),
        "measures": measures_picture(store),
        "strains": _section("Exact or classical strains?", store, STRAINS, TEXT("strains", limits=limits_part(store))),
        "algorithms": _section("Which contact algorithm?", store, CONTACT, contact),
        "spared": _section("What reduces the cost?", store, SPARED),
        "force": _section("How accurate is the tyre's force?", store, FORCE, model_table(store)),
        "sure": _section("How well is this verified?", store, SURE, TEXT("others")),
        "limitations": limitations(store),
        "tyre": filmstrip_of(Catalogue.of(store)),
    }
    counts = {"requests": len(store.planned), "scenes": len({cell.scene for cell in store.planned})}
    return TEXT("page", title=INDEX_TITLE, **counts, **sections, contents=contents, origin=origin(store))


def _section(title: str, store: Store, names: tuple[str, ...], more: Part | str = "") -> Part:
    """Sentences by their names, in order, those that depend on the machine marked; nothing where there are none."""
    by_name = {each.name: each for each in statements(store)}
    sentences = [by_name[name] for name in names if name in by_name]
    return TEXT("section", title=title, **by_machine(sentences), more=more) if sentences else Part()


def limitations(store: Store) -> Part:
    """What does not hold, as computed, and what is not covered at all."""
    sentences = [each for each in statements(store) if each.role == "limitation" and each.name not in ABOVE]
    return TEXT("limitations", **by_machine(sentences))


def campaign_page(store: Store, contents: str) -> Part:
    """The whole page; contents: the list of the other pages. Times are those of its last block."""
    parts = {"origin": origin(store), "refusals": refusals(store), "completeness": completeness(store)}
    failed = [each for each in store.planned if each.ended in ("wrong", "not-converged", "cap-hit")]
    parts |= {"unfinished": TEXT("unfinished", cells=failed) if failed else Part("None.")}
    pages = f"## Pages\n\n{contents}" if contents else ""
    named = {"title": INDEX_TITLE, "store": store, "pages": pages}
    return TEXT("campaign", **named, sequences=_sequences(store), groups=_groups(store), **parts)


def _sequences(store: Store) -> Part:
    """A row for each sequence and reference."""
    own = store.rows("convergence", ladder="")
    if own.empty:
        return Part("No request was solved and analysed on 3 meshes or more.")
    known = store.table("convergence_errors")
    known = known.assign(known=known["value"])[["sequence", "known", "kind", "error", "model_part"]]
    meshes = own.groupby("sequence")["mesh"].agg(", ".join).rename("meshes")
    finest = own.drop_duplicates("sequence", keep="last").join(meshes, on="sequence")
    sequences = finest.merge(known, how="left", on="sequence")
    sequences["off"] = sequences["error"].where(sequences["limit"].isna(), sequences["model_part"])
    return TEXT("sequences", rows=sequences)


def _groups(store: Store) -> list[dict[str, Any]]:
    """Outcomes by scene, algorithm and tolerance, with the sums of the counters of what has converged."""
    groups: dict[tuple[str, ...], list[Cell]] = {}
    for each in store.planned:
        asked = each.asked
        key = (each.scene, str(asked.get("contact", "semismooth")), str(asked["settings"].get("tolerance", "nan")))
        if each.ended not in ("unsupported", "missing"):
            groups.setdefault(key, []).append(each)
    rows = []
    for (scene, contact, tolerance), group in groups.items():
        counters = [each.result["counters"] for each in group if each.result and each.ended in GOOD]
        counts = {"solved": len(group), "converged": len(counters), "failed": len(group) - len(counters)}
        sums = {name: sum(each.get(name, 0) for each in counters) for name in COUNTERS}
        rows.append({"scene": scene, "contact": contact, "tolerance": float(tolerance), **counts, **sums})
    return rows


CLAIMED = Template("claims")
CLAIMS = "claims"
STATUSES = ("confirmed", "qualified", "refuted", "untested")
ORDER = ("refuted", "qualified", "confirmed", "untested")


def claims_page(store: Store) -> Part:
    """The whole page: counts, a table a subject, how to read a status."""
    claims = store.table(CLAIMS)
    counts = claims["status"].value_counts()
    counted = ", ".join(f"{counts.get(status, 0)} {status}" for status in STATUSES)
    subjects = joined(*(_subject(str(name), own) for name, own in claims.groupby("subject", sort=False)))
    return CLAIMED("page", count=len(claims), told=counted, subjects=subjects)


def _subject(name: str, own: pd.DataFrame) -> Part:
    """Tables of a subject, refuted ones first; those of times apart, as another machine has others."""
    ordered = own.assign(rank=own["status"].map(ORDER.index)).sort_values("rank", kind="stable")
    timed = ordered["machine"].astype(bool)
    shown = commands(ordered["command"].dropna().loc[lambda each: each != ""])
    name = f"{name[0].upper()}{name[1:]}"
    return CLAIMED("subject", name=name, steady=ordered[~timed], timed=ordered[timed], commands=shown)


LEDGER = chapter(CLAIMED, claims_page, needs=(CLAIMS,), always=True)


DATA = "data"
BACK = Template(DATA)
FILES = {  # beside the pages, of tables by these names; those of many rows are compressed when they are written
    "cells.csv.gz": ("data_cells", "one row per planned cell, of any outcome"),
    "answers.csv.gz": ("data_answers", "one row per quantity of a cell"),
    "columns.csv": ("data_columns", "one row per column of the other two: unit and meaning"),
    "claims.csv": ("claims", "one row per claim: status, interval, command"),
}
NEEDED = ("data_cells", "data_answers", "data_columns")
AS_ASKED = ("converged", "unstable", "unsupported")
GITHUB = "https://github.com"


def data_files(store: Store) -> dict[str, str]:
    """The tables to be taken away as CSV, by file name."""
    return {
        f"{DATA}/{name}": store.table(table).drop(columns="campaign").to_csv(index=False, float_format="%.10g")
        for name, table, _ in _files(store)
    }


def appendix(store: Store) -> Part:
    """The whole page."""
    failed = [each for each in store.planned if each.ended not in AS_ASKED]
    files = [{"name": name, "rows": len(store.table(table)), "words": words} for name, table, words in _files(store)]
    cells, answers, *_ = (each["rows"] for each in files)
    parts = {"outcomes": outcomes_part(store), "questions": _questions(store), "findings": _findings(store)}
    made = {"origin": origin(store), "machines": machines(store)}
    return BACK("page", **parts, cells=cells, answers=answers, files=files, count=len(failed), failed=failed, **made)


def _files(store: Store) -> Iterator[tuple[str, str, str]]:
    """Names, tables and what they are; a part of the report has too few tables to judge claims."""
    for name, (table, words) in FILES.items():
        if table in NEEDED or (store.pages == ALL and store.has(table)):
            yield name, table, words


def _questions(store: Store) -> Part:
    """What users of other solvers ask in public: threads, the sentences that answer by their place, what is missing."""
    if not store.has("asks"):
        return Part()
    pages, asks = {each.name: each.page for each in statements(store)}, store.table("asks")
    rows = asks.astype(object).fillna("").to_dict("records")
    for row in rows:
        places = dict.fromkeys(pages[name] for name in row["answers"].split(", ") if name in pages)
        row["where"] = ", ".join(f"[{page}]({page}.md)" for page in places)
        row["threads"] = ", ".join(map(_thread, row["threads"].split(", ")))
    return BACK("questions", answered=int(asks["answered"].sum()), count=len(asks), rows=rows)


def _thread(name: str) -> str:
    """A link to a thread by repository and number; words that are none stay words."""
    repository, _, number = name.partition("#")
    return f"[{name}]({GITHUB}/{repository}/issues/{number})" if number.isdigit() else name


def _findings(store: Store) -> Part:
    """Every sentence of conclusion with what it rests on; those that depend on the machine come last."""
    sentences = statements(store)
    steady, timed = ([each for each in sentences if each.machine == kind] for kind in (False, True))
    return BACK("findings", count=len(sentences), steady=steady, timed=timed) if sentences else Part()


APPENDIX = chapter(BACK, appendix, needs=NEEDED)
