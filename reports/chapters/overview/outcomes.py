"""What became of the cells that a campaign has planned: what is solved, what fails, what is refused, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from reports.markdown import Part, by_name, joined, table
from reports.origin import counted
from reports.store.cells import Cell
from reports.store.tables import Store
from reports.template import Template

TEXT = Template("outcomes")
AXES = {"contact": "contact algorithm", "measure": "strain measure"}
WORDS = {  # of each class, for people
    "converged": "and the judge agrees",
    "unstable": "converged, and the judge agrees, to an equilibrium with negative eigenvalues of the tangent",
    "wrong": "said to have converged, and the judge does not agree",
    "not-converged": "the iteration, or the path, came to an end before the load",
    "cap-hit": "a limit of iterations was reached",
    "time": "killed at the time limit",
    "memory": "more than the memory limit",
    "crash": "the process died",
    "unsupported": "refused, with a reason",
    "missing": "not solved yet",
}
SOLVED = ("converged", "unstable", "wrong", "not-converged", "cap-hit")


def outcomes_part(store: Store) -> Part:
    """The whole part."""
    matrices = [_matrix(store, axis) for axis in AXES] if store.has("outcomes") else []
    parts = {"completeness": completeness(store), "refusals": refusals(store)}
    return TEXT("part", summary=summary_table(store), matrices=joined(*matrices), **parts)


def summary_table(store: Store) -> Part:
    """What each algorithm solves and refuses, and its time over that of the default where both solve."""
    data = store.rows("contact_summary")
    return TEXT("summary", rows=data.assign(put=data["solved"] + data["failed"]) if len(data) else [])


def _matrix(store: Store, axis: str) -> Part:
    """Scene by competitor: solved of those that could be."""
    data = store.rows("outcomes", axis=axis)
    whole, own = data[data["scene"] == ""], data[data["scene"] != ""]
    if own.empty:
        return Part()
    names = list(dict.fromkeys(whole["name"]))
    groups = [*((str(scene), each) for scene, each in own.groupby("scene", sort=False)), ("all", whole)]
    rows = by_name((((scene,), each) for scene, each in groups), names, _entry)
    grid = table("Solved of those that could be solved; r: refused, e: the path ends", ["scene", *names], rows)
    return TEXT("matrix", axis=AXES[axis], grid=grid, lost=own[own["cause"] != ""])


def _entry(row: dict) -> str:
    marks = [f"{int(row[key])} {mark}" for key, mark in (("refused", "r"), ("path_ends", "e")) if row[key]]
    return f"{int(row['solved'])}/{int(row['solved'] + row['failed'])}" + (f" ({', '.join(marks)})" if marks else "")


def completeness(store: Store) -> Part:
    """Cells planned by scene and class, and what could not be solved."""
    present = list(counted(store.planned))
    scenes = dict.fromkeys(each.scene for each in store.planned)
    rows = [[scene, *_counts((e for e in store.planned if e.scene == scene), present)] for scene in scenes]
    rows.append(["all", *_counts(store.planned, present)])
    cells = table(f"Cells of the campaign {store.campaign}", ["scene", "planned", *present], rows)
    words = "; ".join(f"*{name}*: {WORDS[name]}" for name in present)
    unsolved = [each for each in store.planned if each.ended not in (*SOLVED, "unsupported")]
    return TEXT("completeness", cells=cells, words=words, unsolved=unsolved)


def _counts(planned: Iterable[Cell], present: list[str]) -> list[int]:
    counts = counted(planned)
    return [sum(counts.values()), *(counts.get(name, 0) for name in present)]


def refusals(store: Store) -> Part:
    """The reasons of unsupported cells, one row for all that share it."""
    found = Counter((each.scene, each.reason) for each in store.planned if each.ended == "unsupported")
    rows = [{"scene": scene, "reason": reason, "count": count} for (scene, reason), count in found.items()]
    return TEXT("refusals", rows=rows) if rows else Part("Every cell that was planned makes sense.")
