"""The page of outcomes: what is solved, what fails and what is refused, and how complete the campaign is."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from reports.chapter import Chapter
from reports.chapters.overview.outcomes import completeness, refusals
from reports.formats import NOTHING, code
from reports.markdown import Part, commands, folded, joined, listing, machine, prose, table
from reports.store.cells import Cell
from reports.store.tables import Store

AXES = {"contact": "contact algorithm", "measure": "strain measure"}


def outcomes_page(store: Store) -> Part:
    """The whole page."""
    text = prose("""# Solved, failed, refused

A failure is a result. A problem is all that was asked but the competitor: scene, mesh, settings, tolerance; those count
here that were put to two competitors at least. *Refused*: the algorithm says why it cannot solve it. *Path ends*: the
equilibrium path itself ends before the load that was asked for, which is no failure of an algorithm.""")
    tables = [_matrix(store, axis) for axis in AXES] if store.has_analysis("outcomes") else []
    return joined(text, *tables, _completeness(store), *_behind(store))


def _matrix(store: Store, axis: str) -> Part:
    """Scene by competitor: solved of those that could be."""
    data = store.analysis("outcomes")
    data = data[data["axis"] == axis]
    whole, own = data[data["scene"] == ""], data[data["scene"] != ""]
    if own.empty:
        return Part("")
    names = list(dict.fromkeys(whole["name"]))
    rows = [[scene, *_entries(each, names)] for scene, each in own.groupby("scene", sort=False)]
    rows.append(["all", *_entries(whole, names)])
    grid = table("Solved of those that could be solved; r: refused, e: the path ends", ["scene", *names], rows)
    lost = own[own["cause"] != ""]
    heads, line = f"{AXES[axis]} | scene | failed | path ends | refused | cause", "{name:code} | {scene} | {failed} | "
    why = listing("Causes", lost, heads, line + "{path_ends} | {refused} | {cause}", words=2) if len(lost) else ""
    lines = [line for line in lost["command"] if line]
    return joined(
        f"## By {AXES[axis]}",
        grid,
        folded("Causes of what is not solved", why) if why else "",
        commands(lines) if lines else "",
    )


def _entries(rows: pd.DataFrame, names: list[str]) -> Iterator[str]:
    found = {row["name"]: row for row in rows.to_dict("records")}
    for name in names:
        if name not in found:
            yield NOTHING
            continue
        row = found[name]
        marks = [f"{int(row[key])} {mark}" for key, mark in (("refused", "r"), ("path_ends", "e")) if row[key]]
        yield f"{int(row['solved'])}/{int(row['solved'] + row['failed'])}" + (f" ({', '.join(marks)})" if marks else "")


def _completeness(store: Store) -> Part:
    return joined("## Completeness", completeness(store), folded("Why cells were refused", refusals(store)))


def _behind(store: Store) -> Iterator[Part | str]:
    """The cells that the other pages show, and those that did not go as asked."""
    cells = store.cells
    if not cells:
        return
    rows = [
        [scene, *_counts([c for c in cells if c.scene == scene])] for scene in dict.fromkeys(c.scene for c in cells)
    ]
    header = ["scene", "cells planned", "converged, steps as asked", "converged, steps cut", "refused", "not converged"]
    yield table("Cells behind the pages", header, [*rows, ["all", *_counts(cells)]])
    asked = [cell for cell in cells if not cell.unsupported]  # what an algorithm refuses stands on its own page
    unusual = [cell for cell in asked if cell.cuts or not cell.converged or cell.expected]
    if unusual:
        yield from _unusual(unusual)


def _counts(cells: list[Cell]) -> list[int]:
    converged = [cell for cell in cells if cell.converged]
    cut, refused = sum(bool(cell.cuts) for cell in converged), sum(cell.unsupported for cell in cells)
    return [len(cells), len(converged) - cut, cut, refused, len(cells) - len(converged) - refused]


def _unusual(cells: list[Cell]) -> Iterator[str]:
    """What became of cells that did not go as asked, and how it ended."""
    header = ["cell", "what happened", "expected"]
    rows = [(cell.label, _happened(cell), cell.expected or "converges as asked") for cell in cells]
    yield table("Cells that did not go as asked, or were not expected to", header, rows, words=3)
    events = [[cell.label, event] for cell in cells for event in cell.cuts]
    events += [[cell.label, cell.reason] for cell in cells if not cell.converged]
    if events:
        listed = table("Rejected steps, and how it ended", ["cell", "event"], events, words=2)
        yield machine(folded("Rejected steps, and how it ended", listed))
    yield commands(cell.command for cell in cells)


def _happened(cell: Cell) -> str:
    if not cell.converged:
        return f"not converged: {code(cell.result['outcome']).strip('`')}"
    return "converged after its step was cut" if cell.cuts else "converged as asked"


CHAPTER = Chapter(
    "outcomes",
    "Solved, failed, refused",
    "every algorithm and measure on every scene, with causes; completeness of the campaign.",
    outcomes_page,
)
