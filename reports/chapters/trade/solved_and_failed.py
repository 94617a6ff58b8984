"""What every contact algorithm and every measure has solved, scene by scene, and why the rest was not."""

from __future__ import annotations

import pandas as pd

from reports.formats import NOTHING, code
from reports.markdown import Part, commands, folded, joined, listing, machine, prose, table
from reports.store.tables import Store

TITLES = {"contact": "By contact algorithm", "measure": "By measure"}


def solved_and_failed(store: Store) -> Part:
    """Both tables, the causes below each, and the ends of paths."""
    data = store.analysis("outcomes")
    if data.empty:
        return Part("## Solved and failed\n\nNo problem was put to two algorithms, or two measures.")
    text = prose("""## Solved and failed

Problems that were put to at least two algorithms, or two measures: solved of put, scene by scene; a scene in which all
solve all is in the last row only. A problem counts as put unless it is refused (*ref*), or its *path ends* before the
load that was asked for: there it turns back or branches, and no state of that path is left to be found, which is no
failure of an algorithm; for a measure it is what the measure says of the shell. What the judge refuses has failed.""")
    blocks = [block for axis, own in data.groupby("axis", sort=False) for block in _axis(str(axis), own)]
    return joined(text, *blocks, *_causes(store))


def _axis(axis: str, data: pd.DataFrame) -> list[str]:
    """A row a scene, a column a competitor; then the causes."""
    names = list(dict.fromkeys(data["name"]))
    by = {(row["scene"], row["name"]): row for row in data.to_dict("records")}
    scenes = data[data["scene"] != ""].groupby("scene", sort=False)
    troubled = [str(scene) for scene, own in scenes if (own["solved"] < own["planned"]).any()]
    rows = [[code(scene), *(_entry(by.get((scene, name))) for name in names)] for scene in troubled]
    rows.append(["all", *(_entry(by.get(("", name))) for name in names)])
    blocks = [table(f"{TITLES[axis]}: solved of put", ["scene", *map(code, names)], rows)]
    lost = data[(data["scene"] != "") & (data["cause"] != "")]
    heads = "scene | " + axis + " | put | solved | share | path ends | failed | refused | cause"
    line = "`{scene}` | `{name}` | {put} | {solved} | {solved_share:.0%} | {path_ends} | {failed} | {refused} | {cause}"
    put = lost["solved"] + lost["failed"]
    if len(lost):
        listed = listing(f"{TITLES[axis]}: what was not solved", lost.assign(put=put), heads, line, words=2)
        blocks.append(folded(f"{TITLES[axis]}: causes", listed))
        run = lost["command"][lost["command"] != ""]
        blocks += [commands(run)] if len(run) else []
    return blocks


def _entry(row: dict | None) -> str:
    """Solved of put, with what ends and what is refused."""
    if row is None:
        return NOTHING
    put = row["solved"] + row["failed"]
    also = [f"{row[name]} {word}" for name, word in (("path_ends", "end"), ("refused", "ref")) if row[name]]
    told = f"{row['solved']}/{put}" if put else ""
    told = f"**{told}**" if row["failed"] else told
    return ", ".join(filter(None, [told, *also]))


def _causes(store: Store) -> list[str]:
    """What the path of each cell that was not solved ends at, and why the others have failed."""
    data = store.analysis("unsolved")
    end = data["path_end"].fillna("") != ""
    heads = "scene | measure | mesh | the path ends at | parameter | found by | cells | algorithms"
    line = "`{scene}` | `{measure}` | {mesh} | {path_end} | {at:.5g} | {found_by} | {cells} | {contacts}"
    parts = [folded("Where paths end", listing("Ends of paths", data[end], heads, line, words=3))] if end.any() else []
    if end.all():
        return [*parts, "No cell has failed without such an end."]
    heads = "scene | measure | mesh | algorithms | cells | class | reason of the first"
    line = "`{scene}` | `{measure}` | {mesh} | {contacts} | {cells} | {outcome} | {why}"
    listed = listing("Failures", data[~end], heads, line, words=4)
    told = folded("What failed without such an end, in its own words", listed)
    return [*parts, machine(told, commands(data[~end]["command"]))]
