"""The part of outcomes: what is solved, what fails and what is refused, and how complete the campaign is."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from reports.chapters.overview.outcomes import completeness, refusals
from reports.formats import NOTHING
from reports.markdown import Part, folded, joined, listing, machine, prose, table
from reports.store.tables import Store

AXES = {"contact": "contact algorithm", "measure": "strain measure"}


def outcomes_part(store: Store) -> Part:
    """The whole part."""
    text = prose("""## Solved, failed, refused

A problem is all that was asked but the competitor: scene, mesh, settings, tolerance; those count here that were put to
two competitors at least. *Refused*: the algorithm says why it cannot solve it. *Path ends*: the equilibrium path itself
ends before the load that was asked for.""")
    tables = [_matrix(store, axis) for axis in AXES] if store.has_analysis("outcomes") else []
    return joined(text, summary_table(store), *tables, completeness(store), _refused(store))


def summary_table(store: Store) -> str:
    """What each algorithm solves and refuses, and its time over that of the default where both solve."""
    if not store.has_analysis("contact_summary"):
        return ""
    data = store.analysis("contact_summary")
    if data.empty:
        return ""
    data = data.assign(put=data["solved"] + data["failed"])
    heads = "algorithm | solved | of | share | failed | refused | seconds over the default | both solve (scenes)"
    line = "{algorithm:code} | {solved} | {put} | {solved_share:.1%} | {failed} | {refused} | "
    line += "{seconds_ratio:.2f} [{seconds_low:.2f}, {seconds_high:.2f}] | {both} ({both_scenes})"
    return machine(listing("Contact algorithms: solved share, and time in the median", data, heads, line))


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
    return joined(
        f"### By {AXES[axis]}",
        grid,
        folded("Causes of what is not solved", why) if why else "",
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


def _refused(store: Store) -> str:
    return folded("Why cells were refused", refusals(store))
