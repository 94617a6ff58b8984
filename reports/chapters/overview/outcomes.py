"""What became of the cells that a campaign has planned: counted by class, and why some were not solved."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from reports.markdown import Part, joined, listing, machine, prose, table
from reports.origin import counted
from reports.store.cells import Cell
from reports.store.tables import Store

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


def completeness(store: Store) -> Part:
    """Cells planned by scene and class, and what could not be solved."""
    present = list(counted(store.planned))
    scenes = dict.fromkeys(each.scene for each in store.planned)
    rows = [[scene, *_counts((e for e in store.planned if e.scene == scene), present)] for scene in scenes]
    rows.append(["all", *_counts(store.planned, present)])
    parts = [table(f"Cells of the campaign {store.campaign}", ["scene", "planned", *present], rows)]
    parts.append(prose("; ".join(f"*{name}*: {WORDS[name]}" for name in present) + "."))
    unsolved = [each for each in store.planned if each.ended not in (*SOLVED, "unsupported")]
    if unsolved:
        told = "cell | class | reason", "{label} | {ended} | {reason}"
        parts.append(machine(listing("Cells without a result", unsolved, *told, words=3)))
    return joined(*parts)


def refusals(store: Store) -> str:
    """The reasons of unsupported cells, one row for all that share it."""
    found = Counter((each.scene, each.reason) for each in store.planned if each.ended == "unsupported")
    if not found:
        return "Every cell that was planned makes sense."
    rows = ([scene, reason, count] for (scene, reason), count in found.items())
    return table("Why cells were not solved", ["scene", "reason", "cells"], rows, words=2)


def _counts(planned: Iterable[Cell], present: list[str]) -> list[int]:
    counts = counted(planned)
    return [sum(counts.values()), *(counts.get(name, 0) for name in present)]
