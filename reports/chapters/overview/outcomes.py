"""What became of the cells that a campaign has planned: counted by class, and why some were not solved."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from reports.markdown import machine, prose, table
from reports.tables import CLASSES, Planned, Store

WORDS = {  # of each class, for people
    "converged": "and the judge agrees",
    "wrong": "said to have converged, and the judge does not agree",
    "not-converged": "the iteration, or the path, came to an end before the load",
    "cap-hit": "a limit of iterations was reached",
    "time": "killed at the time limit",
    "memory": "more than the memory limit",
    "crash": "the process died",
    "unsupported": "refused, with a reason",
    "missing": "not solved yet",
}
SOLVED = ("converged", "wrong", "not-converged", "cap-hit")


def completeness_line(store: Store) -> str:
    """How much of the campaign is there, in one line."""
    counts = Counter(each.ended for each in store.planned)
    told = ", ".join(f"{counts[name]} {name}" for name in CLASSES if counts[name])
    return f"{store.campaign}: {len(store.planned)} cells planned: {told or 'none'}"


def completeness(store: Store) -> str:
    """Cells planned by scene and class, and what could not be solved."""
    present = [name for name in CLASSES if any(each.ended == name for each in store.planned)]
    scenes = dict.fromkeys(each.scene for each in store.planned)
    rows = [[scene, *_counts((e for e in store.planned if e.scene == scene), present)] for scene in scenes]
    rows.append(["all", *_counts(store.planned, present)])
    parts = [table(f"Cells of the campaign {store.campaign}", ["scene", "planned", *present], rows)]
    parts.append(prose("; ".join(f"*{name}*: {WORDS[name]}" for name in present) + "."))
    unsolved = [each for each in store.planned if each.ended not in (*SOLVED, "unsupported")]
    if unsolved:
        told = ([each.label, each.ended, each.reason] for each in unsolved)
        parts.append(machine(table("Cells without a result", ["cell", "class", "reason"], told, words=3)))
    return "\n\n".join(parts)


def refusals(store: Store) -> str:
    """The reasons of unsupported cells, one row for all that share it."""
    found = Counter((each.scene, each.reason) for each in store.planned if each.ended == "unsupported")
    if not found:
        return "Every cell that was planned makes sense."
    rows = ([scene, reason, str(count)] for (scene, reason), count in found.items())
    return table("Why cells were not solved", ["scene", "reason", "cells"], rows, words=2)


def _counts(planned: Iterable[Planned], present: list[str]) -> list[str]:
    counts = Counter(each.ended for each in planned)
    return [str(counts.total()), *(str(counts[name]) for name in present)]
